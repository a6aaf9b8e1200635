/* Scenes that reflect nearly everything: right answers, in a number of sweeps that grows with 1 / sqrt(1 - q), not with
 * 1 / (1 - q) as Jacobi's does.
 */
#include "exact_rows.h"

#include "scenes/body.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const float NO_SKY[3];

static gi_context *open_context(float tolerance, uint32_t max_sweeps)
{
	gi_context_def def = harness_def();
	def.row_tolerance = 0.0025f; /* nearly every leaf has every other in its row: rows are nearly symmetric */
	def.solve_tolerance = tolerance;
	def.max_sweeps = max_sweeps;
	def.sky = GI_SKY_AUTO;
	def.profile = false;
	return harness_context(&def);
}

/* As many frames as it takes, in each of them up to max_sweeps; the report has the sweeps of all. */
static gi_report solve(gi_context *gi)
{
	gi_report r = harness_update(gi);
	uint32_t sweeps = r.sweeps;
	for (int frame = 0; frame < 10 && r.outcome == GI_OUTCOME_SWEEPS; frame++) {
		r = harness_update(gi);
		sweeps += r.sweeps;
	}
	if (r.outcome != GI_OUTCOME_CONVERGED && r.outcome != GI_OUTCOME_ROUNDING)
		fail_msg("outcome %d after %u sweeps, bound %g of the largest B", r.outcome, sweeps,
			 (double)r.solve_relative);
	r.sweeps = sweeps;
	return r;
}

static gi_object add_box(gi_context *gi, const harness_object *like, const float lower[3], const float upper[3],
			 bool inward)
{
	engine_mesh mesh;
	assert_true(shape_box(lower, upper, 1, inward, &mesh));
	return harness_add(gi, like, &mesh);
}

static gi_object add_ball(gi_context *gi, const harness_object *like)
{
	engine_mesh mesh;
	assert_true(shape_sphere(.5f, 1, &mesh));
	return harness_add(gi, like, &mesh);
}

/* ---- furnaces ---- */

/* A room with a block and a ball, all alike: E = 1, B = E / (1 - rho). Returns the ball. */
static gi_object add_furnace(gi_context *gi, float rho)
{
	const harness_object like = {.name = "furnace", .levels = 2, .rho = {rho, rho, rho}, .exitance = {1, 1, 1}};
	add_box(gi, &like, (float[]){-2, 0, -2}, (float[]){2, 3, 2}, true);
	const gi_object block = add_box(gi, &like, (float[]){-.5f, -.5f, -.5f}, (float[]){.5f, .5f, .5f}, false);
	const gi_object ball = add_ball(gi, &like);
	assert_gi(gi_set_pose(gi, block, (gi_pose){{-1, .8f, -.5f}, {.1f, .3f, 0, .9f}}));
	assert_gi(gi_set_pose(gi, ball, (gi_pose){{1, 1.2f, .6f}, {0, 0, 0, 1}}));
	assert_gi(gi_commit(gi));
	return ball;
}

static double worst_of_furnace(const snapshot *s, float rho)
{
	double worst = 0;
	for (uint32_t k = 0; k < 3 * s->leaf_count; k++) {
		const double b = (double)s->leaves[k / 3].radiosity[k % 3];
		assert_true(isfinite(b));
		worst = fmax(worst, fabs(b * (1 - (double)rho) - 1));
	}
	return worst;
}

/* Rows are closed to 1 - 2.5e-7 on purpose, which takes 2.5e-7 / (1 - rho) off B: 2.5e-3 at 0.9999. */
static gi_report furnace_at(float rho, float tolerance, double allowed)
{
	gi_context *gi = open_context(tolerance, 1000);
	add_furnace(gi, rho);
	const gi_report r = solve(gi);
	snapshot s = snapshot_take(gi);
	const double worst = worst_of_furnace(&s, rho), bound = (double)r.solve_bound;
	const double distance = exact_distance(&s, &r, NO_SKY, bound);
	printf("  %8.4f %8.1e %10.0f %8u %8u %10s %10.1e %10.1e %10.1e\n", (double)rho, (double)tolerance,
	       1 / (1 - (double)r.contraction), r.jacobi_sweeps, r.sweeps,
	       r.method == GI_METHOD_CHEBYSHEV ? "Chebyshev" : "Jacobi", worst, distance / (double)r.radiosity_max,
	       (double)r.solve_relative);
	assert_true(worst <= allowed);
	assert_true(distance <= bound);
	snapshot_free(&s);
	gi_context_destroy(gi);
	return r;
}

