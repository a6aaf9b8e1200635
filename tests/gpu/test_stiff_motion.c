/* Scenes that reflect nearly everything while they move, solves cut short: no light from nothing, no bound exceeded,
 * never farther from the solution than from a cold start, and at rest the same light as from a cold start.
 *
 * RELUME_SCENES=N: as many scenes; the default takes about half a minute. RELUME_SCENE=N: that one alone.
 */
#include "exact_rows.h"
#include "random_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { DEFAULT_SCENES = 24, FRAMES = 8, CONTEXTS = 6 };

static const float NO_SKY[3];

typedef struct pair {
	gi_context *warm, *cold;
	gi_context_def def;
} pair;

typedef struct tally {
	uint32_t frames, budgets, compared, at_rest, at_rounding;
	double most_of_ceiling, most_of_cold, most_of_bound, rest_apart;
	uint64_t cold_seed;
} tally;

/* Some sweeps a frame. */
static gi_context_def def_of(uint32_t which)
{
	static const uint32_t sweeps[CONTEXTS] = {2, 3, 7, 20, 50, 100};
	gi_context_def def = harness_def();
	def.row_tolerance = 0.1f;
	def.max_sweeps = sweeps[which];
	return def;
}

/* What no B exceeds: where it is largest, B <= E + rho B. */
static void ceiling_of(const snapshot *s, double ceiling[3])
{
	for (uint32_t c = 0; c < 3; c++)
		ceiling[c] = 0;
	for (uint32_t k = 0; k < 3 * s->leaf_count; k++) {
		const gi_leaf *l = &s->leaves[k / 3];
		ceiling[k % 3] = fmax(ceiling[k % 3], (double)l->exitance[k % 3] / (1 - (double)l->rho[k % 3]));
	}
}

/* The ceiling, what E leaves of it for R, and E + R are each rounded to float: half a unit in the last place, three
 * times. */
static const double ROUNDED = 1.8e-7;

static void expect_within(const snapshot *s, uint64_t seed, int frame, tally *t)
{
	double ceiling[3];
	ceiling_of(s, ceiling);
	for (uint32_t k = 0; k < 3 * s->leaf_count; k++) {
		const gi_leaf *l = &s->leaves[k / 3];
		const double b = (double)l->radiosity[k % 3], e = (double)l->exitance[k % 3], most = ceiling[k % 3];
		if (!(b >= e && b <= most * (1 + ROUNDED)))
			fail_msg("scene %llu, frame %d: B is %.9g, outside [%.9g, %.9g]", (unsigned long long)seed,
				 frame, b, e, most);
		t->most_of_ceiling = fmax(t->most_of_ceiling, most > 0 ? b / most : 0);
	}
}

static double certified_distance(gi_context *gi, const gi_report *r, const snapshot *s, uint64_t seed, int frame,
				 tally *t)
{
	(void)gi;
	const double bound = (double)r->solve_bound, distance = exact_distance(s, r, NO_SKY, INFINITY);
	if (!(distance <= bound))
		fail_msg("scene %llu, frame %d: B is %.6g from the solution, and the certified bound says %.6g",
			 (unsigned long long)seed, frame, distance, bound);
	t->most_of_bound = fmax(t->most_of_bound, bound > 0 ? distance / bound : 0);
	return distance;
}

static gi_report update_under(gi_context *gi, const gi_budget *budget)
{
	gi_report r = {0};
	if (gi_update(gi, budget) || gi_finish(gi) || gi_get_report(gi, &r))
		fail_msg("update: %s", harness_last_message());
	assert_true(r.outcome > 0);
	return r;
}

static double largest_reflected(const snapshot *s)
{
	double most = 0;
	for (uint32_t k = 0; k < 3 * s->leaf_count; k++)
		most = fmax(most, (double)s->leaves[k / 3].radiosity[k % 3] - (double)s->leaves[k / 3].exitance[k % 3]);
	return most;
}

