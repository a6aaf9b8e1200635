#include "deform.h"

#include "host_memory.h"

#include <string.h>

static const float IDENTITY[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/* ---- evaluation ---- */

/* The mean of the joints' matrices by weight; false where no joint has any. */
static bool blend(const uint32_t joints[4], const float weights[4], const float *matrices, double m[16])
{
	double sum = 0;
	memset(m, 0, 16 * sizeof *m);
	for (int k = 0; k < 4; k++) {
		const float *joint = matrices + 16 * (size_t)joints[k];
		if (!(weights[k] > 0))
			continue;
		for (int i = 0; i < 16; i++)
			m[i] += (double)weights[k] * joint[i];
		sum += weights[k];
	}
	for (int i = 0; sum > 0 && i < 16; i++)
		m[i] /= sum;
	return sum > 0;
}

static void evaluate(const float *positions, uint32_t count, const gi_skin *skin, const float *matrices,
		     const float scale[3], double (*out)[3])
{
	for (size_t v = 0; v < count; v++) {
		const float *p = positions + 3 * v;
		double m[16];
		const bool follows = skin->joints && blend(skin->joints + 4 * v, skin->weights + 4 * v, matrices, m);
		for (int r = 0; r < 3; r++) {
			const double at = follows ? m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r] : p[r];
			out[v][r] = at * scale[r];
		}
	}
}

void gi_deform_try(gi_deform *d, const gi_shape *shape)
{
	evaluate(shape->positions, d->vertex_count, &d->skin, shape->joints, shape->scale, d->cage);
	for (uint32_t k = 0; k < d->points.count; k++) {
		double at[3];
		gi_stencils_evaluate(&d->points, k, (const double(*)[3])d->cage, at);
		d->trial[k] = (gi_vec4){(float)at[0], (float)at[1], (float)at[2], 0};
	}
}

/* ---- which shape ---- */

/* Copies into arrays that are there; the same array stays. */
static void copy_shape(const gi_deform *d, const gi_shape *from, gi_shape *to)
{
	if (to->positions != from->positions)
		memcpy(to->positions, from->positions, sizeof(float) * 3 * d->vertex_count);
	if (to->joints != from->joints && d->joint_count)
		memcpy(to->joints, from->joints, sizeof(float) * 16 * d->joint_count);
	if (to->draw_positions != from->draw_positions && d->draw_count)
		memcpy(to->draw_positions, from->draw_positions, sizeof(float) * 3 * d->draw_count);
	memcpy(to->scale, from->scale, sizeof to->scale);
}

void gi_deform_take(gi_deform *d, const gi_shape *shape)
{
	gi_vec4 *before = d->vertices;
	copy_shape(d, shape, &d->next);
	d->vertices = d->trial;
	d->trial = before;
}

void gi_deform_settle(gi_deform *d, gi_hierarchy *h)
{
	memcpy(h->vertices, d->vertices, sizeof *h->vertices * h->vertex_count);
	copy_shape(d, &d->next, &d->now);
	d->drawn_is_late = true;
}

void gi_deform_draw(gi_deform *d, const gi_hierarchy *h, gi_drawn_surface *drawn)
{
	const gi_shape *s = &d->now;
	if (d->draw_count) {
		evaluate(s->draw_positions, d->draw_count, &d->draw_skin, s->joints, s->scale, d->draw);
		gi_drawn_refit_mesh(h, (const double(*)[3])d->draw, d->normals, drawn);
	} else {
		evaluate(s->positions, d->vertex_count, &d->skin, s->joints, s->scale, d->cage);
		gi_drawn_refit(h, &d->drawn, d->tangents, (const double(*)[3])d->cage, drawn);
	}
	d->drawn_is_late = false;
}

/* ---- life ---- */

/* Room for one more, so that no size is zero. */
static void *allocate(size_t count, size_t size, bool *enough)
{
	void *memory = gi_calloc(count + 1, size);
	*enough = *enough && memory;
	return memory;
}

static gi_skin copy_skin(const uint32_t *joints, const float *weights, size_t vertices, bool *enough)
{
	return (gi_skin){gi_copy(joints, 4 * vertices, sizeof *joints, enough),
			 gi_copy(weights, 4 * vertices, sizeof *weights, enough)};
}

static gi_shape make_shape(const gi_deform *d, const gi_object_def *def, bool *enough)
{
	gi_shape s = {.positions = gi_copy(def->positions, 3 * (size_t)d->vertex_count, sizeof(float), enough),
		      .joints = allocate(16 * (size_t)d->joint_count, sizeof(float), enough),
		      .draw_positions =
			  d->draw_count ? gi_copy(def->draw_positions, 3 * (size_t)d->draw_count, sizeof(float), enough)
					: NULL};
	for (uint32_t k = 0; s.joints && k < d->joint_count; k++)
		memcpy(s.joints + 16 * (size_t)k, IDENTITY, sizeof IDENTITY);
	memcpy(s.scale, def->scale, sizeof s.scale);
	return s;
}

/* The vertices of a second side are those of the first. */
static void join_sides(gi_stencils *s, uint32_t vertex_count)
{
	for (uint32_t k = 0; k < s->term_count; k++)
		s->vertex[k] %= vertex_count;
}

