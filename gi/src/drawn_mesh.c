/* The drawn surface of an object that is drawn as a mesh of its own, finer than its cage. */
#include "drawn_build.h"

#include "drawn_locator.h"
#include "host_memory.h"

#include <math.h>

/* A mesh as the caller gave it. */
typedef struct mesh {
	const float *positions;
	uint32_t vertex_count;
	const uint32_t *indices;
	uint32_t index_count;
} mesh;

static bool is_valid(const mesh *m)
{
	for (size_t i = 0; i < 3 * (size_t)m->vertex_count; i++)
		if (!isfinite(m->positions[i]))
			return false;
	for (uint32_t i = 0; i < m->index_count; i++)
		if (m->indices[i] >= m->vertex_count)
			return false;
	return m->index_count % 3 == 0;
}

static gi_vec3d mesh_position(const mesh *m, uint32_t vertex)
{
	return gi_vec3d_load(m->positions + 3 * (size_t)vertex);
}

static void sum_normals(const mesh *m, gi_vec3d *normals)
{
	for (uint32_t i = 0; i + 2 < m->index_count; i += 3) {
		const uint32_t *t = m->indices + i;
		const gi_vec3d moment =
		    gi_vec3d_triangle(mesh_position(m, t[0]), mesh_position(m, t[1]), mesh_position(m, t[2]));
		for (int k = 0; k < 3; k++)
			normals[t[k]] = gi_vec3d_add(normals[t[k]], moment);
	}
}

/* For each vertex one before it, a neighbour where there is one: its leaf is where the search for this one's begins. */
static void find_guides(const mesh *m, uint32_t *guide)
{
	for (uint32_t i = 0; i < m->vertex_count; i++)
		guide[i] = i > 0 ? i - 1 : 0;
	for (uint32_t i = 0; i < m->index_count; i++) {
		const uint32_t vertex = m->indices[i];
		const uint32_t next = m->indices[i % 3 == 2 ? i - 2 : i + 1];
		if (next < vertex)
			guide[vertex] = next;
		else if (vertex < next)
			guide[next] = vertex;
	}
}

static void draw_mesh(drawn_builder *s, const gi_drawn_locator *l, const mesh *m, const gi_vec3d *normals,
		      const uint32_t *guide)
{
	for (uint32_t i = 0; i < m->vertex_count; i++) {
		const gi_vec3d point = mesh_position(m, i), normal = unit_or(normals[i], (gi_vec3d){0.0, 0.0, 0.0});
		const uint32_t near = i > 0 ? s->out->vertices[guide[i]].leaf : 0;
		const gi_leaf_point found = gi_drawn_locate(l, point, normal, near);
		gi_draw_vertex v = {0};
		gi_vec3d_store(v.position, point);
		gi_vec3d_store(v.normal, unit_or(normal, leaf_normal(s->h, found.leaf)));
		gi_drawn_set_light(s, found.leaf, found.weight, &v);
		gi_drawn_add_vertex(s, &v);
	}
	for (uint32_t i = 0; i < m->index_count; i++)
		s->out->indices[s->out->index_count++] = m->indices[i];
}

static bool draw_from_mesh(drawn_builder *s, const mesh *m, double least_cosine)
{
	gi_drawn_locator l = {0};
	bool enough = gi_drawn_make_lights(s, least_cosine) && gi_drawn_locator_build(s->h, false, &l);
	gi_vec3d *normals = gi_drawn_allocate(m->vertex_count, sizeof *normals, &enough);
	uint32_t *guide = gi_drawn_allocate(m->vertex_count, sizeof *guide, &enough);
	s->out->vertices = gi_drawn_allocate(m->vertex_count, sizeof *s->out->vertices, &enough);
	s->out->indices = gi_drawn_allocate(m->index_count, sizeof *s->out->indices, &enough);
	if (enough) {
		sum_normals(m, normals);
		find_guides(m, guide);
		draw_mesh(s, &l, m, normals, guide);
	}
	gi_free(normals);
	gi_free(guide);
	gi_drawn_locator_free(&l);
	return enough;
}

/* False also for an index out of range or a coordinate that is not finite. */
bool gi_drawn_from_mesh(const gi_hierarchy *hierarchy, const float *positions, uint32_t vertex_count,
			const uint32_t *indices, uint32_t index_count, double least_cosine, gi_drawn_surface *out)
{
	*out = (gi_drawn_surface){0};
	const mesh m = {positions, vertex_count, indices, index_count};
	if (hierarchy->leaf_count == 0 || !is_valid(&m))
		return false;
	drawn_builder s = {.h = hierarchy, .out = out};
	const bool done = draw_from_mesh(&s, &m, least_cosine);
	gi_drawn_free_builder(&s);
	if (!done)
		gi_drawn_free(out);
	return done;
}
