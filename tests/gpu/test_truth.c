/* Form factors and radiosity against closed forms (Howell's catalogue), through the whole pipeline: cage, hierarchy,
 * cut, factor, rays, closing, links.
 */
#include "harness.h"

#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What is asked of form factors between objects; the row tolerance it is reached at stands in each test. */
static const double HALF_PER_CENT = 0.005;

static void expect_near(const char *what, double value, double truth, double relative)
{
	printf("  %-48s %.9f  truth %.9f  error %+.4f %%\n", what, value, truth, 100 * (value - truth) / truth);
	if (!(fabs(value - truth) <= relative * fabs(truth)))
		fail_msg("%s: %.9f is not %.9f within %g", what, value, truth, relative);
}

static gi_object add_square(gi_context *gi, const char *name, const float corner[3], const float u[3], const float v[3],
			    uint32_t levels)
{
	engine_mesh mesh;
	assert_true(shape_quad(corner, u, v, 1, 1, &mesh));
	return harness_add(gi, &(harness_object){.name = name, .levels = levels, .rho = {.5f, .5f, .5f}}, &mesh);
}

static double factor(gi_context *gi, gi_object a, gi_object b)
{
	double f;
	assert_gi(gi_form_factor(gi, a, b, &f));
	return f;
}

static gi_context *open_context(float row_tolerance)
{
	gi_context_def def = harness_def();
	def.row_tolerance = row_tolerance;
	def.near_samples = 16;
	return harness_context(&def);
}

/* Rectangles a x b a gap of 1 apart, facing each other. */
static void parallel_case(const char *name, float a, float b, double truth)
{
	gi_context *gi = open_context(0.002f);
	const gi_object low = add_square(gi, "low", (float[]){0, 0, 0}, (float[]){0, 0, b}, (float[]){a, 0, 0}, 4);
	const gi_object high = add_square(gi, "high", (float[]){0, 1, 0}, (float[]){a, 0, 0}, (float[]){0, 0, b}, 4);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	expect_near(name, factor(gi, low, high), truth, HALF_PER_CENT);
	gi_context_destroy(gi);
}

static void parallel_rectangles(void **state)
{
	(void)state;
	parallel_case("C-11 1 x 1", 1, 1, 0.199824895698);
	parallel_case("C-11 4 x 2", 4, 2, 0.508988669041);
	parallel_case("C-11 10 x 10", 10, 10, 0.826994522397);
}

/* w deep from a common edge of length 1, h high. */
static void perpendicular_case(const char *name, float w, float h, double truth)
{
	gi_context *gi = open_context(0.002f);
	const gi_object floor = add_square(gi, "floor", (float[]){0, 0, 0}, (float[]){0, 0, 1}, (float[]){w, 0, 0}, 4);
	const gi_object wall = add_square(gi, "wall", (float[]){0, 0, 0}, (float[]){0, h, 0}, (float[]){0, 0, 1}, 4);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	expect_near(name, factor(gi, floor, wall), truth, HALF_PER_CENT);
	gi_context_destroy(gi);
}

static void perpendicular_rectangles(void **state)
{
	(void)state;
	perpendicular_case("C-14 1 x 1", 1, 1, 0.200043776075);
	perpendicular_case("C-14 h 2, w 1", 1, 2, 0.232852602795);
}

static void occluded_squares(void **state)
{
	(void)state;
	gi_context *gi = open_context(0.001f);
	const gi_object low = add_square(gi, "low", (float[]){0, 0, 0}, (float[]){0, 0, 1}, (float[]){1, 0, 0}, 4);
	const gi_object high = add_square(gi, "high", (float[]){0, 1, 0}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 4);
	add_square(gi, "occluder", (float[]){0, .5f, 0}, (float[]){0, 0, .5f}, (float[]){.5f, 0, 0}, 0);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	expect_near("a corner quarter in between", factor(gi, low, high), 0.149868671774, HALF_PER_CENT);
	expect_near("the same, reversed", factor(gi, high, low), 0.149868671774, HALF_PER_CENT);
	gi_context_destroy(gi);
}

