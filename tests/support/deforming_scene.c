#include "deforming_scene.h"

#include "scenes/body.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static engine_mesh make_mesh(int kind)
{
	engine_mesh m = {0};
	bool made = true;
	if (kind == BENT_BOX)
		made = shape_box((float[]){-.3f, -.5f, -.2f}, (float[]){.3f, .5f, .2f}, 2, false, &m);
	else if (kind == BENT_SPLIT)
		made = shape_box((float[]){-.25f, -.4f, -.25f}, (float[]){.25f, .4f, .25f}, 1, false, &m);
	else if (kind == BENT_BALL)
		made = shape_sphere(.5f, 2, &m);
	else if (kind == BENT_LOOP)
		made = shape_sphere(.4f, 2, &m);
	else
		made = shape_quad((float[]){-.6f, -.5f, 0}, (float[]){1.2f, 0, 0}, (float[]){0, 1, 0}, 3, 3, &m);
	assert_true(made);
	return m;
}

/* Each quad as two triangles. */
static void cut_quads(engine_mesh *m)
{
	uint32_t *indices = calloc(6 * (size_t)m->face_count, sizeof *indices);
	uint32_t *counts = calloc(2 * (size_t)m->face_count, sizeof *counts);
	assert_true(indices && counts);
	for (uint32_t f = 0; f < m->face_count; f++) {
		const uint32_t *q = m->indices + 4 * f;
		const uint32_t six[6] = {q[0], q[1], q[2], q[0], q[2], q[3]};
		memcpy(indices + 6 * (size_t)f, six, sizeof six);
		counts[2 * f] = counts[2 * f + 1] = 3;
	}
	free(m->indices);
	free(m->face_counts);
	m->indices = indices;
	m->face_counts = counts;
	m->face_count *= 2;
	m->index_count = 3 * m->face_count;
}

static const gi_pose POSES[BENT_KINDS] = {{{-.9f, .8f, -.7f}, {0, .3f, 0, .95f}},
					  {{.9f, .9f, -.8f}, {0, 0, 0, 1}},
					  {{0, 1.1f, .8f}, {0, 0, .2f, .98f}},
					  {{-1, 1.7f, .6f}, {0, 0, 0, 1}},
					  {{.9f, 1.2f, .6f}, {.1f, .2f, 0, .97f}}};

void deforming_scene_make(deforming_scene *s)
{
	*s = (deforming_scene){.block_pose = {{0, .3f, 0}, {0, .2f, 0, .98f}}};
	for (int k = 0; k < BENT_KINDS; k++) {
		bent *b = &s->bent[k];
		b->mesh = make_mesh(k);
		if (k == BENT_LOOP)
			cut_quads(&b->mesh);
		b->pose = POSES[k];
		b->positions = calloc(3 * (size_t)b->mesh.vertex_count, sizeof *b->positions);
		assert_non_null(b->positions);
		memcpy(b->positions, b->mesh.positions, sizeof *b->positions * 3 * b->mesh.vertex_count);
	}
}

void deforming_scene_free(deforming_scene *s)
{
	for (int k = 0; k < BENT_KINDS; k++) {
		engine_mesh_free(&s->bent[k].mesh);
		free(s->bent[k].positions);
	}
}

static void add_bent(deforming_scene *s, int kind)
{
	bent *b = &s->bent[kind];
	const gi_material material = {.rho = {.6f, .3f + .1f * (float)kind, .5f},
				      .exitance = {kind == BENT_SPLIT ? s->exitance : 0}};
	const gi_specular mirror = {.reflectance = {.3f, .3f, .3f}};
	gi_object_def def = scene_mesh_def(&b->mesh);
	def.name = "bent";
	def.deforms = true;
	def.materials = &material;
	def.material_count = 1;
	def.specular = s->mirror && kind == BENT_BALL ? &mirror : NULL;
	def.pose = POSES[kind];
	def.levels = kind == BENT_SPLIT || kind == BENT_SHEET ? 0 : 1;
	def.leaf_size = kind == BENT_SPLIT ? .17f : kind == BENT_SHEET ? .21f : 0;
	def.scheme = kind == BENT_BALL ? GI_SCHEME_CATMULL_CLARK : kind == BENT_LOOP ? GI_SCHEME_LOOP : def.scheme;
	def.double_sided = kind == BENT_SHEET;
	if (gi_create_object(s->gi, &def, &b->object))
		fail_msg("gi_create_object: %s", harness_last_message());
}

void deforming_scene_create(deforming_scene *s)
{
	engine_mesh m;
	assert_true(shape_box((float[]){-2, 0, -2}, (float[]){2, 3, 2}, 5, true, &m));
	harness_add(s->gi, &(harness_object){.name = "room", .rho = {.7f, .7f, .7f}}, &m);
	assert_true(shape_quad((float[]){-.5f, 2.99f, -.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 2, 2, &m));
	harness_add(s->gi, &(harness_object){.name = "lamp", .exitance = {20, 20, 20}}, &m);
	assert_true(shape_box((float[]){-.3f, -.3f, -.3f}, (float[]){.3f, .3f, .3f}, 2, false, &m));
	s->block = harness_add(s->gi, &(harness_object){.name = "block", .rho = {.2f, .5f, .7f}}, &m);
	/* On the floor from the first commit on: whether there is a sky is asked then. */
	assert_gi(gi_set_pose(s->gi, s->block, s->block_pose));
	for (int k = 0; k < BENT_KINDS; k++)
		add_bent(s, k);
}

/* Waves that run through the object, and a twist: no two leaves keep their places to one another. */
static void bend(bent *b, int kind, int frame)
{
	const float t = .7f * (float)frame + (float)kind;
	for (uint32_t v = 0; v < b->mesh.vertex_count; v++) {
		const float *p = b->mesh.positions + 3 * (size_t)v;
		float *q = b->positions + 3 * (size_t)v;
		const float turn = .8f * sinf(t) * p[1], c = cosf(turn), s = sinf(turn);
		q[0] = c * p[0] + s * p[2] + .12f * sinf(3 * p[1] + t);
		q[1] = p[1] * (1 + .2f * sinf(1.3f * t)) + .05f * cosf(4 * p[0] + t);
		q[2] = c * p[2] - s * p[0] + .12f * cosf(3 * p[0] + 2 * p[1] + t);
	}
}

void deforming_scene_play(deforming_scene *s, int frame)
{
	for (int k = 0; k < BENT_KINDS; k++) {
		/* Alone, together, with a move and without. */
		if ((frame + k) % 3 == 0 || frame % 5 == 4)
			bend(&s->bent[k], k, frame);
		if ((frame + 2 * k) % 4 == 3)
			s->bent[k].pose.position[0] = POSES[k].position[0] + .1f * sinf((float)frame);
	}
	if (frame % 3 == 1)
		s->block_pose.position[0] = .4f * sinf(1.1f * (float)frame);
	if (s->gi)
		deforming_scene_set(s);
}

void deforming_scene_set(const deforming_scene *s)
{
	for (int k = 0; k < BENT_KINDS; k++) {
		assert_gi(gi_set_positions(s->gi, s->bent[k].object, s->bent[k].positions));
		assert_gi(gi_set_pose(s->gi, s->bent[k].object, s->bent[k].pose));
	}
	assert_gi(gi_set_pose(s->gi, s->block, s->block_pose));
}
