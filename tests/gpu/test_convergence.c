/* The solve on the moving Buddha: every frame meets the tolerance, warm starts save sweeps, the certified bound holds,
 * rest is free.
 *
 * The truth of a frame is the double-precision solution of the very links the library solved (exact_rows.h): what is
 * tested here is the solve alone, not the rows.
 */
#include "exact_rows.h"

#include "scenes/cornell.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { FRAMES = 40 };

static const float FRAME_SECONDS = 1.0f / 30;

static gi_context_def coarse_def(void)
{
	gi_context_def def = harness_def();
	def.row_tolerance = 0.05f;
	def.profile = false;
	return def;
}

static gi_context *open_box(const gi_context_def *def, cornell *made)
{
	gi_context *gi = harness_context(def);
	cornell_def box = cornell_def_default();
	box.wall_faces = box.wall_levels = 2;
	assert_gi(cornell_create(gi, &box, made));
	assert_gi(gi_commit(gi));
	return gi;
}

/* The frame's B against the truth, with nothing on top of the bound; returns bound over true distance. */
static double expect_certified(gi_context *gi, const gi_report *r, const char *what, uint32_t frame)
{
	snapshot s = snapshot_take(gi);
	const double bound = (double)r->solve_bound;
	const double distance = exact_distance(&s, r, (float[3]){0}, bound);
	if (!(distance <= bound))
		fail_msg("%s, frame %u: B is %.4g from the solution, and the certified bound says %.4g", what, frame,
			 distance, bound);
	assert_float_equal(r->radiosity_max, snapshot_largest(&s), 0);
	snapshot_free(&s);
	return bound / fmax(distance, 1e-30);
}

/* ---- tests ---- */

static void expect_converged(const gi_report *r, const gi_context_def *def)
{
	assert_int_equal(r->outcome, GI_OUTCOME_CONVERGED);
	assert_true(r->solve_relative <= def->solve_tolerance);
	assert_true(r->contraction > 0 && r->contraction < 1);
	/* The report's own formula and what rounding does to a sum of at most 1,000 links in single precision. */
	const double amplified = (double)r->residual * ((double)r->amplification - 1);
	assert_true((double)r->solve_bound <= (amplified + 6e-5 * (double)r->radiosity_max) * (1 + 1e-5));
	assert_true(r->amplification >= 1 && (double)r->amplification <= (1 + 1e-5) / (1 - (double)r->contraction));
	assert_true(r->rounding_bound <= r->solve_bound);
	assert_true(r->sweeps <= 25);
}

static int order_doubles(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return x < y ? -1 : x > y;
}

static void moving_buddha(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	cornell in_warm, in_cold;
	gi_context *warm = open_box(&def, &in_warm), *cold = open_box(&def, &in_cold);
	double ratios[2 * FRAMES];
	uint32_t warm_sum = 0, cold_sum = 0;
	printf("  sweeps of warm / cold starts:");
	for (uint32_t frame = 0; frame <= FRAMES; frame++) {
		const gi_pose pose = cornell_buddha_pose((float)frame * FRAME_SECONDS);
		assert_gi(gi_set_pose(warm, in_warm.buddha, pose));
		assert_gi(gi_set_pose(cold, in_cold.buddha, pose));
		gi_reset_radiosity(cold);
		const gi_report a = harness_update(warm), b = harness_update(cold);
		if (frame == 0)
			continue; /* both cold, or solved twice because the pools grew */
		expect_converged(&a, &def);
		expect_converged(&b, &def);
		printf(" %u/%u", a.sweeps, b.sweeps);
		assert_true(a.sweeps <= b.sweeps); /* warm light that is refused costs what a cold start does */
		warm_sum += a.sweeps;
		cold_sum += b.sweeps;
		ratios[2 * frame - 2] = expect_certified(warm, &a, "warm", frame);
		ratios[2 * frame - 1] = expect_certified(cold, &b, "cold", frame);
	}
	qsort(ratios, 2 * FRAMES, sizeof *ratios, order_doubles);
	printf("\n  in sum %u / %u; bound over true distance: median %.1f, least %.2f\n", warm_sum, cold_sum,
	       ratios[FRAMES], ratios[0]);
	gi_context_destroy(warm);
	gi_context_destroy(cold);
}

static void expect_no_work(const gi_report *r)
{
	assert_int_equal(r->outcome, GI_OUTCOME_AT_REST);
	assert_int_equal(r->dispatches, 0);
	assert_int_equal(r->uploaded_bytes, 0);
	assert_int_equal(r->sweeps, 0);
	assert_int_equal(r->dirty_entries + r->new_entries + r->flagged_entries + r->dirty_rows + r->rays, 0);
}

/* Converged and nothing set, or set to what it was: no work; and the rest of the report stays. */
static void rest_costs_nothing(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	cornell made;
	gi_context *gi = open_box(&def, &made);
	const gi_report busy = harness_update(gi);
	assert_int_equal(busy.outcome, GI_OUTCOME_CONVERGED);
	assert_true(busy.dispatches > 0 && busy.uploaded_bytes > 0);
	for (uint64_t frame = 2; frame < 6; frame++) {
		gi_pose pose;
		assert_gi(gi_get_pose(gi, made.buddha, &pose));
		assert_gi(gi_set_pose(gi, made.buddha, pose));
		const gi_report r = harness_update(gi);
		expect_no_work(&r);
		assert_int_equal(r.frame, frame);
		assert_int_equal(r.entries, busy.entries);
		assert_int_equal(r.links, busy.links);
		assert_float_equal(r.solve_bound, busy.solve_bound, 0);
	}
	assert_gi(gi_set_pose(gi, made.buddha, cornell_buddha_pose(1)));
	const gi_report moved = harness_update(gi);
	assert_int_equal(moved.outcome, GI_OUTCOME_CONVERGED);
	assert_true(moved.new_entries > 0 && moved.new_entries < moved.entries);
	const gi_report rest = harness_update(gi);
	expect_no_work(&rest);
	gi_context_destroy(gi);
}

