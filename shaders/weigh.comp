#version 450 core
// After a sweep that begins a solve: which member of the span of 1, v and R before comes nearest to the solution. The
// slowest part of the error is as smooth as v, which solves M v = 1, and sweeps would take 1 / (1 - q) of them to take
// it away; a member of the span that is in flux balance has none of it (Galerkin; with 1 alone it is the ambient term
// of Cohen, Chen, Wallace and Greenberg 1988). With <x, y> = sum of area / rho * x y, in which M is symmetric but for
// sampling, sum_j a_j x_j solves
//
//     sum over j of <x_i, M x_j> a_j = <x_i, s>    for every i
//
// which is the least error e in the norm of <e, M e>. Sums are of the leaves that the sweep brought light to, channel
// by channel: elsewhere the start is 0 (gather.glsl). One group, which adds up in a fixed order. check.comp decides by
// what is left of the residual, of the best multiple of 1 as well, which a cold start is no worse than.
#define READ_FRAME
#define READ_LEAVES
#define READ_MATERIALS
#define READ_LEAF_RADIOSITY
#define WRITE_STATE
#include "buffers.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;

// What begins within what a sweep keeps to ends there but for rounding, and was not kept: T R is what is stored.
const float WITHIN = 1.0 + 1.0 / 1048576.0;

// Two vectors whose products differ from parallel ones by less than this share count as one direction.
const float APART = 1e-4;

struct sweep_of_leaf {
	vec3 x[3], mx[3], s; // 1, v, R - like_v v of before; M of each; s
	vec3 per_flux;       // area / rho; 0 where no light came to
};

// <x_i, M x_j> at 4 i + j, <x_i, s> at 4 i + 3
const uint SUMS = 12u;
shared vec3 sums[SUMS * GI_GROUP_SIZE];
shared vec4 most[GI_GROUP_SIZE];
shared float areas[GI_GROUP_SIZE];
shared vec3 weights[3], cold_weight, like_v;

// What of x is of leaves that light came to.
vec3 where_lit(vec3 x, vec3 light)
{
	return mix(vec3(0.0), x, greaterThan(light, vec3(0.0)));
}

sweep_of_leaf load_sweep(uint leaf)
{
	vec3 rho = load_material(load_leaf(leaf).z).rho.xyz;
	vec4 before = load_leaf_part(GI_LEAF_BEFORE, leaf), now = load_leaf_part(GI_LEAF_R, leaf);
	sweep_of_leaf l;
	float area = load_leaf_part(GI_LEAF_UNDRAWN, leaf).w;
	l.per_flux = where_lit(area / max(rho, vec3(1e-20)), now.xyz);
	l.s = rho * load_leaf_part(GI_LEAF_EMITTED, leaf).xyz;
	l.x[0] = vec3(1.0);
	l.mx[0] = (1.0 - rho) + rho * load_leaf_part(GI_LEAF_B, leaf).w;
	l.x[1] = vec3(before.w);
	l.mx[1] = before.w - rho * ((now.w - 1.0) / max(max(rho.x, max(rho.y, rho.z)), 1e-20));
	l.x[2] = before.xyz - like_v * l.x[1];
	l.mx[2] = before.xyz - (now.xyz - l.s) - like_v * l.mx[1];
	return l;
}

void put(uint sum, vec3 value)
{
	sums[sum * GI_GROUP_SIZE + gl_LocalInvocationID.x] = value;
}

vec3 sum_of(uint sum)
{
	return sums[sum * GI_GROUP_SIZE];
}

// Leaves the group's sums in the first place.
void add_up(uint local, uint count)
{
	barrier();
	if (local == 0u) {
		for (uint sum = 0u; sum < count; sum++)
			for (uint k = 1u; k < GI_GROUP_SIZE; k++)
				sums[sum * GI_GROUP_SIZE] += sums[sum * GI_GROUP_SIZE + k];
		for (uint k = 1u; k < GI_GROUP_SIZE; k++) {
			most[0] = max(most[0], most[k]);
			areas[0] += areas[k];
		}
	}
	barrier();
}

// Of R the multiple of v that has as much of it: without, what R has beside v would drown in rounding. And how far R
// and v lie beyond what a sweep keeps to.
void find_like_v(uint local)
{
	vec3 r = vec3(0.0), ceiling = uintBitsToFloat(state.emitted.ceiling_bits.xyz);
	vec4 beyond = vec4(0.0);
	vec3 v = vec3(0.0);
	float area = 0.0;
	for (uint leaf = local; leaf < frame.counts.x; leaf += GI_GROUP_SIZE) {
		vec4 before = load_leaf_part(GI_LEAF_BEFORE, leaf);
		float a = load_leaf_part(GI_LEAF_UNDRAWN, leaf).w;
		r += where_lit(a * before.xyz, load_leaf_part(GI_LEAF_R, leaf).xyz);
		v += where_lit(vec3(a * before.w), load_leaf_part(GI_LEAF_R, leaf).xyz);
		area += a;
		vec3 exitance = load_material(load_leaf(leaf).z).exitance.xyz;
		vec4 limit = vec4(max(min(ceiling, frame.ceiling.xyz - exitance), vec3(0.0)), frame.ceiling.w);
		beyond = max(beyond, before - WITHIN * limit);
	}
	put(0u, r);
	put(1u, v);
	most[local] = beyond;
	areas[local] = area;
	add_up(local, 2u);
	if (local == 0u)
		like_v = sum_of(0u) / max(sum_of(1u), vec3(1e-30));
	barrier();
}

