// What arrives at the leaves of translucent objects and enters: sum over links of weight * R_node and weight *
// v_node in a sweep, in double precision, or before the first one the irradiance by exitance, and what the row sums to.
// One thread a leaf of theirs.
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
#include "double.glsl"
#include "row_sum.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint leaves;
layout(location = 1) uniform uint emitted; // 1: by exitance

void main()
{
	uint k = thread_number();
	if (k >= leaves)
		return;
	uint leaf = load_diffusion_row(k).z;
	diffusion_values[k] = emitted != 0u ? vec4(load_leaf_part(GI_LEAF_EMITTED, leaf).xyz,
						   1.0 - load_leaf_part(GI_LEAF_B, leaf).w)
					    : to_single(gather(leaf).sum);
}
