// The nearest surface along a ray, by the same trees as rays.glsl: what path tracing asks for. Directions are unit
// vectors, distances metres.

struct nearest {
	float end;     // nothing farther counts; a back counts as `lift` deeper than it lies
	float distance;
	bool front;
	uint rank;
	uint object, primitive; // GI_NONE: nothing was met
	bool second;   // the triangle a c d, not a b c
	vec2 barycentric;
};

// Of leaves in one place either may be met first by a rounding: a front counts before a back (of a sheet), and of two
// fronts that of the higher rank.
void meet_triangle(inout nearest best, vec3 origin, vec3 direction, vec3 a, vec3 b, vec3 c, uint rank, uint object,
		   uint primitive, bool second, float lift)
{
	plane_meeting m = meet_plane(origin, direction, a, b, c);
	if (!inside_triangle(m.barycentric))
		return;
	float t = m.height / m.determinant;
	vec3 n = cross(b - a, c - a);
	float size = length(n), along = dot(n, direction), thick = lift * size / max(abs(along), 1e-3 * size);
	if (!(t > 0.0 && t < best.end + thick))
		return;
	bool front = along < 0.0, tie = front && best.front && abs(t - best.distance) < thick;
	float depth = front ? t : t + thick;
	if (tie ? rank > best.rank : depth < best.end)
		best = nearest(depth, t, front, rank, object, primitive, second, m.barycentric);
}

void meet_object(inout nearest best, uint object, vec3 world_origin, vec3 world_direction, float lift)
{
	vec3 origin = rest_from_world(object, world_origin),
	     direction = rest_direction_from_world(object, world_direction);
	tree_walk walk = walk_of_object(object, origin, direction);
	while (true) {
		uint primitive = next_primitive(walk, best.end + lift);
		if (primitive == GI_NONE)
			break;
		gi_primitive q = load_primitive(primitive);
		uint rank = floatBitsToUint(q.b.w);
		meet_triangle(best, origin, direction, q.a.xyz, q.b.xyz, q.c.xyz, rank, object, primitive, false, lift);
		meet_triangle(best, origin, direction, q.a.xyz, q.c.xyz, q.d.xyz, rank, object, primitive, true, lift);
	}
}

nearest find_nearest(vec3 origin, vec3 direction, float lift)
{
	nearest best = nearest(3e38, 3e38, false, 0u, GI_NONE, GI_NONE, false, vec2(0.0));
	tree_walk walk = walk_of_scene(origin, direction, uvec2(0u, frame.misc.x));
	while (true) {
		uint object = next_object(walk, best.end);
		if (object == GI_NONE)
			break;
		meet_object(best, object, origin, direction, lift);
	}
	return best;
}

// Does anything lie between the two points, or over the front of that rank that the second one lies on?
bool segment_is_free(vec3 from, vec3 to, uint rank, float lift)
{
	vec3 d = to - from;
	tree_walk walk = walk_of_scene(from, d, uvec2(0u, frame.misc.x));
	bool free = true;
	while (free) {
		uint object = next_object(walk, 1.0);
		if (object == GI_NONE)
			break;
		tree_ray ray = tree_ray(rest_from_world(object, from), rest_direction_from_world(object, d), 1.0,
					1.0 + lift, vec2(0.0, lift), uvec2(GI_NONE, rank), true);
		free = !object_hides(object, ray);
	}
	return free;
}
