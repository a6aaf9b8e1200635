/* What would not fit is refused with what it needs and what there is, before any work was done, and leaves everything
 * as it was; whoever follows the advice of the message gets through.
 */
#include "snapshot.h"

#include "scenes/body.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How often a pass over the first rows began (gi_progress_fn). */
static struct {
	uint32_t cuts, traces;
} begun;

static void hear_progress(const char *what, uint32_t done, uint32_t total, void *user)
{
	(void)done;
	(void)total;
	(void)user;
	begun.cuts += strcmp(what, "first light: cut") == 0;
	begun.traces += strcmp(what, "first light: trace") == 0;
}

static gi_object add_quad(gi_context *gi, float y, bool up, uint32_t n, float exitance)
{
	engine_mesh mesh;
	const float x[3] = {2, 0, 0}, z[3] = {0, 0, 2};
	assert_true(shape_quad((float[]){-1, y, -1}, up ? z : x, up ? x : z, n, n, &mesh));
	return harness_add(gi, &(harness_object){.name = "quad", .rho = {.5f, .5f, .5f}, .exitance = {exitance}},
			   &mesh);
}

static gi_object add_box(gi_context *gi, uint32_t number, gi_mobility mobility)
{
	static const float low[3] = {-.04f, 0, -.04f}, high[3] = {.04f, .08f, .04f};
	static const uint32_t corners[] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
	float positions[24];
	for (int k = 0; k < 24; k++)
		positions[k] = k / 3 >> k % 3 & 1 ? high[k % 3] : low[k % 3];
	gi_object_def def = gi_object_def_default();
	def.name = "box";
	def.positions = positions;
	def.vertex_count = 8;
	def.indices = corners;
	def.index_count = 24;
	def.face_count = 6;
	def.mobility = mobility;
	def.pose.position[0] = .1f * (float)(number % 16) - .8f;
	def.pose.position[1] = .3f + .2f * (float)(number / 256);
	def.pose.position[2] = .1f * (float)(number / 16 % 16) - .8f;
	gi_object object;
	assert_gi(gi_create_object(gi, &def, &object));
	return object;
}

static void expect_said(const char *part)
{
	if (!strstr(harness_last_message(), part))
		fail_msg("'%s' is not in: %s", part, harness_last_message());
}

/* The table of leaves times movable objects. */
static void tables(void **state)
{
	(void)state;
	enum { BOXES = 300 };
	gi_context_def def = harness_def();
	def.max_buffer_mib = 4;
	def.row_tolerance = .5f;
	gi_context *gi = harness_context(&def);
	add_quad(gi, 0, true, 4, 0);
	add_quad(gi, 2, false, 1, 10);
	assert_gi(gi_commit(gi));
	gi_report before = harness_update(gi);
	snapshot kept = snapshot_take(gi);
	static gi_object boxes[BOXES];
	for (uint32_t k = 0; k < BOXES; k++)
		boxes[k] = add_box(gi, k, GI_MOBILITY_MOVABLE);
	assert_int_equal(gi_commit(gi), GI_ERROR_OUT_OF_MEMORY);
	printf("  %s\n", harness_last_message());
	/* 1,817 leaves times 302 objects and a sky times 16 bytes are 8.4 MiB. */
	expect_said("buffer of 9 MiB");
	expect_said("max_buffer_mib allows 4 MiB");
	expect_said("GI_MOBILITY_STATIC");
	/* Nothing has happened, and frames go on. */
	gi_report report;
	assert_gi(gi_update(gi, NULL));
	assert_gi(gi_finish(gi));
	assert_gi(gi_get_report(gi, &report));
	assert_int_equal(report.outcome, GI_OUTCOME_AT_REST);
	assert_int_equal(report.gpu_bytes, before.gpu_bytes);
	snapshot now = snapshot_take(gi);
	snapshot_expect_same_rows(&kept, &now, "a commit that does not fit");
	assert_int_equal(snapshot_hash_radiosity(&kept), snapshot_hash_radiosity(&now));
	snapshot_free(&now);
	/* The advice. */
	for (uint32_t k = 0; k < BOXES; k++) {
		assert_gi(gi_destroy_object(gi, boxes[k]));
		boxes[k] = add_box(gi, k, GI_MOBILITY_STATIC);
	}
	assert_gi(gi_commit(gi));
	report = harness_update(gi);
	printf("  static: %u leaves, %llu entries\n", report.leaves, (unsigned long long)report.entries);
	snapshot_free(&kept);
	gi_context_destroy(gi);
}

