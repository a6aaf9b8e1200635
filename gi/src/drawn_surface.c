/* Light vertices and drawn vertices of one object (drawn_surface.h says what they are).
 *
 *   leaves --join_corners--> groups of corners --store_lights--> light vertices      (drawn_surface.c)
 *   finer faces --refine_weights--> weights of the leaf's corners --draw_*--> drawn  (drawn_refined.c)
 *   mesh vertices --find_closest--> weights inside a leaf's triangle --> drawn       (drawn_mesh.c)
 *
 * A "corner" is leaf * 4 + k, k = 0..3; a triangle's fourth stands for its third and is in no group of its own.
 */
#include "drawn_build.h"

#include "host_memory.h"

#include <math.h>

/* Two drawn normals are one when no component differs by more: less than 8 bits could show, more than float rounds. */
#define SAME_NORMAL 1e-5f

void *gi_drawn_allocate(size_t count, size_t size, bool *enough)
{
	void *memory = gi_calloc(count + 1, size);
	*enough = *enough && memory;
	return memory;
}

/* ---- light vertices ---- */

static uint32_t group_of(uint32_t *group, uint32_t corner)
{
	while (group[corner] != corner) {
		group[corner] = group[group[corner]];
		corner = group[corner];
	}
	return corner;
}

/* The lowest corner names the group: numbers do not depend on the order of joining. */
static void join(uint32_t *group, uint32_t a, uint32_t b)
{
	a = group_of(group, a);
	b = group_of(group, b);
	group[a > b ? a : b] = a > b ? b : a;
}

static uint32_t list_edges(const gi_hierarchy *h, gi_leaf_edge *edges)
{
	uint32_t count = 0;
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++) {
		const quad q = leaf_quad(h, leaf);
		for (uint32_t k = 0; k < q.count; k++) {
			const uint32_t a = q.v[k], b = q.v[(k + 1) % q.count];
			edges[count++] = (gi_leaf_edge){a < b ? a : b, a < b ? b : a, 4 * leaf + k};
		}
	}
	return count;
}

/* One pass of a stable counting sort; first by `high`, then by `low`. `offsets` holds vertex_count + 1. */
static void sort_edges(const gi_leaf_edge *from, gi_leaf_edge *to, uint32_t count, bool by_low, uint32_t *offsets,
		       uint32_t vertex_count)
{
	for (uint32_t i = 0; i <= vertex_count; i++)
		offsets[i] = 0;
	for (uint32_t i = 0; i < count; i++)
		offsets[(by_low ? from[i].low : from[i].high) + 1]++;
	for (uint32_t i = 0; i < vertex_count; i++)
		offsets[i + 1] += offsets[i];
	for (uint32_t i = 0; i < count; i++)
		to[offsets[by_low ? from[i].low : from[i].high]++] = from[i];
}

/* The corner of an edge's leaf at the edge's lower or higher vertex. */
static uint32_t end_corner(const gi_hierarchy *h, const gi_leaf_edge *e, bool low)
{
	const quad q = leaf_quad(h, e->corner / 4);
	const uint32_t k = e->corner % 4;
	const bool here = q.v[k] == (low ? e->low : e->high);
	return here ? e->corner : e->corner - k + (k + 1) % q.count;
}

static bool is_parted(const drawn_builder *s, const gi_leaf_edge *e)
{
	return s->parted && s->parted[s->h->leaf_face[e->corner / 4]] >> (e->corner % 4) & 1;
}

static void join_across(drawn_builder *s, const gi_leaf_edge *a, const gi_leaf_edge *b, double least_cosine)
{
	const gi_hierarchy *h = s->h;
	uint32_t *group = s->group;
	if (is_parted(s, a) || is_parted(s, b))
		return;
	if (gi_vec3d_dot(leaf_normal(h, a->corner / 4), leaf_normal(h, b->corner / 4)) < least_cosine)
		return;
	join(group, end_corner(h, a, true), end_corner(h, b, true));
	join(group, end_corner(h, a, false), end_corner(h, b, false));
}

