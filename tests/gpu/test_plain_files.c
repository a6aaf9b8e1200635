/* Plain files as the player plays them without options, against Embree's path tracing of the same leaves: rooms with a
 * door, an L, a hut, furniture in one mesh; in millimetres and feet, turned, far from the origin.
 *
 * Errors are area-weighted RMS over all leaves but the lamps', relative to the truth's, free of its noise
 * (reference/error.h). RELUME_FILE=NAME measures one file alone, RELUME_WORST=N lists the N leaves that hold most of
 * the squared error.
 */
#define _POSIX_C_SOURCE 200809L /* mkdtemp */
#include "harness.h"

#include "plain_files.h"

#include "demos/file_scene.h"
#include "tests/reference/reference_error.h"
#include "tests/reference/leaves.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* What is asked: RMS of H against path tracing over that of H; what leaks into the dark, over the bright side's H. */
static const double ERROR_LIMIT = 0.06, DARK_LIMIT = 0.01;

static const uint32_t PATHS = 256;

typedef struct mean {
	double sum, area;
} mean;

/* A file and how far the loader moved it. */
typedef struct played {
	const plain_file *file;
	double moved[3];
} played;

/* By the lowest coordinates in the file and in the scene. */
static void find_move(const char *path, const file_scene *scene, double moved[3])
{
	double lower[3] = {INFINITY, INFINITY, INFINITY}, p[3];
	char line[256];
	FILE *from = fopen(path, "r");
	assert_non_null(from);
	while (fgets(line, sizeof line, from))
		for (int c = 0; c < 3 && sscanf(line, "v %lf %lf %lf", &p[0], &p[1], &p[2]) == 3; c++)
			lower[c] = fmin(lower[c], p[c]);
	fclose(from);
	for (int c = 0; c < 3; c++)
		moved[c] = (double)scene->lower[c] - lower[c];
}

static void own_centre(const played *of, const gi_leaf *l, double out[3])
{
	double centre[3] = {-of->moved[0], -of->moved[1], -of->moved[2]};
	for (int k = 0; k < 4; k++)
		for (int c = 0; c < 3; c++)
			centre[c] += .25 * (double)l->corners[k][c];
	plain_file_own(&of->file->where, centre, out);
}

static bool is_inside(const region *r, const double p[3])
{
	for (int k = 0; k < 3; k++)
		if (p[k] < r->lower[k] || p[k] > r->upper[k])
			return false;
	return r->lower[0] < r->upper[0];
}

static void list_worst(const played *of, const gi_leaf *leaves, uint32_t count, const double *h,
		       const reference_result *traced, const double *areas)
{
	const char *wanted = getenv("RELUME_WORST");
	bool *told = calloc(count, sizeof *told);
	double all = 0;
	double *error = calloc(count, sizeof *error);
	for (uint32_t k = 0; k < count; k++) {
		for (uint32_t c = 0; c < 3; c++)
			error[k] += areas[k] * (h[3 * k + c] - traced->irradiance[0][3 * k + c]) *
				    (h[3 * k + c] - traced->irradiance[1][3 * k + c]);
		all += error[k];
	}
	for (int n = wanted ? atoi(wanted) : 0; n > 0; n--) {
		uint32_t worst = 0;
		for (uint32_t k = 0; k < count; k++)
			if (!told[k] && (told[worst] || error[k] > error[worst]))
				worst = k;
		double c[3];
		own_centre(of, &leaves[worst], c);
		told[worst] = true;
		printf("    %5.2f %% of the squared error: object %u, area %.4f, at %.3f %.3f %.3f: H %.4f, truth %.4f "
		       "%.4f\n",
		       100 * error[worst] / all, leaves[worst].object.index1, areas[worst], c[0], c[1], c[2],
		       h[3 * worst + 1], traced->irradiance[0][3 * worst + 1], traced->irradiance[1][3 * worst + 1]);
	}
	free(told);
	free(error);
}

/* Sets areas of lamps to zero: what falls on them is of no use. */
static void leave_out_lamps(const gi_leaf *leaves, uint32_t count, double *areas)
{
	for (uint32_t k = 0; k < count; k++)
		if (leaves[k].exitance[1] > 0)
			areas[k] = 0;
}

