// Rays and the trees they walk: boxes of objects in the world, boxes and quads of an object in its rest frame.

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

// Rays that graze a shared edge must not slip between the triangles: barycentric coordinates may fall short by this.
const float EDGE_SLACK = 2e-6;

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

// What the next leaf at or after node n of a packed tree names, whose box the ray meets: a quad, or an object of the
// scene's tree; GI_NONE: no more before node `last`. n goes on behind it. First every ray of a vector goes on to a leaf,
// then all test theirs together (Aila and Laine, 2009).
uint next_leaf(usamplerBuffer tree, grid_ray r, float end, uint last, inout uint n)
{
	uint found = GI_NONE;
	while (n < last && found == GI_NONE) {
		uvec4 node = texel(tree, n);
		bool hit = hits_box(r, node, end);
		bool leaf = (node.w & GI_PACKED_LEAF) != 0u;
		found = hit && leaf ? node.w & ~GI_PACKED_LEAF : GI_NONE;
		n = hit || leaf ? n + 1u : node.w;
	}
	return found;
}

// skip_a and skip_b are leaves whose primitives do not count.
bool primitive_hides(uint primitive, vec3 origin, vec3 direction, float end, vec2 slack, uint skip_a, uint skip_b)
{
	gi_primitive q = load_primitive(primitive);
	uint first = floatBitsToUint(q.a.w), last = floatBitsToUint(q.b.w);
	bool own = (skip_a >= first && skip_a < last) || (skip_b >= first && skip_b < last);
	return !own && (hits_triangle(origin, direction, q.a.xyz, q.b.xyz, q.c.xyz, q.c.w, end, slack) ||
			hits_triangle(origin, direction, q.a.xyz, q.c.xyz, q.d.xyz, q.d.w, end, slack));
}

// Does one object cut the segment?
bool object_hides(uint object, vec3 origin, vec3 direction, float end, vec2 slack, uint skip_a, uint skip_b)
{
	uvec4 range = object_bvh(object);
	grid_ray r = ray_on_grid(origin, direction, object_grid(object).xyz, object_cells(object).xyz);
	uint n = range.x;
	bool hidden = false;
	while (n < range.y && !hidden) {
		uint primitive = next_leaf(bvh_texels, r, end, range.y, n);
		if (primitive == GI_NONE)
			break;
		hidden = primitive_hides(primitive, origin, direction, end, slack, skip_a, skip_b);
	}
	return hidden;
}