static void discs(void **state)
{
	(void)state;
	gi_context *gi = open_context(0.002f);
	engine_mesh mesh;
	assert_true(shape_disc(1, 16, &mesh));
	const gi_object low = harness_add(gi, &(harness_object){.name = "low", .rho = {.5f, .5f, .5f}}, &mesh);
	assert_true(shape_disc(1, 16, &mesh));
	for (uint32_t k = 0; k < mesh.vertex_count; k++) { /* turned about x to face down */
		mesh.positions[3 * k + 1] *= -1;
		mesh.positions[3 * k + 2] *= -1;
	}
	const gi_object high =
	    harness_add(gi, &(harness_object){.name = "high", .rho = {.5f, .5f, .5f}, .position = {0, 1, 0}}, &mesh);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	expect_near("C-41 r 1, r 1, gap 1", factor(gi, low, high), 0.381966011250, HALF_PER_CENT);
	gi_context_destroy(gi);
}

/* Inscribed quads are smaller than their sphere; as large as it they see of each other what spheres do. */
static void scale_to_area(engine_mesh *mesh, double area)
{
	double sum = 0;
	for (uint32_t f = 0; f < mesh->face_count; f++) {
		const float *p[4];
		for (int k = 0; k < 4; k++)
			p[k] = mesh->positions + 3 * mesh->indices[4 * f + (uint32_t)k];
		for (int t = 0; t < 2; t++) {
			double a[3], b[3];
			for (int c = 0; c < 3; c++) {
				a[c] = p[t + 1][c] - p[0][c];
				b[c] = p[t + 2][c] - p[0][c];
			}
			const double n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
					     a[0] * b[1] - a[1] * b[0]};
			sum += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
		}
	}
	for (uint32_t k = 0; k < 3 * mesh->vertex_count; k++)
		mesh->positions[k] *= (float)sqrt(area / sum);
}

static void spheres(void **state)
{
	(void)state;
	gi_context *gi = open_context(0.0001f);
	gi_object object[2];
	for (int k = 0; k < 2; k++) {
		engine_mesh mesh;
		assert_true(shape_sphere(1, 16, &mesh));
		scale_to_area(&mesh, 4 * 3.14159265358979);
		object[k] = harness_add(
		    gi,
		    &(harness_object){.name = "sphere", .rho = {.5f, .5f, .5f}, .position = {3.0f * (float)k, 0, 0}},
		    &mesh);
	}
	assert_gi(gi_commit(gi));
	harness_update(gi);
	expect_near("spheres r 1, r 1, centres 3 apart", factor(gi, object[0], object[1]), 0.02959031, HALF_PER_CENT);
	gi_context_destroy(gi);
}

static void one_leaf_cube(void **state)
{
	(void)state;
	gi_context_def def = harness_def();
	def.row_tolerance = 0.002f;
	def.solve_tolerance = 1e-4f;
	gi_context *gi = harness_context(&def);
	const float rho = .5f;
	const float corners[6][3][3] = {
	    {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}}, /* floor, facing up */
	    {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
	    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}},
	};
	for (int k = 0; k < 6; k++) {
		engine_mesh mesh;
		assert_true(shape_quad(corners[k][0], corners[k][1], corners[k][2], 1, 1, &mesh));
		const float e = k == 0 ? 1.0f : 0.0f;
		harness_add(gi, &(harness_object){.name = "side", .rho = {rho, rho, rho}, .exitance = {e, e, e}},
			    &mesh);
	}
	assert_gi(gi_commit(gi));
	harness_update(gi);
	gi_leaf leaves[6];
	uint32_t count;
	assert_gi(gi_read_leaves(gi, leaves, 6, &count));
	assert_int_equal(count, 6);
	expect_near("unit cube: floor", leaves[0].radiosity[0], 1.0909090981, HALF_PER_CENT);
	expect_near("unit cube: ceiling", leaves[1].radiosity[0], 0.1817458261, HALF_PER_CENT);
	for (int k = 2; k < 6; k++)
		expect_near("unit cube: wall", leaves[k].radiosity[0], 0.1818362689, HALF_PER_CENT);
	gi_context_destroy(gi);
}

