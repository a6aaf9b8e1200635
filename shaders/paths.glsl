// Path tracing of irradiance, the ground truth that rows and solve are measured against (gi_trace_paths). A slot takes
// a run of paths of one leaf; a thread takes its slot on by a few vertices, whatever paths they are of: when one ends
// the next begins, so that threads of a vector do not wait for each other's long paths. What is between two dispatches
// lies in the slot, because a dispatch must end soon: a desktop's watchdog wants it, and llvmpipe silently leaves all
// loops of a thread after 65,535 turns in sum.
//
// Veach's multiple importance sampling (thesis, 1997, chapters 8 to 10) for diffuse surfaces: with cosine sampling,
// pdf_b = cos/pi, and emitter points picked by power, pdf_l = (pdf per area) r^2/cos', the balance heuristic gives both
// the same contribution to irradiance, T E pdf_b / (pdf_b + pdf_l) <= T E, T the product of rho along the path: no
// sample is larger than an exitance, even in a corner beside a lamp.
#define READ_FRAME
#define READ_OBJECTS
#define READ_TOPOLOGY
#define READ_VERTICES_REST
#define READ_LEAVES
#define READ_MATERIALS
#define READ_BVH
#define READ_PRIMITIVES
#define READ_TLAS
#define READ_PATH_LIGHTS
#define READ_PATH_SOBOL
#if SPECULAR
#define READ_SMOOTH
#define READ_SMOOTH_MATERIALS
#endif
#if PUNCTUAL
#define READ_PUNCTUAL_LIGHTS
#endif
#ifdef SKY_IMAGE
#define READ_SKY_TEXELS
#endif
#define WRITE_PATH_SLOTS
#include "buffers.glsl"
#include "dispatch.glsl"
#include "rays.glsl"
#include "closest.glsl"
#include "locate.glsl"
#if SPECULAR
#include "octahedron.glsl"
#include "specular.glsl"
#endif
#include "numbers.glsl"
#ifdef SKY_IMAGE
#include "sky_image.glsl"
#endif

layout(local_size_x = GI_GROUP_SIZE) in;

STORAGE(GI_BIND_PATH_GOING) going_block { uint going; };

layout(location = 0) uniform uint first_leaf;
layout(location = 1) uniform uint leaf_count;
layout(location = 2) uniform uint first_path;
layout(location = 3) uniform uint path_count; // of every leaf
layout(location = 4) uniform uint run;        // paths a slot, at most
layout(location = 5) uniform uint seed;
layout(location = 6) uniform uint light_count;
layout(location = 7) uniform vec4 sky_and_lift; // exitance of what lies beyond; height of a ray's start, metres
#if PUNCTUAL
layout(location = 9) uniform uint punctual_count; // lights without a surface
#endif
layout(location = 8) uniform float density;     // of emitter samples, per m2 and unit of luminous exitance: 1 / power

// Vertices a dispatch: 8 take at most 16 rays, some thousand loop turns.
const uint STEPS = 8u;

// Russian roulette begins where the throughput is below this (measured in tests/reference/reference.c).
const float ROULETTE_BELOW = 0.1;

// Where nearly all light is reflected a path would go on for 1 / (1 - rho) vertices, and the last ones count as the
// first. From this one on a path survives to vertex n with the chance (LONG_PATH / n)^2: twice as many vertices are the
// mean, the sum stays unbiased, and the variance finite for every rho below 1, as no constant chance would leave it.
const float LONG_PATH = 1024.0;

// ---- numbers ----

// Jarzynski and Olano, "Hash functions for GPU rendering", 2020.
uvec4 pcg4d(uvec4 v)
{
	v = v * 1664525u + 1013904223u;
	v.x += v.y * v.w;
	v.y += v.z * v.x;
	v.z += v.x * v.y;
	v.w += v.y * v.z;
	v ^= v >> 16u;
	v.x += v.y * v.w;
	v.y += v.z * v.x;
	v.z += v.x * v.y;
	v.w += v.y * v.z;
	return v;
}

// The middle of one of 2^23 cells: exact in a float, and never 0 or 1.
float unit(uint x)
{
	return (float(x >> 9u) + 0.5) * (1.0 / 8388608.0);
}

// Nested uniform scramble of a number whose bits are reversed: Laine and Karras 2011, constants of Vegdahl 2021.
uint owen_scramble(uint x, uint key)
{
	x ^= x * 0x3d20adeau;
	x += key;
	x *= (key >> 16u) | 1u;
	x ^= x * 0x05526c56u;
	x ^= x * 0x53a22864u;
	return bitfieldReverse(x);
}

