/* Receivers: points that light falls on and that give none.
 *
 * Closed forms under a bright sky; leaves that have the same bits with them and without; rows of updates and of commits
 * that are those of a rebuild; how far off they are from path tracing stands in test_receivers_truth.c.
 */
#include "harmonics.h"
#include "moving_scene.h"
#include "pieces.h"

#include "scenes/shapes.h"

#include <glad/gl.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *frames_wanted(void)
{
	return getenv("RELUME_FRAMES");
}

static gi_receivers create(gi_context *gi, const gi_receivers_def *def)
{
	gi_receivers out;
	if (gi_create_receivers(gi, def, &out))
		fail_msg("gi_create_receivers: %s", harness_last_message());
	return out;
}

/* All of a set's light; *count vec4. */
static float *read_light(gi_context *gi, gi_receivers receivers, uint32_t *count)
{
	if (gi_read_receivers(gi, receivers, NULL, 0, count))
		fail_msg("gi_read_receivers: %s", harness_last_message());
	float *light = calloc(4 * (size_t)*count, sizeof *light);
	assert_non_null(light);
	assert_gi(gi_read_receivers(gi, receivers, light, *count, count));
	return light;
}

/* ---- closed forms ---- */

static const float POINTS[4][3] = {{0, 0, 0}, {1, 2, 3}, {-40, 1, 7}, {.01f, 0, 0}};
static const float NORMALS[4][3] = {{0, 1, 0}, {0, 0, -2}, {.3f, -.4f, .5f}, {1, 1, 1}};

/* Nothing but a sky of exitance E: E falls on everything, from all sides alike. */
static void open_sky(void **state)
{
	(void)state;
	gi_context_def def = harness_def();
	memcpy(def.sky_exitance, (float[]){2, 3, 5}, sizeof def.sky_exitance);
	gi_context *gi = harness_context(&def);
	gi_receivers sets[3];
	for (uint32_t k = 0; k < 3; k++) {
		gi_receivers_def r = gi_receivers_def_default();
		r.positions = POINTS[0];
		r.normals = k == 0 ? NORMALS[0] : NULL;
		r.count = 4;
		r.harmonics = k;
		sets[k] = create(gi, &r);
	}
	assert_gi(gi_commit(gi));
	harness_update(gi);
	for (uint32_t k = 0; k < 3; k++) {
		uint32_t count;
		const uint32_t stride = (k + 1) * (k + 1);
		float *light = read_light(gi, sets[k], &count);
		assert_int_equal(count, 4 * stride);
		for (uint32_t p = 0; p < 4; p++) {
			const float *c = light + 4 * (size_t)stride * p;
			assert_float_equal(c[3], 1, 1e-4);
			for (int channel = 0; channel < 3; channel++) {
				const double e = (double)def.sky_exitance[channel];
				const double h =
				    k ? harmonics_along(c, stride, NORMALS[0], channel) : (double)c[channel];
				assert_float_equal(h / e, 1, k ? 2e-3 : 1e-4);
			}
		}
		free(light);
	}
	gi_context_destroy(gi);
}

/* A square of side 2 h at distance 1 that faces the point, alone: the form factor of a point and a parallel square
 * above its middle, and radiance pi F integrated over its solid angle for the first band. */