/* A frame of a scene whose rows are exact, beside a cold start. */
static void compare(pair *p, uint64_t seed, int frame, tally *t)
{
	gi_reset_radiosity(p->cold);
	const gi_report warm = update_under(p->warm, NULL), cold = update_under(p->cold, NULL);
	snapshot a = snapshot_take(p->warm), b = snapshot_take(p->cold);
	expect_within(&a, seed, frame, t);
	expect_within(&b, seed, frame, t);
	if (warm.outcome != GI_OUTCOME_AT_REST) {
		assert_true(warm.sweeps <= p->def.max_sweeps && cold.sweeps <= p->def.max_sweeps);
		const double far = certified_distance(p->warm, &warm, &a, seed, frame, t);
		const double cold_far = certified_distance(p->cold, &cold, &b, seed, frame, t);
		const double tolerated = (double)p->def.solve_tolerance * largest_reflected(&b);
		if (getenv("RELUME_VERBOSE") && far > fmax(cold_far, tolerated))
			printf("scene %llu frame %d sweeps %u/%u (%u) q %g: warm %g cold %g tolerated %g ratio %g "
			       "outcomes %d %d bound %g %g A %g\n",
			       (unsigned long long)seed, frame, warm.sweeps, cold.sweeps, p->def.max_sweeps,
			       (double)(1 - warm.contraction), far, cold_far, tolerated,
			       far / fmax(cold_far, tolerated), warm.outcome, cold.outcome, (double)warm.solve_bound,
			       (double)cold.solve_bound, (double)warm.amplification);
		const double ratio = far / fmax(fmax(cold_far, tolerated), 1e-30);
		if (ratio > t->most_of_cold) {
			t->most_of_cold = ratio;
			t->cold_seed = seed;
		}
		t->compared++;
	}
	snapshot_free(&a);
	snapshot_free(&b);
}

/* A frame under a budget; the cold context is left alone. */
static void under_budget(pair *p, random_scene *scene, uint64_t seed, int frame, tally *t)
{
	const double kind = random_scene_draw(scene);
	const gi_budget budget = {.rays = kind < .5 ? 1 + (uint64_t)(random_scene_draw(scene) * 2000) : 0,
				  .error = kind > .3 && kind < .7 ? (float)(random_scene_draw(scene) * .5) : 0,
				  .ms = kind > .7 ? (float)exp2(13 * random_scene_draw(scene) - 10) : 0};
	const gi_report r = update_under(p->warm, &budget);
	snapshot s = snapshot_take(p->warm);
	expect_within(&s, seed, frame, t);
	if (r.outcome != GI_OUTCOME_AT_REST)
		certified_distance(p->warm, &r, &s, seed, frame, t);
	t->budgets++;
	snapshot_free(&s);
}

static gi_report come_to_rest(gi_context *gi)
{
	gi_report r = update_under(gi, NULL), last = r;
	for (int k = 0; k < 20000 && r.outcome != GI_OUTCOME_AT_REST; k++) {
		last = r;
		r = update_under(gi, NULL);
	}
	assert_int_equal(r.outcome, GI_OUTCOME_AT_REST);
	return last;
}

/* Light of the two at rest, leaf by leaf, within what both say it may be off by. */
static void expect_same_at_rest(pair *p, uint64_t seed, tally *t)
{
	gi_reset_radiosity(p->cold);
	come_to_rest(p->warm);
	come_to_rest(p->cold);
	gi_report a, b;
	assert_gi(gi_get_report(p->warm, &a));
	assert_gi(gi_get_report(p->cold, &b));
	snapshot warm = snapshot_take(p->warm), cold = snapshot_take(p->cold);
	const double apart = snapshot_distance(&warm, &cold), bounds = (double)a.solve_bound + (double)b.solve_bound;
	if (!(apart <= bounds))
		fail_msg("scene %llu: at rest %g apart, bounds %g", (unsigned long long)seed, apart, bounds);
	const bool met = a.solve_relative <= p->def.solve_tolerance && b.solve_relative <= p->def.solve_tolerance;
	t->at_rest++;
	t->at_rounding += !met;
	if (met)
		t->rest_apart = fmax(t->rest_apart, apart / fmax(largest_reflected(&cold), 1e-30));
	snapshot_free(&warm);
	snapshot_free(&cold);
}

