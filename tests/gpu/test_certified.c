/* The certified bounds on thousands of random scenes and moves: |B - B*| is never above them, B as stored in single
 * precision. Without a budget B* is the double-precision solution of the same links; with one it is that of the links
 * an exact update would have, and the bound is solve_bound + stale_bound. No rounding allowance on top: the bounds have
 * it.
 *
 * RELUME_SCENES=N: as many scenes of four frames each; the default takes about twenty seconds.
 */
#include "exact_rows.h"
#include "random_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEFAULT_SCENES = 75, FRAMES = 4, CONTEXTS = 3 };

/* Bound over true distance; 1 or more, or the bound is wrong. */
typedef struct tally {
	uint32_t waited; /* of the frames under a budget: some rows waited */
	double *ratios;
	uint32_t count, capacity, by_outcome[8], by_chebyshev;
	double least;
	uint64_t least_seed, sweeps;
} tally;

/* The default, one that cuts solves short, and one that single precision often cannot meet; each under another sky. */
static gi_context_def def_of(uint32_t which)
{
	gi_context_def def = harness_def();
	def.row_tolerance = 0.1f;
	def.profile = false;
	if (which == 1) {
		def.max_sweeps = 3;
		def.sky_exitance[0] = def.sky_exitance[1] = def.sky_exitance[2] = 2;
	} else if (which == 2) {
		def.max_sweeps = 1000;
		def.solve_tolerance = 1e-6f;
		def.sky_exitance[2] = 0.1f;
	}
	return def;
}

static void note_ratio(tally *t, double bound, double distance, uint64_t seed)
{
	if (distance <= 0 || t->count == t->capacity)
		return;
	const double ratio = bound / distance;
	t->ratios[t->count++] = ratio;
	if (ratio < t->least) {
		t->least = ratio;
		t->least_seed = seed;
	}
}

/* A frame of a scene: updates, and tests what it reports. */
typedef void frame_fn(gi_context *gi, const gi_context_def *def, random_scene *scene, uint64_t seed, int frame,
		      tally *t);

static void expect_certified(gi_context *gi, const gi_context_def *def, random_scene *scene, uint64_t seed, int frame,
			     tally *t)
{
	(void)scene;
	const gi_report r = harness_update(gi);
	if (r.outcome == GI_OUTCOME_AT_REST)
		return;
	assert_true(r.outcome == GI_OUTCOME_CONVERGED || r.outcome == GI_OUTCOME_SWEEPS ||
		    r.outcome == GI_OUTCOME_ROUNDING);
	snapshot s = snapshot_take(gi);
	const double bound = (double)r.solve_bound, distance = exact_distance(&s, &r, def->sky_exitance, bound);
	if (!(distance <= bound))
		fail_msg(
		    "scene %llu, frame %d: B is %.6g from the solution, and the certified bound says %.6g (outcome %d, "
		    "amplification %g)",
		    (unsigned long long)seed, frame, distance, bound, r.outcome, (double)r.amplification);
	assert_true(r.rounding_bound <= r.solve_bound && r.amplification >= 1);
	assert_true(r.outcome != GI_OUTCOME_CONVERGED || r.solve_relative <= def->solve_tolerance);
	snapshot_free(&s);
	t->by_outcome[r.outcome]++;
	t->by_chebyshev += r.method == GI_METHOD_CHEBYSHEV;
	t->sweeps += r.sweeps;
	note_ratio(t, bound, distance, seed);
}

/* Holds B as it is, of the last of some updates under a budget, against the solution of the rows of an exact update. */
static void compare_with_exact(gi_context *gi, const gi_context_def *def, const gi_report *r, uint64_t seed, int frame,
			       tally *t)
{
	snapshot under = snapshot_take(gi);
	const gi_report full = harness_update(gi);
	assert_int_equal(full.waiting_rows, 0);
	snapshot exact = snapshot_take(gi);
	for (uint32_t k = 0; k < exact.leaf_count; k++)
		memcpy(exact.leaves[k].radiosity, under.leaves[k].radiosity, sizeof exact.leaves[k].radiosity);
	const double bound = (double)r->solve_bound + (double)r->stale_bound;
	const double distance = exact_distance(&exact, &full, def->sky_exitance, bound);
	if (!(distance <= bound))
		fail_msg("scene %llu, frame %d: B is %.6g from the solution of the exact rows; solve_bound %.6g, "
			 "stale_bound %.6g "
			 "(%llu of %u rows wait)",
			 (unsigned long long)seed, frame, distance, (double)r->solve_bound, (double)r->stale_bound,
			 (unsigned long long)r->waiting_rows, r->leaves);
	snapshot_free(&under);
	snapshot_free(&exact);
	t->by_outcome[r->outcome]++;
	t->waited += r->waiting_rows > 0;
	if (r->waiting_rows)
		note_ratio(t, bound, distance, seed);
}

static gi_report update_under(gi_context *gi, const gi_budget *budget)
{
	gi_report r = {0};
	if (gi_update(gi, budget) || gi_finish(gi) || gi_get_report(gi, &r))
		fail_msg("update: %s", harness_last_message());
	return r;
}

/* Updates under a budget but for the first time, then exactly, and holds the first B against the solution of the second
 * rows. */
