#version 450 core
// Largest B of each object's leaves before the solve. One thread a leaf.
#define USE_FRAME
#define USE_LEAVES
#define USE_LEAF_RADIOSITY
#define USE_SHINE
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint leaf = thread_number();
	if (leaf >= frame.counts.x)
		return;
	uint object = leaves[leaf].y;
	vec3 b = leaf_radiosity[leaf].xyz;
	for (int c = 0; c < 3; c++)
		atomicMax(shine[4u * object + uint(c)], floatBitsToUint(b[c]));
}
