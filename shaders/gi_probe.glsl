// The light of Relume's probes in a host's own shaders (gi.h, gi_create_probes): trilinear, of those probes alone that
// see the place. For shaders of GLSL 4.30 and newer: to be pasted or included behind #version and #extension lines. All
// names begin with gi_ or GI_.
//
// Where the light comes from is said by macros before it:
//
//   GI_PROBE_LIGHT_STORAGE n   gi_probe_buffers.light is bound to storage block n
//   GI_PROBE_PLANE_STORAGE n   likewise .planes
//   neither                    light_texture and planes_texture are bound to the units that the host gives the sampler
//                              uniforms gi_probe_light_texels and gi_probe_plane_texels (GLSL 3.30)
//
// gi_probe_grid is gi_probe_buffers.grid: 48 bytes that may stand in a uniform block, or three uniforms.
#ifndef GI_PROBE_GLSL
#define GI_PROBE_GLSL

struct gi_probe_grid {
	vec4 lower;  // w: spacing
	uvec4 count; // w: where their light begins, in vec4
	uvec4 place; // x: vec4 a probe, 4 or 9; y: where their planes begin
};

#ifdef GI_PROBE_LIGHT_STORAGE
layout(std430, binding = GI_PROBE_LIGHT_STORAGE) readonly buffer gi_probe_light_block
{
	vec4 gi_probe_lights[];
};
vec4 gi_probe_light(uint n)
{
	return gi_probe_lights[n];
}
#else
uniform usamplerBuffer gi_probe_light_texels;
vec4 gi_probe_light(uint n)
{
	return uintBitsToFloat(texelFetch(gi_probe_light_texels, int(n)));
}
#endif

#ifdef GI_PROBE_PLANE_STORAGE
layout(std430, binding = GI_PROBE_PLANE_STORAGE) readonly buffer gi_probe_plane_block
{
	vec4 gi_probe_planes[];
};
vec4 gi_probe_plane(uint n)
{
	return gi_probe_planes[n];
}
#else
uniform usamplerBuffer gi_probe_plane_texels;
vec4 gi_probe_plane(uint n)
{
	return uintBitsToFloat(texelFetch(gi_probe_plane_texels, int(n)));
}
#endif

// Directions a side of a probe's map, as points of an octahedron that is folded out (probe_planes.comp).
const int GI_PROBE_SIDE = 16;

// Places nearer than this share of the spacing to a surface lie on it.
const float GI_PROBE_BIAS = 1.0 / 64.0;

// Real spherical harmonics up to band 2, in the order of gi.h.
void gi_sh_basis(vec3 d, out float y[9])
{
	y[0] = 0.282095;
	y[1] = 0.488603 * d.y;
	y[2] = 0.488603 * d.z;
	y[3] = 0.488603 * d.x;
	y[4] = 1.092548 * d.x * d.y;
	y[5] = 1.092548 * d.y * d.z;
	y[6] = 0.315392 * (3.0 * d.z * d.z - 1.0);
	y[7] = 1.092548 * d.x * d.z;
	y[8] = 0.546274 * (d.x * d.x - d.y * d.y);
}

// Irradiance along a unit normal, W/m2, by the coefficients of a receiver without a normal: `first` where they begin,
// `count` 4 or 9 of them.
vec3 gi_sh_irradiance(uint first, uint count, vec3 normal)
{
	float y[9];
	gi_sh_basis(normal, y);
	vec3 sum = vec3(0.0);
	for (uint k = 0u; k < 9u; k++)
		if (k < count)
			sum += y[k] * gi_probe_light(first + k).xyz;
	return max(sum, vec3(0.0));
}

// Texel of a probe's map, over its edges too.
ivec2 gi_probe_wrapped(ivec2 t)
{
	const int last = GI_PROBE_SIDE - 1;
	if (t.x < 0 || t.x > last)
		t = ivec2(t.x < 0 ? 0 : last, last - t.y);
	if (t.y < 0 || t.y > last)
		t = ivec2(last - t.x, t.y < 0 ? 0 : last);
	return clamp(t, ivec2(0), ivec2(last));
}

