#version 450 core
// Lists the entries that see a mirror or glass, of the rows that this update refreshed: of all or, under a budget, of
// those chosen. What is seen there may have changed whatever moved, so that these rows are closed again. One thread a
// row.
#define READ_FRAME
#define READ_OBJECTS
#define READ_TOPOLOGY
#define READ_SEGMENTS
#define READ_ENTRIES
#define READ_TARGETS
#define READ_CHOICES
#define WRITE_QUEUE
#define WRITE_TOUCHED
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "chosen.glsl"
#include "entry.glsl"
#include "specular_entry.glsl"
#include "touched.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint leaf = (frame.update.w & GI_UPDATE_PART) != 0u ? chosen_row() : thread_number();
	if (leaf >= frame.rows.x || state.counts.overflow != 0u)
		return;
	bool any = false;
	for (uint source = frame.swept.z; source < frame.counts.z; source++) {
		if (!has_smooth(source))
			continue;
		uvec2 block = load_segment(segment_of(leaf, source)).xy;
		for (uint k = block.x; k < block.x + (block.y & GI_BLOCK_COUNT_MASK); k++) {
			if (!sees_smooth(load_entry(k), load_target(k)))
				continue;
			queue[atomicAdd(state.counts.specular_paths, 1u)] = k;
			any = true;
		}
	}
	if (any)
		note_changed(leaf);
}
