// The cut of one source object's hierarchy for one receiver leaf: the nodes that stand for it in the leaf's row, coarse
// where they subtend little. A thread walks one (leaf, object) pair: of a run (x first thread, y receiving object, z
// source object, w first leaf), or under a budget of the chosen leaves times all objects.
//
// KEEPS: of the static ones, where what a row has of nodes that stayed what they were is kept, as entries. OWN: of
// objects whose shape may change, for their own leaves: every shape makes all of these anew, so what brings next to
// nothing, two of three, is left out. Else of all others. Apart, for software renderers run both sides of a branch.
#ifndef OWN
#define OWN 0
#endif
#define READ_FRAME
#define READ_OBJECTS
#define READ_SPREAD
#define READ_TOPOLOGY
#define READ_REST
#define READ_WORLD
#define READ_LEAVES
#define READ_SEGMENTS
#define READ_RUNS
#define READ_ROWS
#define READ_CHOICES
#define WRITE_SEGMENTS
#define WRITE_ENTRIES
#define WRITE_TARGETS
#define WRITE_QUEUE
#define WRITE_TOUCHED
#define WRITE_STATE
#define WRITE_ENTRY_POOL
#include "buffers.glsl"
#include "dispatch.glsl"
#include "changed.glsl"
#include "chosen.glsl"
#include "facing.glsl"
#include "fineness.glsl"
#include "spread.glsl"
#define POOL entry_pool
#include "pool.glsl"
#include "touched.glsl"
#include "numbers.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

const uint CUT_SKIP = 0u, CUT_REFINE = 1u, CUT_TAKE = 2u;

// A cluster of less area than this share of its radius squared (a square has 2 of it) has gaps; taken as a point from
// within this many radii it is off by more than 5 %.
const float SPARSE = 0.35;
const float SPARSE_NEAR = 4.0;

// From within this many radii the middle of a node that is seen along it says little of its nearest part: of a floor
// from 5 cm above one corner, a thousandth of what that corner shows. Along it: where so much of its area shows at
// most; it is refined as if so much did.
const float NEAR = 1.5;
const float ALONG = 0.25;

// Nor are several walls like anything at their middle: an open surface whose normals are farther apart than this
// cosine, or what is flat and yet no quad.
const float APART = 0.8;
const float FLAT = 1.0 - 1e-6;

gi_node_geometry geometry_of(uint node, bool same)
{
	// Pairs of one rigid object are computed in its rest frame: their cut does not change when it moves, to the
	// bit.
	if (same)
		return load_rest(node);
	return load_world(node);
}

uint classify_sky(shape p, gi_node_geometry g, uint flags, float refinement)
{
	float height = dot(p.axis, g.sphere.xyz) + g.sphere.w + (p.cone < 0.0 ? 1.0 : sine_of(p.cone));
	if (height <= 0.0)
		return CUT_SKIP;
	float estimate = g.moment.w * min(1.0, height) / PI;
	// Down to what is small and bright, however little it subtends.
	bool refine = refinement * estimate > frame.tolerance.z ||
		      (flags & (GI_NODE_FINER_MOST << GI_NODE_FINER_SHIFT)) != 0u;
	return (flags & GI_NODE_LEAF) == 0u && refine ? CUT_REFINE : CUT_TAKE;
}

// The object whose frame a node's spread is in; that of tops is the world, as their source's.
uint object_of(uint source, uvec4 range)
{
	return source != frame.swept.w || (range.w & GI_NODE_TOP) != 0u ? source : load_leaf(range.y).y;
}

// The other side of a sheet of two sides: the leaf's own corners, the other way round. Where they are in no plane, be
// it by their rounding, heights over it say nothing.
const float ONE_PLACE = 1e-5, OPPOSITE = 0.9;

bool is_other_side(shape p, gi_node_geometry g)
{
	float slack = ONE_PLACE * p.radius + POSITION_SLACK * length(p.centre);
	return dot(p.axis, g.axis.xyz) < -OPPOSITE && distance(p.centre, g.sphere.xyz) <= slack &&
	       abs(p.radius - g.sphere.w) <= slack;
}

// Emitters are fine enough for finer rows as they are.
float tolerance_of(uint flags, float refinement)
{
	uint finer = (flags >> GI_NODE_FINER_SHIFT) & GI_NODE_FINER_MOST;
	return max(frame.tolerance.x / max(float(1u << finer), refinement),
		   min(frame.tolerance.y, frame.tolerance.x / refinement));
}

