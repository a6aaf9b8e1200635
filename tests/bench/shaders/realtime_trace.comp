#version 450 core
#include "realtime.glsl"
// One path a pixel: a thread each. Direct light of what is seen by one shadow ray, indirect light by one ray onwards,
// which takes the light that the last frame found where it ends, if that was on screen; else it is lit by a shadow ray,
// and goes on.
//
// The rays' tree is ray_tree.h's. Radiance of mirrors and glass counts as indirect light.

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 4) uniform usamplerBuffer nodes;
layout(binding = 5) uniform usamplerBuffer triangles; // corner, edge, edge; w of the first: the object
layout(binding = 6) uniform samplerBuffer corner_normals; // three a triangle
layout(binding = 7) uniform sampler2D last_direct; // irradiance, filtered
layout(binding = 8) uniform sampler2D last_indirect;

layout(rgba32f, binding = 0) writeonly uniform image2D direct_out;
layout(rgba32f, binding = 1) writeonly uniform image2D indirect_out;

// ---- numbers ----

uint hash(uint x)
{
	x = x * 747796405u + 2891336453u; // PCG (Jarzynski and Olano, JCGT 9 (3), 2020)
	x = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
	return (x >> 22u) ^ x;
}

uint spread_bits(uint x)
{
	x = (x | (x << 4u)) & 0x0f0fu;
	x = (x | (x << 2u)) & 0x3333u;
	return (x | (x << 1u)) & 0x5555u;
}

uint hash_upwards(uint x, uint seed) // low_discrepancy.h
{
	x += seed;
	x ^= x * 0x6c50b47cu;
	x ^= x * 0xb82f1e52u;
	x ^= x * 0xc7afe638u;
	x ^= x * 0x8d22f6e6u;
	return x;
}

uint owen_scramble(uint x, uint seed)
{
	return bitfieldReverse(hash_upwards(bitfieldReverse(x), seed));
}

uint sobol_second(uint index)
{
	uint result = 0u;
	for (uint v = 0x80000000u; index != 0u; index >>= 1u, v ^= v >> 1u)
		result ^= (index & 1u) != 0u ? v : 0u;
	return result;
}

uint sample_number;
uint pixel_number; // along a Z curve over tiles of 64 x 64
uint tile_seed;
uint pairs;

// Neighbours in a frame take neighbouring points of Sobol's sequence along a Z curve, so that the filter averages
// points that lie evenly (after Ahmed and Wonka, "Screen-space blue-noise diffusion of Monte Carlo sampling error via
// hierarchical ordering of pixels", 2020). From frame to frame the points of each pixel move by a step of golden
// ratio's kind in all dimensions (Roberts' R sequence, of eight here), so that what accumulates lies evenly too.
const vec2 STEPS[4] = vec2[](vec2(0.92159932, 0.84934531), vec2(0.78275606, 0.72138745), vec2(0.66483018, 0.61270704),
			     vec2(0.56467039, 0.52039985));

vec2 next_numbers()
{
	uint seed = hash(tile_seed + pairs);
	uint index = owen_scramble(pixel_number, seed);
	vec2 point = vec2(uvec2(bitfieldReverse(index), sobol_second(index)) >> 8u) * 5.9604644775390625e-8;
	point += vec2(uvec2(hash(seed ^ 0x68bc21ebu), hash(seed ^ 0x02e5be93u)) >> 8u) * 5.9604644775390625e-8;
	vec2 step = STEPS[min(pairs, 3u)];
	// In integers: a float would have lost the fraction after some thousand frames.
	point += vec2(uvec2(step * 4294967295.0) * sample_number >> 8u) * 5.9604644775390625e-8;
	pairs++;
	return fract(point);
}

// ---- rays ----

struct ray_hit {
	float distance;
	uint object, triangle; // NOTHING: none
	vec2 barycentric;
	uint instance;
	bool front;
};

