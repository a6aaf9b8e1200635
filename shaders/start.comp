#version 450 core
// B = E and u = 1 everywhere: a cold start. One thread a node. The sky's B is known: nothing amplifies it, and u is 0.
#define READ_FRAME
#define READ_TOPOLOGY
#define READ_NODE_EXITANCE
#define WRITE_RADIOSITY
#define WRITE_LEAF_RADIOSITY
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint n = thread_number();
	if (n >= frame.counts.y)
		return;
	uvec4 range = load_range(n);
	bool sky = (range.w & GI_NODE_SKY) != 0u;
	vec4 start = vec4(load_exitance(n).xyz, sky ? 0.0 : 1.0);
	radiosity[n] = start;
	if ((range.w & GI_NODE_LEAF) != 0u && !sky)
		leaf_radiosity[range.y] = leaf_radiosity[frame.counts.x + range.y] = start;
}
