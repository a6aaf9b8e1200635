// Visibility of the queued entries, one thread an entry: one ray for most; more for near leaves; for emitters four,
// eight where those are hidden, and the rest where they disagree. An entry's samples are always taken from the first,
// so the result does not depend on what was known before.
//
// TOPS: of entries of several objects at once, whose samples are each on an object of their own; else of all others.
// Apart, for software renderers run both sides of a branch.
#define READ_FRAME
#define READ_OBJECTS
#define READ_TOPOLOGY
#define READ_REST
#define READ_WORLD
#define READ_VERTICES_REST
#define READ_LEAVES
#define READ_LEAF_QUADS
#define READ_BVH
#define READ_PRIMITIVES
#define READ_TLAS
#define READ_ENTRIES
#define READ_QUEUE
#define READ_NODE_EXITANCE
#define READ_TOUCHED
#define WRITE_ENTRIES
#define WRITE_TARGETS
#define WRITE_TOUCHED
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "entry.glsl"
#include "touched.glsl"
#include "sampling.glsl"
#include "rays.glsl"
#include "segments.glsl"
#include "blocker.glsl"
#include "visibility.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

// So many that agree are enough. Of hidden ones more: in shadow the little that comes in is all the light there is, and
// would come in at one go where the first of four is no longer hidden.
const uint PROBES = 4u;
const uint HIDDEN_PROBES = 8u;
const uint SKY_PROBES = 2u;

// The order that samples of a sequence of 16 are taken in, a hexadecimal digit each: the first four and eight of it
// fill both squares evenly (small wrap-around discrepancy, Hickernell 1998), so that those that agree seldom overlook
// an edge between them. In the sequence's own order the first four leave 0.43 of one coordinate without any.
const uvec2 ORDER = uvec2(0xf653c9a0u, 0xe4d1b278u);

// A patch of black sky has a ray for each so much of its form factor, up to four: a row that missed a large one by a
// single ray would be raised by half.
const float COARSE_SKY = 0.15;

// A larger form factor than this has more of them, in proportion, up to so many times as many: there are few such
// entries, and where they leave little for others, as below a block close above a floor, what is left is known by how
// well they are.
const float LARGE = 0.04;
const float MOST_LARGE = 4.0;
const float MOST_SAMPLES = 16.0; // a bit each in an entry

// A point of a source that is not small next to its distance brings the more light the nearer it is, and is the more
// seldom hidden; so V is wanted of the light, not of the area. Of so many segments one is traced, drawn in proportion
// to what they carry.
const uint CANDIDATES = 4u;

// From a flat source of less than this share of its distance, radius over distance, all points bring about the same.
const float FAR = 0.2;

// Where both ends are on one object its pose must not matter, not even by rounding.
vec4 sphere_of(pair p, uint node)
{
	if (p.same)
		return rest_sphere(node);
	return world_sphere(node);
}

// Emitters are cut fine as it is.
uint candidates_of(pair p, bool emitter)
{
	if (emitter || p.sky)
		return 1u;
	vec4 mine = sphere_of(p, load_leaf(p.leaf).x), theirs = sphere_of(p, p.node);
	bool far = (p.t.range.w & GI_NODE_FLAT) != 0u && theirs.w < FAR * distance(theirs.xyz, mine.xyz);
	return far ? 1u : CANDIDATES;
}

#if TOPS
// One of the objects below a top, by area; u becomes where in its share it was, uniform in [0, 1) again.
void choose_object(inout pair p, inout float u)
{
	uint n = p.node;
	while ((topology_range(n).w & GI_NODE_TOP) != 0u) {
		uint first = n + 1u, second = topology_range(first).x;
		float share = rest_moment(first).w / (rest_moment(first).w + rest_moment(second).w);
		bool one = u < share;
		u = clamp(one ? u / share : (u - share) / (1.0 - share), 0.0, 0.99999994);
		n = one ? first : second;
	}
	set_source(p, load_topology(n));
}
#endif

