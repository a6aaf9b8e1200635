/* What is set after creation gives the same bits as a context that was created with it, at the price the header
 * names. */
#include "snapshot.h"

#include "scenes/shapes.h"

#include <glad/gl.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the scene: a floor, a ball that moves and a lamp, open to the sky ---- */

typedef struct loaded {
	gi_context *gi;
	gi_object ball;
} loaded;

static loaded load(const gi_context_def *def)
{
	engine_mesh mesh;
	loaded l = {.gi = harness_context(def)};
	assert_true(shape_quad((float[]){-1, 0, -1}, (float[]){0, 0, 2}, (float[]){2, 0, 0}, 6, 6, &mesh));
	harness_add(l.gi, &(harness_object){.name = "floor", .rho = {.5f, .6f, .7f}}, &mesh);
	assert_true(shape_quad((float[]){-.2f, 1.5f, -.2f}, (float[]){.4f, 0, 0}, (float[]){0, 0, .4f}, 2, 2, &mesh));
	harness_add(l.gi, &(harness_object){.name = "lamp", .rho = {.5f, .5f, .5f}, .exitance = {20, 15, 10}}, &mesh);
	assert_true(shape_sphere(.3f, 2, &mesh));
	l.ball = harness_add(l.gi, &(harness_object){.name = "ball", .rho = {.8f, .4f, .2f}, .position = {.2f, .4f, 0}},
			     &mesh);
	assert_gi(gi_commit(l.gi));
	return l;
}

static gi_context_def def_of_test(void)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .02f;
	def.solve_tolerance = 1e-3f;
	def.sky = GI_SKY_ON;
	def.sky_exitance[0] = def.sky_exitance[1] = def.sky_exitance[2] = 2;
	return def;
}

/* ---- what a context shows ---- */

typedef struct look {
	snapshot rows;
	float *indirect; /* of each leaf, as gi_draw takes it */
	float *paths;
} look;

static look look_at(gi_context *gi)
{
	look seen = {.rows = snapshot_take(gi)};
	const uint32_t leaves = seen.rows.leaf_count;
	gi_buffers buffers;
	uint32_t count;
	assert_gi(gi_get_buffers(gi, &buffers));
	seen.indirect = calloc(leaves, 4 * sizeof *seen.indirect);
	seen.paths = calloc(leaves, 3 * sizeof *seen.paths);
	assert_true(seen.indirect && seen.paths);
	glGetNamedBufferSubData(buffers.leaf_indirect, 0, (GLsizeiptr)(leaves * 4 * sizeof *seen.indirect),
				seen.indirect);
	assert_gi(gi_trace_paths(gi, &(gi_path_options){.paths = 4, .seed = 1}, seen.paths, leaves, &count));
	return seen;
}

static void free_look(look *l)
{
	snapshot_free(&l->rows);
	free(l->indirect);
	free(l->paths);
}

static void expect_same(const look *a, const look *b, const char *what)
{
	const uint32_t leaves = a->rows.leaf_count;
	snapshot_expect_same_rows(&a->rows, &b->rows, what);
	if (snapshot_hash_radiosity(&a->rows) != snapshot_hash_radiosity(&b->rows))
		fail_msg("%s: B is another", what);
	if (memcmp(a->indirect, b->indirect, leaves * 4 * sizeof *a->indirect) != 0)
		fail_msg("%s: indirect light is another", what);
	if (memcmp(a->paths, b->paths, leaves * 3 * sizeof *a->paths) != 0)
		fail_msg("%s: paths find other light", what);
}

/* ---- setters ---- */

typedef enum price { A_SOLVE, EVERY_ROW, A_COMMIT } price;

typedef struct setting {
	const char *what;
	void (*change)(gi_context_def *def);
	price price;
} setting;

static void another_colour(gi_context_def *def)
{
	def->sky_exitance[0] = 1;
	def->sky_exitance[2] = 5;
}

static void a_black_sky(gi_context_def *def)
{
	memset(def->sky_exitance, 0, sizeof def->sky_exitance);
}

static void no_sky(gi_context_def *def)
{
	def->sky = GI_SKY_OFF;
}

static void finer_rows(gi_context_def *def)
{
	def->row_tolerance = .004f;
	def->emitter_refinement = 4;
	def->near_samples = 8;
	def->emitter_samples = 12;
}

static void coarser_rows(gi_context_def *def)
{
	def->row_tolerance = .1f;
}

static void no_pixel_lamps(gi_context_def *def)
{
	def->pixel_lamps = 0;
}

