/* What gi_context_def.solve_tolerance means. R = B - E is the light that a leaf reflects, R* what it reflects in the
 * solution of the rows. Where an update ended with GI_OUTCOME_CONVERGED, leaf by leaf and channel by channel
 *
 *     |R - R*| <= solve_tolerance * (R + max R / 100000),    max R over all leaves, of the same channel
 *
 * whatever lamps emit, however dark it is there, and whatever the light was before.
 */
#include "exact_rows.h"
#include "random_scene.h"

#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const float NO_SKY[3];
static const double DARK_SHARE = 1e-5;

/* B is stored rounded: half a unit in its last place is not the solve's. */
static const double HALF_ULP = 6e-8;

static double reflected(const snapshot *s, uint32_t k)
{
	return (double)s->leaves[k / 3].radiosity[k % 3] - (double)s->leaves[k / 3].exitance[k % 3];
}

/* Largest |B - B*| over R + max R / 100000. */
static double off_by(const snapshot *s, const double *solution)
{
	double most[3] = {0}, worst = 0;
	for (uint32_t k = 0; k < 3 * s->leaf_count; k++)
		most[k % 3] = fmax(most[k % 3], reflected(s, k));
	for (uint32_t k = 0; k < 3 * s->leaf_count; k++) {
		const double b = (double)s->leaves[k / 3].radiosity[k % 3],
			     light = reflected(s, k) + DARK_SHARE * most[k % 3];
		const double off = fmax(fabs(b - solution[k]) - HALF_ULP * b, 0);
		worst = fmax(worst, off > 0 ? off / light : 0);
	}
	return worst;
}

static gi_context *open_context(float tolerance, uint32_t max_sweeps)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .1f;
	def.max_sweeps = max_sweeps;
	def.solve_tolerance = tolerance > 0 ? tolerance : def.solve_tolerance;
	def.profile = false;
	return harness_context(&def);
}

/* Off by what, of the light reflected; fails where the update says less. */
static double measured(gi_context *gi, const gi_report *r, const char *what)
{
	snapshot s = snapshot_take(gi);
	reference_solution solution;
	exact_solution(&s, r, NO_SKY, &solution);
	const double off = off_by(&s, solution.radiosity);
	reference_solution_free(&solution);
	snapshot_free(&s);
	if (!(off <= (double)r->solve_relative))
		fail_msg("%s: off by %g of the light reflected, and the report says %g", what, off,
			 (double)r->solve_relative);
	return off;
}

/* ---- the definition ---- */

enum { SCENES = 30, MOVES = 3 };

static int order_doubles(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return x < y ? -1 : x > y;
}

static void relative_to_what_is_reflected(void **state)
{
	(void)state;
	static const float tolerances[] = {.3f, .03f, 1e-3f};
	for (size_t t = 0; t < sizeof tolerances / sizeof *tolerances; t++) {
		double ratios[SCENES * MOVES];
		int count = 0;
		gi_context *gi = open_context(tolerances[t], 1000);
		for (uint64_t seed = t; seed < SCENES; seed += 3) {
			random_scene scene = random_scene_make(gi, 1000 + seed);
			for (int k = 0; k < MOVES; k++, random_scene_move(gi, &scene)) {
				const gi_report r = harness_update(gi);
				if (r.outcome != GI_OUTCOME_CONVERGED)
					continue;
				assert_true(r.solve_relative <= tolerances[t]);
				const double off = measured(gi, &r, "a random scene");
				ratios[count++] = (double)r.solve_relative / fmax(off, 1e-12);
			}
			random_scene_clear(gi, &scene);
		}
		gi_context_destroy(gi);
		assert_true(count > SCENES / 2);
		qsort(ratios, (size_t)count, sizeof *ratios, order_doubles);
		printf("  tolerance %g: %d solves, certified over measured %.1f in the median, %.2f at least\n",
		       (double)tolerances[t], count, ratios[count / 2], ratios[0]);
	}
}

/* ---- a small bright lamp ---- */

enum { FRAMES = 6 };

