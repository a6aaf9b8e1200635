/* The triangle next to a point: against all of them one by one, and of two sheets the one that faces the same way. */
#include "engine/nearest.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TRIANGLES = 700, POINTS = 400 };

static uint32_t seed = 1;

static float random_float(void)
{
	seed = seed * 1664525u + 1013904223u;
	return (float)(seed >> 8) / 16777216;
}

/* Squared distance to the nearest of many points of a triangle, refined about the best: never less than it is. */
static double search_distance(const float p[3], const engine_triangle *t)
{
	double best = HUGE_VAL, u = .5, v = .5, width = .5;
	for (int round = 0; round < 24; round++, width *= .5) {
		const double about[2] = {u, v};
		for (int k = 0; k < 49; k++) {
			const double a = fmin(fmax(about[0] + width * (k % 7 - 3) / 3, 0), 1),
				     b = fmin(fmax(about[1] + width * (k / 7 - 3) / 3, 0), 1 - a);
			double sum = 0;
			for (int c = 0; c < 3; c++)
				sum += pow((1 - a - b) * (double)t->corners[0][c] + a * (double)t->corners[1][c] +
					       b * (double)t->corners[2][c] - (double)p[c],
					   2);
			if (sum < best) {
				best = sum;
				u = a;
				v = b;
			}
		}
	}
	return best;
}

static void as_one_by_one(void **state)
{
	(void)state;
	static engine_triangle all[TRIANGLES];
	for (int k = 0; k < TRIANGLES; k++) {
		const float middle[3] = {random_float(), random_float(), random_float()};
		for (int c = 0; c < 9; c++)
			all[k].corners[c / 3][c % 3] = middle[c % 3] + .1f * random_float();
		if (k % 50 == 0) /* a line, a point */
			memcpy(all[k].corners[k % 100 ? 1 : 2], all[k].corners[0], sizeof all[k].corners[0]);
	}
	engine_nearest *nearest = engine_nearest_make(all, TRIANGLES);
	assert_non_null(nearest);
	double worst = 0;
	for (int i = 0; i < POINTS; i++) {
		const float p[3] = {1.4f * random_float() - .2f, 1.4f * random_float() - .2f, random_float()};
		const float none[3] = {0, 0, 0};
		const uint32_t found = engine_nearest_find(nearest, p, none);
		double best = HUGE_VAL;
		assert_true(found < TRIANGLES);
		for (int k = 0; k < TRIANGLES; k++)
			best = fmin(best, search_distance(p, &all[k]));
		worst = fmax(worst, sqrt(search_distance(p, &all[found])) - sqrt(best));
	}
	printf("  farther than the nearest by %.1e at most\n", worst);
	assert_true(worst < 1e-4);
	engine_nearest_free(nearest);
	assert_null(engine_nearest_make(all, 0));
	engine_nearest_free(NULL);
}

/* A sheet at z = 0 that looks up, one at z = -0.01 that looks down. */
static void sheets_face_as_asked(void **state)
{
	(void)state;
	static const engine_triangle sheets[2] = {{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
						  {{{0, 0, -.01f}, {0, 1, -.01f}, {1, 0, -.01f}}}};
	const float up[3] = {0, 0, 3}, down[3] = {0, 0, -3};
	engine_nearest *nearest = engine_nearest_make(sheets, 2);
	assert_non_null(nearest);
	for (int k = -3; k <= 3; k++) {
		const float p[3] = {.2f, .3f, -.005f + .004f * (float)k};
		assert_int_equal(engine_nearest_find(nearest, p, up), 0);
		assert_int_equal(engine_nearest_find(nearest, p, down), 1);
	}
	engine_nearest_free(nearest);
	/* Far off, what looks the other way is taken. */
	engine_triangle apart[2];
	memcpy(apart, sheets, sizeof apart);
	for (int k = 0; k < 3; k++)
		apart[1].corners[k][2] = -9;
	nearest = engine_nearest_make(apart, 2);
	assert_non_null(nearest);
	assert_int_equal(engine_nearest_find(nearest, (float[]){.2f, .2f, .1f}, down), 0);
	assert_int_equal(engine_nearest_find(nearest, (float[]){.2f, .2f, -4}, down), 1);
	engine_nearest_free(nearest);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(as_one_by_one), cmocka_unit_test(sheets_face_as_asked)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
