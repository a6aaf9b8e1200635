// What is seen in a mirror, or through glass: where the ray from the eye ends, as a surface for the lamps' passes to
// light (layer.glsl). One of two ways at the first surface, the one that carries more at the others.
#define READ_FRAME
#define READ_OBJECTS
#define READ_TOPOLOGY
#define READ_VERTICES_REST
#define READ_LEAVES
#define READ_LEAF_QUADS
#define READ_MATERIALS
#define READ_BVH
#define READ_PRIMITIVES
#define READ_TLAS
#define READ_LIGHT
#define READ_SMOOTH
#define READ_SMOOTH_MATERIALS
#define READ_CORNER_LIGHTS
#ifdef SKY_IMAGE
#define READ_SKY_TEXELS
#endif
#include "buffers.glsl"
#include "shade_shared.h"
#include "shade_modes.glsl"
#include "surface.glsl"
#include "rays.glsl"
#include "closest.glsl"
#include "locate.glsl"
#include "specular.glsl"
#include "layer.glsl"

layout(location = 0) uniform vec4 eye;        // w 0: the way to it
layout(location = 1) uniform uint way;        // at the first surface
layout(location = 2) uniform uint mode;
layout(location = 3) uniform float lift;
#ifdef SKY_IMAGE
#include "sky_image.glsl"
#else
layout(location = 4) uniform vec4 sky;        // exitance of what lies beyond
#endif
layout(location = 5) uniform float farthest;  // depth where nothing is seen
layout(binding = GI_UNIT_DEPTH) uniform sampler2D depths;

layout(location = 0) out vec4 place;
layout(location = 1) out uvec4 look;

const uint STEPS = 12u;

// Of a point of a leaf: the light of its corners.
vec3 indirect_at(uint leaf, vec3 rest)
{
	vec3 a = load_leaf_corner(leaf, 0u).xyz, b = load_leaf_corner(leaf, 1u).xyz, c = load_leaf_corner(leaf, 2u).xyz,
	     d = load_leaf_corner(leaf, 3u).xyz;
	uvec4 lights = load_corner_lights(leaf);
	vec3 n = cross(c - a, d - b);
	bool second = dot(n, cross(c - a, rest - a)) > 0.0 && c != d;
	vec3 p = second ? c : b, q = second ? d : c;
	float whole = dot(n, cross(p - a, q - a));
	float at_p = clamp(dot(n, cross(rest - a, q - a)) / whole, 0.0, 1.0),
	      at_q = clamp(dot(n, cross(p - a, rest - a)) / whole, 0.0, 1.0);
	vec3 light_a = load_light(lights.x).xyz, light_p = load_light(second ? lights.z : lights.y).xyz,
	     light_q = load_light(second ? lights.w : lights.z).xyz;
	return light_a * max(1.0 - at_p - at_q, 0.0) + light_p * at_p + light_q * at_q;
}

#ifdef TRANSLUCENT
// All the light of what is translucent comes through its leaves.
vec3 lit_by_lamps(gi_material_data m)
{
	return m.exitance.w > 0.0 ? vec3(0.0) : m.rho.xyz;
}
#else
vec3 lit_by_lamps(gi_material_data m)
{
	return m.rho.xyz;
}
#endif

// Exitance of what lies beyond.
vec3 sky_towards(vec3 direction)
{
#ifdef SKY_IMAGE
	return sky_texel_exitance(sky_texel_towards(direction));
#else
	return sky.xyz;
#endif
}

void end_at(nearest hit, light_ray r)
{
	vec3 at = r.origin + r.direction * hit.distance, rest = rest_from_world(hit.object, at);
	gi_primitive q = load_primitive(hit.primitive);
	vec3 b = hit.second ? q.c.xyz : q.b.xyz, c = hit.second ? q.d.xyz : q.c.xyz;
	vec3 n = normalize(world_direction_from_rest(hit.object, cross(b - q.a.xyz, c - q.a.xyz)));
	uint leaf = leaf_at(hit.object, floatBitsToUint(q.a.w), rest);
	gi_material_data m = load_material(load_leaf(leaf).z);
	vec3 own = mode == MODE_INDIRECT ? vec3(0.0) : m.exitance.xyz;
	if (mode != MODE_DIRECT)
		own += m.rho.xyz * indirect_at(leaf, rest);
	store_layer(at, n, r.throughput * own / PI, r.throughput * lit_by_lamps(m), place, look);
}

void main()
{
	ivec2 pixel = ivec2(gl_FragCoord.xy);
	store_layer(vec3(0.0), vec3(0.0, 0.0, 1.0), vec3(0.0), vec3(0.0), place, look);
	if (texelFetch(depths, pixel, 0).x == farthest)
		return;
	surface s = surface_at(pixel);
	gi_smooth_material m = load_smooth_material(s.material);
	if (!is_smooth(m) || (way == WAY_REFRACTED && !is_glass(m)))
		return;
	vec3 toward = eye.w == 0.0 ? normalize(eye.xyz) : normalize(eye.xyz - s.p);
	vec3 n = dot(s.n, toward) > 0.0 ? s.n : toward;
	light_ray r = light_ray(s.p, -toward, vec3(1.0));
	bool on = go_on(smooth_point(s.p, n, n, true), m, way, 0.0, lift, r), inside = way == WAY_REFRACTED;
	for (uint step = 0u; step < STEPS && on; step++) {
		nearest hit = find_nearest(r.origin, r.direction, lift);
		on = hit.object != GI_NONE;
		if (!on) {
			store_layer(vec3(0.0), vec3(0.0, 0.0, 1.0),
				    mode == MODE_INDIRECT ? vec3(0.0) : r.throughput * sky_towards(r.direction) / PI,
				    vec3(0.0), place, look);
			break;
		}
		uint material = load_leaf(floatBitsToUint(load_primitive(hit.primitive).a.w)).z;
		m = load_smooth_material(material);
		if (!is_smooth(m)) {
			on = false;
			if (hit.front)
				end_at(hit, r);
		} else if (step == 0u && inside && hit.front && material == s.material) {
			// What is drawn lies a little before the leaves that rays meet.
			r.origin += r.direction * hit.distance;
			r.origin += r.direction * lift;
		} else {
			on = go_on(smooth_point_of(hit, r.direction), m, WAY_LARGER, 0.0, lift, r);
		}
	}
}
