#version 450 core
// The second half of a sweep: B of every node that covers few leaves, as their area mean. One thread a node.
#define USE_FRAME
#define USE_TOPOLOGY
#define USE_REST
#define USE_LEAVES
#define USE_RADIOSITY
#define USE_LEAF_RADIOSITY
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint n = thread_number();
	if (n >= frame.counts.y)
		return;
	uvec4 range = topology[n].range;
	if (range.z > GI_WIDE_LEAVES || (range.w & GI_NODE_SKY) != 0u)
		return;
	if (range.z == 1u) {
		radiosity[n] = vec4(leaf_radiosity[range.y].xyz, 0.0);
		return;
	}
	vec3 sum = vec3(0.0);
	float area = 0.0;
	for (uint leaf = range.y; leaf < range.y + range.z; leaf++) {
		float a = rest[leaves[leaf].x].moment.w;
		sum += a * leaf_radiosity[leaf].xyz;
		area += a;
	}
	radiosity[n] = vec4(sum / area, 0.0);
}
