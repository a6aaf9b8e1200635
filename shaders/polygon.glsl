// Form factors from a point to polygons and discs. Positive when the front of the source is seen, negative for its
// back.
#include "numbers.glsl"

// One edge of Lambert's contour sum: angle between u and v times the cosine between the receiver's normal and u x v.
float contour_edge(vec3 u, vec3 v, vec3 n)
{
	vec3 w = cross(u, v);
	float s = length(w);
	// An edge through the point or seen end-on spans no area.
	if (s <= 1e-12 * (dot(u, u) + dot(v, v)))
		return 0.0;
	return atan(s, dot(u, v)) * dot(w, n) / s;
}

// Point of the edge u v on the receiver's plane, heights hu and hv of opposite sign.
vec3 edge_crossing(vec3 u, vec3 v, float hu, float hv)
{
	return u + (v - u) * (hu / (hu - hv));
}

// The angle of the complex number z plus the one from u to v about n, both in the plane with that normal.
vec2 turned(vec2 z, vec3 u, vec3 v, vec3 n)
{
	vec2 by = vec2(dot(u, v), dot(n, cross(u, v)));
	return vec2(z.x * by.x - z.y * by.y, z.x * by.y + z.y * by.x);
}

// Lambert's formula for the quad or triangle v (corners relative to the point, counter-clockwise from its front),
// clipped to the half space above the plane with normal n: F = 1/(2 pi) sum over edges. The contour is that of any
// surface it bounds.
float polygon_factor(vec3 v[4], vec3 n)
{
	float sum = 0.0;
	vec3 entry = vec3(0.0), leave = vec3(0.0);
	bool left = false;
	vec2 closing = vec2(1.0, 0.0);
	for (int k = 0; k < 4; k++) {
		vec3 a = v[k], b = v[(k + 1) & 3];
		float ha = dot(n, a), hb = dot(n, b);
		bool above_a = ha > 0.0, above_b = hb > 0.0;
		if (above_a != above_b) {
			vec3 c = edge_crossing(a, b, ha, hb);
			if (above_a) {
				leave = c;
				b = c;
				left = true;
			} else {
				if (left)
					closing = turned(closing, leave, c, n);
				else
					entry = c;
				a = c;
				left = false;
			}
		}
		if (above_a || above_b)
			sum += contour_edge(a, b, n);
	}
	// New edges along the horizon close the contour: one, or two where a warped quad crosses the plane four times.
	if (left)
		closing = turned(closing, leave, entry, n);
	if (closing.y != 0.0)
		sum += atan(closing.y, closing.x);
	return sum * (-0.5 / PI);
}

// A small source that shows an area (negative: of its back) along `to`, the vector from the point to its centre.
// Bounded near the point as a disc's.
float disc_factor(vec3 to, vec3 n, float shown)
{
	float d2 = max(dot(to, to), 1e-30);
	return max(dot(n, to), 0.0) * inversesqrt(d2) * shown / (PI * d2 + abs(shown));
}

#ifdef ROUND
// Of the sphere about a point: by the triangle with corners a b c relative to it (van Oosterom and Strackee, 1983).
float share_of_sphere(vec3 a, vec3 b, vec3 c)
{
	float la = length(a), lb = length(b), lc = length(c);
	float triple = dot(a, cross(b, c)), apart = la * lb * lc + dot(a, b) * lc + dot(a, c) * lb + dot(b, c) * la;
	return triple == 0.0 ? 0.0 : atan(triple, apart) * (-0.5 / PI);
}

// The same by a small source that shows an area, bounded near the point.
float round_disc_factor(vec3 to, float shown)
{
	return shown / (4.0 * PI * max(dot(to, to), 1e-30) + 2.0 * abs(shown));
}
#endif
