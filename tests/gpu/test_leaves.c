/* Scenes of one polygon a wall whose leaves gi_choose_leaves chose, against path tracing: blocks that hover close above
 * a floor, ground that goes through under walls, a ball sunk into a floor, a room behind a wall.
 *
 * Figures are those of two halves of a path-traced reference, whose noise they are free of.
 */
#include "pieces.h"
#include "scenes/shapes.h"

#include "tests/reference/leaves.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 8 };

typedef struct piece {
	engine_mesh mesh;
	gi_material material;
} piece;

/* Objects on their way to the library. */
typedef struct stage {
	piece pieces[MOST];
	gi_object_def defs[MOST];
	gi_object handles[MOST];
	uint32_t count;
	float turn[4]; /* the whole scene is turned by this */
} stage;

static const float GREY[3] = {.7f, .7f, .7f}, BLACK[3] = {0};

static void put(stage *s, const engine_mesh *mesh, const float rho[3], float exitance)
{
	piece *p = &s->pieces[s->count];
	p->mesh = *mesh;
	for (int c = 0; c < 3; c++) {
		p->material.rho[c] = rho[c];
		p->material.exitance[c] = exitance;
	}
	gi_object_def *def = &s->defs[s->count++];
	*def = gi_object_def_default();
	def->positions = p->mesh.positions;
	def->vertex_count = p->mesh.vertex_count;
	def->face_counts = p->mesh.face_counts;
	def->face_count = p->mesh.face_count;
	def->indices = p->mesh.indices;
	def->index_count = p->mesh.index_count;
	def->materials = &p->material;
	def->material_count = 1;
	if (s->turn[3] != 0)
		memcpy(def->pose.rotation, s->turn, sizeof s->turn);
}

static void put_box(stage *s, box b, bool inward, const float rho[3])
{
	engine_mesh mesh;
	assert_true(shape_box(b.lower, b.upper, 1, inward, &mesh));
	put(s, &mesh, rho, 0);
}

static void put_quad(stage *s, const float corner[3], const float u[3], const float v[3], const float rho[3],
		     float exitance)
{
	engine_mesh mesh;
	assert_true(shape_quad(corner, u, v, 1, 1, &mesh));
	put(s, &mesh, rho, exitance);
}

/* A room of 4 x 2.5 x 5 m with a lamp of 1 x 1 m below its ceiling, all but black on its back. */
static void put_room(stage *s, float exitance)
{
	put_box(s, (box){{-2, 0, -2.5f}, {2, 2.5f, 2.5f}}, true, GREY);
	put_quad(s, (float[]){-.9f, 2.4f, -.7f}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, BLACK, exitance);
}

typedef struct measured {
	gi_leaf *leaves;
	float *truth[2];
	uint32_t count;
	gi_leaf_choice choice;
	double rms, noise; /* relative to the RMS of H */
} measured;

static double dot3(const float *a, const float *b)
{
	return (double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2];
}

static void compare(measured *m)
{
	double error = 0, all = 0, between = 0;
	for (uint32_t k = 0; k < m->count; k++) {
		const float *h = m->leaves[k].irradiance, *r1 = m->truth[0] + 3 * k, *r2 = m->truth[1] + 3 * k;
		float d1[3], d2[3], d[3];
		for (int c = 0; c < 3; c++) {
			d1[c] = h[c] - r1[c];
			d2[c] = h[c] - r2[c];
			d[c] = .5f * (r1[c] - r2[c]);
		}
		error += (double)m->leaves[k].area * dot3(d1, d2);
		all += (double)m->leaves[k].area * dot3(r1, r2);
		between += (double)m->leaves[k].area * dot3(d, d);
	}
	m->rms = sqrt(fmax(error, 0) / all);
	m->noise = sqrt(between / all);
}

/* By the library's own paths, which know what lies in one place. */
static void trace_paths(gi_context *gi, measured *m)
{
	for (uint32_t half = 0; half < 2; half++) {
		uint32_t count;
		const gi_path_options options = {.paths = harness_paths(256), .seed = 7 + half};
		assert_gi(gi_trace_paths(gi, &options, m->truth[half], m->count, &count));
	}
}

/* By Embree, where nothing touches: four times the paths in less time. */
static void trace_reference(measured *m)
{
	leaf_scene scene;
	reference_result traced;
	assert_true(leaf_scene_make(m->leaves, m->count, &scene));
	assert_true(reference_trace(&scene.scene, harness_paths(4096), 7, &traced));
	for (uint32_t half = 0; half < 2; half++)
		for (uint32_t k = 0; k < 3 * m->count; k++)
			m->truth[half][k] = (float)traced.irradiance[half][k];
	reference_result_free(&traced);
	leaf_scene_free(&scene);
}