/* Too many leaves for any row. */
static void leaves(void **state)
{
	(void)state;
	gi_context_def def = harness_def();
	def.max_buffer_mib = 1;
	gi_context *gi = harness_context(&def);
	for (int k = 0; k < 2; k++)
		add_quad(gi, (float)k, k == 0, 60, k ? 10 : 0);
	assert_int_equal(gi_commit(gi), GI_ERROR_OUT_OF_MEMORY);
	printf("  %s\n", harness_last_message());
	expect_said("7200 leaves");
	expect_said("buffer of 2 MiB");
	expect_said("larger leaf_size");
	assert_int_equal(gi_update(gi, NULL), GI_ERROR_NOT_COMMITTED);
	gi_context_destroy(gi);
}

/* Rows are found too many before a ray is traced. */
static gi_result first_rows(uint32_t mib, float tolerance, gi_report *report)
{
	gi_context_def def = harness_def();
	def.max_buffer_mib = mib;
	def.row_tolerance = tolerance;
	def.sky = GI_SKY_OFF;
	def.progress = hear_progress;
	begun.cuts = begun.traces = 0;
	gi_context *gi = harness_context(&def);
	add_quad(gi, 0, true, 18, 0);
	add_quad(gi, .4f, false, 18, 10);
	assert_gi(gi_commit(gi));
	gi_result result = gi_update(gi, NULL);
	assert_gi(gi_get_report(gi, report));
	const uint32_t cuts = begun.cuts;
	if (result) { /* and every time, at once */
		assert_int_equal(gi_update(gi, NULL), result);
		assert_int_equal(begun.cuts, cuts);
	}
	gi_context_destroy(gi);
	return result;
}

static void rows(void **state)
{
	(void)state;
	enum { MIB = 2 };
	gi_report report;
	assert_int_equal(first_rows(MIB, 1e-4f, &report), GI_ERROR_OUT_OF_MEMORY);
	printf("  %s; %u cuts, %llu rays\n", harness_last_message(), begun.cuts, (unsigned long long)report.rays);
	assert_int_equal(begun.cuts, 1);
	assert_int_equal(report.rays, 0);
	expect_said("648 leaves");
	expect_said("max_buffer_mib allows 2 MiB");
	const char *number = strstr(harness_last_message(), "buffer of ");
	assert_non_null(number);
	const double needed = atof(number + strlen("buffer of "));
	/* So many do, and one less does not. */
	assert_gi(first_rows((uint32_t)needed, 1e-4f, &report));
	printf("  with %.0f MiB: %llu entries, %.2f MiB\n", needed, (unsigned long long)report.entries,
	       (double)report.entries / 65536);
	assert_int_equal(first_rows((uint32_t)needed - 1, 1e-4f, &report), GI_ERROR_OUT_OF_MEMORY);
	/* And the other advice; down to here every leaf was an entry of its own. */
	assert_gi(first_rows(MIB, .01f, &report));
}

/* Pools that were too small know by how much: one more time is enough, and that is what counts are about. */
static void pools_grow_once(void **state)
{
	(void)state;
	enum { SCALES = 400 };
	gi_context_def def = harness_def();
	def.row_tolerance = 1;
	def.emitter_refinement = 1;
	def.progress = hear_progress;
	gi_context *gi = harness_context(&def);
	for (int k = 0; k < SCALES; k++) {
		engine_mesh mesh;
		const float x = .1f * (float)(k % 20) - 1, z = .1f * (float)(k / 20) - 1, up[3] = {0, 0, .05f},
			    side[3] = {.05f, 0, 0};
		const bool above = k % 2;
		assert_true(
		    shape_quad((float[]){x, above ? 1.5f : 1, z}, above ? side : up, above ? up : side, 1, 1, &mesh));
		gi_object_def scale = scene_mesh_def(&mesh);
		scale.mobility = GI_MOBILITY_MOVABLE; /* each an entry of every row that it faces */
		gi_object object;
		assert_gi(gi_create_object(gi, &scale, &object));
		engine_mesh_free(&mesh);
	}
	assert_gi(gi_commit(gi));
	begun.cuts = begun.traces = 0;
	const gi_report grown = harness_update(gi);
	const float cut = grown.pass_ms[GI_PASS_CUT];
	printf("  %u leaves, %llu entries: cut %u times, %.2f ms in all\n", grown.leaves,
	       (unsigned long long)grown.entries, begun.cuts, (double)cut);
	assert_true(begun.cuts == 2);
	assert_true(grown.outcome == GI_OUTCOME_CONVERGED);
	gi_context_destroy(gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(tables),
	    cmocka_unit_test(leaves),
	    cmocka_unit_test(rows),
	    cmocka_unit_test(pools_grow_once),
	};
	return cmocka_run_group_tests_name("limits", tests, harness_open, harness_close);
}