static void set_all(gi_context *gi, const gi_context_def *d)
{
	assert_gi(gi_set_solve(gi, d->solve_tolerance, d->max_sweeps));
	assert_gi(gi_set_sky(gi, d->sky, d->sky_exitance));
	assert_gi(gi_set_rows(gi, d->row_tolerance, d->emitter_refinement, d->emitter_samples, d->near_samples));
	assert_gi(gi_set_pixel_lamps(gi, d->pixel_lamps));
	assert_gi(gi_set_estimate_leaves(gi, d->estimate_leaves));
}

static void expect_settings(const gi_context *gi, const gi_context_def *wanted)
{
	gi_context_def def;
	assert_gi(gi_get_context_def(gi, &def));
	assert_true(def.sky == wanted->sky && def.pixel_lamps == wanted->pixel_lamps);
	assert_memory_equal(def.sky_exitance, wanted->sky_exitance, sizeof def.sky_exitance);
	assert_true(def.row_tolerance == wanted->row_tolerance && def.emitter_refinement == wanted->emitter_refinement);
	assert_true(def.near_samples == wanted->near_samples && def.emitter_samples == wanted->emitter_samples);
	assert_true(def.solve_tolerance == wanted->solve_tolerance && def.max_sweeps == wanted->max_sweeps);
	assert_true(def.estimate_leaves == wanted->estimate_leaves);
}

static void expect_price(const gi_report *r, const setting *s)
{
	printf("  %s: %llu rows, %llu rays, %u sweeps\n", s->what, (unsigned long long)r->dirty_rows,
	       (unsigned long long)r->rays, r->sweeps);
	assert_true(r->sweeps > 0 && r->outcome == GI_OUTCOME_CONVERGED);
	if (s->price == A_SOLVE)
		assert_true(r->rays == 0 && r->new_entries == 0 && r->dirty_rows == 0);
	else
		assert_true(r->rays > 0 && r->dirty_rows == r->leaves);
}

/* From the settings of before to those, and back. */
static void change(loaded *l, const setting *s, const gi_context_def *to)
{
	set_all(l->gi, to);
	expect_settings(l->gi, to);
	if (s->price == A_COMMIT)
		assert_gi(gi_commit(l->gi));
	gi_reset_radiosity(l->gi); /* bits of B depend on where a solve begins */
	const gi_report r = harness_update(l->gi);
	expect_price(&r, s);
	look set = look_at(l->gi);
	loaded other = load(to);
	harness_update(other.gi);
	look created = look_at(other.gi);
	expect_same(&created, &set, s->what);
	free_look(&set);
	free_look(&created);
	gi_context_destroy(other.gi);
}

static void as_created(void **state)
{
	(void)state;
	static const setting settings[] = {
	    {"another colour of the sky", another_colour, A_SOLVE},
	    {"a black sky", a_black_sky, EVERY_ROW},
	    {"no sky", no_sky, A_COMMIT},
	    {"finer rows", finer_rows, EVERY_ROW},
	    {"coarser rows", coarser_rows, EVERY_ROW},
	    {"no pixel lamps", no_pixel_lamps, A_SOLVE},
	};
	const gi_context_def def = def_of_test();
	for (size_t k = 0; k < sizeof settings / sizeof *settings; k++) {
		loaded l = load(&def);
		harness_update(l.gi);
		gi_context_def to = def;
		settings[k].change(&to);
		change(&l, &settings[k], &to);
		change(&l, &settings[k], &def);
		/* The same once more is nothing. */
		set_all(l.gi, &def);
		assert_int_equal(harness_update(l.gi).outcome, GI_OUTCOME_AT_REST);
		gi_context_destroy(l.gi);
	}
}

/* Before the first commit too. */
static void before_a_scene(void **state)
{
	(void)state;
	gi_context_def def = def_of_test(), to = def;
	another_colour(&to);
	finer_rows(&to);
	no_pixel_lamps(&to);
	gi_context *gi = harness_context(&def);
	set_all(gi, &to);
	expect_settings(gi, &to);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	set_all(gi, &def);
	harness_update(gi);
	gi_context_destroy(gi);
}

/* ---- with what else happens ---- */

