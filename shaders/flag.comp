#version 450 core
// Queues the entries at rest that a mover may have changed (flag.glsl). One thread a row; the row is current
// afterwards.
#define READ_FRAME
#define READ_OBJECTS
#define READ_TOPOLOGY
#define READ_WORLD
#define READ_LEAVES
#define READ_SEGMENTS
#define READ_ENTRIES
#define READ_OBJECT_LISTS
#define READ_ROWS
#define READ_CHOICES
#define READ_TOUCHED
#define WRITE_ENTRIES
#define WRITE_QUEUE
#define WRITE_TOUCHED
#define WRITE_ROWS
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "changed.glsl"
#include "entry.glsl"
#include "swept.glsl"
#include "flag.glsl"
#include "chosen.glsl"
#include "touched.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

// The row of this thread: under a budget of those chosen, else of those that concern.comp listed; GI_NONE: none.
uint row_to_look_at()
{
	if ((frame.update.w & GI_UPDATE_PART) != 0u)
		return chosen_row();
	uint k = spread_number(state.counts.concerned_rows);
	return k < state.counts.concerned_rows ? load_listed(k) : GI_NONE;
}

// What may have changed entries of a row: a mover, or of a leaf that moved one of its neighbours.
struct candidate {
	uint object;    // GI_NONE: it went, or there is none
	bool first;     // of those of the row
	obstacle box;   // where it is
	place in_box;   // where the leaf lies, as seen from that box
	bool was;       // it was elsewhere when the row was refreshed
	place in_trail; // the same for the box of where it was
	place in_hull;  // the same for the box around both
	vec4 hull;      // ball around the box of both
	bool counts;
};

// covered: a static face hides it from the leaf.
candidate load_candidate(watch w, gi_node_geometry p, uint k, bool covered)
{
	uvec4 change = load_swept_change(min(k, max(frame.swept.y, 1u) - 1u));
	bool there = w.candidates.x + k < w.candidates.y;
	vec4 lower = load_swept_corner(k, 2u), upper = load_swept_corner(k, 3u);
	candidate s;
	s.object = !w.moved ? change.y : there ? load_listed_object(w.candidates.x + k) : GI_NONE;
	s.first = k == 0u;
	s.box = load_obstacle(s.object == GI_NONE ? w.mine : s.object, s.object != GI_NONE);
	s.in_box = place_of(s.box, p.sphere.xyz);
	s.was = change.z != 0u && !w.moved;
	s.in_trail = place_in(p.sphere.xyz, load_swept_corner(k, 0u).xyz, load_swept_corner(k, 1u).xyz);
	s.in_hull = place_in(p.sphere.xyz, lower.xyz, upper.xyz);
	s.hull = w.moved ? s.box.ball : ball_about(lower, upper);
	s.counts = w.moved ? there || k == 0u
			   : k < frame.swept.y && change.x > w.since && !covered && reaches_before(s.hull, p);
	return s;
}

// May the candidate have changed what is seen of the node? One test serves three cases: an entry that is seen is held
// against the box where the candidate is, one that several objects hide against where it was, one seen in part against
// the box around both.
bool crosses(candidate s, gi_node_geometry p, uint node, bool seen, bool mixed, bool sky)
{
	vec4 ball = world_sphere(node);
	bool is = seen && s.box.counts, was = mixed && s.was;
	vec3 way = ball.xyz - p.sphere.xyz, turned = turned_into(s.box, way);
	place o = s.in_box;
	o.below = was ? is ? s.in_hull.below : s.in_trail.below : o.below;
	o.above = was ? is ? s.in_hull.above : s.in_trail.above : o.above;
	o.slack = was ? max(s.in_hull.slack, s.in_trail.slack) : o.slack;
	bool crossed = crosses_box(o, was ? way : turned, p.sphere.w, ball.w);
	return (is || was) && (sky ? cone_meets(s.hull, p.sphere, ball) : crossed);
}

bool is_flagged_for(watch w, gi_node_geometry p, candidate s, uvec4 entry, bool sky)
{
	uint blocker = entry.z >> 16u;
	bool hid = w.moved ? s.first && blocker != w.mine && blocker != GI_BLOCKER_NONE : blocker == s.object;
	bool crossed = crosses(s, p, entry.x, (entry.z & 0xFFFFu) != 0u, is_hidden_by_several(w, blocker), sky);
	return samples_of(entry) > 0u && (hid || crossed);
}

void main()
{
	uint leaf = row_to_look_at();
	if (leaf == GI_NONE)
		return;
	watch w = watch_of(leaf);
	gi_node_geometry p = load_world(load_leaf(leaf).x);
	uint flagged = 0u, candidates = w.moved ? max(w.candidates.y - w.candidates.x, 1u) : frame.swept.y;
	for (uint k = 0u; k < candidates; k++) {
		candidate s = load_candidate(w, p, k, is_covered(leaf, k));
		uint source = s.counts ? frame.swept.z : frame.counts.z, at = 0u, end = 0u;
		bool sky = false;
		while (source < frame.counts.z || at < end) {
			if (at == end) {
				uvec4 block = load_segment(segment_of(leaf, source));
				sky = (object_bvh(source).z & GI_OBJECT_SKY) != 0u;
				at = block.x;
				bool cut_anew = pair_is_dirty(w.mine, source, w.since) &&
						!pair_keeps_nodes(w.mine, source, w.since);
				end = at + (cut_anew ? 0u : block.y & GI_BLOCK_COUNT_MASK);
				source++;
				continue;
			}
			uvec4 entry = load_entry(at);
			at++;
			// An entry that another candidate of the row was flagged for bears a mark (unmark.comp).
			if (!is_flagged_for(w, p, s, entry, sky) ||
			    (k > 0u && (entries[at - 1u].y & GI_ENTRY_FLAGGED) != 0u))
				continue;
			if (frame.inner.w != 0u)
				entries[at - 1u].y = entry.y | GI_ENTRY_FLAGGED;
			uint q = atomicAdd(state.counts.queued, 1u);
			if (q < frame.limits.y)
				queue[q] = at - 1u;
			else
				atomicOr(state.counts.overflow, 1u);
			flagged++;
		}
	}
	if (flagged > 0u)
		note_dirty(leaf, flagged);
	if ((load_row(leaf).w & GI_ROW_OPEN) != 0u)
		note_changed(leaf);
	rows[leaf].z = frame.update.x;
}