static void play(pair *p, uint64_t seed, tally *t)
{
	random_scene warm = random_scene_make_stiff(p->warm, seed), cold = random_scene_make_stiff(p->cold, seed);
	const bool budgets = seed % 3 == 2;
	for (int frame = 0; frame < FRAMES; frame++, t->frames++) {
		if (frame) {
			random_scene_move(p->warm, &warm);
			if (!budgets)
				random_scene_move(p->cold, &cold);
		}
		if (budgets)
			under_budget(p, &warm, seed, frame, t);
		else
			compare(p, seed, frame, t);
	}
	if (!budgets && warm.brightest_rho < .999f)
		expect_same_at_rest(p, seed, t);
	random_scene_clear(p->warm, &warm);
	random_scene_clear(p->cold, &cold);
}

/* ---- sweeps of a frame that end astray ---- */

enum { ASTRAY_SCENES = 48, ASTRAY_SWEEPS = 7, RESTS = 6 };

/* Rows so coarse that Chebyshev's steps fail over and over, in frames of few sweeps, while the scene moves and when it
 * rests: whatever sweep ends a frame, what it says of B holds of the B that stands there. */
static void few_sweeps_astray(void **state)
{
	(void)state;
	const char *wanted = getenv("RELUME_ASTRAY");
	const uint64_t scenes = wanted ? strtoull(wanted, NULL, 10) : ASTRAY_SCENES;
	tally t = {0};
	for (uint32_t sweeps = 1; sweeps <= ASTRAY_SWEEPS; sweeps++) {
		gi_context_def def = harness_def();
		def.row_tolerance = 0.3f;
		def.solve_tolerance = 1e-5f;
		def.max_sweeps = sweeps;
		gi_context *gi = harness_context(&def);
		for (uint64_t seed = sweeps - 1; seed < scenes; seed += ASTRAY_SWEEPS) {
			random_scene scene = random_scene_make_stiff(gi, 5000 + seed);
			for (int frame = 0; frame < FRAMES * RESTS; frame++, t.frames++) {
				if (frame && frame % RESTS == 0)
					random_scene_move(gi, &scene);
				const gi_report r = update_under(gi, NULL);
				if (r.outcome == GI_OUTCOME_AT_REST)
					continue;
				assert_true(r.sweeps <= sweeps);
				snapshot s = snapshot_take(gi);
				expect_within(&s, seed, frame, &t);
				certified_distance(gi, &r, &s, seed, frame, &t);
				snapshot_free(&s);
			}
			random_scene_clear(gi, &scene);
		}
		gi_context_destroy(gi);
	}
	printf("  %u frames of 1 to %d sweeps in coarse rows: distance at most %.6f of the bound\n", t.frames,
	       ASTRAY_SWEEPS, t.most_of_bound);
}

static uint32_t scenes_wanted(void)
{
	const char *wanted = getenv("RELUME_SCENES");
	return wanted ? (uint32_t)strtoul(wanted, NULL, 10) : DEFAULT_SCENES;
}

static void stiff_motion(void **state)
{
	(void)state;
	const uint32_t scenes = scenes_wanted();
	const char *only = getenv("RELUME_SCENE");
	tally t = {0};
	for (uint32_t which = 0; which < CONTEXTS; which++) {
		pair p = {.def = def_of(which)};
		p.warm = harness_context(&p.def);
		p.cold = harness_context(&p.def);
		for (uint64_t seed = which; seed < scenes; seed += CONTEXTS)
			if (!only || strtoull(only, NULL, 10) == seed)
				play(&p, seed, &t);
		gi_context_destroy(p.warm);
		gi_context_destroy(p.cold);
	}
	printf(
	    "  %u scenes, %u frames, %u of them under budgets: B at most %.6f of max E / (1 - rho), distance at most "
	    "%.4f of the bound\n",
	    scenes, t.frames, t.budgets, t.most_of_ceiling, t.most_of_bound);
	printf("  %u frames beside a cold start: at most %.3f of its distance, or of the tolerance (scene %llu)\n",
	       t.compared, t.most_of_cold, (unsigned long long)t.cold_seed);
	printf("  at rest %u scenes, %u of them at rounding; the others %.1e of the largest R from a cold start's\n",
	       t.at_rest, t.at_rounding, t.rest_apart);
	assert_true(t.most_of_cold <= 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(stiff_motion), cmocka_unit_test(few_sweeps_astray)};
	return cmocka_run_group_tests_name("stiff motion", tests, harness_open, harness_close);
}
