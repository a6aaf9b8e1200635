#version 450 core
// The same as pull.comp for nodes that cover many leaves: one group a node, summed in a fixed order.
#define READ_FRAME
#define READ_TOPOLOGY
#define READ_NODE_EXITANCE
#define READ_LEAF_RADIOSITY
#define READ_LARGE_NODES
#define WRITE_RADIOSITY
#include "buffers.glsl"
#include "solve.glsl"
#include "node_light.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

shared dvec4 partial[GI_GROUP_SIZE];
shared double partial_area[GI_GROUP_SIZE];

void main()
{
	uint local = gl_LocalInvocationID.x;
	uint n = load_large_node(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x);
	uvec4 range = topology_range(n);
	dvec4 sum = dvec4(0.0lf);
	double area = 0.0lf;
	for (uint k = local; k < range.z; k += GI_GROUP_SIZE) {
		uint leaf = range.y + k;
		double a = double(load_leaf_part(GI_LEAF_UNDRAWN, leaf).w);
		sum += a * dvec4(load_leaf_part(GI_LEAF_R, leaf));
		area += a;
	}
	partial[local] = sum;
	partial_area[local] = area;
	barrier();
	if (local > 0u)
		return;
	// One thread adds them up: halving takes a barrier a step, and llvmpipe compiles each barrier into the end of
	// one function and the beginning of another (Mesa 25.0: 0.1 s for six).
	for (uint k = 1u; k < GI_GROUP_SIZE; k++) {
		sum += partial[k];
		area += partial_area[k];
	}
	store_node(n, to_single(sum / area));
}
