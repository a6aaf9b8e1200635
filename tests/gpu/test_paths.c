/* gi_trace_paths against the reference path tracer, closed forms, and itself.
 *
 * A comparison of noisy figures is made in their own standard error, which the leaves give: the differences of N
 * leaves, independent of each other, have a mean whose standard error is their deviation over sqrt(N).
 */
#include "harness.h"

#include "tests/reference/reference_error.h"
#include "tests/reference/leaves.h"
#include "scenes/cornell.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Standard errors: one of 50,000 fair runs is beyond, and seeds are fixed. */
static const double SIGMAS = 4.3;

typedef struct traced {
	uint32_t count;
	double *irradiance; /* 3 each */
} traced;

static void *allocate(size_t count, size_t size)
{
	void *data = calloc(count + 1, size);
	assert_non_null(data);
	return data;
}

static traced trace(gi_context *gi, uint32_t paths, uint32_t seed)
{
	gi_report report;
	assert_gi(gi_get_report(gi, &report));
	const gi_path_options o = {.paths = paths, .seed = seed};
	float *h = allocate(3 * report.leaves, sizeof *h);
	traced t = {0};
	if (gi_trace_paths(gi, &o, h, report.leaves, &t.count))
		fail_msg("gi_trace_paths: %s", harness_last_message());
	assert_int_equal(t.count, report.leaves);
	t.irradiance = allocate(3 * t.count, sizeof *t.irradiance);
	reference_widen(h, 3, t.count, t.irradiance);
	free(h);
	return t;
}

static gi_leaf *read_leaves(gi_context *gi, uint32_t *count)
{
	assert_gi(gi_read_leaves(gi, NULL, 0, count));
	gi_leaf *leaves = allocate(*count, sizeof *leaves);
	assert_gi(gi_read_leaves(gi, leaves, *count, count));
	return leaves;
}

/* Standard deviations that the mean of values is away from 0. */
static double sigmas_from_zero(const double *values, size_t count)
{
	double sum = 0, squares = 0;
	for (size_t k = 0; k < count; k++) {
		sum += values[k];
		squares += values[k] * values[k];
	}
	const double mean = sum / (double)count, variance = squares / (double)count - mean * mean;
	return fabs(mean) / sqrt(fmax(variance, 1e-300) / (double)count);
}

static void expect_below(const char *what, double value, double limit)
{
	if (!(value < limit))
		fail_msg("%s: %g is not below %g", what, value, limit);
}

/* ---- Cornell box ---- */

static gi_context *open_cornell(void)
{
	gi_context_def def = harness_def();
	def.row_tolerance = 0.2f; /* rows are not looked at */
	gi_context *gi = harness_context(&def);
	cornell_def box = cornell_def_default();
	box.wall_levels = 2;
	box.balls = false;
	cornell made;
	assert_gi(cornell_create(gi, &box, &made));
	assert_gi(gi_commit(gi));
	assert_gi(gi_set_pose(gi, made.buddha, cornell_buddha_pose(1.3f)));
	harness_update(gi);
	return gi;
}

