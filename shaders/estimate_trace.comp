#version 450 core
// The estimate's samples, traced: one thread an item. From a random point of the receiver the form factor of the source
// leaf, by the receiver's normal there, and one ray to a point of it. A row has the mean form factor times the mean
// visibility; the mean of these products is what the two together let through.
#define READ_FRAME
#define READ_OBJECTS
#define READ_TOPOLOGY
#define READ_VERTICES_REST
#define READ_LEAVES
#define READ_LEAF_QUADS
#define READ_BVH
#define READ_PRIMITIVES
#define READ_TLAS
#define READ_ESTIMATE_ITEMS
#define WRITE_ESTIMATE_ITEMS
#include "buffers.glsl"
#include "dispatch.glsl"
#include "polygon.glsl"
#include "sampling.glsl"
#include "rays.glsl"
#include "segments.glsl"
#include "blocker.glsl"
#include "visibility.glsl"

layout(local_size_x = GI_GROUP_SIZE) in;
layout(location = 0) uniform uint salt;
layout(location = 1) uniform uint count; // items

// Even over a group's items, whose order is that of their sources; groups are independent.
vec4 item_numbers(uint t, uint attempt)
{
	return sample_numbers(t / GI_ESTIMATE_GROUP_ITEMS, salt ^ hash(attempt), t % GI_ESTIMATE_GROUP_ITEMS);
}

// Where a corner of the source is: at rest where both are one body's, else in the world; a direction for the sky.
vec3 source_corner(pair p, vec3 rest_corner)
{
	return p.same || p.sky ? rest_corner : to_world(p.source, rest_corner);
}

// From x with normal n to the source leaf; below 0: to its back.
float factor_from(pair p, vec3 x, vec3 n)
{
	vec3 from = p.sky ? vec3(0.0) : x;
	vec3 v[4] = vec3[](source_corner(p, p.theirs.a) - from, source_corner(p, p.theirs.b) - from,
			   source_corner(p, p.theirs.c) - from, source_corner(p, p.theirs.d) - from);
	vec3 to = 0.25 * (v[0] + v[1] + v[2] + v[3]);
	float far = length(to),
	      radius = max(max(distance(v[0], to), distance(v[1], to)), max(distance(v[2], to), distance(v[3], to)));
	if (radius >= POINT_SOURCE * (far - radius))
		return polygon_factor(v, n);
	vec3 area = 0.5 * cross(v[2] - v[0], v[3] - v[1]);
	return disc_factor(to, n, -dot(area, to) / far);
}

// The ray from a to the source, at a point that faces a; blocked where none does.
bool sees(pair p, segment_end a, vec2 u, uint t)
{
	for (uint attempt = 0u; attempt < TRIES; attempt++) {
		vec3 m;
		segment_end b = source_end(p, item_numbers(t, attempt).zw, m);
		if (transfer(p, a, b, u, m) > 0.0)
			return blocker_of(p.receiver, a, p.source, b, !p.back, false) == GI_BLOCKER_NONE;
	}
	return false;
}

void main()
{
	uint t = thread_number();
	if (t >= count)
		return;
	uvec4 item = load_item(t);
	pair p = load_pair(item);
	vec2 u = item_numbers(t, 0u).xy;
	segment_end a = end_on(p.receiver, p.leaf, point_on(p.mine, u));
	// Halves of the unit square become the two triangles, whose areas differ.
	vec3 abc = cross(p.mine.b - p.mine.a, p.mine.c - p.mine.a),
	     acd = cross(p.mine.c - p.mine.a, p.mine.d - p.mine.a);
	bool first = u.x >= u.y || p.mine.c == p.mine.d;
	vec3 n = first ? abc : acd;
	float area = length(n);
	float share = p.mine.c == p.mine.d ? 1.0 : 2.0 * area / (length(abc) + length(acd));
	n /= max(area, 1e-30);
	float f = factor_from(p, p.same ? a.rest : a.world, p.same ? n : direction_to_world(p.receiver, n));
	p.back = f < 0.0 && (p.t.range.w & GI_NODE_BACK) != 0u;
	f = p.back ? -f : max(f, 0.0);
	bool visible = f > 0.0 && sees(p, a, u, t);
	estimate_items[t] = uvec4(item.x, floatBitsToUint(share * f), visible ? 1u : 0u,
			 p.leaf | ((f > 0.0 ? 1u : 0u) << GI_ENTRY_SAMPLE_SHIFT) | (p.back ? GI_ENTRY_BACK : 0u));
}