static void furnaces(void **state)
{
	(void)state;
	puts("       rho     wanted  1/(1 - q)   Jacobi    taken     method  off E/(1-r)  off B*   certified");
	furnace_at(.9f, 1e-4f, 1e-3);
	furnace_at(.99f, 1e-4f, 1e-3);
	furnace_at(.999f, 1e-4f, 1e-3);
	furnace_at(.9999f, 1e-4f, 1e-2);
	/* The same tolerance, above what rounding leaves at all of them. */
	const gi_report two = furnace_at(.99f, 5e-3f, 1e-2), three = furnace_at(.999f, 5e-3f, 1e-2),
			four = furnace_at(.9999f, 5e-3f, 1e-2);
	assert_int_equal(two.outcome, GI_OUTCOME_CONVERGED);
	assert_int_equal(three.outcome, GI_OUTCOME_CONVERGED);
	assert_int_equal(four.outcome, GI_OUTCOME_CONVERGED);
	const double growth = (double)four.sweeps / two.sweeps, step = (double)three.sweeps / two.sweeps;
	printf("  1 - q a hundredth, sweeps times %.1f (Jacobi: %.0f); a tenth, times %.1f\n", growth,
	       (double)four.jacobi_sweeps / two.jacobi_sweeps, step);
	/* sqrt(100) and sqrt(10), and half as much again for the logarithm of what the amplification adds to do. */
	assert_true(growth < 15);
	assert_true(step < 5);
	/* Light that is the same everywhere: a start in flux balance has it but for the rows' sampling. */
	assert_true(four.sweeps <= 10);
	/* 1 - q comes out of rows that sum to 1 - 2.5e-7. */
	assert_true(1 - two.contraction > 80 * (1 - four.contraction));
}

/* ---- one bright wall ---- */

/* A closed room of six quads. */
static void add_walls(gi_context *gi, const float rho[6], const float exitance[6])
{
	static const float sides[6][3][3] = {
	    {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}}, {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}},
	    {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}},
	};
	for (int k = 0; k < 6; k++) {
		engine_mesh mesh;
		assert_true(shape_quad(sides[k][0], sides[k][1], sides[k][2], 1, 1, &mesh));
		harness_add(gi,
			    &(harness_object){.name = "wall",
					      .levels = 2,
					      .rho = {rho[k], rho[k], rho[k]},
					      .exitance = {exitance[k], exitance[k], exitance[k]}},
			    &mesh);
	}
	assert_gi(gi_commit(gi));
}

static void expect_exact(gi_context *gi, const gi_report *r, const char *what)
{
	snapshot s = snapshot_take(gi);
	const double bound = (double)r->solve_bound, distance = exact_distance(&s, r, NO_SKY, bound);
	printf("  %s: q %.6f, amplification %.1f, %u sweeps (Jacobi %u), bound %.1e of the largest B, %.1f times the "
	       "error\n",
	       what, (double)r->contraction, (double)r->amplification, r->sweeps, r->jacobi_sweeps,
	       (double)r->solve_relative, bound / distance);
	if (!(distance <= bound))
		fail_msg("%s: %g from the solution, bound %g", what, distance, bound);
	snapshot_free(&s);
}

/* By the row sums Jacobi would seem to need 100,000 sweeps, and the bound to be 10,000 times the residual: but light
 * leaves the bright wall only for dark ones. */
static void one_bright_wall(void **state)
{
	(void)state;
	gi_context *gi = open_context(1e-4f, 1000);
	add_walls(gi, (float[]){.3f, .3f, .3f, .3f, .3f, .9999f}, (float[]){0, 1, 0, 0, 0, 0});
	const gi_report r = solve(gi);
	expect_exact(gi, &r, "one wall of 0.9999 among 0.3");
	assert_int_equal(r.outcome, GI_OUTCOME_CONVERGED);
	assert_true(r.contraction > .999f && r.amplification < 5);
	assert_true(r.sweeps <= 20);
	gi_context_destroy(gi);
}

/* ---- two mirrors ---- */

/* Two squares face to face, a thousandth of their side apart: light is thrown from one to the other, so eigenvalues lie
 * next to -q as well as next to q. Once both emit, once one. */
static void facing_mirrors(void **state)
{
	(void)state;
	gi_context *gi = open_context(1e-4f, 1000);
	engine_mesh mesh;
	assert_true(shape_quad((float[]){0, 0, 0}, (float[]){0, 0, 1}, (float[]){1, 0, 0}, 1, 1, &mesh));
	const harness_object like = {.name = "mirror", .levels = 3, .rho = {.999f, .99f, .9f}, .exitance = {1, 2, 3}};
	harness_add(gi, &like, &mesh);
	assert_true(shape_quad((float[]){0, .001f, 0}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 1, 1, &mesh));
	const gi_object upper = harness_add(gi, &like, &mesh);
	assert_gi(gi_commit(gi));
	gi_report r = solve(gi);
	expect_exact(gi, &r, "two mirrors of 0.999, both lit");
	const gi_material dark = {.rho = {.999f, .999f, .999f}};
	assert_gi(gi_set_material(gi, upper, 0, dark));
	r = solve(gi);
	expect_exact(gi, &r, "one lit, from there");
	gi_reset_radiosity(gi);
	r = solve(gi);
	expect_exact(gi, &r, "one lit, cold");
	assert_int_equal(r.method, GI_METHOD_CHEBYSHEV);
	assert_true(2 * r.sweeps < r.jacobi_sweeps);
	const gi_report rest = harness_update(gi);
	assert_int_equal(rest.outcome, GI_OUTCOME_AT_REST);
	gi_context_destroy(gi);
}

