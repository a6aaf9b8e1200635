// Is a segment free? Two levels: boxes of objects in the world, boxes and quads of an object in its rest frame.
//
// What an object does to a segment depends on the poses of that object and of the two at the ends alone, and is always
// computed in the blocker's rest frame; an end that lies on the blocker itself is used as it is, without a turn through
// the world. So the answer for a pair of points is the same bits whenever those poses are.

// An object's pose, loaded once for all samples of an entry.
struct body {
	uint object; // GI_NONE: the sky
	bool flat_surface;
	vec4 row0, row1, row2; // world from rest
};

struct segment_end {
	uint leaf;  // the leaf it lies on, which cannot hide it
	vec3 rest;  // in its body's rest frame
	vec3 world; // in the world; a unit direction for the sky: such a segment never ends
};

body load_body(uint object)
{
	bool flat_surface = (object_bvh(object).z & GI_OBJECT_FLAT) != 0u;
	return body(object, flat_surface, object_row0(object), object_row1(object), object_row2(object));
}

vec3 to_world(body b, vec3 p)
{
	vec4 q = vec4(p, 1.0);
	return vec3(dot(b.row0, q), dot(b.row1, q), dot(b.row2, q));
}

vec3 to_rest(body b, vec3 p)
{
	vec3 q = p - vec3(b.row0.w, b.row1.w, b.row2.w);
	return b.row0.xyz * q.x + b.row1.xyz * q.y + b.row2.xyz * q.z;
}

vec3 direction_to_rest(body b, vec3 d)
{
	return b.row0.xyz * d.x + b.row1.xyz * d.y + b.row2.xyz * d.z;
}

vec3 direction_to_world(body b, vec3 d)
{
	return vec3(dot(b.row0.xyz, d), dot(b.row1.xyz, d), dot(b.row2.xyz, d));
}

// A surface that an end of the segment lies in, within rounding, does not hide it: rounding of the plane's distance is
// below this share of the coordinates it is computed from. A share of the segment's length would do for that, but a
// wall just before the lamp, or a small sealed room in a large scene, would leak.
const float PLANE_SLACK = 2.5e-7;

// Rays that graze a shared edge must not slip between the triangles: barycentric coordinates may fall short by this.
const float EDGE_SLACK = 2e-6;

// A ray in the cells of a packed tree.
struct grid_ray {
	vec3 origin;
	vec3 inverse;
};

vec3 safe_inverse(vec3 d)
{
	// A zero would make 0 * infinity in the slab test.
	return 1.0 / mix(d, vec3(1e-30), lessThan(abs(d), vec3(1e-30)));
}

grid_ray ray_on_grid(vec3 origin, vec3 direction, vec3 grid, vec3 cells)
{
	return grid_ray((origin - grid) * cells, safe_inverse(direction * cells));
}

bool hits_box(grid_ray r, uvec4 node, float end)
{
	vec3 lower = vec3(node.x & 0xFFFFu, node.x >> 16u, node.y & 0xFFFFu);
	vec3 upper = vec3(node.y >> 16u, node.z & 0xFFFFu, node.z >> 16u);
	vec3 a = (lower - r.origin) * r.inverse, b = (upper - r.origin) * r.inverse;
	vec3 near = min(a, b), far = max(a, b);
	return max(max(near.x, near.y), max(near.z, 0.0)) <= min(min(far.x, far.y), min(far.z, end));
}

// Where a ray meets a triangle's plane (Moller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997; both
// sides).
struct plane_meeting {
	vec2 barycentric;  // of b and c
	float height;      // the origin's distance from the plane times |ab x ac|
	float determinant; // the same of the direction's length along the plane's normal; 0: parallel
};

plane_meeting meet_plane(vec3 origin, vec3 direction, vec3 a, vec3 b, vec3 c)
{
	vec3 ab = b - a, ac = c - a;
	vec3 p = cross(direction, ac);
	float determinant = dot(ab, p);
	if (determinant == 0.0)
		return plane_meeting(vec2(-1.0), 0.0, 0.0);
	float inverse = 1.0 / determinant;
	vec3 s = origin - a;
	vec3 q = cross(s, ab);
	float height = dot(ac, q);
	return plane_meeting(vec2(dot(s, p), dot(direction, q)) * inverse, determinant < 0.0 ? -height : height, abs(determinant));
}

bool inside_triangle(vec2 barycentric)
{
	return barycentric.x >= -EDGE_SLACK && barycentric.y >= -EDGE_SLACK && barycentric.x + barycentric.y <= 1.0 + EDGE_SLACK;
}