// False where hardly any of the source is before the receiver.
bool choose_segment(pair p, uint k, uint candidates, out segment_end a, out segment_end b, inout body on)
{
	float sum = 0.0;
	for (uint attempt = 0u; attempt < candidates || (sum == 0.0 && attempt < TRIES); attempt++) {
		vec4 u = segment_numbers(p.ids.x, p.ids.y, attempt, k);
		vec3 m;
#if TOPS
		choose_object(p, u.z);
#endif
		segment_end from = end_on(p.receiver, p.leaf, point_on(p.mine, u.xy));
		segment_end to = source_end(p, u.zw, m);
		float carried = transfer(p, from, to, u.xy, m);
		if (carried == 0.0)
			continue;
		sum += carried;
		// The first always, the next ones by their parts of the sum.
		if (unit_float(hash(p.ids.x * 0x9e3779b9u ^ hash(p.ids.y ^ hash(k + 16u * attempt)))) * sum <=
		    carried) {
			a = from;
			b = to;
#if TOPS
			on = p.source;
#endif
		}
	}
	return sum > 0.0;
}

// Of samples that one blocker hides and one that another does. Static objects have the first slots and are asked first
// (tlas.c): that they hide it is said the same way whichever of them does, and whatever else is there.
uint joined_blocker(uint blocker, uint by)
{
	uint kind = by < frame.swept.z ? GI_BLOCKER_STATICS : by;
	return blocker == GI_BLOCKER_NONE || blocker == kind ? kind : GI_BLOCKER_MIXED;
}

// Does a static face hide all of the source, a mover, from the leaf (covered.comp)? Then all rays would be hidden.
bool is_behind_face(uint leaf, uvec4 source)
{
	if (TOPS == 1 || (source.w & GI_NODE_SKY) != 0u)
		return false;
	uint k = object_extra(load_leaf(source.y).y).w;
	return k > 0u && is_covered(leaf, k - 1u);
}

// How many rays an entry has.
struct sampling {
	uint wanted;        // at most
	uint probes;        // so many where they agree,
	uint hidden_probes; // and where all are hidden
};

// Rays go where much light may come from: to emitters, and to what is so near that even a leaf is more than the
// tolerance. Stopping early sharpens penumbrae a little; only emitters, cut so fine that it does not show, have so many
// rays to save. Black sky is not seen at all.
sampling sampling_of(float factor, uint flags)
{
	bool emitter = (flags & GI_NODE_EMITTER) != 0u;
	bool dark_sky = (flags & GI_NODE_SKY) != 0u && frame.misc.w == 0u;
	float most = float(frame.limits.z) * clamp(factor / LARGE, 1.0, MOST_LARGE);
	uint near = uint(clamp(factor / frame.tolerance.x, 1.0, min(most, MOST_SAMPLES)));
	uint dark = max((near + 3u) / 4u, uint(clamp(factor / COARSE_SKY, 1.0, float(PROBES))));
	uint wanted = emitter ? frame.limits.w : dark_sky ? dark : near;
	uint probes = emitter ? min(wanted, PROBES) : dark_sky ? min(wanted, SKY_PROBES) : wanted;
	return sampling(wanted, probes, emitter ? min(wanted, HIDDEN_PROBES) : probes);
}

// What the samples of an entry found so far.
struct findings {
	uint taken;
	uint visible; // a bit each
	uint blocker; // of those that are hidden
	uint leaf;    // of the source, one that is seen; where none is, the first; GI_NONE: no segment carries light
};

// The place in the sequence of the sample that is taken next.
uint sample_of(uint taken, bool reordered)
{
	return reordered ? ((taken < 8u ? ORDER.x : ORDER.y) >> (4u * (taken & 7u))) & 15u : taken;
}

// The leaf that a ray arrived at takes over from the one before, so that each that is seen stays by the same chance.
void note_leaf(pair p, uint leaf, bool seen, inout findings f)
{
	float pick = unit_float(hash(p.ids.x * 0x9e3779b9u ^ hash(p.ids.y ^ hash(~f.taken))));
	bool takes_over = seen && pick * float(bitCount(f.visible) + 1) < 1.0;
	f.leaf = f.leaf == GI_NONE || takes_over ? leaf : f.leaf;
}

