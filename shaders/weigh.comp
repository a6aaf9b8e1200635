#version 450 core
// After the first sweep from the light of before: how the residual it began with compares with that of a cold start, whose
// is the light first reflected (check.comp decides). Channel by channel the largest residual, and the flux in excess or
// wanting, sum of area * residual / rho, over the area. One group, which adds up in a fixed order.
#define READ_FRAME
#define READ_LEAVES
#define READ_MATERIALS
#define READ_LEAF_RADIOSITY
#define WRITE_STATE
#include "buffers.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

struct weights {
	vec3 warm, cold, most; // sums of area * irradiance, the largest residual
	float area;
};

shared weights partial[GI_GROUP_SIZE];

void include(inout weights w, uint leaf)
{
	vec3 rho = load_material(load_leaf(leaf).z).rho.xyz;
	vec3 residual = load_leaf_part(GI_LEAF_R, leaf).xyz - load_leaf_part(GI_LEAF_BEFORE, leaf).xyz;
	vec3 lit = vec3(greaterThan(rho, vec3(0.0)));
	float area = load_leaf_part(GI_LEAF_UNDRAWN, leaf).w;
	w.warm += area * residual / max(rho, vec3(1e-20));
	w.cold += area * lit * load_leaf_part(GI_LEAF_EMITTED, leaf).xyz;
	w.most = max(w.most, abs(residual));
	w.area += area;
}

void main()
{
	uint local = gl_LocalInvocationID.x;
	weights w = weights(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
	for (uint leaf = local; leaf < frame.counts.x; leaf += GI_GROUP_SIZE)
		include(w, leaf);
	partial[local] = w;
	barrier();
	if (local > 0u)
		return;
	for (uint k = 1u; k < GI_GROUP_SIZE; k++) {
		w.warm += partial[k].warm;
		w.cold += partial[k].cold;
		w.most = max(w.most, partial[k].most);
		w.area += partial[k].area;
	}
	for (uint c = 0u; c < 3u; c++) {
		state[GI_STATE_WARM_MEAN_BITS + c] = floatBitsToUint(w.warm[c] / w.area);
		state[GI_STATE_WARM_MOST_BITS + c] = floatBitsToUint(w.most[c]);
		state[GI_STATE_COLD_MEAN_BITS + c] = floatBitsToUint(w.cold[c] / w.area);
	}
	state[GI_STATE_WEIGHED] = 1u;
}
