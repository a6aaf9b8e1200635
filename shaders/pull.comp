#version 450 core
// After a solve: R and B of every node that covers few leaves, R as their area mean in double precision. One thread a
// node.
#define READ_FRAME
#define READ_TOPOLOGY
#define READ_NODE_EXITANCE
#define READ_LEAF_RADIOSITY
#define WRITE_RADIOSITY
#include "buffers.glsl"
#include "dispatch.glsl"
#include "solve.glsl"
#include "node_light.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint n = thread_number();
	if (n >= frame.counts.y)
		return;
	uvec4 range = topology_range(n);
	// No link leads to a top: rays to one end on leaves.
	if (range.z > GI_LARGE_NODE_LEAVES || (range.w & (GI_NODE_SKY | GI_NODE_TOP)) != 0u)
		return;
	if (range.z == 1u) {
		store_node(n, load_leaf_part(GI_LEAF_R, range.y));
		return;
	}
	dvec4 sum = dvec4(0.0lf);
	double area = 0.0lf;
	for (uint leaf = range.y; leaf < range.y + range.z; leaf++) {
		double a = double(load_leaf_part(GI_LEAF_UNDRAWN, leaf).w);
		sum += a * dvec4(load_leaf_part(GI_LEAF_R, leaf));
		area += a;
	}
	store_node(n, to_single(sum / area));
}