// The k-th sample of the sequence. `clear`: the bodies at its ends are known to hide nothing.
void take_sample(pair p, uint k, uint candidates, bool clear, inout findings f)
{
	segment_end a, b;
	body on = p.source;
	// What is not before the receiver must not shine through its back.
	uint by = p.receiver.object;
	if (choose_segment(p, k, candidates, a, b, on)) {
		by = blocker_of(p.receiver, a, on, b, !p.back, clear);
		note_leaf(p, b.leaf, by == GI_BLOCKER_NONE, f);
	}
	if (by == GI_BLOCKER_NONE)
		f.visible |= 1u << f.taken;
	else
		f.blocker = joined_blocker(f.blocker, by);
	f.taken++;
}

// Do so many samples say the same as all would?
bool is_settled(findings f, sampling rays)
{
	bool agree = f.visible == 0u || f.visible == (1u << f.taken) - 1u;
	return agree && f.taken == (f.visible == 0u ? rays.hidden_probes : rays.probes);
}

// `clear`: a bit for each sample that the bodies at its ends are known not to hide.
findings trace(pair p, sampling rays, uint clear)
{
	bool emitter = (p.t.range.w & GI_NODE_EMITTER) != 0u;
	bool reordered = emitter || (!p.sky && rays.wanted <= PROBES);
	uint candidates = candidates_of(p, emitter);
	findings f = findings(0u, 0u, GI_BLOCKER_NONE, GI_NONE);
	while (f.taken < rays.wanted) {
		take_sample(p, sample_of(f.taken, reordered), candidates, (clear & (1u << f.taken)) != 0u, f);
		if (is_settled(f, rays))
			break;
	}
	return f;
}

void keep(uint slot, uvec4 entry, uint visible, uint blocker, uint taken)
{
	entries[slot].z = visible | (blocker << 16u);
	if (taken != samples_of(entry))
		entries[slot].w = (taken << GI_ENTRY_SAMPLE_SHIFT) |
				  (entry.w & ~(GI_ENTRY_SAMPLE_MASK << GI_ENTRY_SAMPLE_SHIFT));
}

// The node whose B the entry's link takes. The light is that of a leaf that was seen: of the node's others some may be
// on the far side of a wall, or in another light altogether. On average it is what the node shows.
uint target_of(pair p, uint found)
{
	uint target = p.sky || found == GI_NONE ? p.node : load_leaf(found).x;
	// Where that begins or ceases to be black the object is relit, and its cuts are made anew.
	vec4 shines = load_exitance(target); // in w its rho
	return target | (shines.w > 0.0 || shines.x + shines.y + shines.z > 0.0 ? 0u : GI_TARGET_BLACK);
}

// Is the row to be closed again? Closing leaves out what no ray sees, but for black sky, and counts its rays among
// those of what is seen of the same source: that is traced anew with it or not at all. Of the same samples seen the
// same target is drawn.
bool changes_row(pair p, uvec4 entry, findings f, bool is_new)
{
	return is_new ? f.visible != 0u || p.sky : f.visible != (entry.z & 0xFFFFu) || f.taken != samples_of(entry);
}

void main()
{
	uint t = thread_number();
	if (t >= min(state.counts.queued, frame.limits.y))
		return;
	uint slot = load_queued(t);
	uvec4 entry = load_entry(slot), source = topology_range(entry.x);
	if (((source.w & GI_NODE_TOP) != 0u) != (TOPS == 1))
		return;
	float factor = uintBitsToFloat(entry.y);
	sampling rays = sampling_of(factor, source.w);
	bool is_new = t < state.counts.new_entries, none = factor <= 0.0;
	if (none || (is_new && is_behind_face(entry.w & GI_ENTRY_LEAF_MASK, source))) {
		// However small, a bright lamp may be behind it.
		keep(slot, entry, 0u, none ? GI_BLOCKER_NONE : GI_BLOCKER_STATICS, none ? 0u : rays.hidden_probes);
		targets[slot] = entry.x;
		return;
	}
	pair p = load_pair(entry);
	// What was visible before, of an entry between bodies that are at rest to each other, they do not hide now.
	findings f = trace(p, rays, is_new ? 0u : entry.z & 0xFFFFu);
	keep(slot, entry, f.visible, f.blocker, f.taken);
	if (changes_row(p, entry, f, is_new))
		note_changed(p.leaf);
	targets[slot] = target_of(p, f.leaf);
	atomicAdd(state.counts.rays, f.taken);
}