typedef struct bulb_room {
	gi_context *gi;
	gi_object box;
} bulb_room;

/* A room of 6 m with a bulb of so many metres and 5,000 W/m2, and a box. */
static bulb_room open_bulb_room(float tolerance, float size, float rho)
{
	bulb_room r = {.gi = open_context(tolerance, 1000)};
	engine_mesh mesh;
	assert_true(shape_box((float[]){-3, 0, -3}, (float[]){3, 6, 3}, 1, true, &mesh));
	harness_add(r.gi, &(harness_object){.name = "room", .levels = 3, .rho = {rho, rho, .8f * rho}}, &mesh);
	const float h = size / 2;
	assert_true(shape_box((float[]){-h, -h, -h}, (float[]){h, h, h}, 1, false, &mesh));
	harness_add(
	    r.gi,
	    &(harness_object){
		.name = "bulb", .rho = {.5f, .5f, .5f}, .exitance = {5000, 5000, 4000}, .position = {.4f, 4.5f, -.3f}},
	    &mesh);
	assert_true(shape_box((float[]){-.5f, -.5f, -.5f}, (float[]){.5f, .5f, .5f}, 1, false, &mesh));
	r.box = harness_add(r.gi, &(harness_object){.name = "box", .levels = 2, .rho = {rho, .5f * rho, rho}}, &mesh);
	assert_gi(gi_commit(r.gi));
	return r;
}

static double mean_irradiance(const snapshot *s)
{
	double sum = 0, area = 0;
	for (uint32_t k = 0; k < s->leaf_count; k++) {
		sum += (double)s->leaves[k].area * (double)s->leaves[k].irradiance[0];
		area += (double)s->leaves[k].area;
	}
	return sum / area;
}

static void solution_of(const snapshot *s, double *out)
{
	for (uint32_t k = 0; k < 3 * s->leaf_count; k++)
		out[k] = (double)s->leaves[k / 3].radiosity[k % 3];
}

/* The box moves 1 mm a frame: every frame within the tolerance of a cold start to 1e-7, the single rounding of what is
 * read back aside. */
static void bulb(float size, float rho)
{
	bulb_room room = open_bulb_room(0, size, rho), cold = open_bulb_room(1e-7f, size, rho);
	const double tolerance = (double)gi_context_def_default().solve_tolerance;
	double worst = 0, first = 0, last = 0, cold_off = 0;
	uint32_t sweeps = 0, cold_sweeps = 0;
	for (int k = 0; k < FRAMES; k++) {
		const gi_pose pose = {{-1.2f + .001f * (float)k, .8f, .5f}, {0, .2f, 0, .98f}};
		assert_gi(gi_set_pose(room.gi, room.box, pose));
		assert_gi(gi_set_pose(cold.gi, cold.box, pose));
		gi_reset_radiosity(cold.gi);
		const gi_report r = harness_update(room.gi), exact = harness_update(cold.gi);
		assert_int_equal(r.outcome, GI_OUTCOME_CONVERGED);
		snapshot a = snapshot_take(room.gi), b = snapshot_take(cold.gi);
		double *light = calloc(3 * b.leaf_count + 1, sizeof *light);
		assert_non_null(light);
		solution_of(&b, light);
		worst = fmax(worst, off_by(&a, light) - (double)exact.solve_relative);
		cold_off = fmax(cold_off, measured(cold.gi, &exact, "a cold start to 1e-7"));
		measured(room.gi, &r, "a bulb");
		first = k ? first : mean_irradiance(&a);
		last = mean_irradiance(&a);
		sweeps += k ? r.sweeps : 0;
		cold_sweeps += exact.sweeps;
		free(light);
		snapshot_free(&a);
		snapshot_free(&b);
	}
	printf("  bulb of %2.0f mm, rho %g: mean H %.5g, after %d frames %.5g; off by at most %.1e of the light "
	       "reflected, a cold "
	       "start to 1e-7 by %.1e; %.1f sweeps a frame, cold %.1f\n",
	       1000 * (double)size, (double)rho, first, FRAMES, last, worst, cold_off, (double)sweeps / (FRAMES - 1),
	       (double)cold_sweeps / FRAMES);
	assert_true(worst <= tolerance);
	assert_true(cold_off <= 1e-4);
	gi_context_destroy(room.gi);
	gi_context_destroy(cold.gi);
}