static void lone_square(void **state)
{
	(void)state;
	gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	static const double HALF = .5;
	const float h = (float)HALF;
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-h, 1, -h}, (float[]){2 * h, 0, 0}, (float[]){0, 0, 2 * h}, 4, 4, &mesh));
	harness_add(gi, &(harness_object){.name = "lamp", .levels = 2, .exitance = {10, 20, 30}}, &mesh);
	const float at[3] = {0, 0, 0}, normals[2][3] = {{0, 1, 0}, {1, 0, 0}};
	const float twice[2][3] = {{0, 0, 0}, {0, 0, 0}};
	gi_receivers_def r = gi_receivers_def_default();
	r.positions = twice[0];
	r.normals = normals[0];
	r.count = 2;
	const gi_receivers facing = create(gi, &r);
	r.positions = at;
	r.normals = NULL;
	r.count = 1;
	r.harmonics = 2;
	const gi_receivers round = create(gi, &r);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	uint32_t count;
	float *light = read_light(gi, facing, &count), *c = read_light(gi, round, &count);
	/* Howell's catalogue, B-2 (parallel) and B-3 (perpendicular), four and two quarters. */
	const double x = HALF, s = sqrt(1 + x * x);
	const double parallel = 4 / (2 * acos(-1.0)) * 2 * (x / s) * atan(x / s);
	const double upright = 2 / (2 * acos(-1.0)) * (atan(x) - atan(x / s) / s);
	assert_float_equal((double)light[0] / (10 * parallel), 1, 2e-3);
	assert_float_equal((double)light[5] / (20 * upright), 1, 2e-2);
	/* Bands 0 and 1 of radiance E / pi over the square: its solid angle, and the mean cosine, pi times F. */
	const double omega = 4 * asin(x * x / (1 + x * x)), pi = acos(-1.0);
	assert_float_equal((double)c[0] / (pi * .282095 * omega * 10 / pi), 1, 5e-3);
	assert_float_equal((double)c[4] / (2 * pi / 3 * .488603 * parallel * 10), 1, 5e-3);
	assert_float_equal((double)c[8] / (double)c[4], 0, 5e-3);
	free(light);
	free(c);
	gi_context_destroy(gi);
}

/* ---- with objects that move ---- */

enum { SETS = 3 };

/* On the floor and in the air; on the block; and points that look round. */
static void add_receivers(scene *s, gi_receivers sets[SETS])
{
	enum { SIDE = 6, COUNT = SIDE * SIDE };
	static float positions[COUNT][3], normals[COUNT][3];
	for (uint32_t k = 0; k < COUNT; k++) {
		const float x = -2.2f + .88f * (float)(k % SIDE), z = -2.2f + .88f * (float)(k / SIDE);
		memcpy(positions[k], (float[]){x, k % 3 ? 0 : 1.7f, z}, sizeof positions[k]);
		memcpy(normals[k], (float[]){0, 1, k % 2 ? .2f : 0}, sizeof normals[k]);
	}
	gi_receivers_def r = gi_receivers_def_default();
	r.positions = positions[0];
	r.normals = normals[0];
	r.count = COUNT;
	sets[0] = create(s->gi, &r);
	r.harmonics = 2;
	r.normals = NULL;
	for (uint32_t k = 0; k < COUNT; k++)
		positions[k][1] += .9f;
	sets[1] = create(s->gi, &r);
	static const float on_block[4][3] = {{0, 1.5f, 0}, {.5f, .7f, 0}, {-.5f, .7f, .2f}, {.1f, .3f, .5f}};
	static const float block_normals[4][3] = {{0, 1, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 0, 1}};
	r.positions = on_block[0];
	r.normals = block_normals[0];
	r.count = 4;
	r.harmonics = 0;
	r.object = s->mover[BLOCK];
	sets[2] = create(s->gi, &r);
}

/* Committed, with the first light. */
static scene open_box_with_receivers(gi_receivers sets[SETS])
{
	const gi_context_def def = harness_def();
	scene s;
	open_box(&s, &def);
	add_receivers(&s, sets);
	assert_gi(gi_commit(s.gi));
	harness_update(s.gi);
	return s;
}

typedef struct light {
	float *values[SETS];
	uint32_t counts[SETS];
} light;

static light take_light(gi_context *gi, const gi_receivers sets[SETS])
{
	light l;
	for (int k = 0; k < SETS; k++)
		l.values[k] = read_light(gi, sets[k], &l.counts[k]);
	return l;
}

static void free_light(light *l)
{
	for (int k = 0; k < SETS; k++)
		free(l->values[k]);
}