// Is what lies `from` the probe before the surfaces that it sees in the directions about it? 0: behind one of them.
// Each direction knows the plane of what it met, so that a wall hides all that is behind it, however obliquely it is
// seen, and in the corner of a room any of its walls does. What fades are directions that come into reach or leave it,
// and depth.
float gi_probe_sees(uint first_plane, vec3 from, float bias)
{
	vec2 p = from.xy / max(abs(from.x) + abs(from.y) + abs(from.z), 1e-30);
	if (from.z < 0.0)
		p = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
	vec2 at = (0.5 * p + 0.5) * float(GI_PROBE_SIDE) - 0.5, nearest = floor(at + 0.5);
	float seen = 1.0;
	for (int k = 0; k < 9; k++) {
		vec2 texel = nearest + vec2(k % 3 - 1, k / 3 - 1);
		vec2 reach = clamp(15.0 - 10.0 * abs(texel - at), 0.0, 1.0);
		ivec2 t = gi_probe_wrapped(ivec2(texel));
		vec4 plane = gi_probe_plane(first_plane + uint(t.y * GI_PROBE_SIDE + t.x));
		float before = clamp(2.0 + (dot(plane.xyz, from) - plane.w) / bias, 0.0, 1.0);
		seen *= 1.0 - reach.x * reach.y * (1.0 - before);
	}
	return seen;
}

// The k-th corner of the cell that a place is in: which probe, and how much it counts.
float gi_probe_weight(gi_probe_grid g, vec3 place, vec3 lifted, uint k, out uint probe)
{
	vec3 last = vec3(g.count.xyz - 1u);
	vec3 cell = clamp((place - g.lower.xyz) / g.lower.w, vec3(0.0), last);
	vec3 base = min(floor(cell), max(last - 1.0, 0.0));
	uvec3 step = uvec3(k & 1u, (k >> 1u) & 1u, k >> 2u), at = min(uvec3(base) + step, g.count.xyz - 1u);
	probe = (at.z * g.count.y + at.y) * g.count.x + at.x;
	vec3 w = mix(1.0 - (cell - base), cell - base, vec3(step));
	// A probe within a solid sees nothing that light comes from.
	float sound = min(1.0, 8.0 * gi_probe_light(g.count.w + g.place.x * probe).w);
	vec3 from = lifted - (g.lower.xyz + g.lower.w * vec3(at));
	uint planes = g.place.y + probe * uint(GI_PROBE_SIDE * GI_PROBE_SIDE);
	return w.x * w.y * w.z * sound * gi_probe_sees(planes, from, GI_PROBE_BIAS * g.lower.w);
}

// Irradiance at a place with a unit normal, W/m2. weight: how much of the cell's probes sees the place; 0: none does,
// and the irradiance is 0.
vec3 gi_probe_irradiance(gi_probe_grid g, vec3 place, vec3 normal, out float weight)
{
	vec3 sum = vec3(0.0), lifted = place + GI_PROBE_BIAS * g.lower.w * normal;
	weight = 0.0;
	for (uint k = 0u; k < 8u; k++) {
		uint probe;
		float w = gi_probe_weight(g, place, lifted, k, probe);
		if (w > 0.0)
			sum += w * gi_sh_irradiance(g.count.w + g.place.x * probe, g.place.x, normal);
		weight += w;
	}
	return weight > 0.0 ? sum / weight : vec3(0.0);
}

// Mean radiance over all directions at a place in the air, W/m2/sr: what fog and smoke scatter alike all round.
vec3 gi_probe_mean_radiance(gi_probe_grid g, vec3 place, out float weight)
{
	vec3 sum = vec3(0.0);
	weight = 0.0;
	for (uint k = 0u; k < 8u; k++) {
		uint probe;
		float w = gi_probe_weight(g, place, place, k, probe);
		sum += w * gi_probe_light(g.count.w + g.place.x * probe).xyz;
		weight += w;
	}
	return weight > 0.0 ? sum * (0.282095 / (3.14159265358979 * weight)) : vec3(0.0);
}

#endif