static void small_bright_lamps(void **state)
{
	(void)state;
	static const float sizes[] = {.04f, .02f, .005f}, rhos[] = {.5f, .7f, .9f};
	for (int k = 0; k < 3; k++)
		for (int j = 0; j < 3; j++)
			bulb(sizes[k], rhos[j]);
}

/* ---- the dark end of a corridor ---- */

/* 16 m long, 2 m wide and high, a lamp at one end and screens that leave half a metre open on alternate sides: light
 * arrives at the other end after some reflections. */
static void add_corridor(gi_context *gi, const float rho[3])
{
	engine_mesh mesh;
	harness_object like = {.name = "corridor", .levels = 1, .rho = {rho[0], rho[1], rho[2]}};
	assert_true(shape_box((float[]){0, 0, 0}, (float[]){2, 2, 16}, 8, true, &mesh));
	harness_add(gi, &like, &mesh);
	like.levels = 2;
	like.name = "screen";
	for (int k = 0; k < 2; k++) {
		const float x = k % 2 ? .5f : 0, z = 5 + 6 * (float)k;
		assert_true(shape_box((float[]){x, 0, z}, (float[]){x + 1.5f, 2, z + .2f}, 1, false, &mesh));
		harness_add(gi, &like, &mesh);
	}
	assert_true(shape_quad((float[]){.5f, 1.9f, .5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 1, 1, &mesh));
	harness_add(gi, &(harness_object){.name = "lamp", .exitance = {500, 500, 500}}, &mesh);
	assert_gi(gi_commit(gi));
}

/* Light reflected in the last metre over what it is in the solution, the mean of the leaves' ratios and the least; and
 * how bright it is there, of the largest. */
static void dark_part(const snapshot *s, const double *solution, double *mean, double *least, double *bright)
{
	double most = 0, sum = 0, light = 0;
	uint32_t count = 0;
	*least = INFINITY;
	for (uint32_t k = 0; k < s->leaf_count; k++) {
		most = fmax(most, reflected(s, 3 * k));
		if (s->leaves[k].corners[0][2] < 15 || s->leaves[k].corners[2][2] < 15)
			continue;
		const double ratio = reflected(s, 3 * k) / solution[3 * k];
		sum += ratio;
		light += reflected(s, 3 * k);
		*least = fmin(*least, ratio);
		count++;
	}
	*mean = sum / count;
	*bright = light / count / most;
}

static void dark_end(void **state)
{
	(void)state;
	static const float rhos[2][3] = {{.5f, .4f, .3f}, {.8f, .7f, .6f}};
	for (int k = 0; k < 2; k++) {
		gi_context *gi = open_context(0, 1000);
		add_corridor(gi, rhos[k]);
		const gi_report r = harness_update(gi);
		assert_int_equal(r.outcome, GI_OUTCOME_CONVERGED);
		const double off = measured(gi, &r, "a corridor");
		snapshot s = snapshot_take(gi);
		reference_solution solution;
		exact_solution(&s, &r, NO_SKY, &solution);
		double mean, least, bright;
		dark_part(&s, solution.radiosity, &mean, &least, &bright);
		printf(
		    "  corridor, rho %g: %u sweeps, off by at most %.1e of the light reflected; its end, %.1e of the "
		    "largest: %.4f of the solution, %.4f at least\n",
		    (double)rhos[k][0], r.sweeps, off, bright, mean, least);
		assert_true(mean > .95 && least > .9);
		reference_solution_free(&solution);
		snapshot_free(&s);
		gi_context_destroy(gi);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(relative_to_what_is_reflected),
					   cmocka_unit_test(small_bright_lamps), cmocka_unit_test(dark_end)};
	return cmocka_run_group_tests_name("tolerance", tests, harness_open, harness_close);
}