static void one_leaf_pair(void **state)
{
	(void)state;
	gi_context *gi = open_context(0.002f);
	for (int k = 0; k < 2; k++) {
		engine_mesh mesh;
		const float corner[3] = {0, (float)k, 0}, a[3] = {1, 0, 0}, b[3] = {0, 0, 1};
		assert_true(shape_quad(corner, k ? a : b, k ? b : a, 1, 1, &mesh));
		const float e = k == 0 ? 1.0f : 0.0f;
		harness_add(gi, &(harness_object){.name = "side", .rho = {.5f, .5f, .5f}, .exitance = {e, e, e}},
			    &mesh);
	}
	assert_gi(gi_commit(gi));
	harness_update(gi);
	gi_leaf leaves[2];
	uint32_t count;
	assert_gi(gi_read_leaves(gi, leaves, 2, &count));
	expect_near("two squares: B1", leaves[0].radiosity[0], 1.0100831523, HALF_PER_CENT);
	expect_near("two squares: B2", leaves[1].radiosity[0], 0.1009198803, HALF_PER_CENT);
	gi_context_destroy(gi);
}

/* A closed room with everything alike has B = E / (1 - rho) on every leaf, whatever stands in it. */
static void furnace_case(float rho, bool block)
{
	gi_context_def def = harness_def();
	def.solve_tolerance = 1e-4f;
	def.max_sweeps = 1000;
	gi_context *gi = harness_context(&def);
	engine_mesh mesh;
	const harness_object body = {.name = "furnace", .levels = 3, .rho = {rho, rho, rho}, .exitance = {1, 1, 1}};
	assert_true(shape_box((float[]){0, 0, 0}, (float[]){2, 1, 3}, 1, true, &mesh));
	harness_add(gi, &body, &mesh);
	if (block) {
		assert_true(shape_sphere(.3f, 4, &mesh));
		harness_object ball = body;
		ball.levels = 1;
		ball.scheme = GI_SCHEME_CATMULL_CLARK;
		memcpy(ball.position, (float[]){1.1f, .5f, 1.2f}, sizeof ball.position);
		harness_add(gi, &ball, &mesh);
	}
	assert_gi(gi_commit(gi));
	const gi_report report = harness_update(gi);
	static gi_leaf leaves[4096];
	uint32_t count;
	assert_gi(gi_read_leaves(gi, leaves, 4096, &count));
	double worst = 0, sum_low = 1, sum_high = 0;
	for (uint32_t k = 0; k < count; k++) {
		worst = fmax(worst, fabs(leaves[k].radiosity[1] * (1 - rho) - 1));
		sum_low = fmin(sum_low, leaves[k].row_sum);
		sum_high = fmax(sum_high, leaves[k].row_sum);
	}
	printf("  furnace rho %.3f %s: worst leaf %.2e off, row sums %.7f .. %.7f, q %.6f, %u sweeps\n", (double)rho,
	       block ? "with a ball" : "empty      ", worst, sum_low, sum_high, (double)report.contraction,
	       report.sweeps);
	assert_true(worst <= 1e-4);
	assert_true(sum_high <= 1.0);
	gi_context_destroy(gi);
}

static void furnace(void **state)
{
	(void)state;
	furnace_case(.5f, false);
	furnace_case(.5f, true);
	furnace_case(.9f, true);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(parallel_rectangles),
	    cmocka_unit_test(perpendicular_rectangles),
	    cmocka_unit_test(occluded_squares),
	    cmocka_unit_test(discs),
	    cmocka_unit_test(spheres),
	    cmocka_unit_test(one_leaf_cube),
	    cmocka_unit_test(one_leaf_pair),
	    cmocka_unit_test(furnace),
	};
	return cmocka_run_group_tests_name("truth", tests, harness_open, harness_close);
}
