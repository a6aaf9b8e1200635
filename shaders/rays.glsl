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

// Where a ray meets a triangle's plane (Moller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997;
// both sides).
struct plane_meeting {
	vec2 barycentric;  // of b and c
	float height;      // the origin's distance from the plane times |ab x ac|
	float determinant; // the same of the direction's length along the plane's normal; 0: parallel
	bool front;        // the ray comes from where the normal points to
};

plane_meeting meet_plane(vec3 origin, vec3 direction, vec3 a, vec3 b, vec3 c)
{
	vec3 ab = b - a, ac = c - a;
	vec3 p = cross(direction, ac);
	float determinant = dot(ab, p);
	if (determinant == 0.0)
		return plane_meeting(vec2(-1.0), 0.0, 0.0, false);
	float inverse = 1.0 / determinant;
	vec3 s = origin - a;
	vec3 q = cross(s, ab);
	float height = dot(ac, q);
	return plane_meeting(vec2(dot(s, p), dot(direction, q)) * inverse, determinant < 0.0 ? -height : height,
			     abs(determinant), determinant > 0.0);
}

bool inside_triangle(vec2 barycentric)
{
	return barycentric.x >= -EDGE_SLACK && barycentric.y >= -EDGE_SLACK &&
	       barycentric.x + barycentric.y <= 1.0 + EDGE_SLACK;
}

// A segment as an object's tree is asked for it, in the object's rest frame. It goes from `origin` to `origin + end *
// direction`.
struct tree_ray {
	vec3 origin, direction;
	float end;
	float reach;        // boxes that begin behind it, as a share of the direction, are not met: just above `end`
	vec2 slack;         // how far an end may be off the plane that it lies in, metres
	uvec2 ranks;        // of the primitives that it begins and ends on, which cannot hide it; GI_NONE
	bool arrives_front; // at the front of the surface it ends on
};

// The origin must lie off the triangle's plane by its slack: a distance times `area2` (|ab x ac|); and so must the end,
// unless the triangle covers what lies in its plane there: as a front does a back, and the higher rank the lower.
bool hits_triangle(tree_ray r, vec3 a, vec3 b, vec3 c, float area2, bool outranks)
{
	plane_meeting m = meet_plane(r.origin, r.direction, a, b, c);
	bool covers = m.front == r.arrives_front ? outranks : m.front;
	return inside_triangle(m.barycentric) && m.height > r.slack.x * area2 &&
	       m.determinant * r.end - m.height > (covers ? -r.slack.y : r.slack.y) * area2;
}

// What the next leaf at or after node n of a packed tree names, whose box the ray meets: a quad, or an object of the
// scene's tree; GI_NONE: no more before node `last`. n goes on behind it. First every ray of a vector goes on to a
// leaf, then all test theirs together (Aila and Laine, 2009).
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

// A walk over a packed tree, from the first node to the last; what is left of it.
struct tree_walk {
	grid_ray ray;
	uint next, end; // nodes
};

tree_walk walk_of_object(uint object, vec3 origin, vec3 direction)
{
	uvec4 range = object_bvh(object);
	return tree_walk(ray_on_grid(origin, direction, object_grid(object).xyz, object_cells(object).xyz), range.x,
			 range.y);
}

// Of the scene's tree, nodes from x up to y.
tree_walk walk_of_scene(vec3 origin, vec3 direction, uvec2 nodes)
{
	return tree_walk(ray_on_grid(origin, direction, frame.grid.xyz, frame.cells.xyz), nodes.x, nodes.y);
}

// What the walk meets next that begins before `end`, a share of the direction; GI_NONE: nothing more. To be called in
// the body of a plain loop: in the head of a for, Mesa 22.3 left after the first object.
uint next_primitive(inout tree_walk walk, float end)
{
	return next_leaf(bvh_texels, walk.ray, end, walk.end, walk.next);
}

uint next_object(inout tree_walk walk, float end)
{
	return next_leaf(tlas_texels, walk.ray, end, walk.end, walk.next);
}

bool primitive_hides(uint primitive, tree_ray r)
{
	gi_primitive q = load_primitive(primitive);
	uint rank = floatBitsToUint(q.b.w);
	bool own = rank == r.ranks.x || rank == r.ranks.y, outranks = rank > r.ranks.y;
	return !own && (hits_triangle(r, q.a.xyz, q.b.xyz, q.c.xyz, q.c.w, outranks) ||
			hits_triangle(r, q.a.xyz, q.c.xyz, q.d.xyz, q.d.w, outranks));
}

// Does one object cut the segment?
bool object_hides(uint object, tree_ray ray)
{
	tree_walk walk = walk_of_object(object, ray.origin, ray.direction);
	bool hidden = false;
	while (!hidden) {
		uint primitive = next_primitive(walk, ray.reach);
		if (primitive == GI_NONE)
			break;
		hidden = primitive_hides(primitive, ray);
	}
	return hidden;
}
