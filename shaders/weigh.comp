#version 450 core
// After the first sweep from the light of before: how the residual it began with compares with that of a cold start, whose
// is the light first reflected (check.comp decides). Channel by channel the part of R whose flux is right where there was
// too much of it, or none where it is far more than any light there can be now; then what that part has: the flux astray,
// sum of area * |residual| / rho, over the area, and the largest residual. One group, which adds up in a fixed order.
#define READ_FRAME
#define READ_LEAVES
#define READ_MATERIALS
#define READ_LEAF_RADIOSITY
#define WRITE_STATE
#include "buffers.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

// Flux in excess by so much of the flux first reflected is taken back.
const float TOO_MUCH = 0.25;

// R before that is so many times the ceiling, which the sweep then kept to, says nothing of T R - R.
const float FAR_ABOVE = 2.0;

struct leaf_residuals {
	vec3 warm, cold; // of R before and of R = 0
	vec3 per_flux;   // what makes area * irradiance of them
};

shared vec3 sums[GI_GROUP_SIZE], cold_sums[GI_GROUP_SIZE], part;
shared vec3 most[GI_GROUP_SIZE]; // of R before, then of residuals
shared float areas[GI_GROUP_SIZE];

leaf_residuals residuals_of(uint leaf)
{
	vec3 rho = load_material(load_leaf(leaf).z).rho.xyz;
	float area = load_leaf_part(GI_LEAF_UNDRAWN, leaf).w;
	return leaf_residuals(load_leaf_part(GI_LEAF_R, leaf).xyz - load_leaf_part(GI_LEAF_BEFORE, leaf).xyz,
			      rho * load_leaf_part(GI_LEAF_EMITTED, leaf).xyz, area / max(rho, vec3(1e-20)));
}

// Leaves these of the group's sums in the first place.
void add_up(uint local)
{
	barrier();
	if (local == 0u) {
		for (uint k = 1u; k < GI_GROUP_SIZE; k++) {
			sums[0] += sums[k];
			cold_sums[0] += cold_sums[k];
			most[0] = max(most[0], most[k]);
			areas[0] += areas[k];
		}
	}
}

vec3 part_of(vec3 lacks, vec3 cold, vec3 before)
{
	vec3 ceiling = uintBitsToFloat(uvec3(state[GI_STATE_CEILING_BITS], state[GI_STATE_CEILING_BITS + 1u],
					     state[GI_STATE_CEILING_BITS + 2u]));
	vec3 kept = vec3(lessThanEqual(before, FAR_ABOVE * min(ceiling, frame.ceiling.xyz)));
	bvec3 too_much = lessThan(lacks, -TOO_MUCH * cold);
	return kept * mix(vec3(1.0), cold / max(cold - lacks, vec3(1e-30)), too_much);
}

void main()
{
	uint local = gl_LocalInvocationID.x;
	sums[local] = cold_sums[local] = most[local] = vec3(0.0);
	areas[local] = 0.0;
	for (uint leaf = local; leaf < frame.counts.x; leaf += GI_GROUP_SIZE) {
		leaf_residuals r = residuals_of(leaf);
		sums[local] += r.per_flux * r.warm;
		cold_sums[local] += r.per_flux * r.cold;
		most[local] = max(most[local], load_leaf_part(GI_LEAF_BEFORE, leaf).xyz);
		areas[local] += load_leaf_part(GI_LEAF_UNDRAWN, leaf).w;
	}
	add_up(local);
	if (local == 0u)
		part = part_of(sums[0], cold_sums[0], most[0]);
	barrier();
	vec3 cold = cold_sums[0], right = part;
	float area = areas[0];
	barrier();
	sums[local] = most[local] = vec3(0.0);
	for (uint leaf = local; leaf < frame.counts.x; leaf += GI_GROUP_SIZE) {
		leaf_residuals r = residuals_of(leaf);
		vec3 residual = abs(mix(r.cold, r.warm, right));
		sums[local] += r.per_flux * residual;
		most[local] = max(most[local], residual);
	}
	add_up(local);
	if (local > 0u)
		return;
	for (uint c = 0u; c < 3u; c++) {
		state[GI_STATE_FACTOR_BITS + c] = floatBitsToUint(right[c]);
		state[GI_STATE_WARM_MEAN_BITS + c] = floatBitsToUint(sums[0][c] / area);
		state[GI_STATE_WARM_MOST_BITS + c] = floatBitsToUint(most[0][c]);
		state[GI_STATE_COLD_MEAN_BITS + c] = floatBitsToUint(cold[c] / area);
	}
	state[GI_STATE_WEIGHED] = 1u;
}
