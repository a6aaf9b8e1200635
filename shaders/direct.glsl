// Direct light of a point from the lamps: Lambert's polygon formula, times the share of the lamp's samples that see the
// point.
//
// LAMPS, where it is defined, says how many lamps there are, one or two of GI_LAMP_FEW_SAMPLES samples each. With
// numbers known to the compiler software renderers read uniforms once for all pixels instead of once a pixel: half the
// time of the whole picture.
#include "shade_shared.h"

layout(std140, binding = GI_BIND_LAMPS) uniform lamp_block { gi_lamp_block lights; };
layout(binding = 0) uniform sampler2DArrayShadow depth_maps; // compared
layout(binding = 1) uniform sampler2DArray depth_values;     // as they are

// Receivers are moved along their normal by this many texels times the sine to the light: what one texel of the map
// spans in depth on a slope, over the two texels that the filter reads.
const float NORMAL_TEXELS = 1.6;
// And towards the light by this many, for depths rounded on surfaces that face it.
const float DEPTH_TEXELS = 0.6;
// A texel of a map of the whole hemisphere is up to this much wider, across the view, than its depth says.
const float BENT_TEXEL = 1.41421;

// Closer to the lamp's plane than this share of the distance no map looks: points there are taken to lie so high.
const float NEAREST = 1e-4;

// Angle between the unit vectors u and v over its sine and over 2 pi, times u x v. A rational fit of the angle in the
// cosine: no atan; relative error 2e-4 (Heitz, Dupuy, Hill and Neubelt, Real-time polygonal-light shading, 2016).
vec3 contour_term(vec3 u, vec3 v)
{
	float x = dot(u, v), y = abs(x);
	float fit = (0.8543985 + (0.4965155 + 0.0145206 * y) * y) / (3.4175940 + (4.1616724 + y) * y);
	float ratio = x > 0.0 ? fit : 0.5 * inversesqrt(max(1.0 - x * x, 1e-7)) - fit;
	return cross(u, v) * ratio;
}

// One edge, clipped to the heights above zero. Where it goes down through the horizon or comes up, that crossing is
// kept.
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

// A point as the maps of one lamp see it, and what its samples have said so far.
struct receiver {
	vec3 q, m;      // the point, moved along its normal, and the normal; in the lamp's frame
	float z;        // its height over the lamp's plane, never 0
	float e;        // its distance, as maps measure it, from the lamp's middle
	float nearer;   // depth.y for the distance less DEPTH_TEXELS
	float reach;    // how far apart a sample's two looks lie, uv, across the view
	vec2 slope, up; // of uv, and of e along q.xy: what turns a step along the lamp into one of uv
	float lit, total;
};

float map_distance(uint k, vec2 d, float z)
{
	return z + lights.lamps[k].map.y * max(abs(d.x), abs(d.y));
}

receiver make_receiver(uint k, vec3 p, vec3 n, float sink)
{
	vec4 depth = lights.lamps[k].depth, map = lights.lamps[k].map;
	receiver r;
	r.q = in_lamp_frame(k, vec4(p, 1.0));
	r.m = in_lamp_frame(k, vec4(n, 0.0));
	float facing = clamp(-dot(r.m, r.q) * inversesqrt(max(dot(r.q, r.q), 1e-30)), 0.0, 1.0);
	float texel = depth.z * mix(1.0, BENT_TEXEL, map.y) * map_distance(k, r.q.xy, max(r.q.z, 0.0));
	r.q += r.m * (texel * NORMAL_TEXELS * sqrt(1.0 - facing * facing) + sink);
	r.z = max(r.q.z, NEAREST * length(r.q) + 1e-12);
	r.e = map_distance(k, r.q.xy, r.z);
	r.nearer = depth.y / (1.0 - DEPTH_TEXELS * depth.z);
	r.slope = r.q.xy / r.e;
	r.up = map.y * (abs(r.q.x) > abs(r.q.y) ? vec2(sign(r.q.x), 0.0) : vec2(0.0, sign(r.q.y)));
	r.reach = 0.0;
	r.lit = 0.0;
	r.total = 1e-30;
	return r;
}

// The point in the map of the sample at s: uv and the depth to compare.
vec3 in_map(uint k, receiver r, vec2 s)
{
	vec4 map = lights.lamps[k].map;
	vec2 d = r.q.xy - s;
	float inverse = 1.0 / map_distance(k, d, r.z);
	// Beyond the farthest blocker the maps' clear depth hides nothing.
	return vec3(d * (map.x * inverse) + map.zw, min(lights.lamps[k].depth.x + r.nearer * inverse, 1.0));
}

// Samples count as much as they would light the point: those below its horizon not at all.
float weight_of(receiver r, vec2 s)
{
	vec3 to = vec3(s - r.q.xy, -r.q.z);
	float square = dot(to, to);
	return max(dot(r.m, to), 0.0) / (square * square);
}

// What the probes say.
struct answer {
	float asked, hidden;   // probes above the horizon, and those that do not see the point
	float blockers, depth; // depth map texels before the point, sum of their depths
};