// The ends of the segment, the far one at `end`, must lie off the triangle's plane by their slack: a distance times `area2`
// (|ab x ac|).
bool hits_triangle(vec3 origin, vec3 direction, vec3 a, vec3 b, vec3 c, float area2, float end, vec2 slack)
{
	plane_meeting m = meet_plane(origin, direction, a, b, c);
	return inside_triangle(m.barycentric) && m.height > slack.x * area2 && m.determinant * end - m.height > slack.y * area2;
}

// Does one object cut the segment? skip_a and skip_b are leaves whose primitives do not count.
bool object_hides(uint object, vec3 origin, vec3 direction, float end, vec2 slack, uint skip_a, uint skip_b)
{
	uvec4 range = object_bvh(object);
	grid_ray r = ray_on_grid(origin, direction, object_grid(object).xyz, object_cells(object).xyz);
	uint n = range.x;
	bool hidden = false;
	while (n < range.y && !hidden) {
		// First every ray of a vector goes on to a quad, then all test theirs together (Aila and Laine, 2009).
		uint primitive = GI_NONE;
		while (n < range.y && primitive == GI_NONE) {
			uvec4 node = load_bvh(n);
			bool hit = hits_box(r, node, end);
			bool leaf = (node.w & GI_PACKED_LEAF) != 0u;
			primitive = hit && leaf ? node.w & ~GI_PACKED_LEAF : GI_NONE;
			n = hit || leaf ? n + 1u : node.w;
		}
		if (primitive == GI_NONE)
			break;
		gi_primitive q = load_primitive(primitive);
		uint first = floatBitsToUint(q.a.w), last = floatBitsToUint(q.b.w);
		bool own = (skip_a >= first && skip_a < last) || (skip_b >= first && skip_b < last);
		hidden = !own && (hits_triangle(origin, direction, q.a.xyz, q.b.xyz, q.c.xyz, q.c.w, end, slack) ||
				  hits_triangle(origin, direction, q.a.xyz, q.c.xyz, q.d.xyz, q.d.w, end, slack));
	}
	return hidden;
}

float reach_of(vec3 v)
{
	return max(abs(v.x), max(abs(v.y), abs(v.z)));
}

// Does the object of `by` cut the segment between a on body A and b on body B?
bool segment_hidden_by(body by, body body_a, segment_end a, body body_b, segment_end b)
{
	bool own_a = by.object == body_a.object, own_b = by.object == body_b.object;
	vec3 origin = own_a ? a.rest : to_rest(by, a.world);
	uint skip_a = own_a ? a.leaf : GI_NONE, skip_b = own_b ? b.leaf : GI_NONE;
	bool sky = body_b.object == GI_NONE;
	vec3 target = sky ? direction_to_rest(by, b.world) : (own_b ? b.rest : to_rest(by, b.world)) - origin;
	// Of what the ends were computed from: world coordinates play no part where both are on the blocker.
	float near = reach_of(own_a ? a.rest : a.world) + reach_of(origin);
	float far = sky ? 0.0 : near + reach_of(own_b ? b.rest : b.world) + reach_of(target);
	return object_hides(by.object, origin, target, sky ? 3e38 : 1.0, PLANE_SLACK * vec2(near, far), skip_a, skip_b);
}

// The object that hides b from a, or GI_BLOCKER_NONE. The ends' own objects come first and without the test of world
// boxes, whose rounding depends on the pose: an object at rest relative to both ends must always answer the same.
uint segment_blocker(body body_a, segment_end a, body body_b, segment_end b)
{
	if (!body_a.flat_surface && segment_hidden_by(body_a, body_a, a, body_b, b))
		return body_a.object;
	bool sky = body_b.object == GI_NONE;
	if (!sky && body_b.object != body_a.object && !body_b.flat_surface && segment_hidden_by(body_b, body_a, a, body_b, b))
		return body_b.object;
	float end = sky ? 3e38 : 1.0;
	grid_ray r = ray_on_grid(a.world, sky ? b.world : b.world - a.world, frame.grid.xyz, frame.cells.xyz);
	uint n = 0u, blocker = GI_BLOCKER_NONE;
	while (n < frame.misc.x && blocker == GI_BLOCKER_NONE) {
		uint object = GI_NONE;
		while (n < frame.misc.x && object == GI_NONE) {
			uvec4 node = load_tlas(n);
			bool hit = hits_box(r, node, end);
			bool leaf = (node.w & GI_PACKED_LEAF) != 0u;
			uint candidate = node.w & ~GI_PACKED_LEAF;
			object = hit && leaf && candidate != body_a.object && candidate != body_b.object ? candidate : GI_NONE;
			n = hit || leaf ? n + 1u : node.w;
		}
		if (object == GI_NONE)
			break;
		if (segment_hidden_by(load_body(object), body_a, a, body_b, b))
			blocker = object;
	}
	return blocker;
}
