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
#include "samples.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

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

// What the samples of an entry found so far.
struct findings {
	uint taken;
	uint visible; // a bit each
	uint blocker; // of those that are hidden
	uint leaf;    // of the source, one that is seen; where none is, the first; GI_NONE: no segment carries light
};

// A leaf that a ray arrived at: where none is seen the first stays.
void note_leaf(pair p, uint leaf, bool seen, inout findings f)
{
	bool takes = seen && takes_over(p.ids, f.taken, uint(bitCount(f.visible)));
	f.leaf = f.leaf == GI_NONE || takes ? leaf : f.leaf;
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
	bool emitter = is_bright(p.t.range.w);
	bool reordered = is_reordered(rays, emitter, p.sky);
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
	sampling rays = sampling_of(entry, source.w);
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