/* One sweep a frame: the solve goes on over frames in which nothing moves, and works on nothing but B, until it is at
 * rest. */
static void budget_of_one_sweep(void **state)
{
	(void)state;
	gi_context_def def = coarse_def();
	cornell made;
	def.max_sweeps = 1;
	gi_context *gi = open_box(&def, &made);
	gi_report r = harness_update(gi);
	assert_int_equal(r.outcome, GI_OUTCOME_SWEEPS);
	expect_certified(gi, &r, "one sweep", 1);
	uint32_t frame = 1;
	float bound = r.solve_bound;
	do {
		r = harness_update(gi);
		frame++;
		assert_int_equal(r.frame, frame);
		if (r.outcome == GI_OUTCOME_AT_REST)
			break;
		assert_true(r.outcome == GI_OUTCOME_SWEEPS || r.outcome == GI_OUTCOME_CONVERGED);
		assert_int_equal(r.sweeps, 1);
		assert_int_equal(r.dirty_entries + r.dirty_rows + r.rays, 0);
		assert_true(r.solve_bound < bound);
		bound = r.solve_bound;
		if (frame % 8 == 0)
			expect_certified(gi, &r, "one sweep", frame);
	} while (frame < 200);
	printf("  one sweep a frame: at rest in frame %u\n", frame);
	expect_no_work(&r);
	assert_true(bound <= def.solve_tolerance * r.radiosity_max);
	gi_context_destroy(gi);
}

/* A tolerance that single precision cannot meet: the GPU sees it and says so in the very frame, with the bound it has
 * and how much of that is rounding; the next frame is at rest, and wakes up when something moves. */
static void rounding_floor(void **state)
{
	(void)state;
	gi_context_def def = coarse_def();
	def.solve_tolerance = 1e-7f;
	def.max_sweeps = 1000;
	gi_context *gi = harness_context(&def);
	engine_mesh mesh;
	const harness_object like = {.name = "furnace", .levels = 2, .rho = {.99f, .985f, .98f}, .exitance = {1, 2, 3}};
	assert_true(shape_box((float[]){0, 0, 0}, (float[]){2, 1, 3}, 1, true, &mesh));
	harness_add(gi, &like, &mesh);
	assert_true(shape_sphere(.2f, 2, &mesh));
	const gi_object ball = harness_add(gi, &like, &mesh);
	float worst = 0;
	uint32_t sweeps = 0;
	for (int k = 0; k < 8; k++) {
		assert_gi(gi_set_pose(gi, ball, (gi_pose){{1, .5f, 1 + .1f * (float)k}, {0, 0, 0, 1}}));
		if (k == 0)
			assert_gi(gi_commit(gi));
		const gi_report r = harness_update(gi);
		assert_int_equal(r.outcome, GI_OUTCOME_ROUNDING);
		assert_true(r.solve_relative > def.solve_tolerance);
		/* Half a unit in the last place, 2^-24, and the doubts of a row, as much, times 1 / (1 - q); twice the
		 * floor is where the solve may end, and of the light reflected, 0.98 of it, the bound knows 1.1 times.
		 */
		assert_true(r.solve_bound / r.radiosity_max < 4 * 6e-8f * 100);
		assert_true(r.solve_relative < 1.15f * 4 * 6e-8f * 100);
		assert_true(r.rounding_bound >= .3f * r.solve_bound);
		expect_certified(gi, &r, "at rounding", (uint32_t)k);
		const gi_report rest = harness_update(gi);
		expect_no_work(&rest);
		worst = r.solve_relative > worst ? r.solve_relative : worst;
		sweeps += r.sweeps;
	}
	printf("  tolerance 1e-7 at q 0.99: 8 solves ended at rounding after %u sweeps, bound at most %.1e\n", sweeps,
	       (double)worst);
	gi_context_destroy(gi);
}

/* gi_finish makes the report be about the last gi_update, however many came before. */
static void finish_reports_the_last_frame(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	cornell made;
	gi_context *gi = open_box(&def, &made);
	gi_report r;
	for (uint64_t frame = 1; frame <= 9; frame++) {
		assert_gi(gi_set_pose(gi, made.buddha, cornell_buddha_pose((float)frame * FRAME_SECONDS)));
		assert_gi(gi_update(gi, NULL));
		if (frame % 3)
			continue;
		assert_gi(gi_finish(gi));
		assert_gi(gi_get_report(gi, &r));
		assert_int_equal(r.frame, frame);
		assert_int_equal(r.outcome, GI_OUTCOME_CONVERGED);
		assert_true(r.dispatches > 0);
	}
	gi_context_destroy(gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(moving_buddha),
	    cmocka_unit_test(rest_costs_nothing),
	    cmocka_unit_test(budget_of_one_sweep),
	    cmocka_unit_test(rounding_floor),
	    cmocka_unit_test(finish_reports_the_last_frame),
	};
	return cmocka_run_group_tests_name("convergence", tests, harness_open, harness_close);
}
