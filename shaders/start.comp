#version 450 core
// B = E everywhere: a cold start. One thread a node.
#define USE_FRAME
#define USE_TOPOLOGY
#define USE_RADIOSITY
#define USE_LEAF_RADIOSITY
#define USE_NODE_EXITANCE
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint n = thread_number();
	if (n >= frame.counts.y)
		return;
	uvec4 range = topology[n].range;
	vec3 e = node_exitance[n].xyz;
	radiosity[n] = vec4(e, 0.0);
	if ((range.w & GI_NODE_LEAF) != 0u && (range.w & GI_NODE_SKY) == 0u)
		leaf_radiosity[range.y] = vec4(e, 0.0);
}
