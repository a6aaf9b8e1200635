/* A face, or a node that is a polygon, as four points: a triangle repeats its third. */
#ifndef GI_HIERARCHY_QUAD_H
#define GI_HIERARCHY_QUAD_H

#include "hierarchy.h"
#include "vec3d.h"

typedef struct quad {
	gi_vec3d a, b, c, d;
} quad;

static inline quad load_quad(const float (*positions)[3], const uint32_t corners[4])
{
	return (quad){gi_vec3d_load(positions[corners[0]]), gi_vec3d_load(positions[corners[1]]),
		      gi_vec3d_load(positions[corners[2]]), gi_vec3d_load(positions[corners[3]])};
}

static inline quad node_quad(const gi_hierarchy *h, uint32_t node)
{
	const gi_uvec4 c = h->topology[node].corners;
	return (quad){gi_vec3d_from(h->vertices[c.x]), gi_vec3d_from(h->vertices[c.y]), gi_vec3d_from(h->vertices[c.z]),
		      gi_vec3d_from(h->vertices[c.w])};
}

static inline gi_vec3d quad_moment(const quad *q)
{
	return gi_vec3d_add(gi_vec3d_triangle(q->a, q->b, q->c), gi_vec3d_triangle(q->a, q->c, q->d));
}

/* The longer diagonal, squared; of a triangle, whose d is c, the longest edge. */
static inline double quad_diagonal2(const quad *q)
{
	const gi_vec3d ac = gi_vec3d_sub(q->c, q->a), bd = gi_vec3d_sub(q->d, q->b), ab = gi_vec3d_sub(q->b, q->a);
	return fmax(fmax(gi_vec3d_dot(ac, ac), gi_vec3d_dot(bd, bd)), gi_vec3d_dot(ab, ab));
}

static inline double quad_area(const quad *q)
{
	return gi_vec3d_length(gi_vec3d_triangle(q->a, q->b, q->c)) +
	       gi_vec3d_length(gi_vec3d_triangle(q->a, q->c, q->d));
}

#endif
