#version 450 core
// Of a row, the irradiance by the own exitance of lamps, which is drawn per pixel: sum over links of weight * E. Under a
// budget of time it is remembered, so that a sweep's sums give all other light (gather.glsl). One thread a chosen row, or
// with ALL one a leaf.
#define READ_FRAME
#define READ_TOPOLOGY
#define READ_ROWS
#define READ_LINKS
#define READ_NODE_EXITANCE
#define READ_CHOICES
#define WRITE_PENDING
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "chosen.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint all;

vec3 lamp_exitance(uint node)
{
	return (load_range(node).w & GI_NODE_LAMP) != 0u ? load_exitance(node).xyz : vec3(0.0);
}

void main()
{
	uint leaf = all != 0u ? thread_number() : chosen_row();
	if (leaf >= frame.counts.x)
		return;
	uvec4 row = load_row(leaf);
	uint end = row.x + (row.y & GI_BLOCK_COUNT_MASK);
	vec3 h = vec3(0.0);
	for (uint k = row.x / 2u; 2u * k < end; k++) {
		uvec4 two = load_two_links(k);
		h += uintBitsToFloat(two.y) * lamp_exitance(two.x);
		h += uintBitsToFloat(two.w) * lamp_exitance(two.z);
	}
	pending[leaf].lamps = vec4(h, 0.0);
}
