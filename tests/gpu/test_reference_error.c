/* Error of the whole pipeline against a path-traced reference: Cornell box with the Buddha.
 *
 * The reference is Embree's, on the same leaves, in two independent halves, so that its own noise drops out
 * (reference/error.h). The figures are area-weighted RMS over all leaves, relative to the reference's: of irradiance H,
 * and of B - E = rho H.
 */
#include "harness.h"

#include "tests/reference/reference_error.h"
#include "tests/reference/leaves.h"
#include "scenes/cornell.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* What is asked at a row tolerance of 0.01: RMS of H against path tracing over that of H; entries a leaf. */
static const double ERROR_LIMIT = 0.03;
static const double ENTRIES_LIMIT = 350;

/* Where a patch of the black sky before the box's open side is half of what a leaf sees: closing must not take it
 * for all or nothing. Rows that a single ray decides are 7.0 % off, 4 % too bright. */
static const float COARSE[2] = {0.1f, 0.05f};
static const double COARSE_LIMIT = 0.06, COARSE_BIAS = 0.03;

/* Each step, 2.4 times finer, takes at least this away: more than the measure's own standard error. */
static const double FALL = 0.95;

/* Reference noise of some per cent per leaf drops out of the measure but for its standard error, which falls with the
 * number of leaves: 0.05 % at 4,100 leaves and this many paths. */
static const uint32_t PATHS = 1024;

typedef struct measured {
	double entries, links; /* per leaf */
	reference_error irradiance, reflected;
} measured;

typedef struct truth {
	reference_result traced;
	leaf_scene leaves;
} truth;

static void *allocate(size_t count, size_t size)
{
	void *data = calloc(count, size);
	assert_non_null(data);
	return data;
}

static truth trace_truth(const gi_leaf *leaves, uint32_t count)
{
	truth t;
	assert_true(leaf_scene_make(leaves, count, &t.leaves));
	assert_true(reference_trace(&t.leaves.scene, PATHS, 1, &t.traced));
	return t;
}

static void free_truth(truth *t)
{
	reference_result_free(&t->traced);
	leaf_scene_free(&t->leaves);
}

/* rho * x, leaf by leaf. */
static double *reflected(const double *rho, const double *x, uint32_t count)
{
	double *out = allocate(3 * count, sizeof *out);
	for (uint32_t k = 0; k < 3 * count; k++)
		out[k] = rho[k] * x[k];
	return out;
}

static void measure_errors(const truth *t, const gi_leaf *leaves, uint32_t count, measured *m)
{
	double *h = allocate(3 * count, sizeof *h), *b = allocate(3 * count, sizeof *b);
	leaf_irradiance(leaves, count, h);
	for (uint32_t k = 0; k < count; k++)
		for (int c = 0; c < 3; c++)
			b[3 * k + (uint32_t)c] = (double)leaves[k].radiosity[c] - (double)leaves[k].exitance[c];
	double *r[2];
	for (int half = 0; half < 2; half++)
		r[half] = reflected(t->leaves.rho, t->traced.irradiance[half], count);
	assert_true(reference_error_measure(h, t->traced.irradiance[0], t->traced.irradiance[1], t->leaves.areas, count,
					    &m->irradiance));
	assert_true(reference_error_measure(b, r[0], r[1], t->leaves.areas, count, &m->reflected));
	free(h);
	free(b);
	free(r[0]);
	free(r[1]);
}

/* Solves the box at one row tolerance; the first call traces the reference. */
static measured solve_box(float row_tolerance, truth *t)
{
	gi_context_def def = harness_def();
	def.row_tolerance = row_tolerance;
	def.near_samples = 1;
	def.solve_tolerance = 1e-4f;
	gi_context *gi = harness_context(&def);
	const cornell_def box = cornell_def_default();
	cornell made;
	assert_gi(cornell_create(gi, &box, &made));
	assert_gi(gi_commit(gi));
	const gi_report report = harness_update(gi);
	assert_int_equal(report.outcome, GI_OUTCOME_CONVERGED);
	gi_leaf *leaves = allocate(report.leaves, sizeof *leaves);
	uint32_t count;
	assert_gi(gi_read_leaves(gi, leaves, report.leaves, &count));
	if (!t->leaves.areas)
		*t = trace_truth(leaves, count);
	measured m = {.entries = (double)report.entries / count, .links = (double)report.links / count};
	measure_errors(t, leaves, count, &m);
	printf("  row tolerance %.4f: %u leaves, per leaf %.0f entries, %.0f links; error of H %.2f %% (bias %+.2f "
	       "%%), of B - E %.2f %%\n",
	       (double)row_tolerance, count, m.entries, m.links, 100 * m.irradiance.rms, 100 * m.irradiance.bias,
	       100 * m.reflected.rms);
	free(leaves);
	gi_context_destroy(gi);
	return m;
}

static void expect_at_most(const char *what, double value, double limit)
{
	if (!(value <= limit))
		fail_msg("%s: %g is more than %g", what, value, limit);
}

static void cornell_with_buddha(void **state)
{
	(void)state;
	static const float tolerances[3] = {0.024f, 0.010f,
					    0.004f}; /* the second is the one that ENTRIES_LIMIT is for */
	truth t = {0};
	measured m[3];
	for (int k = 0; k < 3; k++)
		m[k] = solve_box(tolerances[k], &t);
	measured coarse[2];
	for (int k = 0; k < 2; k++)
		coarse[k] = solve_box(COARSE[k], &t);
	printf("  the reference's own noise: %.2f %% of H\n", 100 * m[0].irradiance.noise);
	free_truth(&t);
	expect_at_most("entries per leaf", m[1].entries, ENTRIES_LIMIT);
	expect_at_most("error of H", m[1].irradiance.rms, ERROR_LIMIT);
	expect_at_most("error of B - E", m[1].reflected.rms, ERROR_LIMIT);
	for (int k = 0; k < 2; k++) {
		expect_at_most("error of H, coarse", coarse[k].irradiance.rms, COARSE_LIMIT);
		expect_at_most("bias of H, coarse", fabs(coarse[k].irradiance.bias), COARSE_BIAS);
	}
	for (int k = 1; k < 3; k++) {
		expect_at_most("error of H, finer", m[k].irradiance.rms, FALL * m[k - 1].irradiance.rms);
		expect_at_most("error of B - E, finer", m[k].reflected.rms, FALL * m[k - 1].reflected.rms);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(cornell_with_buddha)};
	return cmocka_run_group_tests_name("reference error", tests, harness_open, harness_close);
}
