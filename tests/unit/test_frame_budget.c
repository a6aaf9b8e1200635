/* The budget that keeps a frame rate, against frames made up of a known rest and an update that behaves in known ways.
 */
#include "frame_budget.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

/* A renderer: an exact update takes exact_ms; one of m ms takes m + over_ms, and after exact_ms of work nothing waits.
 */
typedef struct renderer {
	frame_budget budget;
	double now_ms, rest_ms, exact_ms, over_ms;
	double fixed_ms;  /* of every update */
	double undone_ms; /* work that waits */
	double update_ms; /* of the newest frame, as the next two */
	double frame_ms;
	uint64_t frames;
} renderer;

static void frame(renderer *r, bool moved)
{
	const double asked = (double)frame_budget_next(&r->budget, moved, r->now_ms).ms;
	if (moved)
		r->undone_ms = r->exact_ms;
	const double work = asked > 0 && r->frames ? fmin(asked, r->undone_ms) : r->undone_ms;
	r->undone_ms -= work;
	r->update_ms = work > 0 ? fmax(work, r->fixed_ms) + (asked > 0 ? r->over_ms : 0) : 0;
	r->frame_ms = r->rest_ms + r->update_ms;
	gi_report report = {.frame = ++r->frames,
			    .outcome = work > 0 ? GI_OUTCOME_CONVERGED : GI_OUTCOME_AT_REST,
			    .leaves = 100,
			    .waiting_rows = r->undone_ms > 0 ? 50 : 0};
	report.pass_ms[GI_PASS_SOLVE] = (float)fmin(r->fixed_ms, r->update_ms);
	report.pass_ms[GI_PASS_TRACE] = (float)r->update_ms - report.pass_ms[GI_PASS_SOLVE];
	report.pass_ms[GI_PASS_DRAW] = (float)r->rest_ms;
	frame_budget_note(&r->budget, r->frame_ms, &report);
	r->now_ms += r->frame_ms;
}

static renderer make(double fps, double rest_ms, double exact_ms, double over_ms)
{
	renderer r = {.budget = frame_budget_make(fps),
		      .now_ms = 1000,
		      .rest_ms = rest_ms,
		      .exact_ms = exact_ms,
		      .over_ms = over_ms,
		      .undone_ms = exact_ms};
	frame(&r, false);
	return r;
}

static void run(renderer *r, int frames, bool moved)
{
	for (int k = 0; k < frames; k++)
		frame(r, moved);
}

static void assert_near(double value, double expected, double off)
{
	if (!(fabs(value - expected) <= off))
		fail_msg("%g is not %g within %g", value, expected, off);
}

static void test_keeps_the_rate(void **state)
{
	(void)state;
	for (double over = -3; over <= 8; over += 11) { /* a library that takes less or more than it was given */
		renderer r = make(30, 12, 300, over);
		run(&r, 40, true);
		assert_near(r.frame_ms, 1e3 / 30, 0.1);
		r.rest_ms = 20; /* the window grows */
		run(&r, 40, true);
		assert_near(r.frame_ms, 1e3 / 30, 0.1);
		r.rest_ms = 3;
		run(&r, 40, true);
		assert_near(r.frame_ms, 1e3 / 30, 0.1);
	}
}

static void test_one_slow_frame_is_forgotten(void **state)
{
	(void)state;
	renderer r = make(30, 12, 300, 0);
	run(&r, 40, true);
	r.rest_ms = 1000;
	frame(&r, true);
	r.rest_ms = 12;
	run(&r, 5, true);
	assert_near(r.frame_ms, 1e3 / 30, 3);
}

static void test_moves_on_when_drawing_is_slow(void **state)
{
	(void)state;
	renderer r = make(30, 80, 300, 0);
	run(&r, 40, true);
	assert_near(r.update_ms, 1e3 / 30 / 8, 0.01);
}

static void test_keeps_the_rate_to_the_last(void **state)
{
	(void)state;
	renderer r = make(30, 12, 300, 0);
	r.fixed_ms = 18; /* leaves 3.3 ms for rays */
	run(&r, 80, true);
	assert_near(r.frame_ms, 1e3 / 30, 0.1);
}

static void test_exact_within_a_second_of_rest(void **state)
{
	(void)state;
	for (double exact = 40; exact <= 500; exact += 46) {
		renderer r = make(30, 12, exact, 5);
		run(&r, 40, true);
		assert_true(r.undone_ms > 0);
		const double stopped = r.now_ms;
		double longest = 0;
		while (r.undone_ms > 0) {
			frame(&r, false);
			longest = fmax(longest, r.frame_ms);
		}
		assert_true(r.now_ms - stopped < 1000 + 12);
		assert_true(longest < 500 + 12);
		run(&r, 40, false);
		assert_near(r.update_ms, 0, 0);
		/* Moving again does not begin with a whole update. */
		frame(&r, true);
		assert_true(r.frame_ms < 50);
	}
}

static void test_exact_where_it_fits(void **state)
{
	(void)state;
	renderer r = make(30, 12, 5, 2);
	run(&r, 10, true);
	assert_near(r.update_ms, 5, 0);
	assert_near(r.budget.asked_ms, 0, 0);
	r.exact_ms = 300; /* until something large moves */
	run(&r, 40, true);
	assert_near(r.frame_ms, 1e3 / 30, 0.1);
}

static void test_exact_without_a_rate(void **state)
{
	(void)state;
	renderer r = make(0, 12, 300, 0);
	run(&r, 5, true);
	assert_near(r.update_ms, 300, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_keeps_the_rate),
	    cmocka_unit_test(test_one_slow_frame_is_forgotten),
	    cmocka_unit_test(test_moves_on_when_drawing_is_slow),
	    cmocka_unit_test(test_keeps_the_rate_to_the_last),
	    cmocka_unit_test(test_exact_within_a_second_of_rest),
	    cmocka_unit_test(test_exact_where_it_fits),
	    cmocka_unit_test(test_exact_without_a_rate),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