static void expect_same_light(const light *a, const light *b, const char *when)
{
	for (int k = 0; k < SETS; k++) {
		assert_int_equal(a->counts[k], b->counts[k]);
		if (memcmp(a->values[k], b->values[k], 4 * sizeof(float) * a->counts[k]) == 0)
			continue;
		uint32_t first = 0;
		while (memcmp(a->values[k] + 4 * first, b->values[k] + 4 * first, 4 * sizeof(float)) == 0)
			first++;
		fail_msg("%s: set %d differs from vec4 %u on: %g, %g", when, k, first, (double)a->values[k][4 * first],
			 (double)b->values[k][4 * first]);
	}
}

/* The light of a cold solve by the rows as they are and by rows built anew. */
static void expect_rebuilt(gi_context *gi, const gi_receivers sets[SETS], const char *when)
{
	gi_reset_radiosity(gi);
	harness_update(gi);
	light kept = take_light(gi, sets);
	gi_reset_radiosity(gi);
	gi_invalidate(gi);
	harness_update(gi);
	light rebuilt = take_light(gi, sets);
	expect_same_light(&kept, &rebuilt, when);
	free_light(&kept);
	free_light(&rebuilt);
}

static void move_objects(scene *s, motion *m)
{
	bool moved[MOVERS];
	next_poses(m, moved);
	for (int k = 0; k < MOVERS; k++)
		if (moved[k])
			assert_gi(gi_set_pose(s->gi, s->mover[k], m->pose[k]));
}

/* Sets of points by themselves: turned, moved, reshaped. */
static void move_receivers(scene *s, const gi_receivers sets[SETS], uint32_t frame)
{
	const float t = .1f * (float)frame;
	if (frame % 3 == 1)
		assert_gi(gi_set_receivers_pose(
		    s->gi, sets[0], (gi_pose){.position = {.1f * sinf(t), 0, 0}, .rotation = {0, .2f * t, 0, 1}}));
	if (frame % 4 == 2) {
		static float positions[36][3];
		for (int k = 0; k < 36; k++)
			memcpy(positions[k], (float[]){2 * sinf(t + (float)k), 1 + .07f * (float)k, 2 * cosf((float)k)},
			       sizeof positions[k]);
		assert_gi(gi_set_receivers(s->gi, sets[1], positions[0], NULL));
	}
}

static uint32_t frame_count(void)
{
	return frames_wanted() ? (uint32_t)atoi(frames_wanted()) : harness_is_long() ? 120 : 6;
}

static void updates_are_rebuilds(void **state)
{
	(void)state;
	gi_receivers sets[SETS];
	scene s = open_box_with_receivers(sets);
	seed_motion(31);
	motion m = start_motion(false);
	for (uint32_t frame = 0; frame < frame_count(); frame++) {
		char when[32];
		snprintf(when, sizeof when, "frame %u", frame);
		move_objects(&s, &m);
		move_receivers(&s, sets, frame);
		harness_update(s.gi);
		if (frame % 3 == 2)
			expect_rebuilt(s.gi, sets, when);
	}
	gi_context_destroy(s.gi);
}

/* Rows of receivers that waited under a budget are those of a rebuild when they have been refreshed. */
static void budgets_end_in_rebuilds(void **state)
{
	(void)state;
	gi_receivers sets[SETS];
	scene s = open_box_with_receivers(sets);
	seed_motion(5);
	motion m = start_motion(false);
	for (uint32_t frame = 0; frame < 4; frame++) {
		move_objects(&s, &m);
		move_receivers(&s, sets, frame);
		assert_gi(gi_update(s.gi, &(gi_budget){.rays = 400}));
	}
	harness_update(s.gi);
	expect_rebuilt(s.gi, sets, "after budgets");
	gi_context_destroy(s.gi);
}

