#version 450 core
// What light there is before the solve. Of each object's leaves the largest B, that of those that emit nothing, the
// least; of each leaf B, and H in the place of the bound that assess.comp makes with it. One thread a leaf.
#define READ_FRAME
#define READ_TOPOLOGY
#define READ_LEAVES
#define READ_ROWS
#define READ_LINKS
#define READ_RADIOSITY
#define READ_LEAF_RADIOSITY
#define WRITE_PENDING
#define WRITE_SHINE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "row_light.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint leaf = thread_number();
	if (leaf >= frame.counts.x)
		return;
	bool emitter = (load_range(load_leaf(leaf).x).w & GI_NODE_EMITTER) != 0u;
	for (uint c = 0u; c < 3u; c++) {
		uint at = GI_SHINE_WORDS * load_leaf(leaf).y + c, b = floatBitsToUint(load_leaf_radiosity(leaf)[c]);
		atomicMax(shine[at + GI_SHINE_ALL], b);
		atomicMax(shine[at + GI_SHINE_OTHERS], emitter ? 0u : b);
		atomicMax(shine[at + GI_SHINE_LEAST], ~b);
	}
	pending[leaf].bound.xyz = light_of_row(leaf);
	pending[leaf].before = vec4(load_leaf_radiosity(leaf).xyz, 0.0);
}
