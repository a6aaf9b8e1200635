// Leaves as quads, and points on them.

// A quad in its object's rest frame, loaded once for all samples of an entry.
struct quad {
	vec3 a, b, c, d;
};

quad load_leaf_quad(uint leaf)
{
	return quad(load_leaf_corner(leaf, 0u).xyz, load_leaf_corner(leaf, 1u).xyz, load_leaf_corner(leaf, 2u).xyz,
		    load_leaf_corner(leaf, 3u).xyz);
}

// Points keep this share of a leaf's width off its edges: on the edge itself they would lie in the wall that rises
// there, which then could not hide anything from them.
const float INSET = 1e-3;

vec3 point_on(quad q, vec2 u)
{
	u = q.c == q.d ? mix(vec2(max(u.x, u.y), min(u.x, u.y)), vec2(2.0, 1.0) / 3.0, 3.0 * INSET)
		       : mix(u, vec2(0.5), 2.0 * INSET);
	return point_on_quad(q.a, q.b, q.c, q.d, u);
}
