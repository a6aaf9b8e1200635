// Direct light of a point from the lamps: Lambert's polygon formula, times the share of the lamp's samples that see the point.
#include "shade_shared.h"

layout(std140, binding = GI_BIND_LAMPS) uniform lamp_block { gi_lamp_block lights; };
layout(binding = 0) uniform sampler2DArrayShadow depth_maps;

// Receivers are moved along their normal by this many texels times the sine to the light: what one texel of the map spans in
// depth on a slope, over the two texels that the filter reads.
const float NORMAL_TEXELS = 1.6;
// And towards the light by this many, for depths rounded on surfaces that face it.
const float DEPTH_TEXELS = 0.6;

// Angle between the unit vectors u and v over its sine and over 2 pi, times u x v. A rational fit of the angle in the cosine: no atan;
// relative error 2e-4 (Heitz, Dupuy, Hill and Neubelt, Real-time polygonal-light shading, 2016).
vec3 contour_term(vec3 u, vec3 v)
{
	float x = dot(u, v), y = abs(x);
	float fit = (0.8543985 + (0.4965155 + 0.0145206 * y) * y) / (3.4175940 + (4.1616724 + y) * y);
	float ratio = x > 0.0 ? fit : 0.5 * inversesqrt(max(1.0 - x * x, 1e-7)) - fit;
	return cross(u, v) * ratio;
}

// One edge, clipped to the heights above zero. Where it goes down through the horizon or comes up, that crossing is kept.
float clipped_edge(vec3 a, vec3 b, vec3 n, float ha, float hb, inout vec3 leave, inout vec3 enter)
{
	vec3 crossing = a + (b - a) * (ha / (abs(ha - hb) < 1e-30 ? 1e-30 : ha - hb));
	bool above_a = ha > 0.0, above_b = hb > 0.0;
	if (above_a && !above_b)
		leave = crossing;
	if (above_b && !above_a)
		enter = crossing;
	vec3 from = above_a ? a : crossing, to = above_b ? b : crossing;
	float term = dot(contour_term(normalize(from), normalize(to)), n);
	return above_a || above_b ? term : 0.0;
}

// Form factor of the lamp from p, unoccluded; 0 behind it.
float lamp_factor(uint k, vec3 p, vec3 n)
{
	vec3 a = lights.lamps[k].corner[0].xyz - p, b = lights.lamps[k].corner[1].xyz - p;
	vec3 c = lights.lamps[k].corner[2].xyz - p, d = lights.lamps[k].corner[3].xyz - p;
	float ha = dot(n, a), hb = dot(n, b), hc = dot(n, c), hd = dot(n, d);
	float lowest = min(min(ha, hb), min(hc, hd)), highest = max(max(ha, hb), max(hc, hd));
	if (highest <= 0.0)
		return 0.0;
	if (lowest >= 0.0) {
		a = normalize(a);
		b = normalize(b);
		c = normalize(c);
		d = normalize(d);
		// A triangle's third corner comes twice, and the edge between is none.
		return max(0.0, -dot(contour_term(a, b) + contour_term(b, c) + contour_term(c, d) + contour_term(d, a), n));
	}
	vec3 leave = n, enter = n;
	float sum = clipped_edge(a, b, n, ha, hb, leave, enter) + clipped_edge(b, c, n, hb, hc, leave, enter) +
		    clipped_edge(c, d, n, hc, hd, leave, enter) + clipped_edge(d, a, n, hd, ha, leave, enter);
	sum += dot(contour_term(normalize(leave), normalize(enter)), n);
	return max(0.0, -sum);
}

vec3 in_lamp_frame(uint k, vec4 p)
{
	return vec3(dot(lights.lamps[k].frame_x, p), dot(lights.lamps[k].frame_y, p), dot(lights.lamps[k].frame_z, p));
}

// Share of the lamp that the point sees. Samples count as much as they would light the point: those below its horizon not at all.
float lamp_visibility(uint k, vec3 p, vec3 n, float sink)
{
	uvec4 range = lights.lamps[k].range;
	vec4 depth = lights.lamps[k].depth;
	vec4 map = lights.lamps[k].map;
	vec3 q = in_lamp_frame(k, vec4(p, 1.0));
	vec3 m = in_lamp_frame(k, vec4(n, 0.0));
	float facing = clamp(-dot(m, q) * inversesqrt(max(dot(q, q), 1e-30)), 0.0, 1.0);
	float texel = depth.z * max(q.z, 0.0);
	q += m * (texel * NORMAL_TEXELS * sqrt(1.0 - facing * facing) + sink);
	if (range.y == 0u || q.z <= 0.0)
		return 1.0;
	float away = 1.0 / q.z;
	float reference = depth.x + depth.y / max(q.z - DEPTH_TEXELS * texel, 1e-30);
	vec2 base = q.xy * map.xy * away + map.zw;
	vec2 shift = map.xy * away;
	float lit = 0.0, total = 1e-30;
	uint probes = range.x + min(range.y, GI_LAMP_PROBES), end = probes;
	for (uint i = range.x; i < end; i++) {
		vec2 s = lights.samples[i].xy;
		vec3 to = vec3(s - q.xy, -q.z);
		float square = dot(to, to);
		float weight = max(dot(m, to), 0.0) / (square * square);
		vec2 uv = base - s * shift;
		lit += weight * texture(depth_maps, vec4(uv, float(i), reference));
		total += weight;
		// Probes that agree speak for all.
		if (i + 1u == probes && lit > 0.001 * total && lit < 0.999 * total)
			end = range.x + range.y;
	}
	return lit > 0.0 ? lit / total : 0.0;
}

vec3 direct_irradiance(vec3 p, vec3 n, float sink)
{
	vec3 sum = vec3(0.0);
	for (uint k = 0u; k < lights.counts.x; k++) {
		float factor = lamp_factor(k, p, n);
		if (factor > 0.0)
			sum += lights.lamps[k].exitance.xyz * (factor * lamp_visibility(k, p, n, sink));
	}
	return sum;
}