void add_products(uint local)
{
	vec3 products[SUMS];
	for (uint k = 0u; k < SUMS; k++)
		products[k] = vec3(0.0);
	for (uint leaf = local; leaf < frame.counts.x; leaf += GI_GROUP_SIZE) {
		sweep_of_leaf l = load_sweep(leaf);
		for (uint i = 0u; i < 3u; i++) {
			vec3 test = l.per_flux * l.x[i];
			for (uint j = 0u; j < 3u; j++)
				products[4u * i + j] += test * l.mx[j];
			products[4u * i + 3u] += test * l.s;
		}
	}
	for (uint k = 0u; k < SUMS; k++)
		put(k, products[k]);
	add_up(local, SUMS);
}

vec4 equation(uint i, uint channel)
{
	return vec4(sum_of(4u * i)[channel], sum_of(4u * i + 1u)[channel], sum_of(4u * i + 2u)[channel],
		    sum_of(4u * i + 3u)[channel]);
}

// What of 1, v and R solves the equations of one channel, by elimination; one that those before it make up is left out,
// and R, which no light is the opposite of, where it would count negatively.
vec3 solution_of(uint channel, bool v_tells, bool with_r)
{
	vec4 one = equation(0u, channel), v = equation(1u, channel), r = equation(2u, channel);
	float v_alone = v.y, r_alone = r.z;
	if (!(one.x > 0.0))
		return vec3(0.0);
	v -= v.x / one.x * one;
	r -= r.x / one.x * one;
	bool with_v = v_tells && v.y > APART * v_alone;
	if (with_v)
		r -= r.y / v.y * v;
	vec3 x = vec3(0.0);
	if (with_r && r.z > APART * r_alone)
		x.z = max(r.w / r.z, 0.0);
	if (with_v)
		x.y = (v.w - v.z * x.z) / v.y;
	x.x = (one.w - one.y * x.y - one.z * x.z) / one.x;
	return x;
}

void choose_weights(vec4 beyond)
{
	bool v_tells = beyond.w <= 0.0;
	for (uint c = 0u; c < 3u; c++) {
		vec3 x = solution_of(c, v_tells, v_tells && beyond[c] <= 0.0);
		for (uint k = 0u; k < 3u; k++)
			weights[k][c] = x[k];
		cold_weight[c] = sum_of(0u)[c] > 0.0 ? sum_of(3u)[c] / sum_of(0u)[c] : 0.0;
	}
}

// What a warm start may not be raised by where no light first arrives (scaled() in gather.glsl).
vec3 cut_of(uint leaf, vec3 s, vec3 swept)
{
	vec3 most = max(load_leaf_part(GI_LEAF_BEFORE, leaf).xyz, load_leaf_part(GI_LEAF_R, leaf).xyz);
	return mix(max(swept - most, vec3(0.0)), vec3(0.0), greaterThan(s, vec3(0.0)));
}

// Mean flux and largest of |s - M x|, x the sum of weights * x_j, and of what x is cut by: known to the first thread.
struct residual_of_start {
	vec3 mean, most;
};

residual_of_start find_residual(uint local, float area, vec3 of_one, vec3 of_v, vec3 of_r, bool is_cut)
{
	vec3 flux = vec3(0.0), largest = vec3(0.0);
	for (uint leaf = local; leaf < frame.counts.x; leaf += GI_GROUP_SIZE) {
		sweep_of_leaf l = load_sweep(leaf);
		vec3 left = l.s - of_one * l.mx[0] - of_v * l.mx[1] - of_r * l.mx[2], residual = abs(left);
		if (is_cut)
			residual += cut_of(leaf, l.s, of_one * l.x[0] + of_v * l.x[1] + of_r * l.x[2] + left);
		flux += l.per_flux * residual;
		largest = max(largest, where_lit(residual, l.per_flux));
	}
	put(0u, flux);
	most[local] = vec4(largest, 0.0);
	add_up(local, 1u);
	residual_of_start found = residual_of_start(sum_of(0u) / area, most[0].xyz);
	barrier();
	return found;
}

void main()
{
	uint local = gl_LocalInvocationID.x;
	if (state.solve.start == GI_START_NONE || state.solve.action > GI_ACTION_KEEP)
		return;
	find_like_v(local);
	vec4 beyond = most[0];
	float area = areas[0];
	barrier();
	add_products(local);
	if (local == 0u)
		choose_weights(beyond);
	barrier();
	bool is_warm = state.solve.start == GI_START_WARM;
	residual_of_start warm = find_residual(local, area, weights[0], weights[1], weights[2], is_warm);
	residual_of_start cold = find_residual(local, area, cold_weight, vec3(0.0), vec3(0.0), false);
	if (local > 0u)
		return;
	state.start.warm_mean.xyz = warm.mean;
	state.start.warm_most.xyz = warm.most;
	state.start.cold_mean.xyz = cold.mean;
	state.start.cold_most.xyz = cold.most;
	state.start.base.xyz = weights[0];
	state.start.lift.xyz = weights[1] - like_v * weights[2];
	state.start.factor.xyz = weights[2];
}