/* Joins the corners on both sides of every edge that is not sharp and does not part light. */
static bool join_corners(drawn_builder *s, double least_cosine)
{
	const gi_hierarchy *h = s->h;
	bool enough = true;
	gi_leaf_edge *edges = gi_drawn_allocate(4 * (size_t)h->leaf_count, sizeof *edges, &enough);
	gi_leaf_edge *sorted = gi_drawn_allocate(4 * (size_t)h->leaf_count, sizeof *sorted, &enough);
	uint32_t *offsets = gi_drawn_allocate(h->vertex_count, sizeof *offsets, &enough);
	if (enough) {
		const uint32_t count = list_edges(h, edges);
		sort_edges(edges, sorted, count, false, offsets, h->vertex_count);
		sort_edges(sorted, edges, count, true, offsets, h->vertex_count);
		for (uint32_t i = 0; i < 4 * h->leaf_count; i++)
			s->group[i] = i;
		for (uint32_t i = 0; i < count; i++)
			for (uint32_t j = i + 1;
			     j < count && edges[j].low == edges[i].low && edges[j].high == edges[i].high; j++)
				join_across(s, &edges[i], &edges[j], least_cosine);
		enough = gi_drawn_find_hanging(h, s->parted, edges, count, least_cosine, join, s->group, &s->hanging) &&
			 (!s->has_seams || gi_drawn_find_seams(h, edges, count, &s->seams));
	}
	gi_free(edges);
	gi_free(sorted);
	gi_free(offsets);
	return enough;
}

/* A leaf counts at its corner by its angle there: how the surface is cut into leaves round the vertex makes no
 * difference. 1e-6 keeps a vertex among slivers from dividing by zero. */
static float corner_angle(const gi_hierarchy *h, const quad *q, uint32_t k)
{
	const gi_vec3d at = vertex_position(h, q->v[k]);
	const gi_vec3d a = gi_vec3d_sub(vertex_position(h, q->v[(k + 1) % q->count]), at);
	const gi_vec3d b = gi_vec3d_sub(vertex_position(h, q->v[(k + q->count - 1) % q->count]), at);
	return (float)(atan2(gi_vec3d_length(gi_vec3d_cross(a, b)), gi_vec3d_dot(a, b)) + 1e-6);
}

/* Numbers the groups in the order of their first corners, and counts the leaves of each. */
static void number_lights(drawn_builder *s)
{
	gi_drawn_surface *out = s->out;
	for (uint32_t leaf = 0; leaf < s->h->leaf_count; leaf++) {
		const quad q = leaf_quad(s->h, leaf);
		for (uint32_t k = 0; k < q.count; k++) {
			/* A group's name is its lowest corner, which is met first. */
			const uint32_t corner = 4 * leaf + k, name = group_of(s->group, corner);
			s->out->corner_light[corner] = name == corner ? out->light_count++ : s->out->corner_light[name];
			out->light_first[s->out->corner_light[corner] + 1]++;
		}
		if (q.count == 3)
			s->out->corner_light[4 * leaf + 3] = s->out->corner_light[4 * leaf + 2];
	}
	for (uint32_t light = 0; light < out->light_count; light++)
		out->light_first[light + 1] += out->light_first[light];
}

static void fill_lights(const drawn_builder *s, uint32_t *filled)
{
	gi_drawn_surface *out = s->out;
	for (uint32_t leaf = 0; leaf < s->h->leaf_count; leaf++) {
		const quad q = leaf_quad(s->h, leaf);
		for (uint32_t k = 0; k < q.count; k++) {
			const uint32_t light = s->out->corner_light[4 * leaf + k];
			const uint32_t at = out->light_first[light] + filled[light]++;
			out->light_leaf[at] = leaf;
			out->light_weight[at] = corner_angle(s->h, &q, k);
		}
	}
	for (uint32_t light = 0; light < out->light_count; light++) {
		double sum = 0.0;
		for (uint32_t i = out->light_first[light]; i < out->light_first[light + 1]; i++)
			sum += out->light_weight[i];
		for (uint32_t i = out->light_first[light]; i < out->light_first[light + 1]; i++)
			out->light_weight[i] = (float)(out->light_weight[i] / sum);
	}
}

bool gi_drawn_make_lights(drawn_builder *s, double least_cosine)
{
	const size_t corners = 4 * (size_t)s->h->leaf_count;
	bool enough = true;
	s->group = gi_drawn_allocate(corners, sizeof *s->group, &enough);
	s->out->corner_light = gi_drawn_allocate(corners, sizeof *s->out->corner_light, &enough);
	s->out->light_first = gi_drawn_allocate(corners, sizeof *s->out->light_first, &enough);
	s->out->light_leaf = gi_drawn_allocate(corners, sizeof *s->out->light_leaf, &enough);
	s->out->light_weight = gi_drawn_allocate(corners, sizeof *s->out->light_weight, &enough);
	if (!enough || !join_corners(s, least_cosine))
		return false;
	number_lights(s);
	uint32_t *filled = gi_drawn_allocate(s->out->light_count, sizeof *filled, &enough);
	if (enough)
		fill_lights(s, filled);
	gi_free(filled);
	return enough && gi_drawn_hang_lights(&s->hanging, s->out->corner_light, s->h->leaf_count, s->out);
}

