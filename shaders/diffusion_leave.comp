#version 450 core
// A sweep's end at translucent objects: T R_i = s_i + sum_j S_ij * (what arrives at j), channel by channel, in double
// precision, with v = 1 + the largest of the three. The same bounds hold as of other leaves (check.comp), for S and the
// rows together are one matrix without negative entries whose rows sum to less than 1. One thread a leaf of theirs.
#include "double.glsl"
#define READ_FRAME
#define READ_LEAVES
#define READ_MATERIALS
#define READ_LEAF_RADIOSITY
#define READ_STATE
#define READ_DIFFUSION_ROWS
#define READ_DIFFUSION_LINKS
#define READ_DIFFUSION_VALUES
#define WRITE_LEAF_RADIOSITY
#define WRITE_LEAF_INDIRECT
#define WRITE_STATE
#include "buffers.glsl"
#include "dispatch.glsl"
#include "solve.glsl"
#include "numbers.glsl"
#include "diffusion.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint leaves;

#include "sweep.glsl"

// Values are off by ROUNDING four times: nodes' means, what arrives, and clusters of two kinds; s, an irradiance by
// exitance that went the same way, by as much and as it is stored once more. Sums in double precision, of up to 2^24
// terms, add less than SUMMED to that. What is below the least normal float may be lost, in a value or in all that went
// into it.
const double SUMMED = 1e-8lf, LOST = 16777216.0lf;

swept work_out(diffused d, dvec3 rho, double lacks, dvec4 source, vec4 before, vec3 ceiling)
{
	swept s;
	s.before = dvec4(before);
	s.arrived = dvec4(d.light, max(d.amplified.x, max(d.amplified.y, d.amplified.z)));
	s.image = source + s.arrived;
	dvec4 lost = LOST * double(LEAST_NORMAL) * dvec4(vec4(greaterThan(vec4(ceiling, 1.0), vec4(0.0))));
	s.arrived_doubt = (4.0lf * ROUNDING + SUMMED) * s.arrived + lost;
	s.doubt = s.arrived_doubt + 4.0lf * ROUNDING_OF_REAL * s.image + lost;
	s.doubt.xyz += (6.0lf * ROUNDING + SUMMED) * source.xyz;
	s.row_sum = rho * (1.0lf - lacks) * (1.0lf + 4.0lf * ROUNDING_OF_REAL);
	s.gap = max(1.0lf - s.row_sum, dvec3(0.0lf));
	return s;
}

void leave(uvec4 row, uint action)
{
	uint leaf = row.z;
	gi_material_data m = load_material(load_leaf(leaf).z);
	vec4 before = load_leaf_part(GI_LEAF_R, leaf);
	if ((action & GI_ACTION_KEEP) != 0u)
		leaf_radiosity[GI_LEAF_KEPT * frame.counts.x + leaf] = before;
	vec3 ceiling = uintBitsToFloat(state_before.emitted.ceiling_bits.xyz);
	dvec4 source = dvec4(dvec3(m.rho.xyz) * dvec3(load_leaf_part(GI_LEAF_EMITTED, leaf).xyz), 1.0lf);
	float lacks = load_leaf_part(GI_LEAF_B, leaf).w;
	swept s = work_out(diffuse(row), dvec3(m.rho.xyz), double(lacks), source, before, ceiling);
	// Drawn is rho times that, and no lamp besides.
	vec3 drawn = vec3(s.image.xyz / max(dvec3(m.rho.xyz), dvec3(1e-30lf)));
	leaf_indirect[leaf] = vec4(drawn, 0.0);
	finish(leaf, s, source, before, ceiling, m.exitance.xyz, lacks);
}

void main()
{
	report_nothing();
	uint k = thread_number(), action = state_before.solve.action;
	if (k < leaves && action <= GI_ACTION_KEEP)
		leave(load_diffusion_row(k), action);
	barrier();
	if (gl_LocalInvocationID.x < FOUND_COUNT)
		join(gl_LocalInvocationID.x);
	barrier();
	if (gl_LocalInvocationID.x == 0u)
		report_group();
}