/* ---- moving, and in small pieces ---- */

enum { MOVES = 5 };

static gi_pose ball_at(int k)
{
	return (gi_pose){{1, 1.2f, .6f - .05f * (float)k}, {0, 0, 0, 1}};
}

static void warm_starts(void **state)
{
	(void)state;
	uint32_t warm_sum = 0, cold_sum = 0;
	gi_context *warm = open_context(1e-3f, 1000), *cold = open_context(1e-3f, 1000);
	const gi_object in_warm = add_furnace(warm, .995f), in_cold = add_furnace(cold, .995f);
	for (int k = 0; k < MOVES; k++) {
		assert_gi(gi_set_pose(warm, in_warm, ball_at(k)));
		assert_gi(gi_set_pose(cold, in_cold, ball_at(k)));
		/* The furnace's B is the same wherever the ball is: so that there is something to do, its light
		 * changes. */
		const float e = 1 + .1f * (float)k;
		const gi_material like = {.rho = {.995f, .995f, .995f}, .exitance = {e, e, 1}};
		assert_gi(gi_set_material(warm, in_warm, 0, like));
		assert_gi(gi_set_material(cold, in_cold, 0, like));
		gi_reset_radiosity(cold);
		const gi_report a = solve(warm), b = solve(cold);
		if (k == 0)
			continue;
		printf("%s%u/%u", k == 1 ? "  rho 0.995, sweeps of warm / cold starts: " : " ", a.sweeps, b.sweeps);
		warm_sum += a.sweeps;
		cold_sum += b.sweeps;
	}
	putchar('\n');
	/* Light that is the same everywhere is what a cold start in flux balance begins with: warm can be as good. */
	assert_true(warm_sum <= cold_sum);
	gi_context_destroy(warm);
	gi_context_destroy(cold);
}

/* A few sweeps a frame: Chebyshev goes on where the last frame ended, every frame is certified, and it comes to rest in
 * hardly more sweeps than at one go. */
static void few_sweeps_a_frame(void **state)
{
	(void)state;
	gi_context *whole = open_context(1e-3f, 1000), *parts = open_context(1e-3f, 7);
	/* A ball much brighter than the rest: a multiple of v is not the light. */
	const gi_material bright = {.rho = {.998f, .998f, .998f}, .exitance = {300, 100, 1}};
	assert_gi(gi_set_material(whole, add_furnace(whole, .998f), 0, bright));
	assert_gi(gi_set_material(parts, add_furnace(parts, .998f), 0, bright));
	const gi_report at_once = solve(whole);
	uint32_t sweeps = 0, frames = 0;
	gi_report r;
	do {
		r = harness_update(parts);
		sweeps += r.sweeps;
		frames++;
		if (frames % 8 == 1) {
			snapshot s = snapshot_take(parts);
			assert_true(exact_distance(&s, &r, NO_SKY, (double)r.solve_bound) <= (double)r.solve_bound);
			snapshot_free(&s);
		}
	} while (r.outcome == GI_OUTCOME_SWEEPS && frames < 200);
	printf("  rho 0.998: %u sweeps at one go, %u in %u frames\n", at_once.sweeps, sweeps, frames);
	assert_int_equal(r.outcome, GI_OUTCOME_CONVERGED);
	assert_true(sweeps <= at_once.sweeps + at_once.sweeps / 4);
	gi_context_destroy(whole);
	gi_context_destroy(parts);
}

/* ---- nothing lost ---- */

static void all_reflected_is_refused(void **state)
{
	(void)state;
	gi_context *gi = open_context(1e-4f, 100);
	gi_material white = {.rho = {.5f, 1, .5f}};
	engine_mesh mesh;
	assert_true(shape_quad((float[]){0, 0, 0}, (float[]){0, 0, 1}, (float[]){1, 0, 0}, 1, 1, &mesh));
	gi_object_def def = scene_mesh_def(&mesh);
	def.materials = &white;
	def.material_count = 1;
	gi_object object;
	assert_int_equal(gi_create_object(gi, &def, &object), GI_ERROR_INVALID_MATERIAL);
	assert_non_null(strstr(harness_last_message(), "no finite solution"));
	white.rho[1] = .9999999f;
	assert_gi(gi_create_object(gi, &def, &object));
	white.rho[1] = 1;
	assert_int_equal(gi_set_material(gi, object, 0, white), GI_ERROR_INVALID_MATERIAL);
	assert_non_null(strstr(harness_last_message(), "no finite solution"));
	engine_mesh_free(&mesh);
	gi_context_destroy(gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(furnaces),           cmocka_unit_test(one_bright_wall),
	    cmocka_unit_test(facing_mirrors),     cmocka_unit_test(warm_starts),
	    cmocka_unit_test(few_sweeps_a_frame), cmocka_unit_test(all_reflected_is_refused),
	};
	return cmocka_run_group_tests_name("stiff", tests, harness_open, harness_close);
}