// The nearest triangle along the ray, or any before best.distance.
void trace_instance(uint number, vec3 world_origin, vec3 world_direction, bool any, inout ray_hit best)
{
	mat4 to = instances[number].object_from_world;
	uvec4 range = instances[number].range;
	vec3 o = (to * vec4(world_origin, 1.0)).xyz, d = mat3(to) * world_direction;
	vec3 size = abs(d);
	uint axis = size.x >= size.y && size.x >= size.z ? 0u : size.y >= size.z ? 1u : 2u;
	uint order = 2u * axis + (d[axis] < 0.0 ? 1u : 0u);
	vec3 inverse = 1.0 / mix(d, vec3(1e-20), lessThan(size, vec3(1e-20)));
	vec3 shift = -o * inverse;
	uint base = range.x + order * range.y, n = 0u;
	while (n < range.y) {
		uvec4 a = texelFetch(nodes, int(2u * (base + n))), b = texelFetch(nodes, int(2u * (base + n) + 1u));
		vec3 t0 = uintBitsToFloat(a.xyz) * inverse + shift, t1 = uintBitsToFloat(b.xyz) * inverse + shift;
		vec3 low = min(t0, t1), high = max(t0, t1);
		float enters = max(max(low.x, low.y), max(low.z, 0.0));
		bool met = enters <= min(min(high.x, high.y), min(high.z, best.distance)) * 1.0000004;
		uint count = met ? b.w >> 28u : 0u, first = range.z + (b.w & 0x0fffffffu);
		n = met ? n + 1u : a.w;
		for (uint k = 0u; k < count; k++) {
			uint triangle = first + k;
			uvec4 corner = texelFetch(triangles, int(3u * triangle));
			vec3 e1 = uintBitsToFloat(texelFetch(triangles, int(3u * triangle + 1u)).xyz);
			vec3 e2 = uintBitsToFloat(texelFetch(triangles, int(3u * triangle + 2u)).xyz);
			// Möller and Trumbore, "Fast, minimum storage ray-triangle intersection", 1997.
			vec3 p = cross(d, e2), from = o - uintBitsToFloat(corner.xyz), q = cross(from, e1);
			float determinant = dot(e1, p), over = 1.0 / determinant;
			float u = dot(from, p) * over, v = dot(d, q) * over, t = dot(e2, q) * over;
			if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < best.distance)
				best = ray_hit(t, corner.w, triangle, vec2(u, v), number, determinant > 0.0);
		}
		if (any && best.object != NOTHING)
			n = range.y;
	}
}

ray_hit trace_ray(vec3 origin, vec3 direction, float end, bool any)
{
	ray_hit best = ray_hit(end, NOTHING, NOTHING, vec2(0.0), 0u, false);
	for (uint k = 0u; k < counts.x; k++)
		trace_instance(k, origin, direction, any, best);
	return best;
}

bool is_free(vec3 from, vec3 to)
{
	return trace_ray(from, to - from, 0.99998, true).object == NOTHING;
}

vec3 normal_at(ray_hit h)
{
	int first = int(3u * h.triangle);
	vec3 a = texelFetch(corner_normals, first).xyz, b = texelFetch(corner_normals, first + 1).xyz;
	vec3 c = texelFetch(corner_normals, first + 2).xyz;
	vec3 n = a + (b - a) * h.barycentric.x + (c - a) * h.barycentric.y;
	return normalize(mat3(instances[h.instance].world_from_object) * n);
}

// ---- surfaces ----

