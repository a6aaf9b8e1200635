/* Rows kept by updates are those of a rebuild, to the bit, whatever moved, turned, returned or was relit.
 *
 * Two gi contexts share the OpenGL context and get the same poses and materials. One updates; the other is invalidated
 * and made cold every frame. After each frame all entries, all links and all row sums are compared as bytes, and B to
 * 1e-5 of the largest.
 */
#include "moving_scene.h"
#include "snapshot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

/* How far B of an update may be from a rebuild's, over the largest. Both solves stop within 1e-6 of
 * the largest B of the same fixed point; the rest is room for the rounding of sums of some hundred products in single
 * precision. */
static const double RADIOSITY_TOLERANCE = 1e-5;
static const float SOLVE_TOLERANCE = 1e-4f;

/* Coarse, so that 200 rebuilds are affordable: about 700 leaves with 60 entries each. */
static const float ROW_TOLERANCE = 0.03f;

/* ---- comparison ---- */

typedef struct tally {
	double entries, fresh, flagged, worst;
	uint32_t frames;
} tally;

static void expect_converged(const gi_report *r, const char *when)
{
	if (r->outcome != GI_OUTCOME_CONVERGED && r->outcome != GI_OUTCOME_AT_REST)
		fail_msg("%s: outcome %d after %u sweeps, bound %g of the largest B %g, residual %g, q %g", when,
			 r->outcome, r->sweeps, (double)r->solve_relative, (double)r->radiosity_max,
			 (double)r->residual, (double)r->contraction);
}

static void compare(scene *kept, scene *rebuilt, const char *when, tally *t)
{
	gi_invalidate(rebuilt->gi);
	gi_reset_radiosity(rebuilt->gi);
	const gi_report report = harness_update(kept->gi), full = harness_update(rebuilt->gi);
	expect_converged(&report, when);
	expect_converged(&full, when);
	assert_int_equal(full.new_entries, full.entries);
	assert_int_equal(report.entries, full.entries);
	assert_int_equal(report.links, full.links);
	snapshot a = snapshot_take(kept->gi), b = snapshot_take(rebuilt->gi);
	assert_int_equal(a.entry_count, report.entries);
	assert_int_equal(a.link_count, report.links);
	snapshot_expect_same_rows(&a, &b, when);
	const double distance = snapshot_distance(&a, &b), largest = snapshot_largest(&b);
	if (!(distance <= RADIOSITY_TOLERANCE * largest)) /* all black: zero from zero */
		fail_msg("%s: B is %.3g W/m2 from the rebuild's, whose largest is %g", when, distance, largest);
	snapshot_free(&a);
	snapshot_free(&b);
	t->entries += (double)report.entries;
	t->fresh += (double)report.new_entries;
	t->flagged += (double)report.flagged_entries;
	t->worst = fmax(t->worst, distance > 0 ? distance / largest : 0);
	t->frames++;
}

static void print_tally(const char *name, const tally *t)
{
	printf("  %s: %u frames, %.0f entries; of them cut anew %.1f %%, flagged %.1f %%; worst B %.2e\n", name,
	       t->frames, t->entries / t->frames, 100 * t->fresh / t->entries, 100 * t->flagged / t->entries, t->worst);
}

typedef void open_fn(scene *s, const gi_context_def *def);

static void pose_both(scene pair[2], int mover, gi_pose pose)
{
	for (int k = 0; k < 2; k++)
		assert_gi(gi_set_pose(pair[k].gi, pair[k].mover[mover], pose));
}

/* Pools and tables have their size after so many frames. */
enum { WARM_FRAMES = 40 };

typedef struct memory {
	uint64_t gpu_bytes;
	long resident_kib;
} memory;

static memory memory_now(gi_context *gi)
{
	gi_report report;
	struct rusage usage;
	assert_gi(gi_get_report(gi, &report));
	assert_int_equal(getrusage(RUSAGE_SELF, &usage), 0);
	return (memory){report.gpu_bytes, usage.ru_maxrss};
}

/* The frames since WARM_FRAMES took nothing on the GPU and next to nothing of the process, whose allocator keeps some
 * of what comparisons ask for. */
