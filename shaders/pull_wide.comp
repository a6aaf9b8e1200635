#version 450 core
// The same as pull.comp for nodes that cover many leaves: one group a node, summed in a fixed order.
#define USE_TOPOLOGY
#define USE_REST
#define USE_LEAVES
#define USE_RADIOSITY
#define USE_LEAF_RADIOSITY
#define USE_WIDE_NODES
#include "buffers.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

shared vec4 partial[GI_GROUP_SIZE];

void main()
{
	uint local = gl_LocalInvocationID.x;
	uint n = wide_nodes[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x];
	uvec4 range = topology[n].range;
	vec4 sum = vec4(0.0);
	for (uint k = local; k < range.z; k += GI_GROUP_SIZE) {
		uint leaf = range.y + k;
		float a = rest[leaves[leaf].x].moment.w;
		sum += a * vec4(leaf_radiosity[leaf].xyz, 1.0);
	}
	partial[local] = sum;
	barrier();
	for (uint half_size = GI_GROUP_SIZE / 2u; half_size > 0u; half_size /= 2u) {
		if (local < half_size)
			partial[local] += partial[local + half_size];
		barrier();
	}
	if (local == 0u)
		radiosity[n] = vec4(partial[0].xyz / partial[0].w, 0.0);
}
