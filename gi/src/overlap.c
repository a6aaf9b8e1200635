#include "overlap.h"

#include "bits.h"
#include "vec3d.h"

/* What two triangles share along an edge is narrower than this share of it, by rounding of their corners. */
#define EDGE_TOLERANCE 1e-6

typedef struct triangle {
	gi_vec3d corners[3];
} triangle;

/* The two of a primitive; returns how many have an area. */
static int triangles_of(const gi_primitive *p, triangle out[2])
{
	const gi_vec3d a = gi_vec3d_from(p->a), b = gi_vec3d_from(p->b), c = gi_vec3d_from(p->c),
		       d = gi_vec3d_from(p->d);
	int count = 0;
	if (p->c.w > 0)
		out[count++] = (triangle){{a, b, c}};
	if (p->d.w > 0)
		out[count++] = (triangle){{a, c, d}};
	return count;
}

/* Does an edge of t part it from the other, all in one plane? */
static bool edge_parts(const triangle *t, const triangle *other)
{
	const gi_vec3d normal = gi_vec3d_triangle(t->corners[0], t->corners[1], t->corners[2]);
	for (int i = 0; i < 3; i++) {
		const gi_vec3d from = t->corners[i], edge = gi_vec3d_sub(t->corners[(i + 1) % 3], from);
		const gi_vec3d inward = gi_vec3d_cross(normal, edge);
		const double least = EDGE_TOLERANCE * gi_vec3d_length(inward) * gi_vec3d_length(edge);
		bool beyond = true;
		for (int k = 0; k < 3; k++)
			beyond = beyond && gi_vec3d_dot(inward, gi_vec3d_sub(other->corners[k], from)) <= least;
		if (beyond)
			return true;
	}
	return false;
}

static bool primitives_overlap(const gi_primitive *p, const gi_primitive *q)
{
	triangle mine[2], theirs[2];
	const int m = triangles_of(p, mine), n = triangles_of(q, theirs);
	for (int i = 0; i < m; i++)
		for (int k = 0; k < n; k++)
			if (!edge_parts(&mine[i], &theirs[k]) && !edge_parts(&theirs[k], &mine[i]))
				return true;
	return false;
}

static bool boxes_meet(const gi_bvh_node *n, const gi_primitive *p)
{
	const gi_vec4 *corners[4] = {&p->a, &p->b, &p->c, &p->d};
	const float *lower = &n->lower.x, *upper = &n->upper.x;
	for (int axis = 0; axis < 3; axis++) {
		bool below = true, above = true;
		for (int i = 0; i < 4; i++) {
			below = below && (&corners[i]->x)[axis] < lower[axis];
			above = above && (&corners[i]->x)[axis] > upper[axis];
		}
		if (below || above)
			return false;
	}
	return true;
}

bool gi_plane_overlaps(const gi_bvh *bvh)
{
	for (uint32_t k = 0; k < bvh->primitive_count; k++) {
		const gi_primitive *p = &bvh->primitives[k];
		for (uint32_t n = 0; n < bvh->node_count;) {
			const uint32_t other = gi_bits_from_float(bvh->nodes[n].upper.w);
			const bool meets = boxes_meet(&bvh->nodes[n], p);
			if (meets && other != GI_NONE && other > k && primitives_overlap(p, &bvh->primitives[other]))
				return true;
			n = meets ? n + 1 : gi_bits_from_float(bvh->nodes[n].lower.w);
		}
	}
	return false;
}
