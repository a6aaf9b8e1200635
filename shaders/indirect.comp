#version 450 core
// Irradiance of a leaf from everything but the own exitance of lamps, which is drawn per pixel: sum over links of
// weight * (B - E). One thread a leaf.
#define USE_FRAME
#define USE_TOPOLOGY
#define USE_ROWS
#define USE_LINKS
#define USE_RADIOSITY
#define USE_NODE_EXITANCE
#define USE_LEAF_INDIRECT
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

void main()
{
	uint leaf = thread_number();
	if (leaf >= frame.counts.x)
		return;
	uvec4 row = rows[leaf];
	uint end = row.x + (row.y & GI_BLOCK_COUNT_MASK);
	vec3 h = vec3(0.0);
	for (uint k = row.x; k < end; k++) {
		uvec2 link = links[k];
		bool lamp = (topology[link.x].range.w & GI_NODE_LAMP) != 0u;
		vec3 own = lamp ? node_exitance[link.x].xyz : vec3(0.0);
		h += uintBitsToFloat(link.y) * (radiosity[link.x].xyz - own);
	}
	leaf_indirect[leaf] = vec4(h, 0.0);
}
