#version 450 core
// What light there is before the solve. Of each object's leaves the largest B, that of those that emit nothing, the
// least; of each leaf B, and H in the place of the bound that assess.comp makes with it. One thread a leaf.
#define USE_FRAME
#define USE_TOPOLOGY
#define USE_LEAVES
#define USE_ROWS
#define USE_LINKS
#define USE_RADIOSITY
#define USE_LEAF_RADIOSITY
#define USE_PENDING
#define USE_SHINE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "row_light.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint leaf = thread_number();
	if (leaf >= frame.counts.x)
		return;
	bool emitter = (topology[leaves[leaf].x].range.w & GI_NODE_EMITTER) != 0u;
	for (uint c = 0u; c < 3u; c++) {
		uint at = GI_SHINE_WORDS * leaves[leaf].y + c, b = floatBitsToUint(leaf_radiosity[leaf][c]);
		atomicMax(shine[at + GI_SHINE_ALL], b);
		atomicMax(shine[at + GI_SHINE_OTHERS], emitter ? 0u : b);
		atomicMax(shine[at + GI_SHINE_LEAST], ~b);
	}
	pending[leaf].bound.xyz = light_of_row(leaf);
	pending[leaf].before = vec4(leaf_radiosity[leaf].xyz, 0.0);
}
