// Is a segment free? Two levels: boxes of objects in the world, boxes and quads of an object in its rest frame.
//
// What an object does to a segment depends on the poses of that object and of the two at the ends alone, and is always
// computed in the blocker's rest frame; an end that lies on the blocker itself is used as it is, without a turn through the
// world. So the answer for a pair of points is the same bits whenever those poses are.

struct segment_end {
	uint object;   // GI_NONE: a direction, the segment never ends
	uint leaf;     // the leaf it lies on, which cannot hide it
	vec3 rest;     // in the object's rest frame
	vec3 world;    // in the world; a unit direction when object is GI_NONE
	float size;    // metres, of the leaf: the scale of a ray that has no length of its own
};

// Shares of the segment left out at its ends: more than the rounding of its ends (1e-7 of the coordinates), less than a hair.
const float SEGMENT_BEGIN = 5e-5;

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

// Moller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997; both sides.
bool hits_triangle(vec3 origin, vec3 direction, vec3 a, vec3 b, vec3 c, float begin, float end)
{
	vec3 ab = b - a, ac = c - a;
	vec3 p = cross(direction, ac);
	float determinant = dot(ab, p);
	if (determinant == 0.0)
		return false;
	float inverse = 1.0 / determinant;
	vec3 s = origin - a;
	float u = dot(s, p) * inverse;
	vec3 q = cross(s, ab);
	float v = dot(direction, q) * inverse;
	float t = dot(ac, q) * inverse;
	return u >= -EDGE_SLACK && v >= -EDGE_SLACK && u + v <= 1.0 + EDGE_SLACK && t > begin && t < end;
}

// Does one object cut the segment? skip_a and skip_b are leaves whose primitives do not count.
bool object_hides(uint object, vec3 origin, vec3 direction, float begin, float end, uint skip_a, uint skip_b)
{
	uvec4 range = objects[object].bvh;
	grid_ray r = ray_on_grid(origin, direction, objects[object].grid.xyz, objects[object].cells.xyz);
	uint n = range.x;
	while (n < range.y) {
		uvec4 node = bvh[n];
		bool hit = hits_box(r, node, end);
		bool leaf = (node.w & GI_PACKED_LEAF) != 0u;
		if (hit && leaf) {
			gi_primitive q = primitives[node.w & ~GI_PACKED_LEAF];
			uint first = floatBitsToUint(q.a.w), last = floatBitsToUint(q.b.w);
			bool own = (skip_a >= first && skip_a < last) || (skip_b >= first && skip_b < last);
			if (!own && (hits_triangle(origin, direction, q.a.xyz, q.b.xyz, q.c.xyz, begin, end) ||
				     hits_triangle(origin, direction, q.a.xyz, q.c.xyz, q.d.xyz, begin, end)))
				return true;
		}
		n = hit || leaf ? n + 1u : node.w;
	}
	return false;
}

bool segment_hidden_by(uint object, segment_end a, segment_end b)
{
	vec3 origin = a.object == object ? a.rest : rest_from_world(object, a.world);
	uint skip_a = a.object == object ? a.leaf : GI_NONE;
	if (b.object == GI_NONE) {
		vec3 direction = rest_direction_from_world(object, b.world);
		float begin = SEGMENT_BEGIN * a.size;
		return object_hides(object, origin, direction, begin, 3e38, skip_a, GI_NONE);
	}
	vec3 target = b.object == object ? b.rest : rest_from_world(object, b.world);
	uint skip_b = b.object == object ? b.leaf : GI_NONE;
	return object_hides(object, origin, target - origin, SEGMENT_BEGIN, 1.0 - SEGMENT_BEGIN, skip_a, skip_b);
}

bool is_flat(uint object)
{
	return (objects[object].bvh.z & GI_OBJECT_FLAT) != 0u;
}

// The object that hides b from a, or GI_BLOCKER_NONE. The ends' own objects come first and without the test of world boxes, whose rounding
// depends on the pose: an object at rest relative to both ends must always answer the same.
uint segment_blocker(segment_end a, segment_end b)
{
	if (!is_flat(a.object) && segment_hidden_by(a.object, a, b))
		return a.object;
	if (b.object != GI_NONE && b.object != a.object && !is_flat(b.object) && segment_hidden_by(b.object, a, b))
		return b.object;
	vec3 direction = b.object == GI_NONE ? b.world : b.world - a.world;
	float end = b.object == GI_NONE ? 3e38 : 1.0;
	grid_ray r = ray_on_grid(a.world, direction, frame.grid.xyz, frame.cells.xyz);
	uint n = 0u;
	while (n < frame.misc.x) {
		uvec4 node = tlas[n];
		bool hit = hits_box(r, node, end);
		bool leaf = (node.w & GI_PACKED_LEAF) != 0u;
		uint object = node.w & ~GI_PACKED_LEAF;
		if (hit && leaf && object != a.object && object != b.object && segment_hidden_by(object, a, b))
			return object;
		n = hit || leaf ? n + 1u : node.w;
	}
	return GI_BLOCKER_NONE;
}