// shown: the area that is seen of a node that is taken.
uint classify(uint leaf, shape p, float refinement, gi_node_geometry g, uvec4 range, uint node, uint source, bool same,
	      out float shown)
{
	uint flags = range.w;
	shown = g.moment.w;
	if ((flags & GI_NODE_SKY) != 0u)
		return classify_sky(p, g, flags, refinement);
	facing f = facing_of(p, g, flags);
	if (f.unseen)
		return CUT_SKIP;
	if ((flags & GI_NODE_LEAF) != 0u)
		return is_other_side(p, g) && load_leaf(range.y).y == load_leaf(leaf).y ? CUT_SKIP : CUT_TAKE;
	float d = f.d;
	// Nor anything where the two face each other, a hair apart.
	float reach = g.sphere.w + (dot(p.axis, g.axis.xyz) < 0.0 ? p.radius : 0.0);
	if (d < max(g.sphere.w, reach))
		return CUT_REFINE;
	bool near = f.faced < ALONG * d && d < NEAR * g.sphere.w;
	shown = g.moment.w * min(1.0, f.faced / d);
	if (g.axis.w < FLAT_CONE) {
		vec3 view = f.to / -d;
		vec2 sides = shown_area(load_spread(node), g.moment, view,
					same ? view : rest_direction_from_world(object_of(source, range), view));
		shown = (flags & GI_NODE_BACK) != 0u ? max(sides.x, sides.y) : sides.x;
	}
	// Patches far apart in a cluster: little of them, and yet the nearest is not where the cluster's middle is.
	// Of lamps what they show counts, so that rows of them seen edge-on are refined too.
	float area = (flags & GI_NODE_EMITTER) != 0u ? shown : g.moment.w;
	bool sparse = area < SPARSE * g.sphere.w * g.sphere.w;
	bool walls = ((flags & GI_NODE_BACK) != 0u && g.axis.w < APART) || g.axis.w >= FLAT;
	if ((sparse || walls) && (flags & GI_NODE_POLYGON) == 0u && d < SPARSE_NEAR * g.sphere.w)
		return CUT_REFINE;
	float most = near ? max(shown, ALONG * g.moment.w) : shown;
	float estimate = most * min(1.0, f.height / d) / (PI * d * d + most);
	return estimate > tolerance_of(flags, refinement) ? CUT_REFINE : CUT_TAKE;
}

#if OWN
// A form factor of less than this share of the tolerance is left out. All of them are a thousandth of a row.
const float NEGLIGIBLE = 0.01;

// Of squares side by side the middles are farther apart than this share of both radii.
const float OVERLAP = 0.65;

// Mean height above a plane of what reaches `reach` to both sides of its middle, at a height.
float mean_above(float height, float reach)
{
	float above = clamp(height + reach, 0.0, 2.0 * reach);
	return max(height, above * above / max(4.0 * reach, 1e-30));
}

// Does a node that would be taken bring next to nothing? Of a curved surface most of what balls and cones let through
// (facing.glsl) lies below the horizon, or so close above it that rays to it are wasted. What is no polygon is taken as
// a disc, its middle for all of it (factor.glsl). Where the two face each other a hair apart, or pass through each
// other, heights say nothing.
bool is_negligible(shape p, gi_node_geometry g, uint flags, float shown)
{
	bool polygon = (flags & GI_NODE_LEAF) != 0u || ((flags & GI_NODE_POLYGON) != 0u && g.axis.w >= FLAT_CONE);
	vec3 to = g.sphere.xyz - p.centre;
	float d = max(length(to), p.radius), apart = length(cross(p.axis, g.axis.xyz));
	float height = dot(p.axis, to), faced = -dot(g.axis.xyz, to);
	bool across = dot(p.axis, g.axis.xyz) < 0.0, before = height > 0.0 && faced > 0.0;
	if (across && d < (before ? 1.0 : OVERLAP) * (p.radius + g.sphere.w))
		return false;
	float fold = p.cone < FOLDED ? d * sine_of(p.cone) : 0.0;
	height = mean_above(height, fold + (polygon ? g.sphere.w * apart : 0.0));
	faced = mean_above(faced, d * sine_of(g.axis.w) + p.radius * apart);
	shown *= polygon && (flags & GI_NODE_BACK) == 0u ? min(faced / d, 1.0) : 1.0;
	return shown * min(height / d, 1.0) <= NEGLIGIBLE * tolerance_of(flags, 1.0) * (PI * d * d + shown);
}
#endif

// What closing wants to know of a node, kept with the entry.
uint kind_of(uint flags)
{
	return ((flags & GI_NODE_EMITTER) != 0u ? GI_ENTRY_EMITTER : 0u) |
	       ((flags & (GI_NODE_POLYGON | GI_NODE_SKY)) != 0u ? GI_ENTRY_EXACT : 0u);
}

// What a row has of the static ones while that is brought up to date: entries [next, end), in the order of the cut.
struct old_part {
	uint next, end;
	uint since; // the update that refreshed the row
};