/* Mean, over the leaves and by object, as the reference has it; the difference of the two is noise alone. */
static void agrees_with_the_reference(void **state)
{
	(void)state;
	gi_context *gi = open_cornell();
	uint32_t count;
	gi_leaf *leaves = read_leaves(gi, &count);
	leaf_scene scene;
	reference_result r;
	assert_true(leaf_scene_make(leaves, count, &scene));
	assert_true(reference_trace(&scene.scene, 256, 7, &r));
	const traced a = trace(gi, 64, 1), b = trace(gi, 64, 2);
	reference_error error;
	double *difference = allocate(count, sizeof *difference);
	uint32_t first = 0;
	for (uint32_t end = 1; end <= count; end++) {
		if (end < count && leaves[end].object.index1 == leaves[first].object.index1)
			continue;
		for (int c = 0; c < 3; c++) {
			for (uint32_t k = first; k < end; k++) {
				const size_t at = 3 * (size_t)k + (size_t)c;
				difference[k] = 0.5 * (a.irradiance[at] + b.irradiance[at]) -
						0.5 * (r.irradiance[0][at] + r.irradiance[1][at]);
			}
			expect_below("standard errors of an object's mean",
				     sigmas_from_zero(difference + first, end - first), SIGMAS);
		}
		first = end;
	}
	/* |H - R|^2 without both noises: what is left is the difference of expectations. 64 paths leave a noise of 5 %
	 * of a leaf's irradiance; products of two have a mean with a standard error of (0.05)^2 / sqrt(500), as large
	 * leaves count most and channels are alike. */
	assert_true(
	    reference_error_measure(a.irradiance, r.irradiance[0], r.irradiance[1], scene.areas, count, &error));
	double cross = 0, size = 0;
	for (uint32_t k = 0; k < 3 * count; k++) {
		const double area = scene.areas[k / 3];
		cross += area * (a.irradiance[k] - r.irradiance[0][k]) * (b.irradiance[k] - r.irradiance[1][k]);
		size += area * r.irradiance[0][k] * r.irradiance[1][k];
	}
	printf("  %u leaves: plain difference of half the paths %.2f %%, without the noise %+.2e (squared)\n", count,
	       100 * error.plain, cross / size);
	expect_below("squared difference without noise", fabs(cross / size), SIGMAS * 1.2e-4);
	free(difference);
	free(a.irradiance);
	free(b.irradiance);
	free(leaves);
	leaf_scene_free(&scene);
	reference_result_free(&r);
	gi_context_destroy(gi);
}

static double rms_difference(const traced *a, const traced *b)
{
	double sum = 0;
	for (size_t k = 0; k < 3 * (size_t)a->count; k++)
		sum += (a->irradiance[k] - b->irradiance[k]) * (a->irradiance[k] - b->irradiance[k]);
	return sqrt(sum / (3.0 * a->count));
}

static void noise_falls_and_seeds_decide(void **state)
{
	(void)state;
	gi_context *gi = open_cornell();
	const traced coarse[2] = {trace(gi, 4, 1), trace(gi, 4, 2)}, fine[2] = {trace(gi, 64, 1), trace(gi, 64, 2)};
	const traced again = trace(gi, 4, 1);
	assert_memory_equal(again.irradiance, coarse[0].irradiance, sizeof(double) * 3 * again.count);
	const double noise[2] = {rms_difference(&coarse[0], &coarse[1]), rms_difference(&fine[0], &fine[1])};
	printf("  noise at 4 and 64 paths: ratio %.2f\n", noise[0] / noise[1]);
	/* sqrt(16) = 4 without stratification, at most 16 with a perfect one; 3 % of sampling error of the ratio itself
	 */
	expect_below("1 / sqrt(paths)", 0.97 * 4, noise[0] / noise[1]);
	expect_below("noise that still falls as paths do", noise[0] / noise[1], 16);
	for (int k = 0; k < 2; k++) {
		free(coarse[k].irradiance);
		free(fine[k].irradiance);
	}
	free(again.irradiance);
	gi_context_destroy(gi);
}

/* ---- closed forms ---- */

/* rho and E alike everywhere: H = E / (1 - rho) on every leaf, whatever stands in the room. */
static void furnace(void **state)
{
	(void)state;
	static const float rho[] = {0.3f, 0.9f};
	for (int k = 0; k < 2; k++) {
		gi_context_def def = harness_def();
		def.row_tolerance = 0.2f;
		gi_context *gi = harness_context(&def);
		harness_object o = {
		    .name = "room", .levels = 1, .rho = {rho[k], rho[k], rho[k]}, .exitance = {1, 1, 1}};
		engine_mesh mesh;
		assert_true(shape_box((float[]){-1, -1, -1}, (float[]){1, 1, 1}, 2, true, &mesh));
		harness_add(gi, &o, &mesh);
		assert_true(shape_sphere(0.5f, 3, &mesh));
		o.name = "ball";
		o.levels = 0;
		o.position[0] = 0.2f;
		harness_add(gi, &o, &mesh);
		assert_gi(gi_commit(gi));
		harness_update(gi);
		const traced t = trace(gi, 256, 1);
		double *excess = allocate(t.count, sizeof *excess);
		const double exact = 1 / (1 - (double)rho[k]);
		for (uint32_t leaf = 0; leaf < t.count; leaf++)
			excess[leaf] = t.irradiance[3 * leaf] / exact - 1;
		const double away = sigmas_from_zero(excess, t.count);
		double mean = 0;
		for (uint32_t leaf = 0; leaf < t.count; leaf++)
			mean += excess[leaf] / t.count;
		printf("  rho %.1f: mean %+.3f %%, %.1f standard errors\n", (double)rho[k], 100 * mean, away);
		expect_below("standard errors from E / (1 - rho)", away, SIGMAS);
		free(excess);
		free(t.irradiance);
		gi_context_destroy(gi);
	}
}

