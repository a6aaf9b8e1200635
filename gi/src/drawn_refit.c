/* The drawn surface of a shape that changes: where its vertices are, and their normals. What light they have stays. */
#include "drawn_build.h"

/* Tangents this near to parallel, as the sine of their angle, span no plane (refine.cpp). */
#define PARALLEL 1e-6

static gi_vec3d evaluate(const gi_stencils *s, uint32_t point, const double (*cage)[3])
{
	double at[3];
	gi_stencils_evaluate(s, point, cage, at);
	return (gi_vec3d){at[0], at[1], at[2]};
}

/* What a refit reads. */
typedef struct refit {
	const gi_hierarchy *h;
	const gi_stencils *points, *tangents;
	const double (*cage)[3];
} refit;

static gi_vec3d place_of(const refit *r, uint32_t vertex)
{
	return r->points->count ? evaluate(r->points, vertex, r->cage) : vertex_position(r->h, vertex);
}

static gi_vec3d middle_of(const gi_hierarchy *h, uint32_t leaf)
{
	const quad q = leaf_quad(h, leaf);
	gi_vec3d centre = {0};
	for (uint32_t k = 0; k < 4; k++)
		centre = gi_vec3d_add(centre, gi_vec3d_scale(vertex_position(h, q.v[k]), 0.25));
	return centre;
}

/* 0 where there is none. */
static gi_vec3d limit_normal(const refit *r, uint32_t vertex)
{
	const gi_vec3d a = evaluate(&r->tangents[0], vertex, r->cage), b = evaluate(&r->tangents[1], vertex, r->cage);
	const gi_vec3d normal = gi_vec3d_cross(a, b);
	const bool plane = gi_vec3d_length(normal) > PARALLEL * gi_vec3d_length(a) * gi_vec3d_length(b);
	return plane ? gi_vec3d_unit(normal) : (gi_vec3d){0};
}

static gi_vec3d face_moment(const refit *r, const uint32_t corners[4])
{
	const gi_vec3d a = place_of(r, corners[0]), c = place_of(r, corners[2]);
	return gi_vec3d_add(gi_vec3d_triangle(a, place_of(r, corners[1]), c),
			    gi_vec3d_triangle(a, c, place_of(r, corners[3])));
}

void gi_drawn_refit(const gi_hierarchy *h, const gi_stencils *points, const gi_stencils tangents[2],
		    const double (*cage)[3], gi_drawn_surface *drawn)
{
	const refit r = {h, points, tangents, cage};
	for (uint32_t k = 0; k < drawn->vertex_count; k++) {
		const gi_draw_bond *bond = &drawn->bonds[k];
		gi_draw_vertex *v = &drawn->vertices[k];
		const gi_vec3d at = bond->place == GI_NONE ? middle_of(h, v->leaf) : place_of(&r, bond->place);
		gi_vec3d normal = {0};
		if (bond->facing != GI_NONE)
			normal = limit_normal(&r, bond->facing);
		else if (bond->face != GI_NONE)
			normal = face_moment(&r, drawn->faces[bond->face]);
		gi_vec3d_store(v->position, at);
		gi_vec3d_store(v->normal, unit_or(normal, leaf_normal(h, v->leaf)));
	}
}

static gi_vec3d load(const double v[3])
{
	return (gi_vec3d){v[0], v[1], v[2]};
}

void gi_drawn_refit_mesh(const gi_hierarchy *h, const double (*positions)[3], double (*normals)[3],
			 gi_drawn_surface *drawn)
{
	for (uint32_t k = 0; k < drawn->vertex_count; k++)
		normals[k][0] = normals[k][1] = normals[k][2] = 0;
	for (uint32_t i = 0; i + 2 < drawn->index_count; i += 3) {
		const uint32_t *t = drawn->indices + i;
		const gi_vec3d moment =
		    gi_vec3d_triangle(load(positions[t[0]]), load(positions[t[1]]), load(positions[t[2]]));
		for (int k = 0; k < 3; k++) {
			normals[t[k]][0] += moment.x;
			normals[t[k]][1] += moment.y;
			normals[t[k]][2] += moment.z;
		}
	}
	for (uint32_t k = 0; k < drawn->vertex_count; k++) {
		gi_draw_vertex *v = &drawn->vertices[k];
		gi_vec3d_store(v->position, load(positions[k]));
		gi_vec3d_store(v->normal, unit_or(load(normals[k]), leaf_normal(h, v->leaf)));
	}
}