static size_t largest_upload(uint32_t leaf_count)
{
	/* Quads of leaves are as large as primitives, of which there is one a leaf; and trees take less. */
	return 4 * sizeof(gi_vec4) * (size_t)leaf_count;
}

/* What evaluations write besides the leaves' vertices by the shape set last. */
static void allocate_work(gi_deform *d, uint32_t leaf_vertices, bool *enough)
{
	d->trial = allocate(leaf_vertices, sizeof *d->trial, enough);
	d->cage = allocate(d->vertex_count, sizeof *d->cage, enough);
	d->draw = allocate(d->draw_count, sizeof *d->draw, enough);
	d->normals = allocate(d->draw_count, sizeof *d->normals, enough);
	d->sums = allocate(d->node_count, sizeof *d->sums, enough);
	d->scratch = allocate(largest_upload(d->leaf_count), 1, enough);
}

gi_deform *gi_deform_make(const gi_object_def *def, gi_refined *refined, const gi_hierarchy *h)
{
	gi_deform *d = gi_calloc(1, sizeof *d);
	if (!d)
		return NULL;
	bool enough = true;
	d->vertex_count = def->vertex_count;
	d->joint_count = def->joints ? def->joint_count : 0;
	d->draw_count = def->draw_index_count ? def->draw_vertex_count : 0;
	d->leaf_count = h->leaf_count;
	d->node_count = h->node_count;
	d->two_sided = def->double_sided;
	d->skin = copy_skin(def->joints, def->joint_weights, d->vertex_count, &enough);
	if (d->draw_count)
		d->draw_skin = copy_skin(def->draw_joints, def->draw_joint_weights, d->draw_count, &enough);
	d->next = make_shape(d, def, &enough);
	d->now = make_shape(d, def, &enough);
	d->points = refined->points;
	refined->points = (gi_stencils){0};
	join_sides(&d->points, d->vertex_count);
	d->faces = allocate(h->leaf_count, sizeof *d->faces, &enough);
	for (uint32_t leaf = 0; d->faces && leaf < h->leaf_count; leaf++)
		d->faces[leaf] = refined->faces[h->leaf_face[leaf]] % def->face_count;
	d->by_size = allocate(h->leaf_count, sizeof *d->by_size, &enough);
	d->vertices = allocate(h->vertex_count, sizeof *d->vertices, &enough);
	allocate_work(d, h->vertex_count, &enough);
	if (enough)
		return d;
	gi_deform_free(d, true);
	return NULL;
}

static gi_shape duplicate_shape(const gi_deform *d, const gi_shape *from, bool *enough)
{
	gi_shape s = *from;
	s.positions = gi_copy(from->positions, 3 * (size_t)d->vertex_count, sizeof(float), enough);
	s.joints = gi_copy(from->joints, 16 * (size_t)d->joint_count, sizeof(float), enough);
	s.draw_positions = gi_copy(from->draw_positions, 3 * (size_t)d->draw_count, sizeof(float), enough);
	return s;
}

gi_deform *gi_deform_copy(const gi_deform *from, uint32_t leaf_vertices)
{
	gi_deform *d = gi_malloc(sizeof *d);
	if (!d)
		return NULL;
	bool enough = true;
	*d = *from;
	d->next = duplicate_shape(from, &from->next, &enough);
	d->now = duplicate_shape(from, &from->now, &enough);
	d->vertices = gi_copy(from->vertices, leaf_vertices, sizeof *d->vertices, &enough);
	allocate_work(d, leaf_vertices, &enough);
	if (enough)
		return d;
	gi_deform_free(d, false);
	return NULL;
}

void gi_deform_take_drawn(gi_deform *d, gi_refined *fine, bool finer)
{
	if (finer) {
		d->drawn = fine->points;
		fine->points = (gi_stencils){0};
		join_sides(&d->drawn, d->vertex_count);
	}
	for (int k = 0; k < 2; k++) {
		d->tangents[k] = fine->tangents[k];
		fine->tangents[k] = (gi_stencils){0};
		join_sides(&d->tangents[k], d->vertex_count);
	}
}

static void free_shape(gi_shape *s)
{
	gi_free(s->positions);
	gi_free(s->joints);
	gi_free(s->draw_positions);
}

static void free_common(gi_deform *d)
{
	gi_free(d->skin.joints);
	gi_free(d->skin.weights);
	gi_free(d->draw_skin.joints);
	gi_free(d->draw_skin.weights);
	gi_stencils_free(&d->points);
	gi_stencils_free(&d->drawn);
	for (int k = 0; k < 2; k++)
		gi_stencils_free(&d->tangents[k]);
	gi_free(d->faces);
	gi_free(d->by_size);
}

void gi_deform_free(gi_deform *d, bool last)
{
	if (!d)
		return;
	if (last)
		free_common(d);
	free_shape(&d->next);
	free_shape(&d->now);
	gi_free(d->vertices);
	gi_free(d->trial);
	gi_free(d->cage);
	gi_free(d->draw);
	gi_free(d->normals);
	gi_free(d->sums);
	gi_free(d->scratch);
	gi_free(d);
}
