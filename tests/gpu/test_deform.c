/* Moving skin: rows of shapes that change are those of a rebuild and of a context that knew no other shape, bit for
 * bit.
 */
#include "snapshot.h"

#include "deforming_scene.h"
#include "scenes/body.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static gi_context *open_context(void)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .05f;
	def.caustic_photons = 1024;
	return harness_context(&def);
}

/* A context in which everything was given the shapes and poses of `s` before its first commit. */
static gi_context *open_fresh(const deforming_scene *s)
{
	deforming_scene fresh = *s;
	fresh.gi = open_context();
	deforming_scene_create(&fresh);
	deforming_scene_set(&fresh);
	assert_gi(gi_commit(fresh.gi));
	harness_update(fresh.gi);
	return fresh.gi;
}

static void expect_fresh_rows(const deforming_scene *s, const char *when)
{
	gi_context *fresh = open_fresh(s);
	snapshot here = snapshot_take(s->gi), there = snapshot_take(fresh);
	snapshot_expect_same_rows(&here, &there, when);
	for (uint32_t k = 0; k < here.leaf_count; k++) {
		assert_memory_equal(here.leaves[k].corners, there.leaves[k].corners, sizeof here.leaves[k].corners);
		assert_memory_equal(&here.leaves[k].area, &there.leaves[k].area, sizeof here.leaves[k].area);
	}
	snapshot_free(&here);
	snapshot_free(&there);
	gi_context_destroy(fresh);
}

static void play(deforming_scene *s, int frames, int fresh_every)
{
	s->gi = open_context();
	deforming_scene_create(s);
	assert_gi(gi_commit(s->gi));
	harness_update(s->gi);
	for (int frame = 0; frame < frames; frame++) {
		char when[64];
		snprintf(when, sizeof when, "frame %d", frame);
		deforming_scene_play(s, frame);
		const gi_report r = harness_update(s->gi);
		assert_true(r.outcome > 0 && r.new_entries > 0);
		if (frame % fresh_every == fresh_every - 1)
			expect_fresh_rows(s, when);
		snapshot_expect_rebuilt_rows(s->gi, when);
	}
	gi_context_destroy(s->gi);
	s->gi = NULL;
}

static void rows_are_a_rebuilds(void **state)
{
	(void)state;
	deforming_scene s;
	deforming_scene_make(&s);
	play(&s, harness_is_long() ? 200 : 6, 3);
	deforming_scene_free(&s);
}

/* Light from a shape that bends, and a mirror that does: lamps, photons and smooth normals follow. */
static void what_shines_and_mirrors_bends(void **state)
{
	(void)state;
	deforming_scene s;
	deforming_scene_make(&s);
	s.exitance = 5;
	s.mirror = true;
	play(&s, harness_is_long() ? 100 : 2, 2);
	deforming_scene_free(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(rows_are_a_rebuilds),
	    cmocka_unit_test(what_shines_and_mirrors_bends),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
