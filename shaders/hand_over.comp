#version 450 core
// The second half of a sweep: R of every leaf to its node, which is where links lead (rays end on leaves). Means of
// other nodes wait for the end of the solve (pull.comp). One thread a leaf.
#define READ_FRAME
#define READ_LEAVES
#define READ_LEAF_RADIOSITY
#define WRITE_RADIOSITY
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint leaf = thread_number();
	if (leaf < frame.counts.x)
		radiosity[GI_NODE_R * frame.counts.y + load_leaf(leaf).x] = load_leaf_part(GI_LEAF_R, leaf);
}