void gi_drawn_free_builder(drawn_builder *s)
{
	gi_free(s->group);
	gi_free(s->hanging.items);
	gi_free(s->seams.points);
	gi_free(s->first_drawn);
	gi_free(s->next_drawn);
}

/* ---- drawn vertices ---- */

static void add_light(uint32_t light[4], float weight[4], uint32_t *count, uint32_t added, float by)
{
	uint32_t at = 0;
	while (at < *count && light[at] < added)
		at++;
	if (at == *count || light[at] != added) {
		for (uint32_t i = (*count)++; i > at; i--) {
			light[i] = light[i - 1];
			weight[i] = weight[i - 1];
		}
		light[at] = added;
		weight[at] = 0.0f;
	}
	weight[at] += by;
}

void gi_drawn_light_at(const gi_drawn_surface *drawn, uint32_t leaf, const float weight[4], uint32_t light[4],
		       float light_weight[4])
{
	uint32_t count = 0;
	for (uint32_t k = 0; k < 4; k++)
		if (weight[k] > 0.0f)
			add_light(light, light_weight, &count, drawn->corner_light[4 * leaf + k], weight[k]);
	for (; count > 0 && count < 4; count++) {
		light[count] = light[0];
		light_weight[count] = 0.0f;
	}
}

void gi_drawn_set_light(const drawn_builder *s, uint32_t leaf, const float weight[4], gi_draw_vertex *v)
{
	gi_drawn_light_at(s->out, leaf, weight, v->light, v->weight);
	v->leaf = leaf;
}

static bool is_same(const drawn_builder *s, const gi_draw_vertex *a, const gi_draw_vertex *b)
{
	if (s->h->leaf_material[a->leaf] != s->h->leaf_material[b->leaf])
		return false;
	for (int axis = 0; axis < 3; axis++)
		if (a->position[axis] != b->position[axis] || fabsf(a->normal[axis] - b->normal[axis]) > SAME_NORMAL)
			return false;
	for (int i = 0; i < 4; i++)
		if (a->light[i] != b->light[i] || a->weight[i] != b->weight[i])
			return false;
	return true;
}

static bool hangs_alike(const drawn_builder *s, uint32_t vertex)
{
	const gi_draw_bond *bonds = s->out->bonds;
	return !bonds || (bonds[vertex].place == s->bond.place && bonds[vertex].facing == s->bond.facing &&
			  bonds[vertex].face == s->bond.face && (s->bond.facing != GI_NONE || s->bond.face != GI_NONE));
}

uint32_t gi_drawn_add_vertex(drawn_builder *s, const gi_draw_vertex *v)
{
	if (s->out->bonds)
		s->out->bonds[s->out->vertex_count] = s->bond;
	s->out->vertices[s->out->vertex_count] = *v;
	return s->out->vertex_count++;
}

uint32_t gi_drawn_share_vertex(drawn_builder *s, uint32_t place, const gi_draw_vertex *v)
{
	for (uint32_t i = s->first_drawn[place]; i != GI_NONE; i = s->next_drawn[i])
		if (is_same(s, &s->out->vertices[i], v) && hangs_alike(s, i))
			return i;
	const uint32_t added = gi_drawn_add_vertex(s, v);
	s->next_drawn[added] = s->first_drawn[place];
	return s->first_drawn[place] = added;
}

void gi_drawn_add_triangle(gi_drawn_surface *out, uint32_t a, uint32_t b, uint32_t c)
{
	out->indices[out->index_count++] = a;
	out->indices[out->index_count++] = b;
	out->indices[out->index_count++] = c;
}

void gi_drawn_free(gi_drawn_surface *drawn)
{
	if (!drawn)
		return;
	gi_free(drawn->light_first);
	gi_free(drawn->light_leaf);
	gi_free(drawn->light_weight);
	gi_free(drawn->corner_light);
	gi_free(drawn->vertices);
	gi_free(drawn->indices);
	gi_free(drawn->uvs);
	gi_free(drawn->bonds);
	gi_free(drawn->faces);
	*drawn = (gi_drawn_surface){0};
}