/* Until the next update the light is the old one; rows that wait for a budget get what they missed. */
static void between_updates(void **state)
{
	(void)state;
	const gi_context_def def = def_of_test();
	gi_context_def to = def;
	another_colour(&to);
	loaded l = load(&def), other = load(&to);
	harness_update(l.gi);
	look before = look_at(l.gi);
	set_all(l.gi, &to);
	look still = look_at(l.gi);
	expect_same(&before, &still, "a sky that no update saw");
	const gi_pose pose = {{-.2f, .5f, .1f}, {0, 0, 0, 1}};
	assert_gi(gi_set_pose(l.gi, l.ball, pose));
	assert_gi(gi_update(l.gi, &(gi_budget){.rays = 100}));
	assert_gi(gi_finish(l.gi));
	gi_report r;
	assert_gi(gi_get_report(l.gi, &r));
	assert_true(r.waiting_rows > 0);
	set_all(l.gi, &def);
	assert_gi(gi_update(l.gi, &(gi_budget){.rays = 100}));
	set_all(l.gi, &to);
	gi_reset_radiosity(l.gi);
	harness_update(l.gi);
	assert_gi(gi_set_pose(other.gi, other.ball, pose));
	harness_update(other.gi);
	gi_invalidate(other.gi);
	gi_reset_radiosity(other.gi);
	harness_update(other.gi);
	look set = look_at(l.gi), created = look_at(other.gi);
	expect_same(&created, &set, "a sky that changed while rows waited");
	free_look(&before);
	free_look(&still);
	free_look(&set);
	free_look(&created);
	gi_context_destroy(l.gi);
	gi_context_destroy(other.gi);
}

static void estimates(void **state)
{
	(void)state;
	const gi_context_def def = def_of_test();
	loaded l = load(&def);
	assert_true(harness_update(l.gi).sampling_rays == 0);
	static const uint32_t leaves[] = {32, 300, 16, 0};
	for (size_t k = 0; k < sizeof leaves / sizeof *leaves; k++) {
		assert_gi(gi_set_estimate_leaves(l.gi, leaves[k]));
		gi_invalidate(l.gi);
		const gi_report r = harness_update(l.gi);
		assert_true((r.sampling_rays > 0) == (leaves[k] > 0));
		assert_true(r.sampling_rays <= (uint64_t)512 * leaves[k]);
		assert_true(r.sampling_rays >= (uint64_t)256 * leaves[k]);
		assert_true((r.sampling_local_squared != 0) == (leaves[k] > 0));
	}
	gi_context_destroy(l.gi);
}

/* ---- what is refused ---- */

static void refused(void **state)
{
	(void)state;
	const gi_context_def def = def_of_test();
	gi_context *gi = harness_context(&def);
	const float sky[3] = {1, 1, 1};
	const struct {
		gi_result result;
		const char *names;
	} calls[] = {
	    {gi_set_sky(gi, (gi_sky)7, sky), "sky"},
	    {gi_set_sky(gi, GI_SKY_ON, (float[]){1, NAN, 1}), "sky_exitance"},
	    {gi_set_sky(gi, GI_SKY_ON, (float[]){1, 1, -1}), "sky_exitance"},
	    {gi_set_sky(gi, GI_SKY_ON, NULL), "exitance"},
	    {gi_set_rows(gi, 0, 20, 16, 4), "row_tolerance"},
	    {gi_set_rows(gi, NAN, 20, 16, 4), "row_tolerance"},
	    {gi_set_rows(gi, .1f, .5f, 16, 4), "emitter_refinement"},
	    {gi_set_rows(gi, .1f, 20, 17, 4), "emitter_samples"},
	    {gi_set_rows(gi, .1f, 20, 16, 0), "near_samples"},
	    {gi_set_pixel_lamps(gi, 33), "pixel_lamps"},
	    {gi_set_estimate_leaves(gi, 65537), "estimate_leaves"},
	    {gi_set_sky(NULL, GI_SKY_ON, sky), "context"},
	    {gi_set_rows(NULL, .1f, 20, 16, 4), "context"},
	    {gi_set_pixel_lamps(NULL, 1), "context"},
	    {gi_set_estimate_leaves(NULL, 1), "context"},
	};
	for (size_t k = 0; k < sizeof calls / sizeof *calls; k++)
		if (calls[k].result != GI_ERROR_INVALID_ARGUMENT)
			fail_msg("call %zu, about %s: %s", k, calls[k].names, gi_result_text(calls[k].result));
	expect_settings(gi, &def);
	gi_context_destroy(gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(as_created), cmocka_unit_test(before_a_scene), cmocka_unit_test(between_updates),
	    cmocka_unit_test(estimates),  cmocka_unit_test(refused),
	};
	return cmocka_run_group_tests_name("settings", tests, harness_open, harness_close);
}