/* Objects and receivers come and go. */
static void commits_keep_rows(void **state)
{
	(void)state;
	gi_receivers sets[SETS];
	scene s = open_box_with_receivers(sets);
	engine_mesh mesh;
	assert_true(shape_sphere(.4f, 2, &mesh));
	const gi_object ball =
	    harness_add(s.gi, &(harness_object){.name = "late", .rho = {.5f, .5f, .5f}, .position = {1, 1, 1}}, &mesh);
	assert_gi(gi_commit(s.gi));
	harness_update(s.gi);
	expect_rebuilt(s.gi, sets, "an object more");
	assert_gi(gi_destroy_object(s.gi, ball));
	assert_gi(gi_destroy_receivers(s.gi, sets[0]));
	const gi_receivers gone = sets[0];
	gi_receivers_def r = gi_receivers_def_default();
	r.positions = POINTS[1];
	r.normals = NORMALS[1];
	r.count = 2;
	sets[0] = create(s.gi, &r);
	assert_false(gi_receivers_are_valid(s.gi, gone));
	assert_gi(gi_commit(s.gi));
	const gi_report report = harness_update(s.gi);
	assert_true(report.new_entries < report.entries / 2);
	expect_rebuilt(s.gi, sets, "an object and a set less, another set");
	gi_context_destroy(s.gi);
}

/* Two scenes in the same motion, one with receivers: after each update leaves are the same bits. */
static void leaves_know_nothing_of_them(void **state)
{
	(void)state;
	const gi_context_def def = harness_def();
	scene s[2];
	for (int k = 0; k < 2; k++)
		open_box(&s[k], &def);
	gi_receivers sets[SETS];
	add_receivers(&s[0], sets);
	for (int k = 0; k < 2; k++) {
		assert_gi(gi_commit(s[k].gi));
		harness_update(s[k].gi);
	}
	motion m[2];
	for (uint32_t frame = 0; frame < 4; frame++) {
		for (int k = 0; k < 2; k++) {
			if (frame == 0) {
				seed_motion(77);
				m[k] = start_motion(false);
			}
			seed_motion(1000 + frame);
			if (frame != 3) /* receivers move alone */
				move_objects(&s[k], &m[k]);
		}
		move_receivers(&s[0], sets, frame);
		snapshot taken[2];
		for (int k = 0; k < 2; k++) {
			harness_update(s[k].gi);
			taken[k] = snapshot_take(s[k].gi);
		}
		assert_int_equal(taken[0].leaf_count, taken[1].leaf_count);
		snapshot_expect_same_rows(&taken[0], &taken[1], "with and without receivers");
		assert_true(snapshot_hash_radiosity(&taken[0]) == snapshot_hash_radiosity(&taken[1]));
		for (int k = 0; k < 2; k++)
			snapshot_free(&taken[k]);
	}
	for (int k = 0; k < 2; k++)
		gi_context_destroy(s[k].gi);
}

/* ---- life and errors ---- */

static gi_receivers add_probes(gi_context *gi)
{
	gi_probes_def def = gi_probes_def_default();
	def.spacing = 1;
	def.count[0] = def.count[1] = def.count[2] = 2;
	gi_receivers probes;
	assert_gi(gi_create_probes(gi, &def, &probes));
	assert_gi(gi_commit(gi));
	harness_update(gi);
	gi_probe_buffers buffers;
	assert_gi(gi_get_probe_buffers(gi, probes, &buffers));
	return probes;
}

/* All that OpenGL has, whoever made it. */
static uint32_t count_objects(void)
{
	uint32_t count = 0;
	for (GLuint name = 1; name < 20000; name++)
		count += glIsBuffer(name) + glIsTexture(name) + glIsProgram(name) + glIsQuery(name);
	return count;
}

