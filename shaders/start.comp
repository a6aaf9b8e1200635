#version 450 core
// R = 0, B = E and v = 1 everywhere: what check.comp takes for a cold start. One thread a node. The sky reflects
// nothing and amplifies nothing.
#define READ_FRAME
#define READ_TOPOLOGY
#define READ_NODE_EXITANCE
#define WRITE_RADIOSITY
#define WRITE_LEAF_RADIOSITY
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint n = thread_number();
	if (n == 0u) {
		state.solve.scale = vec4(0.0);
		state.solve.seen = 0.0;
		state.solve.ellipse = 0u;
	}
	if (n >= frame.counts.y)
		return;
	uvec4 range = topology_range(n);
	bool sky = (range.w & GI_NODE_SKY) != 0u;
	vec4 b = vec4(load_exitance(n).xyz, 0.0), r = vec4(0.0, 0.0, 0.0, sky ? 0.0 : 1.0);
	radiosity[GI_NODE_B * frame.counts.y + n] = b;
	radiosity[GI_NODE_R * frame.counts.y + n] = r;
	if ((range.w & GI_NODE_LEAF) == 0u || sky)
		return;
	leaf_radiosity[GI_LEAF_B * frame.counts.x + range.y].xyz = b.xyz;
	leaf_radiosity[GI_LEAF_R * frame.counts.x + range.y] = r;
	leaf_radiosity[GI_LEAF_BEFORE * frame.counts.x + range.y] = r;
}