/* Where nearly nothing is absorbed paths end all the same, and their mean is still E / (1 - rho). */
static void nearly_white_rooms_end(void **state)
{
	(void)state;
	enum { CALLS = 12, WALLS = 6 };
	static const float rho[] = {0.9995f, 0.9999999f};
	for (int k = 0; k < 2; k++) {
		gi_context_def def = harness_def();
		def.row_tolerance = 0.2f;
		gi_context *gi = harness_context(&def);
		engine_mesh mesh;
		assert_true(shape_box((float[]){-1, -1, -1}, (float[]){1, 2, 1}, 1, true, &mesh));
		harness_add(gi,
			    &(harness_object){.name = "room", .rho = {rho[k], rho[k], rho[k]}, .exitance = {1, 1, 1}},
			    &mesh);
		assert_gi(gi_commit(gi));
		harness_update(gi);
		const double exact = 1 / (1 - (double)rho[k]);
		double excess[CALLS * WALLS], mean = 0;
		for (uint32_t call = 0; call < CALLS; call++) {
			const traced t = trace(gi, 16, 1 + call);
			assert_int_equal(t.count, WALLS);
			for (uint32_t wall = 0; wall < WALLS; wall++) {
				excess[WALLS * call + wall] = t.irradiance[3 * wall] / exact - 1;
				mean += excess[WALLS * call + wall] / (CALLS * WALLS);
				assert_true(t.irradiance[3 * wall] > 1 && isfinite(t.irradiance[3 * wall]));
			}
			free(t.irradiance);
		}
		const double away = sigmas_from_zero(excess, CALLS * WALLS);
		printf("  rho %.7f: mean %+.1f %% from E / (1 - rho), %.1f standard errors\n", (double)rho[k],
		       100 * mean, away);
		if (k == 0) /* the other one's noise is no normal distribution */
			expect_below("standard errors from E / (1 - rho)", away, SIGMAS);
		gi_context_destroy(gi);
	}
}

static gi_object add_square(gi_context *gi, const char *name, const float corner[3], const float u[3], const float v[3],
			    const float exitance[3], bool double_sided)
{
	harness_object o = {.name = name, .rho = {0.5f, 0.5f, 0.5f}, .double_sided = double_sided};
	memcpy(o.exitance, exitance, sizeof o.exitance);
	engine_mesh mesh;
	assert_true(shape_quad(corner, u, v, 1, 1, &mesh));
	return harness_add(gi, &o, &mesh);
}

static const float DARK[3] = {0}, BRIGHT[3] = {1, 2, 4};

/* One convex patch under a sky: H is the sky's exitance to the bit but rounding. Without a sky: nothing. */
static void sky(void **state)
{
	(void)state;
	for (int lit = 0; lit < 2; lit++) {
		gi_context_def def = harness_def();
		for (int c = 0; lit && c < 3; c++)
			def.sky_exitance[c] = BRIGHT[c];
		gi_context *gi = harness_context(&def);
		add_square(gi, "square", (float[]){0, 0, 0}, (float[]){0, 0, 1}, (float[]){1, 0, 0}, DARK, false);
		assert_gi(gi_commit(gi));
		harness_update(gi);
		const traced t = trace(gi, 64, 3);
		for (int c = 0; c < 3; c++)
			assert_true(fabs(t.irradiance[c] - (lit ? BRIGHT[c] : 0)) < 1e-6);
		free(t.irradiance);
		gi_context_destroy(gi);
	}
}

