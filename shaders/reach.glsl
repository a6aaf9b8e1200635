// An upper bound on the sum of the form factors that a row's entries of one object can have, however it is cut.
#include "numbers.glsl"

// A walk that visits more nodes is near enough for anything.
const uint REACH_VISITS = 24u;

// Of a node all of which is at least `near` away, whichever of its descendants stand for it: F <= A cos / (pi r^2) with
// the area A that it shows, sum of a max(0, n.d) = sum of a (|n.d| + n.d) / 2 <= (area + moment.d) / 2 for one
// direction d to the receiver, and no more than area radius / (2 near) more for directions that differ.
float reach_of_node(shape p, gi_node_geometry g, facing f, float near, bool back)
{
	float height = f.height + g.sphere.w + (g.sphere.w + p.radius) * sine_of(p.cone) + p.radius;
	float net = back ? abs(dot(g.moment.xyz, f.to)) : -dot(g.moment.xyz, f.to);
	float shown = min(g.moment.w, 0.5 * (g.moment.w * (1.0 + (g.sphere.w + p.radius) / near) + net / f.d));
	return min(1.0, shown * min(1.0, height / near) / (PI * near * near));
}

float reach(shape p, uint object)
{
	uvec4 nodes = object_nodes(object);
	float sum = 0.0;
	uint visits = 0u;
	for (uint n = nodes.x; n < nodes.y; visits++) {
		uvec4 range = topology_range(n);
		gi_node_geometry g = load_world(n);
		facing f = facing_of(p, g, range.w);
		float near = f.d - g.sphere.w - p.radius;
		if (f.unseen) {
			n = range.x;
		} else if (near > 0.0 && (near >= g.sphere.w || range.z == 1u)) {
			sum += reach_of_node(p, g, f, near, (range.w & GI_NODE_BACK) != 0u);
			n = range.x;
		} else if ((range.w & GI_NODE_LEAF) != 0u || visits > REACH_VISITS) {
			return 1.0;
		} else {
			// A cut may take the node whole all the same, when it is below the tolerance.
			sum += frame.tolerance.x;
			n++;
		}
	}
	return min(1.0, sum);
}