/* Chooses, creates, solves, traces. */
static gi_context *measure(stage *s, float leaf_size, bool touches, measured *m)
{
	gi_context *gi = open_context(.01f);
	gi_leaf_choice_def def = gi_leaf_choice_def_default();
	def.leaf_size = leaf_size;
	assert_gi(gi_choose_leaves(gi, &def, s->defs, s->count, &m->choice));
	for (uint32_t k = 0; k < s->count; k++)
		assert_gi(gi_create_object(gi, &s->defs[k], &s->handles[k]));
	gi_free_leaf_choice(&(gi_leaf_choice){.memory = m->choice.memory});
	assert_gi(gi_commit(gi));
	solve(gi);
	assert_gi(gi_read_leaves(gi, NULL, 0, &m->count));
	assert_int_equal(m->count, m->choice.leaves);
	m->leaves = malloc(sizeof *m->leaves * m->count);
	assert_gi(gi_read_leaves(gi, m->leaves, m->count, &m->count));
	for (uint32_t half = 0; half < 2; half++)
		m->truth[half] = malloc(sizeof(float) * 3 * m->count);
	if (touches)
		trace_paths(gi, m);
	else
		trace_reference(m);
	compare(m);
	return gi;
}

static void end(gi_context *gi, stage *s, measured *m)
{
	gi_context_destroy(gi);
	for (uint32_t k = 0; k < s->count; k++)
		engine_mesh_free(&s->pieces[k].mesh);
	free(m->leaves);
	free(m->truth[0]);
	free(m->truth[1]);
}

/* To the scene's own frame. */
static void turn_back(const stage *s, const float in[3], double out[3])
{
	const double w = s->turn[3] != 0 ? (double)s->turn[3] : 1, q[3] = {-s->turn[0], -s->turn[1], -s->turn[2]};
	double t[3];
	for (int k = 0; k < 3; k++)
		t[k] = 2 * (q[(k + 1) % 3] * (double)in[(k + 2) % 3] - q[(k + 2) % 3] * (double)in[(k + 1) % 3]);
	for (int k = 0; k < 3; k++)
		out[k] = (double)in[k] + w * t[k] + q[(k + 1) % 3] * t[(k + 2) % 3] - q[(k + 2) % 3] * t[(k + 1) % 3];
}

static void centre_of(const stage *s, const gi_leaf *l, double centre[3])
{
	float sum[3] = {0};
	for (int k = 0; k < 4; k++)
		for (int c = 0; c < 3; c++)
			sum[c] += .25f * l->corners[k][c];
	turn_back(s, sum, centre);
}

/* Leaves of the first object, on its floor, with their middles in a box: how far off at most, W/m2, beyond 25 % of the
 * truth.
 */
static double worst_below(const stage *s, const measured *m, box in, double *mean, double *truth)
{
	double worst = 0, sum = 0, sum_truth = 0, area = 0;
	for (uint32_t k = 0; k < m->count; k++) {
		const gi_leaf *l = &m->leaves[k];
		double c[3];
		centre_of(s, l, c);
		if (l->object.index1 != s->handles[0].index1 || c[0] < (double)in.lower[0] ||
		    c[0] > (double)in.upper[0] || c[1] < (double)in.lower[1] || c[1] > (double)in.upper[1] ||
		    c[2] < (double)in.lower[2] || c[2] > (double)in.upper[2])
			continue;
		const double h = (double)l->irradiance[1],
			     r = .5 * ((double)m->truth[0][3 * k + 1] + (double)m->truth[1][3 * k + 1]);
		worst = fmax(worst, fabs(h - r) / fmax(.02, .25 * r));
		sum += h * (double)l->area;
		sum_truth += r * (double)l->area;
		area += (double)l->area;
	}
	*mean = sum / area;
	*truth = sum_truth / area;
	return worst;
}

