// What of the picture a leaf fills, for the camera that an update was given (gi_budget.view).

// Leaves that are not seen light those that are: they count as this share of their size. Less gains little more, and
// loses where they are near (docs/accuracy.md).
const float UNSEEN = 1.0 / 16.0;

bool is_outside(vec4 plane, gi_node_geometry p)
{
	return dot(plane.xyz, p.sphere.xyz) + plane.w < -p.sphere.w * length(plane.xyz);
}

// Whether any of it may be seen, as far as the edges of the picture and its own direction say.
bool may_be_seen(gi_node_geometry p)
{
	vec4 w = frame.view_w;
	if (is_outside(w + frame.view_x, p) || is_outside(w - frame.view_x, p) || is_outside(w + frame.view_y, p) ||
	    is_outside(w - frame.view_y, p) || is_outside(w, p))
		return false;
	vec3 to = frame.view_eye.xyz - frame.view_eye.w * p.sphere.xyz;
	if (p.axis.w < 0.0)
		return true; // it faces every way
	float turn = p.axis.w >= 1.0 ? 0.0 : sqrt(max(0.0, 1.0 - p.axis.w * p.axis.w));
	return dot(p.axis.xyz, to) > -(frame.view_eye.w * p.sphere.w + turn * length(to));
}

// Share of the picture that a leaf in sight fills: a projection to x / w, y / w makes of a small area A with normal n
//
//     A dot(n, x (grad y cross grad w) + y (grad w cross grad x) + w (grad x cross grad y)) / w^3.
float share_of_picture(gi_node_geometry p)
{
	vec4 at = vec4(p.sphere.xyz, 1.0);
	vec3 dx = frame.view_x.xyz, dy = frame.view_y.xyz, dw = frame.view_w.xyz;
	float w = max(dot(frame.view_w, at), max(p.sphere.w * length(dw), 1e-30));
	vec3 swept = dot(frame.view_x, at) * cross(dy, dw) + dot(frame.view_y, at) * cross(dw, dx) + w * cross(dx, dy);
	return min(1.0, 0.25 * p.moment.w * abs(dot(p.axis.xyz, swept)) / (w * w * w)); // the picture is 2 x 2
}
