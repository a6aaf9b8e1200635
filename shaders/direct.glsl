// Direct light of a point from the lamps: Lambert's polygon formula, times the share of the lamp's samples that see the
// point.
#include "shade_shared.h"

// One lamp at a time, at an address that the compiler knows: software renderers then read it once for all pixels.
layout(std140, binding = GI_UNIFORM_LAMP) uniform lamp_block { gi_lamp lamp; };
layout(binding = GI_UNIT_MAPS) uniform sampler2DArrayShadow depth_maps; // compared
layout(binding = GI_UNIT_MAP_VALUES) uniform sampler2DArray depth_values;     // as they are
layout(binding = GI_UNIT_MASKS) uniform usamplerBuffer masks;

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

// The sum over the edges of the part above the horizon: each edge clipped, and in the end the one along the horizon.
// A loop without turns where there is nothing to do: software renderers work both sides of a branch out, but leave
// loops early.
float clipped_sum(bool wanted, vec3 a, vec3 b, vec3 c, vec3 d, vec3 n)
{
	vec3 leave = n, enter = n;
	float sum = 0.0;
	for (uint k = wanted ? 0u : 5u; k < 5u; k++) {
		float ha = dot(n, a), hb = dot(n, b);
		vec3 crossing = a + (b - a) * (ha / (abs(ha - hb) < 1e-30 ? 1e-30 : ha - hb));
		bool above_a = ha > 0.0, above_b = hb > 0.0, last = k == 4u;
		leave = above_a && !above_b ? crossing : leave;
		enter = above_b && !above_a ? crossing : enter;
		vec3 from = last ? leave : above_a ? a : crossing, to = last ? enter : above_b ? b : crossing;
		float term = dot(contour_term(normalize(from), normalize(to)), n);
		sum += above_a || above_b || last ? term : 0.0;
		vec3 first = a;
		a = b;
		b = c;
		c = d;
		d = first;
	}
	return sum;
}

// Heights over the horizon that are rounding, as a share of the distance.
const float IN_PLANE = 1e-5;

// Form factor of the lamp from p, unoccluded; 0 behind it.
float lamp_factor(vec3 p, vec3 n)
{
	vec3 a = lamp.corner[0].xyz - p, b = lamp.corner[1].xyz - p;
	vec3 c = lamp.corner[2].xyz - p, d = lamp.corner[3].xyz - p;
	float ha = dot(n, a), hb = dot(n, b), hc = dot(n, c), hd = dot(n, d);
	float lowest = min(min(ha, hb), min(hc, hd));
	// Of a lamp in the point's own plane rounding shows nothing.
	float highest = max(max(ha, hb), max(hc, hd)) - IN_PLANE * length(a);
	float clipped = clipped_sum(lowest < 0.0 && highest > 0.0, a, b, c, d, n);
	a = normalize(a);
	b = normalize(b);
	c = normalize(c);
	d = normalize(d);
	// A triangle's third corner comes twice, and the edge between is none.
	float whole = dot(contour_term(a, b) + contour_term(b, c) + contour_term(c, d) + contour_term(d, a), n);
	return highest <= 0.0 ? 0.0 : max(0.0, lowest < 0.0 ? -clipped : -whole);
}

