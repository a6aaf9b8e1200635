// What arrives at the leaves of translucent objects and enters: sum over links of weight * R_node and weight *
// v_node in a sweep, in double precision, or before the first one the irradiance by exitance. One thread a leaf of
// theirs.
#define READ_FRAME
#define READ_ROWS
#define READ_LINKS
#define READ_RADIOSITY
#define READ_LEAF_RADIOSITY
#define READ_DIFFUSION_ROWS
#define WRITE_DIFFUSION_VALUES
#include "buffers.glsl"
#include "dispatch.glsl"
#include "solve.glsl"
#ifdef SPECULAR
#include "specular_link.glsl"
#endif

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint leaves;
layout(location = 1) uniform uint emitted; // 1: by exitance

dvec4 arriving(uint leaf)
{
	uvec4 row = load_row(leaf);
	dvec4 sum = dvec4(0.0lf);
	uint reflected = GI_NODE_R * frame.counts.y;
	uint k = row.x / 2u, end = row.x + (row.y & GI_BLOCK_COUNT_MASK);
#ifdef SPECULAR
	for (; 2u * k < end; k++) {
		uvec4 link = load_two_links(k);
		if (!is_specular(link))
			break;
		dvec4 weights = dvec4(weights_of(link), largest_weight_of(link));
		sum += weights * dvec4(load_radiosity(reflected + node_of(link)));
	}
#endif
	for (; 2u * k < end; k++) {
		uvec4 two = load_two_links(k);
		sum += double(uintBitsToFloat(two.y)) * dvec4(load_radiosity(reflected + two.x));
		sum += double(uintBitsToFloat(two.w)) * dvec4(load_radiosity(reflected + two.z));
	}
	return sum;
}

void main()
{
	uint k = thread_number();
	if (k >= leaves)
		return;
	uint leaf = load_diffusion_row(k).z;
	diffusion_values[k] =
	    emitted != 0u ? vec4(load_leaf_part(GI_LEAF_EMITTED, leaf).xyz, 0.0) : to_single(arriving(leaf));
}
