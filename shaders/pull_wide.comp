#version 450 core
// The same as pull.comp for nodes that cover many leaves: one group a node, summed in a fixed order.
#define READ_TOPOLOGY
#define READ_REST
#define READ_LEAVES
#define READ_LEAF_RADIOSITY
#define READ_WIDE_NODES
#define WRITE_RADIOSITY
#include "buffers.glsl"
#include "solve.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

shared dvec4 partial[GI_GROUP_SIZE];
shared double partial_area[GI_GROUP_SIZE];

void main()
{
	uint local = gl_LocalInvocationID.x;
	uint n = load_wide_node(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x);
	uvec4 range = load_range(n);
	dvec4 sum = dvec4(0.0lf);
	double area = 0.0lf;
	for (uint k = local; k < range.z; k += GI_GROUP_SIZE) {
		uint leaf = range.y + k;
		double a = double(load_rest(load_leaf(leaf).x).moment.w);
		sum += a * dvec4(load_leaf_radiosity(leaf));
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