/* A block above the floor: leaves below it against the truth, all leaves of the scene together. */
static void expect_block(float height, float leaf_size, const float turn[4])
{
	stage s = {0};
	measured m = {0};
	const box b = {{-.3f, height, -.45f}, {.9f, height + .8f, .35f}};
	memcpy(s.turn, turn, sizeof s.turn);
	put_room(&s, 30);
	put_box(&s, b, false, GREY);
	gi_context *gi = measure(&s, leaf_size, height == 0, &m);
	const box below = {{b.lower[0], -.1f, b.lower[2]}, {b.upper[0], .1f, b.upper[2]}};
	double mean, truth;
	const double worst = worst_below(&s, &m, below, &mean, &truth);
	printf("block %.2f m above the floor%s, %u leaves of %.3g, %.3g, %u cuts: H below %.4f, truth %.4f, one leaf "
	       "%.1f times 0.02 W/m2 or 25 %% off; scene %.2f %% RMS (noise %.2f)\n",
	       (double)height, turn[3] != 0 ? ", turned" : "", m.count, (double)m.choice.leaf_size,
	       (double)m.choice.least_size, m.choice.cuts, mean, truth, worst, 100 * m.rms, 100 * m.noise);
	assert_true(fabs(mean - truth) <= fmax(.02, .25 * truth));
	assert_true(height > 0 || worst == 0); /* nothing comes in */
	/* 1 is wanted; it is 0.9 to 1.9, by the draw of the rays (what comes through the slit has some 30 entries)
	 * and because light falls off within leaves that send it on as one (docs/accuracy.md). */
	assert_true(worst <= 2.2);
	assert_true(m.rms <= .02);
	end(gi, &s, &m);
}

static const float STRAIGHT[4] = {0, 0, 0, 0}, TURNED[4] = {.1f, .3f, .2f, .9273618f};

static void a_block_stands(void **state)
{
	(void)state;
	expect_block(0, .5f, STRAIGHT);
	expect_block(0, .25f, TURNED);
}

static void a_block_hovers(void **state)
{
	(void)state;
	expect_block(.01f, .25f, STRAIGHT);
	expect_block(.05f, .5f, TURNED);
	if (harness_is_long()) {
		expect_block(.05f, .25f, STRAIGHT);
		expect_block(.01f, .5f, TURNED);
	}
}

/* Behind a wall of one box that goes through floor, sides and ceiling of one box. */
static void a_wall_parts_a_room(void **state)
{
	(void)state;
	stage s = {0};
	measured m = {0};
	put_room(&s, 30);
	put_box(&s, (box){{-2.1f, -.1f, 1.03f}, {2.1f, 2.6f, 1.17f}}, false, GREY);
	gi_context *gi = measure(&s, .25f, true, &m);
	double dark = 0;
	for (uint32_t k = 0; k < m.count; k++) {
		double c[3];
		centre_of(&s, &m.leaves[k], c);
		dark = c[2] > 1.17 ? fmax(dark, (double)m.leaves[k].irradiance[1]) : dark;
	}
	printf("a wall through a room, %u leaves: behind it H is %g at most; scene %.2f %% RMS (noise %.2f)\n", m.count,
	       dark, 100 * m.rms, 100 * m.noise);
	assert_true(dark == 0);
	assert_true(m.rms <= .02);
	end(gi, &s, &m);
}

/* A ball of flat faces, half in the floor: its rim and the floor are cut where they meet. */
static void a_ball_is_sunk(void **state)
{
	(void)state;
	stage s = {0};
	measured m = {0};
	engine_mesh ball;
	put_room(&s, 30);
	assert_true(shape_sphere(.5f, 3, &ball));
	put(&s, &ball, GREY, 0);
	s.defs[2].pose.position[1] = .07f;
	gi_context *gi = measure(&s, .25f, true, &m);
	double error = 0, all = 0;
	for (uint32_t k = 0; k < m.count; k++) {
		const float *h = m.leaves[k].irradiance, *r1 = m.truth[0] + 3 * k, *r2 = m.truth[1] + 3 * k;
		if (m.leaves[k].object.index1 != s.handles[2].index1)
			continue;
		error += (double)m.leaves[k].area * ((double)h[1] - (double)r1[1]) * ((double)h[1] - (double)r2[1]);
		all += (double)m.leaves[k].area * (double)r1[1] * (double)r2[1];
	}
	const double on_ball = sqrt(fmax(error, 0) / all);
	printf("a ball sunk into the floor, %u leaves: %.2f %% RMS on it; scene %.2f %% RMS (noise %.2f)\n", m.count,
	       100 * on_ball, 100 * m.rms, 100 * m.noise);
	assert_true(on_ball <= .03);
	assert_true(m.rms <= .02);
	end(gi, &s, &m);
}

