// What a curved node shows to a direction (gi_node_spread).

// Normals within 8 degrees of their mean: as good as flat, and its contour tells the form factor.
const float FLAT_CONE = 0.99;

// Leaves whose halves' normals differ from the mean by more than this cosine (2.5 degrees) are folded.
const float FOLDED = 0.999;

// Area of front sides, and of back sides, projected along `view` (unit, from the node to its observer); view_rest is
// the same in the rest frame, moment and view share theirs.
vec2 shown_area(gi_node_spread s, vec4 moment, vec3 view, vec3 view_rest)
{
	vec3 v = view_rest;
	float t = dot(s.diagonal.xyz, v * v) + 2.0 * dot(s.mixed.xyz, v.xyz * v.yzx);
	// Not sqrt(area * t): the square of an area leaves the range of floats long before the area does.
	float both = s.mixed.w * moment.w * sqrt(max(0.0, t / moment.w));
	float net = dot(moment.xyz, view);
	return max(vec2(0.0), 0.5 * vec2(both + net, both - net));
}
