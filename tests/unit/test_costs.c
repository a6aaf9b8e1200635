/* What updates under a budget of time learn from the times of those before: a machine of known prices is simulated, and
 * its clock is stalled, slowed and turned back.
 */
#include "costs.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>

static const float BUDGET_MS = 4;
static const double WANTED_RAYS = 30000, WANTED_ROWS = 400;

typedef enum part { PART_RAYS, PART_ROWS, PART_SWEEPS, PART_FIXED, PARTS } part;

/* Passes take a time of their own and one for each ray, row or sweep. `slow` is what the whole machine is slowed by. */
typedef struct machine {
	double slow;
	uint32_t frame;
} machine;

static double total_ms(const gi_spent *s)
{
	return (double)s->by_ray + (double)s->fixed;
}

/* stall: ms that one part takes longer. */
static gi_spent spend(const machine *m, const gi_costs *costs, part stalled, double stall)
{
	const double rays = fmin(WANTED_RAYS, gi_costs_rays(costs, BUDGET_MS));
	const double rows = fmin(WANTED_ROWS, gi_costs_rows(costs, BUDGET_MS));
	const double sweeps = fmin(100, floor(gi_costs_sweeps(costs, BUDGET_MS)));
	gi_spent s = {.rays = (uint64_t)fmax(20, rays), .rows = (uint32_t)rows, .sweeps = (uint32_t)sweeps};
	s.late = rays < WANTED_RAYS;
	const double noise = 1 + .05 * sin(2.4 * m->frame);
	double ms[PARTS] = {m->slow * noise * (.3 + 1.2e-4 * (double)s.rays), m->slow * noise * (.05 + 2e-3 * s.rows),
			    m->slow * noise * (.02 + .12 * s.sweeps), 0};
	ms[PART_FIXED] = m->slow * noise * .4;
	ms[stalled] += stall;
	s.by_ray = (float)ms[PART_RAYS];
	s.by_row = (float)ms[PART_ROWS];
	s.by_sweep = (float)ms[PART_SWEEPS];
	s.fixed = (float)(ms[PART_ROWS] + ms[PART_SWEEPS] + ms[PART_FIXED]);
	return s;
}

/* `frames` more; the last one's. */
static gi_spent play(machine *m, gi_costs *costs, uint32_t frames)
{
	gi_spent last = {0};
	for (uint32_t k = 0; k < frames; k++, m->frame++) {
		last = spend(m, costs, PART_FIXED, 0);
		gi_costs_learn(costs, &last);
	}
	return last;
}

static void stall_once(machine *m, gi_costs *costs, part where, double ms)
{
	const gi_spent s = spend(m, costs, where, ms);
	gi_costs_learn(costs, &s);
	m->frame++;
}

static void a_stalled_frame_changes_nothing(void **state)
{
	(void)state;
	machine calm = {.slow = 1};
	gi_costs learned = {0};
	const gi_spent before = play(&calm, &learned, 60);
	printf("  calm: %llu rays, %u rows, %u sweeps in %.2f ms of %.0f\n", (unsigned long long)before.rays,
	       before.rows, before.sweeps, total_ms(&before), (double)BUDGET_MS);
	assert_true(fabs(total_ms(&before) - BUDGET_MS) < .15 * BUDGET_MS);
	for (int where = 0; where < PARTS; where++)
		for (uint32_t stalls = 1; stalls <= 2; stalls++) {
			machine m = calm;
			gi_costs costs = learned;
			for (uint32_t k = 0; k < stalls; k++)
				stall_once(&m, &costs, (part)where, 500);
			uint64_t least = UINT64_MAX;
			for (int k = 0; k < 20; k++) {
				const gi_spent s = play(&m, &costs, 1);
				least = s.rays < least ? s.rays : least;
			}
			printf("  %u stalled in part %d: at least %llu rays after it\n", stalls, where,
			       (unsigned long long)least);
			assert_true((double)least > .85 * (double)before.rays);
		}
}

/* The very first frames compile shaders, or wait for a disk. */
static void a_start_that_stalls_is_forgotten(void **state)
{
	(void)state;
	machine calm = {.slow = 1};
	gi_costs costs = {0};
	const gi_spent wanted = play(&calm, &costs, 60);
	for (int where = 0; where < PARTS; where++) {
		machine m = {.slow = 1};
		costs = (gi_costs){0};
		stall_once(&m, &costs, (part)where, 3000);
		const gi_spent s = play(&m, &costs, 25);
		printf("  first frame stalled in part %d: %llu rays 25 frames later\n", where,
		       (unsigned long long)s.rays);
		assert_true((double)s.rays > .85 * (double)wanted.rays);
	}
}

/* A laptop that clocks down, and up again. */
static void lasting_changes_are_followed(void **state)
{
	(void)state;
	machine m = {.slow = 1};
	gi_costs costs = {0};
	const gi_spent fast = play(&m, &costs, 60);
	m.slow = 2.5;
	const gi_spent slow = play(&m, &costs, 12);
	m.slow = 1;
	const gi_spent again = play(&m, &costs, 25);
	printf("  %llu rays; %llu in %.2f ms on a machine 2.5 times slower; %llu after it\n",
	       (unsigned long long)fast.rays, (unsigned long long)slow.rays, total_ms(&slow),
	       (unsigned long long)again.rays);
	assert_true(total_ms(&slow) < 1.25 * BUDGET_MS);
	assert_true((double)again.rays > .85 * (double)fast.rays);
}

static void times_that_are_none_are_ignored(void **state)
{
	(void)state;
	gi_price price = {0};
	gi_price_add(&price, -3600);
	gi_price_add(&price, NAN);
	gi_price_add(&price, INFINITY);
	gi_price_add(&price, 0);
	assert_true(gi_price_of(&price) == 0);
	for (int k = 1; k <= 7; k++)
		gi_price_add(&price, (float)k);
	assert_true(gi_price_of(&price) == 5);
	machine m = {.slow = 1};
	gi_costs costs = {0};
	const gi_spent before = play(&m, &costs, 60);
	for (int where = 0; where < PARTS; where++)
		stall_once(&m, &costs, (part)where, -1e6);
	const gi_spent after = play(&m, &costs, 5);
	assert_true(fabs((double)after.rays - (double)before.rays) < .1 * (double)before.rays);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_stalled_frame_changes_nothing),
	    cmocka_unit_test(a_start_that_stalls_is_forgotten),
	    cmocka_unit_test(lasting_changes_are_followed),
	    cmocka_unit_test(times_that_are_none_are_ignored),
	};
	return cmocka_run_group_tests_name("costs", tests, NULL, NULL);
}