// Irradiance by one point of light.
vec3 light_at(vec3 p, vec3 n, vec2 numbers)
{
	uint k = 0u;
	while (k + 1u < counts.y && numbers.x >= lights[k].origin.w)
		k++;
	rt_light l = lights[k];
	float before = k > 0u ? lights[k - 1u].origin.w : 0.0;
	float root = sqrt(clamp((numbers.x - before) / (l.origin.w - before), 0.0, 1.0));
	vec3 at = l.origin.xyz + l.u.xyz * (root * (1.0 - numbers.y)) + l.v.xyz * (root * numbers.y);
	vec3 to = at - p, facing = normalize(cross(l.u.xyz, l.v.xyz));
	float square = dot(to, to), cosines = max(dot(n, to), 0.0) * max(-dot(facing, to), 0.0) / square;
	if (counts.y == 0u || cosines <= 0.0 || !is_free(p, at))
		return vec3(0.0);
	return l.exitance.xyz * (cosines / (PI * square * l.u.w));
}

vec3 cosine_direction(vec3 n, vec2 numbers)
{
	// Duff et al., JCGT 6 (1), 2017.
	float sign_z = n.z < 0.0 ? -1.0 : 1.0, a = -1.0 / (sign_z + n.z), b = n.x * n.y * a;
	vec3 s = vec3(1.0 + sign_z * n.x * n.x * a, sign_z * b, -sign_z * n.x);
	vec3 t = vec3(b, sign_z + n.y * n.y * a, -n.y);
	float radius = sqrt(numbers.y), angle = 2.0 * PI * numbers.x;
	return normalize(n * sqrt(max(1.0 - numbers.y, 0.0)) + s * (radius * cos(angle)) + t * (radius * sin(angle)));
}

float fresnel(float cosine, float index) // Born and Wolf, Principles of Optics, 7th ed., 1.5.2
{
	float sine2 = (1.0 - cosine * cosine) / (index * index);
	if (sine2 >= 1.0)
		return 1.0;
	float inside = sqrt(1.0 - sine2);
	float parallel = (index * cosine - inside) / (index * cosine + inside);
	float perpendicular = (cosine - index * inside) / (cosine + index * inside);
	return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

// A ray at a mirror or glass; false where it ends. n: against it.
bool go_on(rt_object o, vec3 p, vec3 n, bool front, float chance, inout vec3 origin, inout vec3 direction,
	   inout vec3 weight)
{
	bool glass = o.transmittance.xyz != vec3(0.0);
	float cosine = clamp(-dot(direction, n), 0.0, 1.0), index = front ? o.reflectance.w : 1.0 / o.reflectance.w;
	bool reflected = !glass || chance < fresnel(cosine, index);
	float inside = sqrt(max(1.0 - (1.0 - cosine * cosine) / (index * index), 0.0));
	vec3 refracted = direction / index + n * (cosine / index - inside);
	direction = normalize(reflected ? direction + 2.0 * cosine * n : refracted);
	weight *= glass ? (reflected ? vec3(1.0) : o.transmittance.xyz) : o.reflectance.xyz;
	origin = p + n * (reflected ? settings.x : -settings.x);
	return glass || front;
}

// The light that the last frame found at a point of an object; w: 0 where it was not seen there.
vec4 seen_light(uint object, vec3 p, vec3 n)
{
	ivec2 size = textureSize(places_before, 0);
	vec3 before = (objects[object].before_from_now * vec4(p, 1.0)).xyz;
	vec3 at = find_pixel(camera_before, before, vec2(size));
	ivec2 pixel = ivec2(floor(at.xy));
	if (flags.y == 0u || at.z <= 0.0 || any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, size)))
		return vec4(0.0);
	vec4 place = texelFetch(places_before, pixel, 0);
	vec3 normal = texelFetch(normals_before, pixel, 0).xyz;
	// A pixel's width there, and what it is on a slope.
	float width = 2.0 * at.z * length(camera_before.up.xyz) / float(size.y), apart = distance(place.xyz, before);
	float slope = max(abs(dot(normal, normalize(camera_before.eye.xyz - before))), 0.1);
	vec3 was = mat3(objects[object].before_from_now) * n;
	if (object_of(place) != object || apart > 1.5 * width / slope || dot(normal, was) < 0.9)
		return vec4(0.0);
	return vec4(texelFetch(last_direct, pixel, 0).xyz + texelFetch(last_indirect, pixel, 0).xyz, 1.0);
}

