#version 450 core
// The same as pull.comp for nodes that cover many leaves: one group a node, summed in a fixed order.
#define USE_TOPOLOGY
#define USE_REST
#define USE_LEAVES
#define USE_RADIOSITY
#define USE_LEAF_RADIOSITY
#define USE_WIDE_NODES
#include "buffers.glsl"
#include "solve.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

shared dvec4 partial[GI_GROUP_SIZE];
shared double partial_area[GI_GROUP_SIZE];

void main()
{
	uint local = gl_LocalInvocationID.x;
	uint n = wide_nodes[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x];
	uvec4 range = topology[n].range;
	dvec4 sum = dvec4(0.0lf);
	double area = 0.0lf;
	for (uint k = local; k < range.z; k += GI_GROUP_SIZE) {
		uint leaf = range.y + k;
		double a = double(rest[leaves[leaf].x].moment.w);
		sum += a * dvec4(leaf_radiosity[leaf]);
		area += a;
	}
	partial[local] = sum;
	partial_area[local] = area;
	barrier();
	for (uint half_size = GI_GROUP_SIZE / 2u; half_size > 0u; half_size /= 2u) {
		if (local < half_size) {
			partial[local] += partial[local + half_size];
			partial_area[local] += partial_area[local + half_size];
		}
		barrier();
	}
	if (local == 0u)
		radiosity[n] = to_single(partial[0] / partial_area[0]);
}