uint sobol_number(uint dimension, uint path, uint key)
{
	uint x = 0u;
	for (; path != 0u; path &= path - 1u)
		x ^= load_sobol(32u * dimension + uint(findLSB(path)));
	return owen_scramble(x, key);
}

// What one vertex of a path needs: a direction, an emitter, a point on it; and for roulette. The first vertex's are
// stratified over the leaf's paths, the others are hashes.
struct numbers {
	vec2 direction;
	uint emitter;
	vec2 on_emitter;
	float roulette;
	vec2 smooth_way; // at mirrors and glass: whether there, and which way
};

numbers numbers_at(uint leaf, uint path, uint bounce)
{
	uvec4 a = pcg4d(uvec4(leaf, path, seed, 2u * bounce)), b = pcg4d(uvec4(leaf, path, seed, 2u * bounce + 1u));
	return numbers(vec2(unit(a.x), unit(a.y)), a.z, vec2(unit(a.w), unit(b.x)), unit(b.y),
		       vec2(unit(b.z), unit(b.w)));
}

// Keys that no (leaf, path) has: the number of paths is below 2^31.
numbers first_numbers(uint leaf, uint path, out vec2 on_leaf)
{
	uvec4 a = pcg4d(uvec4(leaf, 0x80000000u, seed, 0u)), b = pcg4d(uvec4(leaf, 0x80000001u, seed, 0u));
	on_leaf = vec2(unit(sobol_number(0u, path, a.x)), unit(sobol_number(1u, path, a.y)));
	numbers n = numbers_at(leaf, path, 0u); // for the roulette, and for mirrors and glass
	n.direction = vec2(unit(sobol_number(2u, path, a.z)), unit(sobol_number(3u, path, a.w)));
	n.emitter = sobol_number(4u, path, b.x);
	n.on_emitter = vec2(unit(sobol_number(5u, path, b.y)), unit(sobol_number(6u, path, b.z)));
	return n;
}

// ---- surfaces ----

struct vertex {
	vec3 origin; // lifted off the surface
	vec3 normal; // or, at mirrors and glass, the direction that the path goes on in
	bool at_smooth;
};

vec3 triangle_point(vec3 a, vec3 b, vec3 c, vec2 u)
{
	float root = sqrt(u.x);
	return a + (b - a) * (root * (1.0 - u.y)) + (c - a) * (root * u.y);
}

vec3 corner_of(uint object, uint number)
{
	return world_from_rest(object, load_rest_vertex(number).xyz);
}

// A point of a leaf, even over its two triangles.
vertex start_on(uint leaf, vec2 u)
{
	uvec4 l = load_leaf(leaf), corners = topology_corners(l.x);
	vec3 a = corner_of(l.y, corners.x), b = corner_of(l.y, corners.y), c = corner_of(l.y, corners.z),
	     d = corner_of(l.y, corners.w);
	vec3 first = cross(b - a, c - a), second = cross(c - a, d - a);
	float share = length(first) / (length(first) + length(second));
	bool in_first = u.x < share;
	u.x = min(in_first ? u.x / share : (u.x - share) / (1.0 - share), 1.0);
	vec3 n = normalize(in_first ? first : second);
	return vertex(triangle_point(a, in_first ? b : c, in_first ? c : d, u) + n * sky_and_lift.w, n, false);
}

// Where a ray ended, in the world; `material` is that of the leaves there.
vertex vertex_at(nearest hit, out uint material)
{
	gi_primitive q = load_primitive(hit.primitive);
	vec3 a = q.a.xyz, b = hit.second ? q.c.xyz : q.b.xyz, c = hit.second ? q.d.xyz : q.c.xyz;
	vec3 p = a + (b - a) * hit.barycentric.x + (c - a) * hit.barycentric.y;
	vec3 n = normalize(world_direction_from_rest(hit.object, cross(b - a, c - a)));
	uint first = floatBitsToUint(q.a.w);
	bool apart = (object_bvh(hit.object).z & GI_OBJECT_LEAF_MATERIALS) != 0u;
	material = load_leaf(apart ? leaf_at(hit.object, first, p) : first).z;
	return vertex(world_from_rest(hit.object, p) + n * sky_and_lift.w, n, false);
}