// Asks sample i whether it sees the point, by the depth map's nearest texel.
void probe(uint i, uint k, receiver r, float size, inout answer a)
{
	vec2 s = lights.samples[i].xy;
	vec3 at = in_map(k, r, s);
	float d = texelFetch(depth_values, ivec3(clamp(at.xy, 0.0, 0.9999) * size, int(i)), 0).x;
	float above = dot(r.m, vec3(s - r.q.xy, -r.q.z)) > 0.0 ? 1.0 : 0.0, hidden = d < at.z ? above : 0.0;
	a.asked += above;
	a.hidden += hidden;
	a.blockers += hidden;
	a.depth += hidden * d;
}

// The same by the four texels that a look filters. Samples near the corners of the lamp decide where a penumbra ends.
void probe_wide(uint i, uint k, receiver r, inout answer a)
{
	vec2 s = lights.samples[i].xy;
	vec3 at = in_map(k, r, s);
	vec4 d = textureGather(depth_values, vec3(at.xy, float(i)));
	float above = dot(r.m, vec3(s - r.q.xy, -r.q.z)) > 0.0 ? 1.0 : 0.0;
	vec4 hidden = vec4(lessThan(d, vec4(at.z))) * above;
	float count = hidden.x + hidden.y + hidden.z + hidden.w;
	a.asked += above;
	a.hidden += 0.25 * count;
	a.blockers += count;
	a.depth += dot(hidden, d);
}

// Two looks a little apart make two smaller steps of the one that the sample's shadow is.
void look(uint i, uint k, inout receiver r)
{
	vec4 s = lights.samples[i];
	vec3 at = in_map(k, r, s.xy);
	vec2 aside = s.zw * r.reach;
	aside -= r.slope * dot(r.up, aside);
	float weight = weight_of(r, s.xy);
	r.lit += weight * (texture(depth_maps, vec4(at.xy - aside, float(i), at.z)) +
			   texture(depth_maps, vec4(at.xy + aside, float(i), at.z)));
	r.total += 2.0 * weight;
}

// The shadows of neighbouring samples lie as far apart as the samples, seen through the blocker.
float reach_past(float blocker, uint k, receiver r)
{
	vec4 depth = lights.lamps[k].depth;
	float apart = depth.w * max(r.e - blocker, 0.0) / blocker;
	return max(apart / r.e, 0.5 * depth.z) * lights.lamps[k].map.x;
}

float lamp_visibility(uint k, vec3 p, vec3 n, float sink)
{
	uvec4 range = lights.lamps[k].range;
	vec4 depth = lights.lamps[k].depth;
	float size = float(textureSize(depth_values, 0).x);
	receiver r = make_receiver(k, p, n, sink);
	answer a = answer(0.0, 0.0, 0.0, 0.0);
#ifdef LAMPS
	uint first = k * GI_LAMP_FEW_SAMPLES;
	probe_wide(first, k, r, a);
	probe_wide(first + 1u, k, r, a);
	probe_wide(first + 2u, k, r, a);
	probe_wide(first + 3u, k, r, a);
	probe(first + 4u, k, r, size, a);
	probe(first + 5u, k, r, size, a);
	probe(first + 6u, k, r, size, a);
	probe(first + 7u, k, r, size, a);
#else
	uint first = range.x, probes = first + min(range.y, GI_LAMP_PROBES);
	for (uint i = first; i < probes; i++)
		probe_wide(i, k, r, a);
#endif
	// Where all probes are lit all samples are. Where none is, a look aside may still find light: taking that for
	// dark leaves steps along the edges of dark shadows. Software renderers run a loop's body once where no pixel
	// wants it, so it is short.
	bool clear = a.hidden == 0.0;
	uint end = first + range.y;
	float blocker = depth.y / (a.depth / max(a.blockers, 1.0) - depth.x);
	r.reach = reach_past(clear ? r.e : blocker, k, r);
	for (uint i = clear ? end : first; i < end; i++)
		look(i, k, r);
	return clear ? 1.0 : r.lit / r.total;
}

#ifdef LAMPS
vec3 light_of(uint k, vec3 p, vec3 n, float sink)
{
	float factor = lamp_factor(k, p, n);
	factor *= lights.lamps[k].range.y != 0u ? lamp_visibility(k, p, n, sink) : 1.0;
	return lights.lamps[k].exitance.xyz * factor;
}

vec3 direct_irradiance(vec3 p, vec3 n, float sink)
{
	vec3 sum = light_of(0u, p, n, sink);
	if (LAMPS == 2)
		sum += light_of(1u, p, n, sink);
	return sum;
}
#else
vec3 direct_irradiance(vec3 p, vec3 n, float sink)
{
	vec3 sum = vec3(0.0);
	for (uint k = 0u; k < lights.counts.x; k++) {
		float factor = lamp_factor(k, p, n);
		if (factor > 0.0 && lights.lamps[k].range.y != 0u)
			factor *= lamp_visibility(k, p, n, sink);
		sum += lights.lamps[k].exitance.xyz * factor;
	}
	return sum;
}
#endif
