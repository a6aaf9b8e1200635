#version 450 core
// Photons from an emitter to a mirror or glass object and on, to the leaf where each ends (Arvo, "Backward ray
// tracing", 1986). One thread a photon, those of pairs whose paths nothing touched are what they were.
//
// Of a point of the emitter, by its power, the photon goes to a point of the circle that the smooth object's bounding
// sphere is from there, evenly by solid angle. Its number alone decides where: the same scene gives the same photons.
#define READ_FRAME
#define READ_OBJECTS
#define READ_TOPOLOGY
#define READ_VERTICES_REST
#define READ_LEAVES
#define READ_MATERIALS
#define READ_BVH
#define READ_PRIMITIVES
#define READ_TLAS
#define READ_CAUSTIC_LIGHTS
#define READ_SMOOTH
#define READ_SMOOTH_MATERIALS
#define READ_CAUSTIC_PAIRS
#define WRITE_PHOTONS
#define WRITE_CAUSTIC_PATHS
#include "buffers.glsl"
#include "dispatch.glsl"
#include "octahedron.glsl"
#include "rays.glsl"
#include "closest.glsl"
#include "locate.glsl"
#include "specular.glsl"
#include "ordered.glsl"
#include "numbers.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint photons_a_pair;
layout(location = 1) uniform uint pair_count;
layout(location = 2) uniform float lift;
layout(location = 3) uniform uint allowed; // photons of a pair in this update

const uint STEPS = 16u;

// 2^32 over the powers of g, g^3 = g + 1: their multiples fill a square evenly (Roberts, "The unreasonable
// effectiveness of quasirandom sequences", 2018). Directions are drawn by them, on which most depends; points of the
// emitter by hashes.
const uvec2 STRIDES = uvec2(0xC13FA9A9u, 0x91E10DA5u);

float unit(uint x)
{
	return (float(x >> 9u) + 0.5) * (1.0 / 8388608.0);
}

vec2 direction_numbers(uint photon)
{
	return vec2(unit(0x80000000u + photon * STRIDES.x), unit(0x80000000u + photon * STRIDES.y));
}

uint hash_of(uint photon, uint what)
{
	uint x = photon * 0x9E3779B9u ^ (what + 1u) * 0x85EBCA6Bu;
	x = (x ^ (x >> 16u)) * 0x7FEB352Du;
	x = (x ^ (x >> 15u)) * 0x846CA68Bu;
	return x ^ (x >> 16u);
}

// Hashes of a photon: of each step, and before those of where it begins.
const uint OF_EMITTER = 0u, OF_POINT = 1u, OF_STEP = 3u;

uint pick_light(uint u, uvec4 lights)
{
	uint low = lights.x, high = lights.y - 1u;
	while (low < high) {
		uint middle = (low + high) >> 1u;
		if (u <= load_caustic_triangle(3u * middle).w)
			high = middle;
		else
			low = middle + 1u;
	}
	return low;
}