// Cosine-weighted about n, in a tangent frame without a branch at the poles (Duff et al. 2017).
vec3 cosine_direction(vec3 n, vec2 u)
{
	float s = n.z >= 0.0 ? 1.0 : -1.0;
	float k = -1.0 / (s + n.z), m = n.x * n.y * k;
	vec3 tangent = vec3(1.0 + s * n.x * n.x * k, s * m, -s * n.x), bitangent = vec3(m, s + n.y * n.y * k, -n.y);
	float radius = sqrt(u.y), phi = 2.0 * PI * u.x;
	return n * sqrt(1.0 - u.y) + tangent * (radius * cos(phi)) + bitangent * (radius * sin(phi));
}

// ---- light ----

// Samples per m2 that an emitter of this exitance gets.
float light_density(vec3 exitance)
{
	return dot(exitance, vec3(0.2126, 0.7152, 0.0722)) * density;
}

uint pick_light(uint u)
{
	uint low = 0u, high = light_count - 1u;
	while (low < high) {
		uint middle = (low + high) >> 1u;
		if (u <= load_light_triangle(3u * middle).w)
			high = middle;
		else
			low = middle + 1u;
	}
	return low;
}

// Irradiance from one point of one emitter, weighted. Both densities are seen from the lifted origin to the surface
// itself, as those of a ray that meets the emitter are: the two weights add up to 1 right into the corners.
vec3 light_from_emitters(vertex v, numbers u)
{
	uint k = 3u * pick_light(u.emitter);
	vec3 a = uintBitsToFloat(load_light_triangle(k).xyz), b = uintBitsToFloat(load_light_triangle(k + 1u).xyz),
	     c = uintBitsToFloat(load_light_triangle(k + 2u).xyz);
	vec3 n = normalize(cross(b - a, c - a)), q = triangle_point(a, b, c, u.on_emitter), d = q - v.origin;
	float r2 = dot(d, d), r = sqrt(r2), cos_here = dot(v.normal, d), cos_there = -dot(n, d);
	uint rank = load_leaf(load_light_triangle(k + 2u).w).w;
	if (!(cos_here > 0.0 && cos_there > 0.0) || !segment_is_free(v.origin, q, rank, sky_and_lift.w))
		return vec3(0.0);
	vec3 exitance = load_material(load_light_triangle(k + 1u).w).exitance.xyz;
	float pdf_b = cos_here / (r * PI), pdf_l = light_density(exitance) * r2 * r / cos_there;
	return exitance * (pdf_b / (pdf_b + pdf_l));
}

float largest(vec3 v)
{
	return max(v.x, max(v.y, v.z));
}

#if PUNCTUAL
#include "punctual.glsl"
#include "punctual_path.glsl"
#endif

#if SPECULAR
// Where a path goes on from a surface that may be a mirror or glass; `tint` comes as its rho, and leaves as what the
// light is multiplied by. False: nowhere. Of what is a mirror and reflects diffusely too one is drawn, as often as it
// may carry.
bool scatter(nearest hit, vec3 direction, gi_smooth_material m, vec2 u, inout vertex next, inout vec3 tint)
{
	if (!is_smooth(m))
		return hit.front;
	float diffuse = hit.front ? largest(tint) : 0.0;
	float share = diffuse / (diffuse + largest(max(m.specular.xyz, m.transmittance.xyz)));
	if (u.x < share) {
		tint /= share;
		return true;
	}
	light_ray r = light_ray(next.origin, direction, vec3(1.0));
	bool on = go_on(smooth_point_of(hit, direction), m, WAY_BY_CHANCE, u.y, sky_and_lift.w, r);
	tint = r.throughput / (1.0 - share);
	next = vertex(r.origin, r.direction, true);
	return on;
}
#endif

// Emitters that a ray met: weighted against those that points are drawn on, which mirrors and glass are in the way of.
vec3 light_from_hit(vertex v, nearest hit, vec3 exitance, float cosine, numbers u)
{
	float pdf_b = sqrt(1.0 - u.direction.y) / PI;
	float pdf_l = light_density(exitance) * hit.distance * hit.distance / max(cosine, 1e-12);
	return v.at_smooth ? exitance : exitance * (pdf_b / (pdf_b + pdf_l));
}

// What a ray that met nothing finds. Of a picture, weighted against directions that are drawn by its light.
#ifdef SKY_IMAGE
vec3 light_from_beyond(vertex v, vec3 direction, numbers u)
{
	uint texel = sky_texel_towards(direction);
	float pdf_b = sqrt(1.0 - u.direction.y) / PI;
	return sky_texel_exitance(texel) * (v.at_smooth ? 1.0 : pdf_b / (pdf_b + sky_density(texel)));
}