static void expect_bounded(gi_context *gi, const gi_context_def *def, random_scene *scene, uint64_t seed, int frame,
			   tally *t)
{
	if (frame == 0) {
		harness_update(gi);
		return;
	}
	const double kind = random_scene_draw(scene);
	const gi_budget budget = {.rays = kind < .6 ? 1 + (uint64_t)(random_scene_draw(scene) * 2000) : 0,
				  .error = kind > .4 ? (float)(random_scene_draw(scene) * .5) : 0};
	const gi_report r = update_under(gi, &budget);
	compare_with_exact(gi, def, &r, seed, frame, t);
}

/* The same under a budget of time, from what nothing fits into to what all may fit into, with up to five updates in a
 * row: rows keep their bounds from one to the next where nothing moved between. */
static void expect_bounded_in_time(gi_context *gi, const gi_context_def *def, random_scene *scene, uint64_t seed,
				   int frame, tally *t)
{
	if (frame == 0) {
		harness_update(gi);
		return;
	}
	const gi_budget budget = {.ms = (float)exp2(13 * random_scene_draw(scene) - 10),
				  .error = random_scene_draw(scene) > .7 ? (float)(random_scene_draw(scene) * .5) : 0};
	const int updates = (int)(random_scene_draw(scene) * 5);
	gi_report r = update_under(gi, &budget);
	for (int k = 0; k < updates; k++) {
		if (random_scene_draw(scene) > .6)
			random_scene_move(gi, scene);
		r = update_under(gi, &budget);
	}
	compare_with_exact(gi, def, &r, seed, frame, t);
}

static int order_doubles(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return x < y ? -1 : x > y;
}

static void print_outcomes(const tally *t)
{
	const uint32_t all =
	    t->by_outcome[GI_OUTCOME_CONVERGED] + t->by_outcome[GI_OUTCOME_SWEEPS] + t->by_outcome[GI_OUTCOME_ROUNDING];
	printf("  %u solves: %u met the tolerance, %u had no more sweeps, %u (%.0f %%) ended at rounding; %u by "
	       "Chebyshev; %.1f sweeps a solve\n",
	       all, t->by_outcome[GI_OUTCOME_CONVERGED], t->by_outcome[GI_OUTCOME_SWEEPS],
	       t->by_outcome[GI_OUTCOME_ROUNDING], 100.0 * t->by_outcome[GI_OUTCOME_ROUNDING] / all, t->by_chebyshev,
	       (double)t->sweeps / all);
}

static uint32_t scenes_wanted(void)
{
	const char *wanted = getenv("RELUME_SCENES");
	return wanted ? (uint32_t)strtoul(wanted, NULL, 10) : DEFAULT_SCENES;
}

static tally new_tally(uint32_t capacity)
{
	tally t = {.capacity = capacity, .least = INFINITY};
	t.ratios = calloc(t.capacity + 1, sizeof *t.ratios);
	assert_non_null(t.ratios);
	return t;
}

static tally run_scenes(frame_fn *expect, bool profile)
{
	const uint32_t scenes = scenes_wanted();
	tally t = new_tally(scenes * FRAMES);
	for (uint32_t which = 0; which < CONTEXTS; which++) {
		gi_context_def def = def_of(which);
		def.profile = profile;
		gi_context *gi = harness_context(&def);
		for (uint64_t seed = which; seed < scenes; seed += CONTEXTS) {
			random_scene scene = random_scene_make(gi, seed);
			for (int frame = 0; frame < FRAMES; frame++) {
				if (frame)
					random_scene_move(gi, &scene);
				expect(gi, &def, &scene, seed, frame, &t);
			}
			random_scene_clear(gi, &scene);
		}
		gi_context_destroy(gi);
	}
	qsort(t.ratios, t.count, sizeof *t.ratios, order_doubles);
	return t;
}

static void print_ratios(const tally *t)
{
	printf("  bound over true distance: median %.2f, least %.4f (scene %llu)\n", t->ratios[t->count / 2], t->least,
	       (unsigned long long)t->least_seed);
}

static void never_exceeded(void **state)
{
	(void)state;
	tally t = run_scenes(expect_certified, false);
	print_outcomes(&t);
	print_ratios(&t);
	/* Every way a solve can end was seen. */
	assert_true(t.by_outcome[GI_OUTCOME_CONVERGED] && t.by_outcome[GI_OUTCOME_SWEEPS] &&
		    t.by_outcome[GI_OUTCOME_ROUNDING] && t.by_chebyshev);
	free(t.ratios);
}

static void expect_never_exceeded(frame_fn *expect, bool profile)
{
	tally t = run_scenes(expect, profile);
	printf("  %u of %u frames under a budget had waiting rows\n", t.waited, scenes_wanted() * (FRAMES - 1));
	print_ratios(&t);
	assert_true(t.waited > scenes_wanted() / 2);
	free(t.ratios);
}

static void budgets_never_exceeded(void **state)
{
	(void)state;
	expect_never_exceeded(expect_bounded, false);
}

static void times_never_exceeded(void **state)
{
	(void)state;
	expect_never_exceeded(expect_bounded_in_time, true); /* a budget of time needs the timers */
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(never_exceeded), cmocka_unit_test(budgets_never_exceeded),
					   cmocka_unit_test(times_never_exceeded)};
	return cmocka_run_group_tests_name("certified", tests, harness_open, harness_close);
}
