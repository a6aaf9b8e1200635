#version 450 core
// Before the first sweep: what exitance that entered translucent objects leaves their leaves with, over the
// albedo, takes the place of the irradiance by exitance. No row sums to more than the albedo, which all leaves of
// an object have: what emitted.comp found of the irradiance that entered bounds it. Likewise what S and the rows
// together sum to, over the albedo, takes the place of the row's own sum; where rows see mirrors in their own light
// that may be more than 1. One thread a leaf of theirs.
#define READ_FRAME
#define READ_LEAVES
#define READ_MATERIALS
#define READ_DIFFUSION_ROWS
#define READ_DIFFUSION_LINKS
#define READ_DIFFUSION_VALUES
#define WRITE_LEAF_RADIOSITY
#include "buffers.glsl"
#include "dispatch.glsl"
#include "solve.glsl"
#include "diffusion.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint leaves;

// More than what floats lose of a sum on its way: as it is stored, and again in clusters of two kinds, whose shares may
// sum to a little more than 1.
const double SUMS_SLACK = 4e-6lf;

void main()
{
	uint k = thread_number();
	if (k >= leaves)
		return;
	uvec4 row = load_diffusion_row(k);
	dvec3 rho = dvec3(load_material(load_leaf(row.z).z).rho.xyz);
	diffused d = diffuse(row);
	dvec3 light = d.light / max(rho, dvec3(1e-30lf)), sums = d.amplified / max(rho, dvec3(1e-30lf));
	double lacks = 1.0lf - SUMS_SLACK - max(sums.x, max(sums.y, sums.z));
	leaf_radiosity[GI_LEAF_B * frame.counts.x + row.z].w = float(lacks);
	leaf_radiosity[GI_LEAF_EMITTED * frame.counts.x + row.z] = to_single(dvec4(light, 0.0lf));
}