vec3 light_from_sky(vertex v, uint leaf, uint path, uint bounce)
{
	uvec4 a = pcg4d(uvec4(leaf, path, ~seed, bounce));
	uint texel = pick_sky_texel(a.x);
	vec3 direction = sky_direction(texel, vec2(unit(a.y), unit(a.z)));
	float cosine = dot(v.normal, direction);
	if (!(cosine > 0.0) || find_nearest(v.origin, direction, sky_and_lift.w).object != GI_NONE)
		return vec3(0.0);
	float pdf_b = cosine / PI;
	return sky_texel_exitance(texel) * (pdf_b / (pdf_b + sky_density(texel)));
}
#else
vec3 light_from_beyond(vertex v, vec3 direction, numbers u)
{
	return sky_and_lift.xyz;
}
#endif

// Vertex `number` of a path, from 0: gathers light into `sum` and goes on to the next. False when the path ends.
bool extend(inout vertex v, inout vec3 throughput, inout vec3 sum, numbers u, float number)
{
	vec3 found = light_count > 0u && !v.at_smooth ? light_from_emitters(v, u) : vec3(0.0);
#if PUNCTUAL
	found += v.at_smooth ? vec3(0.0) : light_from_punctual(v, u, punctual_count);
#endif
	vec3 direction = v.at_smooth ? v.normal : cosine_direction(v.normal, u.direction);
	nearest hit = find_nearest(v.origin, direction, sky_and_lift.w);
	if (hit.object == GI_NONE) {
		sum += throughput * (found + light_from_beyond(v, direction, u));
		return false;
	}
	uint material;
	vertex next = vertex_at(hit, material);
	if (hit.front)
		found += light_from_hit(v, hit, load_material(material).exitance.xyz, -dot(next.normal, direction), u);
	sum += throughput * found;
	vec3 tint = load_material(material).rho.xyz;
#if SPECULAR
	if (!scatter(hit, direction, load_smooth_material(material), u.smooth_way, next, tint))
		return false;
#else
	if (!hit.front)
		return false;
#endif
	// Survival keeps the largest channel of the throughput where it was: a path neither grows nor fades from then
	// on.
	float before = largest(throughput);
	throughput *= tint;
	float survival = largest(throughput) < ROULETTE_BELOW ? min(largest(throughput) / before, 1.0) : 1.0;
	if (number > LONG_PATH)
		survival = min(survival, 1.0 - 2.0 / number);
	if (u.roulette >= survival)
		return false;
	throughput /= survival;
	v = next;
	return true;
}

// Takes the slot on by one vertex.
void step_on(uint leaf, inout gi_path_slot slot)
{
	uint path = uint(slot.origin.w), bounce = uint(slot.normal.w);
	vertex v = vertex(slot.origin.xyz, slot.normal.xyz, slot.throughput.w != 0.0);
	vec3 throughput = slot.throughput.xyz, found = slot.found.xyz;
	numbers u;
	if (bounce == 0u) {
		vec2 on_leaf;
		u = first_numbers(leaf, path, on_leaf);
		v = start_on(leaf, on_leaf);
		throughput = vec3(1.0);
	} else {
		u = numbers_at(leaf, path, bounce);
	}
#ifdef SKY_IMAGE
	if (!v.at_smooth)
		found += throughput * light_from_sky(v, leaf, path, bounce);
#endif
	bool on = extend(v, throughput, found, u, slot.normal.w);
	slot.origin = vec4(v.origin, float(on ? path : path + 1u));
	slot.normal = vec4(v.normal, float(on ? bounce + 1u : 0u));
	slot.throughput = vec4(throughput, on && v.at_smooth ? 1.0 : 0.0);
	// What a path adds is small beside what the slot has: it is added at once.
	slot.found.xyz = on ? found : vec3(0.0);
	slot.sum.xyz += on ? vec3(0.0) : found;
}

void main()
{
	uint t = thread_number(), runs = (path_count + run - 1u) / run;
	if (t >= leaf_count * runs)
		return;
	// Slots side by side work on leaves side by side, whose rays go the same ways.
	uint leaf = first_leaf + t % leaf_count, part = t / leaf_count;
	float begin = float(first_path + part * run), end = float(first_path + min(path_count, (part + 1u) * run));
	gi_path_slot slot = path_slots[t];
	if (slot.origin.w < begin) // cleared to -1: a new run
		slot = gi_path_slot(vec4(0.0, 0.0, 0.0, begin), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
	if (slot.origin.w >= end)
		return;
	for (uint k = 0u; k < STEPS && slot.origin.w < end; k++)
		step_on(leaf, slot);
	path_slots[t] = slot;
	if (slot.origin.w < end)
		going = 1u;
}