static void expect_flat_memory(const memory *before, gi_context *gi)
{
	const memory now = memory_now(gi);
	if (!before->gpu_bytes)
		return;
	printf("  memory after %d frames and at the end: %.1f and %.1f MB on the GPU, %ld and %ld MB of the process at "
	       "most\n",
	       WARM_FRAMES, 1e-6 * (double)before->gpu_bytes, 1e-6 * (double)now.gpu_bytes, before->resident_kib >> 10,
	       now.resident_kib >> 10);
	assert_int_equal(now.gpu_bytes, before->gpu_bytes);
	assert_true(now.resident_kib <= before->resident_kib + (64 << 10));
}

/* Compares every `every`-th frame: an update accumulates nothing, so what went wrong in between would show there too.
 */
static void run(const char *name, open_fn *open, const gi_context_def *def, uint32_t frames, uint32_t every,
		bool stay_inside)
{
	memory before = {0};
	scene pair[2];
	seed_motion(20240229);
	for (int k = 0; k < 2; k++)
		open(&pair[k], def);
	motion m = start_motion(stay_inside);
	for (int k = 0; k < MOVERS; k++)
		pose_both(pair, k, m.pose[k]);
	tally t = {0};
	compare(&pair[0], &pair[1], "the first frame", &t);
	const snapshot at_home = snapshot_take(pair[0].gi);
	t = (tally){0};
	for (uint32_t frame = 1; frame <= frames; frame++) {
		char when[64];
		bool moved[MOVERS];
		snprintf(when, sizeof when, "%s, frame %u", name, frame);
		next_poses(&m, moved);
		for (int k = 0; k < MOVERS; k++)
			if (moved[k])
				pose_both(pair, k, m.pose[k]);
		if (frame % every == 0 || frame == frames)
			compare(&pair[0], &pair[1], when, &t);
		else
			harness_update(pair[0].gi);
		if (frame == WARM_FRAMES)
			before = memory_now(pair[0].gi);
	}
	print_tally(name, &t);
	expect_flat_memory(&before, pair[0].gi);
	/* All three move often, and yet less than all is done again. */
	assert_true(t.fresh + t.flagged < .8 * t.entries);
	assert_true(t.flagged > 0);

	/* Everything where it was at first: the rows of then, though nothing was rebuilt since. */
	for (int k = 0; k < MOVERS; k++)
		pose_both(pair, k, HOME[k]);
	compare(&pair[0], &pair[1], "home again", &t);
	snapshot home_again = snapshot_take(pair[0].gi);
	snapshot_expect_same_rows(&at_home, &home_again, "home again, against the first frame");
	snapshot_free(&home_again);
	snapshot_free((snapshot *)&at_home);
	for (int k = 0; k < 2; k++)
		gi_context_destroy(pair[k].gi);
}

static gi_context_def coarse_def(void)
{
	gi_context_def def = harness_def();
	def.row_tolerance = ROW_TOLERANCE;
	def.solve_tolerance = SOLVE_TOLERANCE;
	def.profile = false;
	return def;
}

static void open_front(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	const char *frames = getenv("RELUME_FRAMES");
	const char *every = getenv("RELUME_COMPARE_EVERY");
	run("open box", open_box, &def, frames ? (uint32_t)atoi(frames) : 50, every ? (uint32_t)atoi(every) : 1, false);
}

static void bright_sky(void **state)
{
	(void)state;
	gi_context_def def = coarse_def();
	def.sky = GI_SKY_ON;
	for (int c = 0; c < 3; c++)
		def.sky_exitance[c] = 3.0f + (float)c;
	run("open box, bright sky", open_box, &def, 50, 1, false);
}

static void closed_room(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	run("closed room", open_room, &def, 50, 1, true);
}

/* ---- materials ---- */

static void light_both(scene pair[2], int which, gi_material m)
{
	for (int k = 0; k < 2; k++)
		assert_gi(gi_set_material(pair[k].gi, which < 0 ? pair[k].light : pair[k].mover[which], 0, m));
}

/* Lamps go out and on again, objects start to shine, turn black and white again, with and without a move in the same
 * frame. */
