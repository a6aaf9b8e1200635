/* Figures of files that walk: a skin and morph targets of a glTF file, played as gi_play does. Every frame's rows are a
 * rebuild's, bit for bit; a step is little more work than that of a rigid figure of the same size.
 */
#include "snapshot.h"

#include "demos/file_scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char FILE_NAME[] = RELUME_SOURCE_DIR "/demos/scenes/walker.gltf";

/* Not animated it stands as the file binds it. */
static gi_context *open_scene(file_scene *f, bool rigid, bool animated)
{
	char message[512] = "";
	gi_context_def def = harness_def();
	def.row_tolerance = .05f;
	*f = (file_scene){.program = "test_walker", .leaves = 1000};
	if (!file_scene_load(f, FILE_NAME, message, sizeof message))
		fail_msg("%s", message);
	for (uint32_t k = 0; rigid && k < f->scene.object_count; k++)
		f->scene.objects[k].deforms = false;
	gi_context *gi = harness_context(&def);
	if (!file_scene_create(f, gi, message, sizeof message))
		fail_msg("%s", message);
	if (animated)
		assert_gi(file_scene_animate(f, gi, 0));
	assert_gi(gi_commit(gi));
	harness_update(gi);
	return gi;
}

static uint32_t object_named(const file_scene *f, const char *name)
{
	uint32_t k = 0;
	while (k < f->scene.object_count && strcmp(f->scene.objects[k].name, name) != 0)
		k++;
	assert_true(k < f->scene.object_count);
	return k;
}

static void every_step_is_a_rebuilds(void **state)
{
	(void)state;
	file_scene f;
	gi_context *gi = open_scene(&f, false, true);
	const int frames = harness_is_long() ? 144 : 4;
	assert_true(f.scene.objects[object_named(&f, "figure")].deforms);
	assert_true(f.scene.objects[object_named(&f, "curtain")].deforms);
	assert_false(f.scene.objects[object_named(&f, "block")].deforms);
	assert_true(f.scene.duration_s == 6 && !f.scene.warning[0]);
	for (int frame = 1; frame <= frames; frame++) {
		char when[64];
		snprintf(when, sizeof when, "frame %d", frame);
		assert_gi(file_scene_animate(&f, gi, frame / 24.0));
		const gi_report r = harness_update(gi);
		assert_true(r.outcome > 0 && r.new_entries > 0);
		snapshot_expect_rebuilt_rows(gi, when);
	}
	gi_context_destroy(gi);
	file_scene_free(&f);
}

/* ---- what is left out ---- */

/* RMS of H over the figure's leaves, and of what it differs by between two snapshots. */
static double light_apart(const snapshot *a, const snapshot *b, gi_object figure)
{
	double sum = 0, apart = 0;
	assert_int_equal(a->leaf_count, b->leaf_count);
	for (uint32_t l = 0; l < a->leaf_count; l++)
		for (int k = 0; k < 3 && a->leaves[l].object.index1 == figure.index1; k++) {
			const double h = (double)a->leaves[l].irradiance[k], d = (double)b->leaves[l].irradiance[k] - h;
			sum += (double)a->leaves[l].area * h * h;
			apart += (double)a->leaves[l].area * d * d;
		}
	assert_true(sum > 0);
	return sqrt(apart / sum);
}

/* Of pairs of its own leaves a figure that deforms leaves out those that bring next to nothing; a rigid one has them
 * all. Beside that the two differ by the rounding of their vertices, and what that does to single rays, 1.04 %; what is
 * ten times as much left out makes it 5.3 %. */
static void what_is_left_out_brings_nothing(void **state)
{
	(void)state;
	file_scene f[2];
	snapshot s[2];
	gi_object figure = {0};
	for (int rigid = 0; rigid < 2; rigid++) {
		gi_context *gi = open_scene(&f[rigid], rigid, false);
		figure = f[rigid].handles[object_named(&f[rigid], "figure")];
		s[rigid] = snapshot_take(gi);
		gi_context_destroy(gi);
		file_scene_free(&f[rigid]);
	}
	const double apart = light_apart(&s[1], &s[0], figure);
	printf("  of %u entries %u are left out, which changes the light of the figure by %.3f %%\n",
	       (unsigned)s[1].entry_count, (unsigned)(s[1].entry_count - s[0].entry_count), 100 * apart);
	assert_true(s[0].entry_count < s[1].entry_count);
	assert_true(apart < .015);
	snapshot_free(&s[0]);
	snapshot_free(&s[1]);
}

