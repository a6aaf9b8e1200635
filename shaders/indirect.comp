#version 450 core
// Irradiance of a leaf from everything but the own exitance of lamps, which is drawn per pixel: sum over links of
// weight * (B - E). One thread a leaf.
#define READ_FRAME
#define READ_TOPOLOGY
#define READ_ROWS
#define READ_LINKS
#define READ_RADIOSITY
#define READ_NODE_EXITANCE
#define WRITE_LEAF_INDIRECT
#include "buffers.glsl"
#include "dispatch.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

vec3 indirect_radiosity(uint node)
{
	bool lamp = (load_range(node).w & GI_NODE_LAMP) != 0u;
	return load_radiosity(node).xyz - (lamp ? load_exitance(node).xyz : vec3(0.0));
}

void main()
{
	uint leaf = thread_number();
	if (leaf >= frame.counts.x)
		return;
	uvec4 row = load_row(leaf);
	uint end = row.x + (row.y & GI_BLOCK_COUNT_MASK);
	vec3 h = vec3(0.0);
	for (uint k = row.x / 2u; 2u * k < end; k++) {
		uvec4 two = load_two_links(k);
		h += uintBitsToFloat(two.y) * indirect_radiosity(two.x);
		h += uintBitsToFloat(two.w) * indirect_radiosity(two.z);
	}
	leaf_indirect[leaf] = vec4(h, 0.0);
}
