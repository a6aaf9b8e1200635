// Does one flat static face hide all of a box from all of a leaf? It does where the segment from each corner of the
// leaf to each corner of the box crosses it: from a fixed point a convex surface is seen as convex, so that what holds
// for corners holds for all between them.
//
// Rays must say the same, so the face is taken for smaller by more than their rounding, and what would make rounding
// large is left out: segments along the face, slivers, and edges seen end-on.

// Shares of the largest coordinate: what the face is made smaller by, and how far off a plane its corners may be.
const float COVER_SLACK = 1e-4;
const float COVER_FLAT = 2e-6;

// Least sines of angles: between a segment and the face, between the face's sides, that an edge is seen at.
const float COVER_GRAZING = 0.02;
const float COVER_SLIVER = 0.05;
const float COVER_EDGE = 0.005;

struct cover_box {
	vec3 middle, half_size;
};

// The leaf's corners, c and d the same where it is a triangle, and likewise those of the face, all in the world.
bool covers(vec3 leaf[4], cover_box box, vec3 face[4])
{
	vec3 ab = face[1] - face[0], ac = face[2] - face[0], ad = face[3] - face[0];
	vec3 first = cross(ab, ac), second = cross(ac, ad), n = first + second;
	vec3 middle = 0.25 * (face[0] + face[1] + face[2] + face[3]);
	float area = length(n), scale = 0.0, most_off = 0.0, near = 3e38, reach = 0.0;
	bool triangle = face[2] == face[3];
	bool broad = length(first) > COVER_SLIVER * length(ab) * length(ac) &&
		     (triangle || length(second) > COVER_SLIVER * length(ac) * length(ad));
	if (!broad || area <= 0.0)
		return false;
	n /= area;
	vec3 far = abs(box.middle) + box.half_size;
	float beyond = dot(n, box.middle - face[0]), half_reach = dot(abs(n), box.half_size);
	n = beyond < 0.0 ? n : -n; // the box lies behind it
	scale = max(far.x, max(far.y, far.z));
	for (uint k = 0u; k < 4u; k++) {
		vec3 corner = max(abs(leaf[k]), abs(face[k]));
		scale = max(scale, max(corner.x, max(corner.y, corner.z)));
		most_off = max(most_off, abs(dot(n, face[k] - face[0])));
		near = min(near, dot(n, leaf[k] - face[0]));
		reach = max(reach, length(leaf[k] - box.middle));
	}
	float slack = COVER_SLACK * scale, box_near = abs(beyond) - half_reach, box_far = abs(beyond) + half_reach;
	if (most_off > COVER_FLAT * scale || near < slack || box_near < slack ||
	    near + box_near < COVER_GRAZING * (reach + length(box.half_size)))
		return false;
	float turn = beyond < 0.0 ? 1.0 : -1.0;
	bool inside = true;
	for (uint e = 0u; e < 4u && inside; e++) {
		vec3 from = face[e], to = face[(e + 1u) & 3u], next = face[(e + 2u) & 3u];
		if (from == to)
			continue;
		// Convex: every corner turns the way the face does.
		next = next == to ? face[0] : next;
		inside = turn * dot(n, cross(to - from, next - to)) > 0.0;
		for (uint k = 0u; k < 4u && inside; k++) {
			vec3 u = from - leaf[k], v = to - leaf[k], m = cross(u, v);
			m = dot(m, middle - leaf[k]) < 0.0 ? -m : m;
			float height = dot(n, leaf[k] - face[0]), size = length(m);
			float within = dot(m, box.middle - leaf[k]) - dot(abs(m), box.half_size);
			inside = size > COVER_EDGE * length(u) * length(v) &&
				 within * height > slack * size * (height + box_far);
		}
	}
	return inside;
}