/* A room whose faces are there five times is cut as the room is, and all leaves counted are there. */
static void copies_are_not_counted(void **state)
{
	(void)state;
	enum { COPIES = 5 };
	uint32_t leaves[2];
	for (uint32_t copies = 0; copies < 2; copies++) {
		gi_context *gi = open_context(.1f);
		engine_mesh room;
		stage s = {0};
		assert_true(shape_box((float[]){-2, 0, -2.5f}, (float[]){2, 2.5f, 2.5f}, 1, true, &room));
		put(&s, &room, GREY, 1);
		put_box(&s, (box){{-1, 0, -1}, {0, .8f, .2f}}, false, GREY);
		gi_object_def *def = &s.defs[0];
		uint32_t counts[6 * COPIES], indices[24 * COPIES];
		for (uint32_t k = 0; k < 24 * COPIES; k++) {
			counts[k / 4] = 4;
			indices[k] = def->indices[k % 24];
		}
		if (copies) {
			def->face_counts = counts;
			def->indices = indices;
			def->face_count *= COPIES;
			def->index_count *= COPIES;
		}
		const gi_leaf_choice_def wanted = gi_leaf_choice_def_default();
		gi_leaf_choice choice;
		assert_gi(gi_choose_leaves(gi, &wanted, s.defs, s.count, &choice));
		for (uint32_t k = 0; k < s.count; k++)
			assert_gi(gi_create_object(gi, &s.defs[k], &s.handles[k]));
		assert_gi(gi_commit(gi));
		assert_gi(gi_read_leaves(gi, NULL, 0, &leaves[copies]));
		assert_int_equal(leaves[copies], choice.leaves);
		gi_free_leaf_choice(&choice);
		gi_context_destroy(gi);
		for (uint32_t k = 0; k < s.count; k++)
			engine_mesh_free(&s.pieces[k].mesh);
	}
	printf("a room: %u leaves, each face five times: %u\n", leaves[0], leaves[1]);
	assert_int_equal(leaves[0], leaves[1]);
}

/* What a refusal says fits does. */
static void the_size_named_fits(void **state)
{
	(void)state;
	static const float heights[] = {0, .01f, .3f};
	for (size_t k = 0; k < 3; k++)
		for (float size = 1e-4f; size < .02f; size *= 4) {
			gi_context *gi = open_context(.1f);
			stage s = {0};
			gi_leaf_choice choice;
			gi_leaf_choice_def def = gi_leaf_choice_def_default();
			put_room(&s, 30);
			put_box(&s, (box){{-.3f, heights[k], -.45f}, {.9f, heights[k] + .8f, .35f}}, false, GREY);
			def.leaf_size = size;
			def.most_leaves = 3000;
			assert_int_equal(gi_choose_leaves(gi, &def, s.defs, s.count, &choice),
					 GI_ERROR_INVALID_ARGUMENT);
			const char *named = strstr(harness_last_message(), "size of ");
			assert_non_null(named);
			def.leaf_size = (float)atof(named + strlen("size of "));
			assert_gi(gi_choose_leaves(gi, &def, s.defs, s.count, &choice));
			printf("%s: %u\n", harness_last_message(), choice.leaves);
			assert_true(choice.leaves > def.most_leaves / 8);
			gi_free_leaf_choice(&choice);
			gi_context_destroy(gi);
			for (uint32_t n = 0; n < s.count; n++)
				engine_mesh_free(&s.pieces[n].mesh);
		}
}

/* A room of 2 m and a plate of two sides, `gap` below its ceiling or beside a wall: what is between the two stays
 * there. */
typedef struct plate {
	float gap, size; /* m, before scaling */
	float scale, leaf_size;
	const float *turn;
	bool upright, shines; /* else a lamp of one side below it does */
} plate;

static void put_two_sided(stage *s, const plate *p)
{
	const float half = .5f * p->size, at = 1 - p->gap, across = .07f, e = p->shines ? 31.4f : 0;
	const float low[3] = {across - half, at, -half}, side[3] = {at, across - half, -half};
	const float x[3] = {p->size, 0, 0}, y[3] = {0, p->size, 0}, z[3] = {0, 0, p->size};
	put_quad(s, p->upright ? side : low, p->upright ? y : x, z, GREY, e);
	s->defs[s->count - 1].double_sided = true;
	if (!p->shines)
		put_quad(s, (float[]){-.3f, .2f, -.3f}, (float[]){.4f, 0, 0}, (float[]){0, 0, .6f}, BLACK, 31.4f);
}