/* Parallel unit squares, gap 1, the upper one lit, rho 0.5 on both. Its light arrives below: B_2 = 0.1009198803 for
 * E = 1 when both are one leaf, whose irradiance is even; true irradiance is not, and its mean differs by 0.04 %. With
 * the lamp turned over only its black back is seen, and a sheet between them that reflects on both sides keeps all
 * light above it. */
static void backs_and_sheets(void **state)
{
	(void)state;
	static const double exact[3] = {0.1009198803 / 0.5, 0, 0};
	for (int k = 0; k < 3; k++) {
		const gi_context_def def = harness_def();
		gi_context *gi = harness_context(&def);
		static const float x[3] = {1, 0, 0}, z[3] = {0, 0, 1}, wide_x[3] = {60, 0, 0}, wide_z[3] = {0, 0, 60};
		add_square(gi, "floor", (float[]){0, 0, 0}, z, x, DARK, false);
		add_square(gi, "lamp", (float[]){0, 1, 0}, k == 1 ? z : x, k == 1 ? x : z, (float[]){1, 1, 1}, false);
		if (k == 2)
			add_square(gi, "sheet", (float[]){-30, 0.5f, -30}, wide_z, wide_x, DARK, true);
		assert_gi(gi_commit(gi));
		harness_update(gi);
		const traced t = trace(gi, 65536, 1);
		printf("  floor %.6f, exact %.6f\n", t.irradiance[0], exact[k]);
		/* 65,536 paths, each 0.2 +- 0.1 even unstratified: 0.2 % of one standard error. */
		assert_true(fabs(t.irradiance[0] - exact[k]) < SIGMAS * 0.002 * exact[k] + 1e-9);
		if (k == 2) /* the sheet's upper side is its other leaf: lit, and the lower one is not */
			assert_true((t.irradiance[6] > 1e-5) != (t.irradiance[9] > 1e-5));
		free(t.irradiance);
		gi_context_destroy(gi);
	}
}

/* ---- misuse ---- */

static void misuse(void **state)
{
	(void)state;
	const gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	float h[3] = {-1, -1, -1};
	uint32_t count = 7;
	assert_int_equal(gi_trace_paths(NULL, NULL, h, 1, &count), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_trace_paths(gi, NULL, NULL, 1, &count), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_trace_paths(gi, NULL, h, 1, NULL), GI_ERROR_INVALID_ARGUMENT);
	add_square(gi, "square", (float[]){0, 0, 0}, (float[]){0, 0, 1}, (float[]){1, 0, 0}, BRIGHT, false);
	assert_int_equal(gi_trace_paths(gi, NULL, h, 1, &count), GI_ERROR_NOT_COMMITTED);
	assert_gi(gi_commit(gi));
	assert_int_equal(gi_trace_paths(gi, NULL, h, 1, &count), GI_ERROR_NOT_COMMITTED);
	harness_update(gi);
	const gi_path_options none = {.paths = 0};
	assert_int_equal(gi_trace_paths(gi, &none, h, 1, &count), GI_ERROR_INVALID_ARGUMENT);
	assert_true(h[0] == -1);
	assert_gi(gi_trace_paths(gi, NULL, h, 0, &count)); /* only the count */
	assert_int_equal(count, 1);
	assert_true(h[0] == -1);
	assert_gi(gi_trace_paths(gi, NULL, h, 1, &count));
	assert_true(h[0] == 0 && h[1] == 0 && h[2] == 0);
	gi_context_destroy(gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(agrees_with_the_reference),
	    cmocka_unit_test(noise_falls_and_seeds_decide),
	    cmocka_unit_test(furnace),
	    cmocka_unit_test(nearly_white_rooms_end),
	    cmocka_unit_test(sky),
	    cmocka_unit_test(backs_and_sheets),
	    cmocka_unit_test(misuse),
	};
	return cmocka_run_group_tests_name("paths", tests, harness_open, harness_close);
}
