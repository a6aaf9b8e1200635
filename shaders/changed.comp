#version 450 core
// Lists the rows to close: those that closing may bring otherwise than they were. One thread a leaf.
#define READ_FRAME
#define READ_TOUCHED
#define WRITE_TOUCHED
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "touched.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint leaf = thread_number();
	if (leaf < frame.rows.x && load_touched(frame.rows.x + leaf) != 0u)
		list_row(leaf, atomicAdd(state.counts.changed_rows, 1u));
}