static void come_and_go(void **state)
{
	(void)state;
	harness_require_context();
	glUseProgram(0);
	const uint32_t objects = count_objects();
	gi_context_def def = harness_def();
	def.sky_exitance[0] = 1;
	gi_context *gi = harness_context(&def);
	add_block(gi, &(harness_object){.name = "block", .rho = {.5f, .5f, .5f}}, (box){{-1, 0, -1}, {1, 1, 1}});
	for (uint32_t round = 0; round < 100; round++) {
		gi_receivers_def r = gi_receivers_def_default();
		r.positions = POINTS[0];
		r.normals = round % 3 ? NORMALS[0] : NULL;
		r.harmonics = round % 3 ? 0 : 1 + round % 2;
		r.count = 1 + round % 4;
		r.offset = r.normals ? .1f : 0;
		const gi_receivers set = create(gi, &r);
		assert_gi(gi_commit(gi));
		harness_update(gi);
		uint32_t count;
		free(read_light(gi, set, &count));
		if (round % 10 == 0)
			assert_gi(gi_destroy_receivers(gi, add_probes(gi)));
		assert_gi(gi_destroy_receivers(gi, set));
		assert_int_equal(gi_destroy_receivers(gi, set), GI_ERROR_INVALID_HANDLE);
	}
	assert_gi(gi_commit(gi));
	harness_update(gi);
	gi_context_destroy(gi);
	glUseProgram(0); /* the driver keeps the one that is bound */
	assert_int_equal(count_objects(), objects);
}

static void refuse(gi_context *gi, const gi_receivers_def *def, gi_result expected)
{
	gi_receivers out = {7, 7, 7};
	assert_int_equal(gi_create_receivers(gi, def, &out), expected);
	assert_int_equal(out.index1, 0);
}

static void bad_definitions(void **state)
{
	(void)state;
	const gi_context_def context_def = harness_def();
	gi_context *gi = harness_context(&context_def);
	gi_receivers_def good = gi_receivers_def_default(), bad;
	good.positions = POINTS[0];
	good.normals = NORMALS[0];
	good.count = 4;
	bad = good, bad.internal = 0, refuse(gi, &bad, GI_ERROR_INVALID_DEF);
	bad = good, bad.positions = NULL, refuse(gi, &bad, GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.count = 0, refuse(gi, &bad, GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.normals = NULL, refuse(gi, &bad, GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.harmonics = 3, refuse(gi, &bad, GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.size = -1, refuse(gi, &bad, GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.refinement = .5f, refuse(gi, &bad, GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.refinement = 1025, refuse(gi, &bad, GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.refinement = NAN, refuse(gi, &bad, GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.samples = 0, refuse(gi, &bad, GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.samples = 17, refuse(gi, &bad, GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.offset = NAN, refuse(gi, &bad, GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.normals = (float[12]){0}, refuse(gi, &bad, GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.positions = (float[12]){INFINITY}, refuse(gi, &bad, GI_ERROR_INVALID_ARGUMENT);
	bad = good, bad.pose.rotation[3] = 0, refuse(gi, &bad, GI_ERROR_INVALID_POSE);
	bad = good, bad.object.index1 = 1, refuse(gi, &bad, GI_ERROR_INVALID_HANDLE);
	const gi_receivers set = create(gi, &good);
	gi_receiver_buffer where;
	assert_int_equal(gi_get_receiver_buffer(gi, set, &where), GI_ERROR_NOT_COMMITTED);
	assert_gi(gi_commit(gi));
	assert_int_equal(gi_get_receiver_buffer(gi, set, &where), GI_ERROR_NOT_COMMITTED);
	harness_update(gi);
	assert_gi(gi_get_receiver_buffer(gi, set, &where));
	assert_true(where.buffer && where.first == 0 && where.count == 4 && where.stride == 1);
	assert_int_equal(gi_set_receivers(gi, set, (float[12]){NAN}, NULL), GI_ERROR_INVALID_ARGUMENT);
	gi_context_destroy(gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(open_sky),
					   cmocka_unit_test(lone_square),
					   cmocka_unit_test(bad_definitions),
					   cmocka_unit_test(updates_are_rebuilds),
					   cmocka_unit_test(commits_keep_rows),
					   cmocka_unit_test(budgets_end_in_rebuilds),
					   cmocka_unit_test(leaves_know_nothing_of_them),
					   cmocka_unit_test(come_and_go)};
	return cmocka_run_group_tests_name("receivers", tests, harness_open, harness_close);
}