// Where the photon begins, and what it carries; throughput 0: nothing.
light_ray emit(gi_caustic_pair pair, uint photon, out float reach)
{
	uint k = 3u * pick_light(hash_of(photon, OF_EMITTER), pair.lights);
	vec3 a = uintBitsToFloat(load_caustic_triangle(k).xyz), b = uintBitsToFloat(load_caustic_triangle(k + 1u).xyz),
	     c = uintBitsToFloat(load_caustic_triangle(k + 2u).xyz);
	vec3 n = normalize(cross(b - a, c - a));
	float root = sqrt(unit(hash_of(photon, OF_POINT))), v = unit(hash_of(photon, OF_POINT + 1u));
	vec3 p = a + (b - a) * (root * (1.0 - v)) + (c - a) * (root * v);
	vec3 to = pair.sphere.xyz - p;
	float away = length(to), sine = min(pair.sphere.w / max(away, 1e-30), 1.0);
	// A cap of so much of 1 - cosine; a point within the sphere looks everywhere.
	float cap = away > pair.sphere.w ? sine * sine / (1.0 + sqrt(1.0 - sine * sine)) : 2.0;
	vec3 axis = away > 0.0 ? to / away : n;
	vec2 u = direction_numbers(photon);
	float down = cap * u.x, phi = 2.0 * PI * u.y;
	float s = axis.z >= 0.0 ? 1.0 : -1.0, d = -1.0 / (s + axis.z), m = axis.x * axis.y * d;
	vec3 tangent = vec3(1.0 + s * axis.x * axis.x * d, s * m, -s * axis.x),
	     bitangent = vec3(m, s + axis.y * axis.y * d, -axis.y);
	float radius = sqrt(max(down * (2.0 - down), 0.0));
	vec3 direction = axis * (1.0 - down) + tangent * (radius * cos(phi)) + bitangent * (radius * sin(phi));
	vec3 exitance = load_material(load_caustic_triangle(k + 1u).w).exitance.xyz;
	float largest = max(exitance.x, max(exitance.y, exitance.z));
	// Radiance is exitance / pi, and the cap 2 pi (1 - cosine) wide.
	float carried = pair.power.x * 2.0 * cap * max(dot(n, direction), 0.0);
	reach = away + pair.sphere.w;
	return light_ray(p + n * lift, direction, carried > 0.0 ? exitance * (carried / largest) : vec3(0.0));
}

void include(uint pair, vec3 p)
{
	for (uint k = 0u; k < 3u; k++) {
		atomicMin(caustic_paths[GI_CAUSTIC_PATH_WORDS * pair + k], ordered_from_float(p[k]));
		atomicMax(caustic_paths[GI_CAUSTIC_PATH_WORDS * pair + 3u + k], ordered_from_float(p[k]));
	}
}

gi_photon follow(uint number_of_pair, uint photon)
{
	gi_caustic_pair pair = load_caustic_pair(number_of_pair);
	float reach;
	light_ray r = emit(pair, photon, reach);
	gi_photon lost = gi_photon(vec4(0.0, 0.0, 0.0, uintBitsToFloat(GI_NONE)), vec4(0.0)), found = lost;
	bool on = r.throughput != vec3(0.0);
	if (on)
		include(number_of_pair, r.origin);
	for (uint step = 0u; step < STEPS && on; step++) {
		nearest hit = find_nearest(r.origin, r.direction, lift);
		// On the way to the object what lies behind it is no matter.
		float end = step == 0u ? min(hit.distance, reach) : min(hit.distance, 1e30);
		include(number_of_pair, r.origin + r.direction * end);
		on = hit.object != GI_NONE && (step > 0u || hit.object == pair.lights.w);
		if (!on)
			break;
		gi_primitive q = load_primitive(hit.primitive);
		uint first = floatBitsToUint(q.a.w);
		gi_smooth_material m = load_smooth_material(load_leaf(first).z);
		if (is_smooth(m)) {
			on = go_on(smooth_point_of(hit, r.direction), m, WAY_BY_CHANCE,
				   unit(hash_of(photon, OF_STEP + step)), lift, r);
		} else {
			on = false;
			vec3 at = r.origin + r.direction * hit.distance;
			uint leaf = hit.front ? leaf_at(hit.object, first, rest_from_world(hit.object, at)) : GI_NONE;
			if (step > 0u)
				found = gi_photon(vec4(at, uintBitsToFloat(leaf)), vec4(r.throughput, 0.0));
		}
	}
	return found;
}

void main()
{
	uint t = thread_number(), pair = t / allowed;
	if (pair >= pair_count)
		return;
	uint photon = caustic_paths[GI_CAUSTIC_PATH_WORDS * pair + GI_CAUSTIC_BEFORE] + t % allowed;
	if (photon < caustic_paths[GI_CAUSTIC_PATH_WORDS * pair + GI_CAUSTIC_NOW])
		photons[pair * photons_a_pair + photon] = follow(pair, photon);
}
