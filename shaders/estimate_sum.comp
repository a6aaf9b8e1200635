#version 450 core
// What the samples of a chosen leaf say of its row: one thread a leaf. D = H - H of a group of samples has the row's
// error and the group's noise; products across groups, which are independent, have the error's square alone:
//
//     |error|^2 = sum over g != h of D_g . D_h / (G (G - 1)) = (|sum D|^2 - sum |D|^2) / (G (G - 1))
#define READ_RADIOSITY
#define READ_ESTIMATE_ITEMS
#define READ_ESTIMATE_SHARES
#define READ_ESTIMATE_CHANCES
#define READ_ESTIMATE_RESULTS
#define READ_LEAVES
#define READ_MATERIALS
#define READ_ROWS
#define READ_REST
#define WRITE_ESTIMATE_RESULTS
#include "buffers.glsl"
#include "dispatch.glsl"
#include "entry.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint first;
layout(location = 1) uniform uint count;
layout(location = 2) uniform float area; // of all leaves

// H by one group: over the samples' own sum where the row was closed by its own.
vec3 light_of_group(uint at, bool closed, inout uint rays)
{
	vec3 h = vec3(0.0);
	float weight = 0.0;
	for (uint k = at; k < at + GI_ESTIMATE_GROUP_ITEMS; k++) {
		uvec4 e = load_item(k);
		rays += samples_of(e);
		if ((e.z & 1u) == 0u)
			continue;
		float fv = load_share(k) * uintBitsToFloat(e.y);
		weight += fv;
		if ((e.w & GI_ENTRY_BACK) == 0u)
			h += fv * load_radiosity(e.x).xyz;
	}
	return closed && weight > 0.0 ? h / weight : h;
}

void main()
{
	uint t = thread_number();
	if (t >= count)
		return;
	gi_estimate_leaf r = load_result(first + t);
	vec3 sum = vec3(0.0);
	float squares = 0.0;
	uint rays = 0u;
	for (uint g = 0u; g < GI_ESTIMATE_GROUPS; g++) {
		vec3 d = r.light.xyz -
			 light_of_group((t * GI_ESTIMATE_GROUPS + g) * GI_ESTIMATE_GROUP_ITEMS, r.light.w > 0.0, rays);
		sum += d;
		squares += dot(d, d);
	}
	uint leaf = floatBitsToUint(r.error.w);
	r.error.x = load_rest(load_leaf(leaf).x).moment.w / (area * load_chance(leaf).y);
	r.error.y = (dot(sum, sum) - squares) / float(GI_ESTIMATE_GROUPS * (GI_ESTIMATE_GROUPS - 1u));
	r.error.z = uintBitsToFloat(rays);
	vec3 returned = load_material(load_leaf(leaf).z).rho.xyz * abs(uintBitsToFloat(load_row(leaf).w)) * r.light.xyz;
	r.bias = vec4(sum / float(GI_ESTIMATE_GROUPS), returned.x + returned.y + returned.z);
	estimate_results[first + t] = r;
}
