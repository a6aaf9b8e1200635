#version 450 core
// Indirect irradiance at the light vertices (corners of leaves): weighted means of the adjacent leaves.
#define USE_FRAME
#define USE_LEAF_INDIRECT
#define USE_LIGHT_LINKS
#define USE_LIGHT_FIRST
#define USE_LIGHT
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint t = thread_number();
	if (t >= frame.misc.z)
		return;
	vec3 sum = vec3(0.0);
	for (uint k = light_first[t]; k < light_first[t + 1u]; k++)
		sum += uintBitsToFloat(light_links[k].y) * leaf_indirect[light_links[k].x].xyz;
	light[t] = vec4(sum, 0.0);
}
