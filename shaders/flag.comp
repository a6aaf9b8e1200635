#version 450 core
// Queues the entries at rest that a mover may have changed (flag.glsl). One thread a row; the row is current afterwards.
#define READ_FRAME
#define READ_OBJECTS
#define READ_TOPOLOGY
#define READ_WORLD
#define READ_LEAVES
#define READ_SEGMENTS
#define READ_ENTRIES
#define READ_SUSPECTS
#define READ_ROWS
#define READ_CHOICES
#define WRITE_QUEUE
#define WRITE_TOUCHED
#define WRITE_ROWS
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "changed.glsl"
#include "entry.glsl"
#include "flag.glsl"
#include "chosen.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint leaf = chosen_row();
	if (leaf == GI_NONE)
		return;
	watch w = watch_of(leaf);
	gi_node_geometry p = load_world(load_leaf(leaf).x);
	uint flagged = 0u;
	for (uint source = frame.trails.z; source < frame.counts.z; source++) {
		if (pair_is_dirty(w.mine, source, w.since) && !pair_keeps_nodes(w.mine, source, w.since))
			continue; // cut anew
		uvec4 block = load_segment(segment_of(leaf, source));
		uint count = block.y & GI_BLOCK_COUNT_MASK;
		for (uint k = 0u; k < count; k++) {
			if (!is_flagged(w, p, load_entry(block.x + k)))
				continue;
			uint q = atomicAdd(state[GI_STATE_QUEUED], 1u);
			if (q < frame.limits.y)
				queue[q] = block.x + k;
			else
				atomicOr(state[GI_STATE_OVERFLOW], 1u);
			flagged++;
		}
	}
	if ((load_row(leaf).w & GI_ROW_OPEN) != 0u)
		flagged = max(flagged, 1u);
	if (flagged > 0u)
		touched[leaf] += flagged;
	rows[leaf].z = frame.update.x;
}