static double region_mean(const played *of, const region *r, const gi_leaf *leaves, uint32_t count, const double *areas)
{
	mean m = {0};
	for (uint32_t k = 0; k < count; k++) {
		double c[3];
		own_centre(of, &leaves[k], c);
		if (!is_inside(r, c))
			continue;
		m.sum += areas[k] * (double)leaves[k].irradiance[1];
		m.area += areas[k];
	}
	return m.area > 0 ? m.sum / m.area : 0;
}

static void solve(gi_context *gi, gi_report *report)
{
	*report = harness_update(gi);
	for (int frame = 0; frame < 20 && report->outcome == GI_OUTCOME_SWEEPS; frame++)
		*report = harness_update(gi);
}

static bool compare(const played *of, gi_context *gi, uint32_t count)
{
	gi_leaf *leaves = malloc(sizeof *leaves * count);
	double *h = malloc(sizeof *h * 3 * count);
	leaf_scene scene;
	reference_result traced;
	assert_true(leaves && h);
	assert_gi(gi_read_leaves(gi, leaves, count, &count));
	leaf_irradiance(leaves, count, h);
	assert_true(leaf_scene_make(leaves, count, &scene));
	assert_true(reference_trace(&scene.scene, harness_paths(PATHS), 1, &traced));
	leave_out_lamps(leaves, count, scene.areas);
	reference_error e;
	assert_true(reference_error_measure(h, traced.irradiance[0], traced.irradiance[1], scene.areas, count, &e));
	const double lit = region_mean(of, &of->file->lit, leaves, count, scene.areas),
		     dark = region_mean(of, &of->file->dark, leaves, count, scene.areas);
	printf("  %-16s %5u leaves: RMS %.2f %% of H (bias %+.2f %%, noise %.2f %%)", of->file->name, count,
	       100 * e.rms, 100 * e.bias, 100 * e.noise);
	if (lit > 0)
		printf("; dark %.3g of lit", dark / lit);
	printf("\n");
	list_worst(of, leaves, count, h, &traced, scene.areas);
	leaf_scene_free(&scene);
	reference_result_free(&traced);
	free(leaves);
	free(h);
	return e.rms <= ERROR_LIMIT && !(lit > 0 && dark > DARK_LIMIT * lit);
}

static bool measure(const plain_file *file, const char *path)
{
	file_scene loaded = {.program = "test_plain_files"};
	char message[1024] = "";
	if (!file_scene_load(&loaded, path, message, sizeof message))
		fail_msg("%s", message);
	gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	if (!file_scene_create(&loaded, gi, message, sizeof message))
		fail_msg("%s: %s", message, harness_last_message());
	assert_gi(gi_commit(gi));
	gi_report report;
	solve(gi, &report);
	assert_int_equal(report.outcome, GI_OUTCOME_CONVERGED);
	played of = {.file = file};
	find_move(path, &loaded, of.moved);
	const bool right = compare(&of, gi, report.leaves);
	gi_context_destroy(gi);
	file_scene_free(&loaded);
	return right;
}

static void plain_files_are_right(void **state)
{
	(void)state;
	harness_require_context();
	const char *only = getenv("RELUME_FILE");
	char folder[] = "/tmp/relume-plain-XXXXXX", path[256];
	assert_non_null(mkdtemp(folder));
	uint32_t wrong = 0;
	for (uint32_t k = 0; k < PLAIN_FILE_COUNT; k++) {
		const bool wanted = only ? strcmp(only, plain_files[k].name) == 0 : harness_is_long() || k % 3 < 2;
		if (!wanted)
			continue;
		assert_true(plain_file_write(&plain_files[k], folder, path, sizeof path));
		wrong += !measure(&plain_files[k], path);
		remove(path);
		strcpy(strrchr(path, '.'), ".mtl");
		remove(path);
	}
	rmdir(folder);
	assert_int_equal(wrong, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(plain_files_are_right)};
	return cmocka_run_group_tests_name("plain files", tests, harness_open, harness_close);
}
