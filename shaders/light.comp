#version 450 core
// Indirect irradiance at the light vertices (corners of leaves): weighted means of the adjacent leaves.
#define READ_FRAME
#define READ_LEAF_INDIRECT
#define READ_LIGHT_LINKS
#define READ_LIGHT_FIRST
#define WRITE_LIGHT
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint t = thread_number();
	if (t >= frame.misc.z)
		return;
	vec3 sum = vec3(0.0);
	for (uint k = load_light_first(t); k < load_light_first(t + 1u); k++)
		sum += uintBitsToFloat(load_light_link(k).y) * load_leaf_indirect(load_light_link(k).x).xyz;
	light[t] = vec4(sum, 0.0);
}
