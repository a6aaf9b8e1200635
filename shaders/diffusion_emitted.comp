#version 450 core
// Before the first sweep: what exitance that entered translucent objects leaves their leaves with, over the
// albedo, takes the place of the irradiance by exitance. No row sums to more than the albedo, which all leaves of
// an object have: what emitted.comp found of the irradiance that entered bounds it. One thread a leaf of theirs.
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

void main()
{
	uint k = thread_number();
	if (k >= leaves)
		return;
	uvec4 row = load_diffusion_row(k);
	dvec3 rho = dvec3(load_material(load_leaf(row.z).z).rho.xyz);
	dvec3 light = diffuse(row).light / max(rho, dvec3(1e-30lf));
	leaf_radiosity[GI_LEAF_EMITTED * frame.counts.x + row.z] = to_single(dvec4(light, 0.0lf));
}