vec3 in_lamp_frame(vec4 p)
{
	return vec3(dot(lamp.frame_x, p), dot(lamp.frame_y, p), dot(lamp.frame_z, p));
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

float map_distance(vec2 d, float z)
{
	return z + lamp.map.y * max(abs(d.x), abs(d.y));
}

receiver make_receiver(vec3 p, vec3 n)
{
	vec4 depth = lamp.depth, map = lamp.map;
	receiver r;
	r.q = in_lamp_frame(vec4(p, 1.0));
	r.m = in_lamp_frame(vec4(n, 0.0));
	float facing = clamp(-dot(r.m, r.q) * inversesqrt(max(dot(r.q, r.q), 1e-30)), 0.0, 1.0);
	float texel = depth.z * mix(1.0, BENT_TEXEL, map.y) * map_distance(r.q.xy, max(r.q.z, 0.0));
	r.q += r.m * (texel * NORMAL_TEXELS * sqrt(1.0 - facing * facing));
	r.z = max(r.q.z, NEAREST * length(r.q) + 1e-12);
	r.e = map_distance(r.q.xy, r.z);
	r.nearer = depth.y / (1.0 - DEPTH_TEXELS * depth.z);
	r.slope = r.q.xy / r.e;
	r.up = map.y * (abs(r.q.x) > abs(r.q.y) ? vec2(sign(r.q.x), 0.0) : vec2(0.0, sign(r.q.y)));
	r.reach = 0.0;
	r.lit = 0.0;
	r.total = 1e-30;
	return r;
}

// The point in the map of the sample at s: uv and the depth to compare.
vec3 in_map(receiver r, vec2 s)
{
	vec4 map = lamp.map;
	vec2 d = r.q.xy - s;
	float inverse = 1.0 / map_distance(d, r.z);
	// Beyond the farthest blocker the maps' clear depth hides nothing.
	return vec3(d * (map.x * inverse) + map.zw, min(lamp.depth.x + r.nearer * inverse, 1.0));
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
	float blockers, depth; // depth map texels before the point, sum of their depths
};

// Asks sample i whether it sees the point, by the four texels that a look filters.
void probe_wide(uint i, receiver r, inout answer a)
{
	vec2 s = lamp.samples[i].xy;
	vec3 at = in_map(r, s);
	vec4 d = textureGather(depth_values, vec3(at.xy, float(lamp.range.x + i)));
	float above = dot(r.m, vec3(s - r.q.xy, -r.q.z)) > 0.0 ? 1.0 : 0.0;
	vec4 hidden = vec4(lessThan(d, vec4(at.z))) * above;
	a.blockers += hidden.x + hidden.y + hidden.z + hidden.w;
	a.depth += dot(hidden, d);
}

// The same by the nearest texel.
void probe(uint i, receiver r, float size, inout answer a)
{
	vec2 s = lamp.samples[i].xy;
	vec3 at = in_map(r, s);
	ivec2 texel = ivec2(clamp(at.xy, 0.0, 0.9999) * size);
	float d = texelFetch(depth_values, ivec3(texel, int(lamp.range.x + i)), 0).x;
	float hidden = d < at.z && dot(r.m, vec3(s - r.q.xy, -r.q.z)) > 0.0 ? 1.0 : 0.0;
	a.blockers += hidden;
	a.depth += hidden * d;
}

// Two looks a little apart make two smaller steps of the one that the sample's shadow is. Where the receiver's own
// plane rises towards the lamp on the way aside it is looked for as high as that plane, or it would hide itself: with
// the point moved by d across the view the plane's inverse distance from the sample grows by dot(m, d) / dot(m, s - q).
void look(uint i, inout receiver r)
{
	vec4 s = lamp.samples[i];
	vec3 at = in_map(r, s.xy), to = vec3(s.xy - r.q.xy, -r.q.z);
	vec2 aside = s.zw * r.reach, moved = aside * (r.e / lamp.map.x);
	float rises = dot(r.m.xy, moved) / max(dot(r.m, to), 1e-3 * r.e);
	float deeper = r.nearer / map_distance(to.xy, r.z) * min(abs(rises), 0.5);
	aside -= r.slope * dot(r.up, aside);
	float weight = weight_of(r, s.xy);
	float layer = float(lamp.range.x + i);
	r.lit += weight * (texture(depth_maps, vec4(at.xy - aside, layer, at.z + (rises > 0.0 ? deeper : 0.0))) +
			   texture(depth_maps, vec4(at.xy + aside, layer, at.z + (rises > 0.0 ? 0.0 : deeper))));
	r.total += 2.0 * weight;
}

// The shadows of neighbouring samples lie as far apart as the samples, seen through the blocker.
float reach_past(float blocker, receiver r)
{
	vec4 depth = lamp.depth;
	float apart = depth.w * max(r.e - blocker, 0.0) / blocker;
	return max(apart / r.e, 0.5 * depth.z) * lamp.map.x;
}

// False where every sample sees the point for certain.
bool may_be_hidden(receiver r)
{
	uvec3 cell = uvec3(clamp((r.q - lamp.grid_lower.xyz) * lamp.grid_scale.xyz, vec3(0.0),
				 vec3(GI_MASK_SIDE, GI_MASK_SIDE, GI_MASK_HEIGHT) - 0.5));
	uint row = cell.z * GI_MASK_SIDE + cell.y;
	uint bits = word(masks, lamp.range.z + 2u * row + (cell.x >> 5));
	return (bits >> (cell.x & 31u) & 1u) != 0u;
}

// `wanted`: false where nobody asks.
float lamp_visibility(vec3 p, vec3 n, bool wanted)
{
	receiver r = make_receiver(p, n);
	answer a = answer(0.0, 0.0);
	uint samples = wanted && may_be_hidden(r) ? lamp.range.y : 0u;
	uint wide = min(samples, lamp.range.w), probes = min(samples, GI_LAMP_PROBES);
	for (uint i = 0u; i < wide; i++)
		probe_wide(i, r, a);
	float size = float(textureSize(depth_values, 0).x);
	for (uint i = wide; i < probes; i++)
		probe(i, r, size, a);
	// Where all probes are lit all samples are. Where none is, a look aside may still find light: taking that for
	// dark leaves steps along the edges of dark shadows. Software renderers run a loop's body once where no pixel
	// wants it, so it is short.
	bool clear = a.blockers == 0.0;
	float blocker = lamp.depth.y / (a.depth / max(a.blockers, 1.0) - lamp.depth.x);
	r.reach = reach_past(clear ? r.e : blocker, r);
	uint looks = clear ? 0u : lamp.range.y;
	for (uint i = 0u; i < looks; i++)
		look(i, r);
	return clear ? 1.0 : r.lit / r.total;
}

vec3 direct_irradiance(vec3 p, vec3 n)
{
	float factor = lamp_factor(p, n);
#ifdef SHADOWS
	factor *= lamp_visibility(p, n, factor > 0.0);
#endif
	return lamp.exitance.xyz * factor;
}
