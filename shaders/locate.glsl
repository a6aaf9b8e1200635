// The leaf that a point of a primitive lies on: rays meet flat faces whole.

// How far inside the quad, or the triangle, of a node the point lies: the least distance from its edges, below 0
// outside.
float inside_of(uint node, vec3 p)
{
	uvec4 v = topology_corners(node);
	vec3 q[4] = vec3[4](load_rest_vertex(v.x).xyz, load_rest_vertex(v.y).xyz, load_rest_vertex(v.z).xyz,
			    load_rest_vertex(v.w).xyz);
	vec3 n = cross(q[2] - q[0], q[3] - q[1]);
	float least = 3e38;
	for (uint k = 0u; k < 4u; k++) {
		vec3 edge = q[(k + 1u) & 3u] - q[k];
		vec3 inward = cross(n, edge);
		float size = length(inward); // 0 where a triangle repeats its corner
		least = size > 0.0 ? min(least, dot(inward, p - q[k]) / size) : least;
	}
	return least;
}

// `first` leaf of the primitive, of the whole scene as objects have them; p in the object's rest frame.
uint leaf_at(uint object, uint first, vec3 p)
{
	uint n = object_nodes(object).x;
	uvec4 range = topology_range(n);
	while ((range.w & (GI_NODE_FLAT | GI_NODE_LEAF)) == 0u) {
		n++;
		range = topology_range(n);
		while (range.y + range.z <= first) {
			n = range.x;
			range = topology_range(n);
		}
	}
	while ((range.w & GI_NODE_LEAF) == 0u) {
		uint best = n + 1u;
		float most = -3e38;
		for (uint child = n + 1u; child < range.x; child = topology_range(child).x) {
			float inside = inside_of(child, p);
			best = inside > most ? child : best;
			most = max(most, inside);
		}
		n = best;
		range = topology_range(n);
	}
	return range.y;
}