/* ---- where it is ---- */

/* Corners of an object's leaves. */
static void bounds_of(gi_context *gi, gi_object object, double lower[3], double upper[3])
{
	snapshot s = snapshot_take(gi);
	for (int k = 0; k < 3; k++) {
		lower[k] = INFINITY;
		upper[k] = -INFINITY;
	}
	for (uint32_t l = 0; l < s.leaf_count; l++)
		for (int c = 0; c < 4 && s.leaves[l].object.index1 == object.index1; c++)
			for (int k = 0; k < 3; k++) {
				lower[k] = fmin(lower[k], (double)s.leaves[l].corners[c][k]);
				upper[k] = fmax(upper[k], (double)s.leaves[l].corners[c][k]);
			}
	snapshot_free(&s);
}

/* On its circle, as tall as it is made, a foot near the floor at any time; the curtain waves and stays where it
 * hangs. */
static void it_walks(void **state)
{
	(void)state;
	file_scene f;
	gi_context *gi = open_scene(&f, false, true);
	const uint32_t figure = object_named(&f, "figure"), curtain = object_named(&f, "curtain");
	double before = INFINITY;
	for (int k = 0; k < 5; k++) {
		const double time_s = .35 + 1.13 * k, way = time_s / 6 * 2 * 3.14159265358979;
		double lower[3], upper[3];
		assert_gi(file_scene_animate(&f, gi, time_s));
		harness_update(gi);
		bounds_of(gi, f.handles[figure], lower, upper);
		assert_true(fabs(lower[1]) < .03 && upper[1] > 1.6 && upper[1] < 1.85);
		/* A stride and the arms reach half a metre to either side. */
		assert_true(fabs((lower[0] + upper[0]) / 2 - .95 * sin(way)) < .3);
		assert_true(fabs((lower[2] + upper[2]) / 2 - .95 * cos(way)) < .3);
		bounds_of(gi, f.handles[curtain], lower, upper);
		assert_true(fabs(lower[0] + .05) < .01 && fabs(upper[0] - 1.45) < .01);
		assert_true(upper[2] - lower[2] > .1 && upper[2] - lower[2] < .3);
		assert_true(fabs(lower[2] - before) > 1e-4);
		before = lower[2];
	}
	gi_context_destroy(gi);
	file_scene_free(&f);
}

/* ---- what it takes ---- */

/* The figure alone moves. */
static gi_report last_of(bool rigid, int frames)
{
	file_scene f;
	gi_report r = {0};
	gi_context *gi = open_scene(&f, rigid, true);
	const uint32_t figure = object_named(&f, "figure");
	f.scene.objects[object_named(&f, "curtain")].deforms = false;
	for (int frame = 0; frame < frames; frame++) {
		const double time_s = (frame + 1) / 24.0, way = time_s / 6 * 2 * 3.14159265358979, half = way / 2;
		if (rigid)
			assert_gi(gi_set_pose(gi, f.handles[figure],
					      (gi_pose){{(float)(.95 * sin(way)), 0, (float)(.95 * cos(way))},
							{0, (float)sin(half), 0, (float)cos(half)}}));
		else
			assert_gi(file_scene_animate(&f, gi, time_s));
		r = harness_update(gi);
	}
	gi_context_destroy(gi);
	file_scene_free(&f);
	return r;
}

/* A step of the figure beside one of the same figure as a rigid body. What that is in time tests/bench/skin_cost.c
 * tells; with all pairs of its own leaves it would be 1.66 times the entries and 1.17 times the rays. */
static void a_step_takes_little_more_than_a_rigid_ones(void **state)
{
	(void)state;
	const gi_report rigid = last_of(true, 3), walking = last_of(false, 3);
	printf("  new entries %u and %u, rays %u and %u\n", (unsigned)walking.new_entries, (unsigned)rigid.new_entries,
	       (unsigned)walking.rays, (unsigned)rigid.rays);
	assert_int_equal(walking.leaves, rigid.leaves);
	assert_true((double)walking.new_entries < 1.35 * (double)rigid.new_entries);
	assert_true((double)walking.rays < 1.12 * (double)rigid.rays);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(every_step_is_a_rebuilds),
	    cmocka_unit_test(what_is_left_out_brings_nothing),
	    cmocka_unit_test(it_walks),
	    cmocka_unit_test(a_step_takes_little_more_than_a_rigid_ones),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