static void materials(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	const gi_material bright = {.exitance = {40, 30, 20}}, dark = {0}, red = {.rho = {.8f, .1f, .1f}},
			  glowing = {.rho = {.5f, .5f, .5f}, .exitance = {0, 3, 5}}, grey = {.rho = {.5f, .5f, .5f}};
	const struct {
		const char *what;
		int which;
		gi_material value;
		int moves;
	} steps[] = {
	    {"brighter", -1, bright, -1},
	    {"the block glows", BLOCK, glowing, -1},
	    {"the lamp is off", -1, dark, -1},
	    {"the ball is black", BALL, dark, -1},
	    {"the ball is red", BALL, red, BALL},
	    {"the lamp is on", -1, bright, SHEET},
	    {"the sheet glows", SHEET, glowing, BLOCK},
	    {"the block is grey", BLOCK, grey, BLOCK},
	    {"the sheet is black", SHEET, dark, -1},
	    {"the sheet is grey", SHEET, grey, SHEET},
	    {"all dark but the lamp", BLOCK, dark, -1},
	    {"the lamp is off again", -1, dark, BALL},
	    {"a lamp again", -1, bright, -1},
	};
	scene pair[2];
	seed_motion(7);
	for (int k = 0; k < 2; k++)
		open_box(&pair[k], &def);
	motion m = start_motion(false);
	for (int k = 0; k < MOVERS; k++)
		pose_both(pair, k, m.pose[k]);
	tally t = {0};
	compare(&pair[0], &pair[1], "materials, first frame", &t);
	t = (tally){0};
	for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
		light_both(pair, steps[k].which, steps[k].value);
		if (steps[k].moves >= 0)
			pose_both(pair, steps[k].moves, random_pose(steps[k].moves, false));
		compare(&pair[0], &pair[1], steps[k].what, &t);
	}
	print_tally("materials", &t);
	for (int k = 0; k < 2; k++)
		gi_context_destroy(pair[k].gi);
}

/* Of rows only what emits or is black matters: other values change the light alone, and no pass over rows runs. */
static void values_alone(void **state)
{
	(void)state;
	gi_context_def def = coarse_def();
	def.profile = true;
	scene pair[2];
	for (int k = 0; k < 2; k++)
		open_box(&pair[k], &def);
	tally t = {0};
	compare(&pair[0], &pair[1], "values, first frame", &t);
	for (int step = 0; step < 4; step++) {
		const float value = .2f + .2f * (float)step;
		const gi_material m = {.rho = {value, .5f, .5f}}, lamp = {.exitance = {10 * value, 30, 40}};
		light_both(pair, step % 2 ? BALL : -1, step % 2 ? m : lamp);
		compare(&pair[0], &pair[1], "a value", &t);
		gi_report r;
		assert_gi(gi_set_material(pair[0].gi, pair[0].mover[BLOCK], 0, m));
		assert_gi(gi_set_material(pair[1].gi, pair[1].mover[BLOCK], 0, m));
		r = harness_update(pair[0].gi);
		assert_int_equal(r.dirty_rows + r.dirty_entries + r.rays, 0);
		for (int pass = GI_PASS_POSE; pass <= GI_PASS_CLOSE; pass++)
			assert_true(r.pass_ms[pass] == 0);
		assert_true(r.pass_ms[GI_PASS_SOLVE] > 0 && r.sweeps > 0);
	}
	for (int k = 0; k < 2; k++)
		gi_context_destroy(pair[k].gi);
}

/* ---- what is not seen ---- */

static void expect_unseen_is_nothing(gi_context *gi, gi_object object)
{
	double f;
	if (gi_object_is_valid(gi, object)) {
		assert_gi(gi_form_factor(gi, object, (gi_object){0}, &f));
		assert_true(f == 0);
	}
	snapshot s = snapshot_take(gi);
	uint32_t first = s.leaf_count, end = 0;
	for (uint32_t k = 0; k < s.leaf_count; k++) {
		if (s.leaves[k].object.index1 != object.index1)
			continue;
		first = k < first ? k : first;
		end = k + 1;
		for (int c = 0; c < 3; c++)
			assert_true(s.leaves[k].radiosity[c] == 0 && s.leaves[k].irradiance[c] == 0);
	}
	assert_true(first < end);
	for (uint64_t k = 0; k < s.entry_count; k++) {
		const gi_entry *e = &s.entries[k];
		assert_true(e->leaf < first || e->leaf >= end);
		assert_true(!e->leaf_count || e->first_leaf < first || e->first_leaf >= end);
	}
	snapshot_free(&s);
}

