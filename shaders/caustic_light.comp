#version 450 core
// Irradiance of each leaf through mirrors and glass. One thread a leaf.
#define READ_FRAME
#define READ_REST
#define READ_LEAVES
#define READ_CAUSTIC_PAIRS
#define WRITE_CAUSTIC_SUMS
#define WRITE_CAUSTIC_LIGHT
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint leaf = thread_number();
	if (leaf >= frame.counts.x)
		return;
	vec3 sum = vec3(caustic_sums[3u * leaf], caustic_sums[3u * leaf + 1u], caustic_sums[3u * leaf + 2u]);
	caustic_light[leaf] = vec4(sum * (load_caustic_pair(0u).power.w / rest_moment(load_leaf(leaf).x).w), 0.0);
}
