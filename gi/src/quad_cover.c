/* The corners of a convex quad among its points: the one farthest from any point, the one farthest from that, and the
 * farthest on either side of the line between the two. */
#include "quad_cover.h"

static gi_vec3d vertex_at(const gi_hierarchy *h, uint32_t vertex)
{
	return gi_vec3d_from(h->vertices[vertex]);
}

/* What a vertex is measured by: its distance from a point, or from a line on one side. */
typedef struct measure {
	gi_vec3d from, across; /* across: zero for distances from the point */
} measure;

static double measured(const gi_hierarchy *h, uint32_t vertex, const measure *m)
{
	const gi_vec3d to = gi_vec3d_sub(vertex_at(h, vertex), m->from);
	const bool point = gi_vec3d_dot(m->across, m->across) == 0;
	return point ? gi_vec3d_length(to) : gi_vec3d_dot(m->across, to);
}

/* Of vertices equally far but for rounding the first is taken, so that a symmetric mesh has the same corners at every
 * scale. */
static uint32_t farthest(const gi_hierarchy *h, uint32_t first, uint32_t count, const measure *m)
{
	uint32_t best = h->topology[h->leaf_node[first]].corners.x;
	double most = measured(h, best, m);
	for (uint32_t leaf = first; leaf < first + count; leaf++) {
		const gi_uvec4 c = h->topology[h->leaf_node[leaf]].corners;
		const uint32_t corners[4] = {c.x, c.y, c.z, c.w};
		for (int i = 0; i < 4; i++) {
			const double distance = measured(h, corners[i], m);
			if (distance > most + GI_TIE * fabs(most)) {
				most = distance;
				best = corners[i];
			}
		}
	}
	return best;
}

/* A line's left side, seen against the normal: unit vector. */
static gi_vec3d left_of(gi_vec3d a, gi_vec3d b, gi_vec3d normal)
{
	const gi_vec3d across = gi_vec3d_cross(normal, gi_vec3d_sub(b, a));
	const double length = gi_vec3d_length(across);
	return length > 0 ? gi_vec3d_scale(across, 1 / length) : across;
}

/* Is nothing right of a side, which goes round counter-clockwise? */
static bool holds_all(const gi_hierarchy *h, uint32_t first, uint32_t count, gi_vec3d normal, double tolerance,
		      const uint32_t corners[4])
{
	for (int i = 0; i < 4; i++) {
		const gi_vec3d a = vertex_at(h, corners[i]), b = vertex_at(h, corners[(i + 1) % 4]);
		const gi_vec3d right = gi_vec3d_scale(left_of(a, b, normal), -1);
		const measure m = {a, right};
		if (gi_vec3d_dot(right, right) == 0 || measured(h, farthest(h, first, count, &m), &m) > tolerance)
			return false;
	}
	return true;
}

bool gi_quad_cover(const gi_hierarchy *h, uint32_t first, uint32_t count, gi_vec3d normal, double tolerance,
		   uint32_t corners[4])
{
	measure m = {vertex_at(h, h->topology[h->leaf_node[first]].corners.x), {0, 0, 0}};
	corners[0] = farthest(h, first, count, &m);
	m.from = vertex_at(h, corners[0]);
	corners[2] = farthest(h, first, count, &m);
	m.across = left_of(m.from, vertex_at(h, corners[2]), normal);
	corners[3] = farthest(h, first, count, &m);
	const double left = measured(h, corners[3], &m);
	m.across = gi_vec3d_scale(m.across, -1);
	corners[1] = farthest(h, first, count, &m);
	const double right = measured(h, corners[1], &m);
	return left > tolerance && right > tolerance && holds_all(h, first, count, normal, tolerance, corners);
}
