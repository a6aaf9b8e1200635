#version 450 core
// The mean over the chosen leaves, into the report: one group, sums in a fixed order.
//
// The samples see what a row adds to the error. What all rows have in common also arrives again with the light that is
// reflected: a mean m with the part r of the light becomes m + r m + r^2 m + ... = m / (1 - r), where errors without
// a common sign average out over a row. So
//
//     |error|^2 = mean |e|^2 + |m|^2 (1 / (1 - r)^2 - 1),
//     |m|^2     = (|sum w e|^2 - sum w^2 |e|^2) / ((sum w)^2 - sum w^2)
//
// the latter over pairs of different leaves, so that the samples' noise is not in it.
#define READ_ESTIMATE_RESULTS
#define WRITE_STATE
#include "buffers.glsl"

// Where it is dark: each leaf's error is taken over its own light, or over this part of the scene's where it has less,
// below which nobody sees it. The common part of reflected errors is left out: it goes with the scene's light.
const float DARK = 0.01;

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint all;

struct totals {
	vec4 mean;  // w times: squared error, squared light, light, light returned
	vec4 bias;  // w times the error; w
	vec2 pairs; // w^2 times: squared error with noise, 1
	uint rays;
};

shared totals sums[GI_GROUP_SIZE];
shared float estimate_shares[GI_GROUP_SIZE];

totals add(totals a, totals b)
{
	return totals(a.mean + b.mean, a.bias + b.bias, a.pairs + b.pairs, a.rays + b.rays);
}

totals of_leaf(gi_estimate_leaf r)
{
	float w = r.error.x, light = r.light.x + r.light.y + r.light.z;
	return totals(w * vec4(r.error.y, dot(r.light.xyz, r.light.xyz), light, r.bias.w), w * vec4(r.bias.xyz, 1.0),
		      w * w * vec2(dot(r.bias.xyz, r.bias.xyz), 1.0), floatBitsToUint(r.error.z));
}

// r is held below this: in rooms so white that light hardly ever ends the error does not grow without limit.
const float MOST_RETURN = 0.98;

void report(totals t)
{
	float w = t.bias.w;
	float returned = t.mean.z > 0.0 ? min(t.mean.w / t.mean.z, MOST_RETURN) : 0.0;
	float pairs = w * w - t.pairs.y;
	float bias = pairs > 0.0 ? max(0.0, (dot(t.bias.xyz, t.bias.xyz) - t.pairs.x) / pairs) : 0.0;
	float gain = 1.0 / (1.0 - returned);
	state.estimate.squared = t.mean.x / w + bias * (gain * gain - 1.0);
	state.estimate.power = t.mean.y / w;
	state.estimate.rays = t.rays;
}

float local_error(gi_estimate_leaf r, float power)
{
	return r.error.x * r.error.y / (dot(r.light.xyz, r.light.xyz) + DARK * DARK * power);
}

void main()
{
	uint t = gl_LocalInvocationID.x;
	totals own = totals(vec4(0.0), vec4(0.0), vec2(0.0), 0u);
	for (uint k = t; k < all; k += GI_GROUP_SIZE)
		own = add(own, of_leaf(load_result(k)));
	sums[t] = own;
	barrier();
	own = sums[0];
	for (uint k = 1u; k < GI_GROUP_SIZE; k++)
		own = add(own, sums[k]);
	float power = own.mean.y / own.bias.w, share = 0.0;
	for (uint k = t; k < all && power > 0.0; k += GI_GROUP_SIZE)
		share += local_error(load_result(k), power);
	estimate_shares[t] = share;
	barrier();
	if (t > 0u)
		return;
	for (uint k = 1u; k < GI_GROUP_SIZE; k++)
		share += estimate_shares[k];
	state.estimate.local = share / own.bias.w;
	report(own);
}