// ---- a path ----

// Adds to the irradiance of a diffuse pixel, or to pi times the radiance of another.
void trace_path(uint object, vec3 p, vec3 n, inout vec3 direct, inout vec3 all_indirect)
{
	vec3 direction = normalize(p - camera.eye.xyz), weight = vec3(1.0), indirect = vec3(0.0);
	vec3 origin = p + n * settings.x - direction * settings.x;
	bool diffuse = !is_smooth(objects[object]), on = !diffuse || flags.z != MODE_DIRECT, caustic = !diffuse;
	if (diffuse) {
		vec2 numbers = next_numbers();
		if (flags.z != MODE_INDIRECT)
			direct += light_at(origin, n, numbers);
		direction = cosine_direction(n, next_numbers());
	} else {
		weight = vec3(PI);
		vec3 against = dot(n, direction) < 0.0 ? n : -n;
		on = go_on(objects[object], p, against, true, next_numbers().x, origin, direction, weight);
	}
	uint bounces = diffuse ? 1u : 0u; // diffuse vertices
	for (uint step = 0u; step < 16u && on; step++) {
		ray_hit h = trace_ray(origin, direction, 3e38, false);
		on = h.object != NOTHING;
		rt_object o = objects[on ? h.object : 0u];
		p = origin + direction * h.distance;
		n = on ? normal_at(h) : vec3(0.0, 0.0, 1.0);
		bool wanted = bounces == 0u ? flags.z != MODE_INDIRECT : flags.z != MODE_DIRECT;
		if (on && h.front && caustic && wanted)
			indirect += weight * o.exitance.xyz * (bounces == 0u ? 1.0 / PI : 1.0);
		if (on && is_smooth(o)) {
			caustic = true;
			vec3 against = h.front ? n : -n;
			against = dot(against, direction) < 0.0 ? against : -direction;
			on = go_on(o, p, against, h.front, next_numbers().x, origin, direction, weight);
		} else if (on && h.front) {
			weight *= bounces == 0u ? o.rho.xyz / PI : o.rho.xyz;
			vec4 known = flags.z == MODE_GLOBAL ? seen_light(h.object, p, n) : vec4(0.0);
			indirect += weight * known.xyz;
			origin = p + n * settings.x - direction * settings.x;
			on = known.w == 0.0 && max(weight.x, max(weight.y, weight.z)) > 0.0;
			vec2 numbers = next_numbers();
			if (on && wanted)
				indirect += weight * light_at(origin, n, numbers);
			bounces++;
			on = on && bounces <= counts.w && flags.z != MODE_DIRECT;
			caustic = false;
			direction = cosine_direction(n, next_numbers());
		} else {
			on = false;
		}
	}
	float largest = max(indirect.x, max(indirect.y, indirect.z));
	all_indirect += indirect * (largest > settings.w ? settings.w / largest : 1.0);
}

void main()
{
	ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(places, 0);
	if (any(greaterThanEqual(pixel, size)))
		return;
	pixel_number = spread_bits(uint(pixel.x) & 63u) | spread_bits(uint(pixel.y) & 63u) << 1u;
	tile_seed = hash(uint(pixel.x) >> 6u | (uint(pixel.y) >> 6u) << 16u);
	vec4 place = texelFetch(places, pixel, 0);
	vec3 n = texelFetch(normals, pixel, 0).xyz, direct = vec3(0.0), indirect = vec3(0.0);
	uint object = object_of(place), paths = object == NOTHING ? 0u : flags.w;
	for (uint k = 0u; k < paths; k++) {
		pairs = 0u;
		sample_number = counts.z * flags.w + k;
		trace_path(object, place.xyz, n, direct, indirect);
	}
	imageStore(direct_out, pixel, vec4(direct / float(flags.w), 0.0));
	imageStore(indirect_out, pixel, vec4(indirect / float(flags.w), 0.0));
}