/* Hidden and shown, moved meanwhile, lamps too, under a budget between. */
static void hide_and_show(scene pair[2], tally *t)
{
	static const struct {
		const char *what;
		int which; /* -1: the lamp */
		bool hidden;
		int moves;
	} steps[] = {
	    {"the ball is hidden", BALL, true, -1},     {"the hidden ball moves", BALL, true, BALL},
	    {"the block moves", BALL, true, BLOCK},     {"the ball is there again", BALL, false, -1},
	    {"the lamp is hidden", -1, true, SHEET},    {"the block is hidden too", BLOCK, true, BALL},
	    {"the lamp is there again", -1, false, -1}, {"the block is there again", BLOCK, false, SHEET},
	};
	for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
		for (int c = 0; c < 2; c++)
			assert_gi(gi_set_hidden(pair[c].gi,
						steps[k].which < 0 ? pair[c].light : pair[c].mover[steps[k].which],
						steps[k].hidden));
		if (steps[k].moves >= 0)
			pose_both(pair, steps[k].moves, random_pose(steps[k].moves, false));
		assert_gi(gi_update(pair[0].gi, &(gi_budget){.rays = 2000}));
		compare(&pair[0], &pair[1], steps[k].what, t);
		if (steps[k].hidden)
			expect_unseen_is_nothing(pair[0].gi,
						 steps[k].which < 0 ? pair[0].light : pair[0].mover[steps[k].which]);
	}
}

static void hide_movers(scene pair[2], bool hidden)
{
	for (int c = 0; c < 2; c++)
		for (int k = 0; k < MOVERS; k++)
			assert_gi(gi_set_hidden(pair[c].gi, pair[c].mover[k], hidden));
}

static void expect_destroyed_is_nothing(scene pair[2], double all, tally *t)
{
	for (int c = 0; c < 2; c++)
		assert_gi(gi_destroy_object(pair[c].gi, pair[c].mover[BALL]));
	compare(&pair[0], &pair[1], "the ball is gone", t);
	expect_unseen_is_nothing(pair[0].gi, pair[0].mover[BALL]);
	const gi_report before = harness_update(pair[0].gi);
	assert_gi(gi_commit(pair[0].gi));
	const gi_report after = harness_update(pair[0].gi);
	printf("  %.0f entries; without the ball %llu, and %llu after the commit\n", all,
	       (unsigned long long)before.entries, (unsigned long long)after.entries);
	assert_int_equal(before.entries, after.entries);
	assert_true((double)after.entries < all);
}

static void unseen(void **state)
{
	(void)state;
	const gi_context_def def = coarse_def();
	scene pair[2];
	seed_motion(99);
	for (int k = 0; k < 2; k++)
		open_box(&pair[k], &def);
	tally t = {0};
	compare(&pair[0], &pair[1], "unseen, first frame", &t);
	const double all = t.entries;
	snapshot at_first = snapshot_take(pair[0].gi);
	hide_and_show(pair, &t);
	for (int k = 0; k < MOVERS; k++)
		pose_both(pair, k, gi_pose_identity());
	hide_movers(pair, true);
	compare(&pair[0], &pair[1], "all movers hidden", &t);
	hide_movers(pair, false);
	compare(&pair[0], &pair[1], "all as it was", &t);
	snapshot at_last = snapshot_take(pair[0].gi);
	snapshot_expect_same_rows(&at_first, &at_last, "all as it was");
	snapshot_free(&at_first);
	snapshot_free(&at_last);
	expect_destroyed_is_nothing(pair, all, &t);
	for (int k = 0; k < 2; k++)
		gi_context_destroy(pair[k].gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(open_front), cmocka_unit_test(bright_sky),   cmocka_unit_test(closed_room),
	    cmocka_unit_test(materials),  cmocka_unit_test(values_alone), cmocka_unit_test(unseen),
	};
	return cmocka_run_group_tests_name("update", tests, harness_open, harness_close);
}