// Is a node, or something below it, another than when the row was refreshed?
bool is_fresh(uvec4 range, uint node, uint since)
{
	if ((range.w & GI_NODE_TOP) != 0u)
		return topology_corners(node).y > since;
	uvec4 changed = object_changed(load_leaf(range.y).y);
	return max(changed.x, changed.y) > since;
}

// To the next entry that is there, at or after a node.
void pass_over(inout old_part old, uint node)
{
	while (old.next < old.end && (entries[old.next].x < node || (entries[old.next].w & GI_ENTRY_GONE) != 0u))
		old.next++;
}

struct cut_size {
	uint nodes, fresh; // how many there are, and of them those that the row had not
};

// Writes the first `room` nodes of the cut at entry `at`. Of what is in `old` it takes over what is below nodes that
// are not fresh: a row that has something of such a node has its whole cut. With `at` not behind old.next nothing is
// overwritten before it is read. Fresh ones are queued from `queued` on, where the row keeps some.
cut_size write_cut(shape p, float refinement, uint leaf, uint source, bool same, uint at, uint room, old_part old,
		   uint queued)
{
	uvec4 nodes = object_nodes(source);
	cut_size size = cut_size(0u, 0u);
	bool keeps = KEEPS == 1 && old.end > old.next;
	for (uint n = nodes.x; n < nodes.y;) {
		uvec4 range = topology_range(n);
#if KEEPS
		pass_over(old, n);
#endif
		if (KEEPS == 1 && old.next < old.end && entries[old.next].x < range.x &&
		    !is_fresh(range, n, old.since)) {
			for (; old.next < old.end && entries[old.next].x < range.x; pass_over(old, n)) {
				if (size.nodes < room && old.next != at + size.nodes) {
					entries[at + size.nodes] = entries[old.next];
					targets[at + size.nodes] = targets[old.next];
				}
				size.nodes++;
				old.next++;
			}
			n = range.x;
			continue;
		}
		gi_node_geometry g = geometry_of(n, same);
		float shown;
		uint verdict = classify(leaf, p, refinement, g, range, n, source, same, shown);
#if OWN
		if (verdict == CUT_TAKE && is_negligible(p, g, range.w, shown))
			verdict = CUT_SKIP;
#endif
		if (verdict == CUT_TAKE) {
			// The form factor and the visibility come from the passes that follow; one sample is what most
			// take. It is no entry that a mover may have changed.
			if (size.nodes < room) {
				entries[at + size.nodes] =
				    uvec4(n, 0u, GI_BLOCKER_NONE << 16u,
					  leaf | (1u << GI_ENTRY_SAMPLE_SHIFT) | kind_of(range.w));
				if (keeps && queued + size.fresh < frame.limits.y)
					queue[queued + size.fresh] = at + size.nodes;
			}
			size.nodes++;
			size.fresh++;
		}
		n = verdict == CUT_REFINE ? n + 1u : range.x;
	}
	return size;
}

// Makes room for `count` entries before those of a block that has it.
void shift(inout old_part old, uint count)
{
	for (uint k = old.end; k > old.next; k--) {
		entries[k - 1u + count] = entries[k - 1u];
		targets[k - 1u + count] = targets[k - 1u];
	}
	old.next += count;
	old.end += count;
}

// Leaf and source object of a thread; no leaf when it has nothing to do. Threads side by side share the source.
uvec2 pair_of(uint t)
{
#if OWN
	if ((frame.update.w & GI_UPDATE_PART) != 0u) {
		uint leaf = chosen_row();
		return leaf == GI_NONE ? uvec2(GI_NONE) : uvec2(leaf, load_leaf(leaf).y);
	}
	if (t >= frame.statics.w)
		return uvec2(GI_NONE);
	t += frame.work.w;
#else
	if ((frame.update.w & GI_UPDATE_PART) != 0u) {
		uint count = state.refresh.chosen_rows;
		return t < count * source_count() ? uvec2(chosen_leaf(t % count), frame.swept.z + t / count)
						  : uvec2(GI_NONE);
	}
	if (t >= frame.work.w)
		return uvec2(GI_NONE);
#endif
	uvec4 run = find_run(frame.work.x, frame.work.z, t);
	return uvec2(run.w + (t - run.x), run.z);
}

// Does the pair's cut have to be made anew, and by this shader?
bool is_wanted(uint mine, uint source, uint since)
{
	bool own = mine == source && (object_bvh(source).z & GI_OBJECT_DEFORMS) != 0u;
	if (own != (OWN == 1))
		return false;
	if ((frame.update.w & GI_UPDATE_REBUILD) != 0u)
		return KEEPS == 0;
	return pair_is_dirty(mine, source, since) && pair_keeps_nodes(mine, source, since) == (KEEPS == 1);
}