static void scale_stage(stage *s, float scale)
{
	for (uint32_t k = 0; k < s->count; k++)
		for (uint32_t v = 0; v < 3 * s->pieces[k].mesh.vertex_count; v++)
			s->pieces[k].mesh.positions[v] *= scale;
}

typedef struct parts {
	double area, light, truth;
} parts;

static void add_leaf(parts *p, const measured *m, uint32_t k)
{
	const double area = (double)m->leaves[k].area;
	p->area += area;
	p->light += area * (double)m->leaves[k].irradiance[1];
	p->truth += .5 * area * ((double)m->truth[0][3 * k + 1] + (double)m->truth[1][3 * k + 1]);
}

/* Of the room: what the plate is before, what lies round that as far as a leaf is wide, and all the rest. */
static void expect_plate(const plate *p)
{
	stage s = {0};
	measured m = {0};
	memcpy(s.turn, p->turn, sizeof s.turn);
	put_box(&s, (box){{-1, -1, -1}, {1, 1, 1}}, true, GREY);
	put_two_sided(&s, p);
	scale_stage(&s, p->scale);
	gi_context *gi = measure(&s, p->scale * p->leaf_size, true, &m);
	parts before = {0}, halo = {0}, rest = {0};
	for (uint32_t k = 0; k < m.count; k++) {
		double c[3];
		if (m.leaves[k].object.index1 != s.handles[0].index1)
			continue;
		centre_of(&s, &m.leaves[k], c);
		const double scale = (double)p->scale, up = c[p->upright ? 0 : 1] / scale,
			     across = fabs(c[p->upright ? 1 : 0] / scale - .07), along = fabs(c[2] / scale),
			     out = fmax(across, along) - .5 * (double)p->size;
		add_leaf(up < .999 || out > (double)p->leaf_size ? &rest : out > 0 ? &halo : &before, &m, k);
	}
	printf("%s of %.2f m, %.0f mm %s, scale %g%s, %u leaves of %.3g, %.3g: H %.3f of %.3f before it, %.4f of %.4f "
	       "round it, "
	       "elsewhere %.4f of %.4f (%+.2f %%); scene %.2f %% RMS (noise %.2f)\n",
	       p->shines ? "lamp" : "plate", (double)p->size, 1e3 * (double)p->gap,
	       p->upright ? "off a wall" : "below a ceiling", (double)p->scale, p->turn[3] != 0 ? ", turned" : "",
	       m.count, (double)(m.choice.leaf_size / p->scale), (double)(m.choice.least_size / p->scale),
	       before.light / before.area, before.truth / before.area, halo.light / halo.area, halo.truth / halo.area,
	       rest.light / rest.area, rest.truth / rest.area, 100 * (rest.light / rest.truth - 1), 100 * m.rms,
	       100 * m.noise);
	assert_true(fabs(rest.light / rest.truth - 1) <= .02);
	assert_true(fabs(before.light - before.truth) <= fmax(.05 * before.truth, .02 * before.area));
	/* No ring of light that came through the leaves before the plate: some 25 times as bright as what is round
	 * them. */
	assert_true(fabs(halo.light / halo.truth - 1) <= .2);
	end(gi, &s, &m);
}

static void a_plate_hangs_close(void **state)
{
	(void)state;
	static const plate plates[] = {
	    {.01f, .6f, 1, .25f, STRAIGHT, false, true},  {.002f, .6f, 1, .25f, STRAIGHT, false, true},
	    {.05f, .6f, 1, .25f, STRAIGHT, false, true},  {.01f, .2f, 1, .25f, TURNED, false, true},
	    {.01f, 1.3f, 1, .5f, STRAIGHT, true, true},   {.01f, .6f, 1e-3f, .25f, STRAIGHT, false, true},
	    {.02f, .45f, 1e3f, .25f, TURNED, true, true}, {.005f, .7f, 1, .25f, STRAIGHT, false, false},
	    {.01f, .6f, 1, .125f, STRAIGHT, false, true},
	};
	for (size_t k = 0; k < sizeof plates / sizeof *plates; k++)
		expect_plate(&plates[k]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_block_stands),         cmocka_unit_test(a_block_hovers),
	    cmocka_unit_test(a_wall_parts_a_room),    cmocka_unit_test(a_ball_is_sunk),
	    cmocka_unit_test(copies_are_not_counted), cmocka_unit_test(the_size_named_fits),
	    cmocka_unit_test(a_plate_hangs_close),
	};
	return cmocka_run_group_tests_name("leaves", tests, harness_open, harness_close);
}