// The cut of a pair while it is made.
struct cut {
	uint leaf, source;
	bool same, unseen;
	shape receiver;
	float refinement;
	uint segment;
	uvec2 block;    // of entries
	uint old_count; // how many the segment had
	bool keeps;     // some of them stay
	old_part old;
	cut_size size;
	uint queued;    // where its entries begin in the queue
};

cut begin_cut(uint leaf, uint source, uvec4 receiver, uint since)
{
	cut c;
	c.leaf = leaf;
	c.source = source;
	c.same = receiver.y == source;
	c.unseen = ((object_bvh(receiver.y).z | object_bvh(source).z) & GI_OBJECT_UNSEEN) != 0u;
	c.receiver = shape_of(geometry_of(receiver.x, c.same), topology_range(receiver.x).w);
	c.refinement = fineness_of(leaf).refinement;
	c.segment = segment_of(leaf, source);
	c.block = load_segment(c.segment).xy;
	c.old_count = c.block.y & GI_BLOCK_COUNT_MASK;
	c.keeps = KEEPS == 1 && !c.unseen && c.old_count > 0u;
	c.old = old_part(c.block.x, c.keeps ? c.block.x + c.old_count : c.block.x, since);
	c.size = cut_size(0u, 0u);
	c.queued = 0u;
	return c;
}

// Finds room for what a walk came to; true: it has to be walked again. 
bool fit_cut(uint room, bool counted, inout cut c)
{
	uint needed = c.keeps && c.size.nodes > 0u ? c.old_count + c.size.fresh : c.size.nodes;
	uvec2 fitting = fit_block(c.block, needed);
	bool full = fitting.x == GI_NONE; // then what there is room for is kept
	bool again = !full && (counted || fitting != c.block) && c.size.nodes > 0u;
	if (c.keeps && again) {
		if (fitting == c.block)
			shift(c.old, c.size.fresh);
		c.queued = atomicAdd(state.counts.new_entries, c.size.fresh);
	}
	c.size.nodes = full ? min(c.size.nodes, room) : c.size.nodes;
	c.block = full ? c.block : fitting;
	return again;
}

// Writes the entries; false: nothing of them changed. Walked again where the block turns out not to fit, above all the
// first time, and where entries are kept: first to see how many come. One place that walks, takes and writes: every
// call is put in line, and compilers take their time with copies.
bool make_cut(inout cut c)
{
	bool counts = c.keeps;
	for (bool again = true; again; counts = false) {
		bool has = c.block.y >> 24u != GI_BLOCK_NO_CLASS;
		uint room = has && !counts ? GI_BLOCK_SMALLEST << (c.block.y >> 24u) : 0u;
		if (!c.unseen)
			c.size = write_cut(c.receiver, c.refinement, c.leaf, c.source, c.same, c.block.x, room, c.old,
					   c.queued);
		if (c.keeps && !counts)
			break;
		if (counts && c.size.fresh == 0u && c.size.nodes == c.old_count)
			return false;
		again = fit_cut(room, counts, c);
	}
	return true;
}

// What was seen is seen no more as it was; what is seen now, tracing finds. Of emitters closing leaves the sum of form
// factors.
void note_cut(cut c)
{
	segments[c.segment].xy = uvec2(c.block.x, (c.block.y & ~GI_BLOCK_COUNT_MASK) | c.size.nodes);
	if (c.size.nodes != c.old_count)
		atomicAdd(state.rows.entries, c.size.nodes - c.old_count);
	if (c.size.nodes + c.old_count > 0u)
		note_dirty(c.leaf, max(c.size.fresh, 1u));
	bool was_seen = c.old_count > 0u && uintBitsToFloat(load_segment(c.segment).z) > 0.0;
	if (was_seen || (c.size.nodes > 0u && (topology_range(object_nodes(c.source).x).w & GI_NODE_EMITTER) != 0u))
		note_changed(c.leaf);
}

// Of a cut that keeps entries the fresh ones are in the queue already (write_cut).
void queue_cut(inout cut c)
{
	if (!c.keeps)
		c.queued = atomicAdd(state.counts.new_entries, c.size.nodes);
	if (c.queued + c.size.fresh > frame.limits.y) {
		atomicOr(state.counts.overflow, 1u);
		return;
	}
	for (uint k = 0u; k < c.size.nodes && !c.keeps; k++)
		queue[c.queued + k] = c.block.x + k;
}

void main()
{
	uvec2 pair = pair_of(thread_number());
	if (pair.x == GI_NONE)
		return;
	uvec4 receiver = load_leaf(pair.x);
	uint since = load_row(pair.x).z;
	if (!is_wanted(receiver.y, pair.y, since))
		return;
	cut c = begin_cut(pair.x, pair.y, receiver, since);
	if (!make_cut(c))
		return;
	note_cut(c);
	if (c.size.nodes > 0u)
		queue_cut(c);
}
