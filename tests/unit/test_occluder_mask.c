/* Where a lamp may be hidden: nothing that hides it is missed, most of what does not is known; and where that is in the
 * picture. */
#include "occluder_mask.h"
#include "screen_rect.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static double uniform(double lower, double upper)
{
	return lower + (upper - lower) * rand() / RAND_MAX;
}

/* A lamp of 1 x 0.6 in a scene 6 m wide and 4 m high. */
static occluder_mask make_mask(uint64_t rows[OCCLUDER_MASK_ROWS])
{
	occluder_mask mask = {.rows = rows, .lamp_lower = {-0.5, -0.3}, .lamp_upper = {0.5, 0.3}, .lowest = 1e-4};
	occluder_mask_clear(&mask, &(occluder_box){{-3, -3, -0.5}, {3, 3, 4}});
	return mask;
}

static occluder_box random_box(void)
{
	occluder_box box;
	for (int axis = 0; axis < 3; axis++) {
		box.lower[axis] = axis == 2 ? uniform(-0.3, 3.5) : uniform(-2.8, 2.5);
		box.upper[axis] = box.lower[axis] + uniform(0.01, 0.6);
	}
	return box;
}

static bool bit_at(const occluder_mask *mask, const double q[3])
{
	const double point = 1e-9;
	const occluder_box box = {{q[0] - point, q[1] - point, q[2] - point},
				  {q[0] + point, q[1] + point, q[2] + point}};
	return occluder_mask_any(mask, &box);
}

/* A point of the box, and what lies beyond it on the ray from a point of the lamp. */
static void test_all_that_is_hidden_is_marked(void **state)
{
	(void)state;
	static uint64_t rows[OCCLUDER_MASK_ROWS];
	int inside = 0;
	for (int round = 0; round < 200; round++) {
		occluder_mask mask = make_mask(rows);
		const occluder_box box = random_box();
		occluder_mask_add(&mask, &box);
		for (int k = 0; k < 200; k++) {
			const double s[2] = {uniform(-0.5, 0.5), uniform(-0.3, 0.3)},
				     t = 1 + 3 * uniform(0, 1) * uniform(0, 1);
			double q[3];
			for (int axis = 0; axis < 3; axis++) {
				const double b = uniform(box.lower[axis], box.upper[axis]),
					     from = axis < 2 ? s[axis] : 0;
				q[axis] = from + (b - from) * t;
			}
			if (q[2] < t * 1e-3 || q[2] > 4 || fabs(q[0]) > 3 || fabs(q[1]) > 3)
				continue;
			inside++;
			if (!bit_at(&mask, q))
				fail_msg("box %d: %g %g %g is hidden and not marked", round, q[0], q[1], q[2]);
		}
	}
	assert_true(inside > 10000);
}

/* Does the segment from q to the lamp's point s meet the box? */
static bool meets(const occluder_box *box, const double q[3], const double s[2])
{
	double enter = 0, leave = 1;
	for (int axis = 0; axis < 3; axis++) {
		const double d = (axis < 2 ? s[axis] : 0) - q[axis];
		double a = (box->lower[axis] - q[axis]) / d, b = (box->upper[axis] - q[axis]) / d;
		enter = fmax(enter, fmin(a, b));
		leave = fmin(leave, fmax(a, b));
	}
	return enter <= leave;
}

/* Marked and not hidden from any of the lamp's corners: a cell is 9 cm wide and 13 cm high. */
static void test_little_else_is_marked(void **state)
{
	(void)state;
	static uint64_t rows[OCCLUDER_MASK_ROWS];
	occluder_mask mask = make_mask(rows);
	const occluder_box box = {{-0.4, -0.4, 1.6}, {0.4, 0.4, 2.4}};
	occluder_mask_add(&mask, &box);
	int marked = 0, hidden = 0;
	for (int k = 0; k < 100000; k++) {
		const double q[3] = {uniform(-3, 3), uniform(-3, 3), uniform(0.01, 4)};
		bool any = false;
		for (int corner = 0; corner < 4; corner++) {
			const double s[2] = {corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.3 : -0.3};
			any = any || meets(&box, q, s);
		}
		hidden += any;
		marked += bit_at(&mask, q);
	}
	assert_true(hidden > 2000);
	assert_true(marked >= hidden);
	assert_true(marked < 2 * hidden);
}

/* Looks along -z from the origin, 90 degrees wide. */
static const float CLIP[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, -1, 0, 0, -0.1f, 0};

static void test_rect_holds_the_ball(void **state)
{
	(void)state;
	const uint32_t size[2] = {400, 200};
	screen_rect rect = screen_rect_empty();
	assert_true(rect.upper[0] <= rect.lower[0]);
	screen_rect_add(&rect, CLIP, size, (gi_vec3d){0, 0, 5}, 1);  /* behind the eye */
	screen_rect_add(&rect, CLIP, size, (gi_vec3d){9, 0, -5}, 1); /* beside the picture */
	assert_true(rect.upper[0] <= rect.lower[0]);
	screen_rect_add(&rect, CLIP, size, (gi_vec3d){1, 2, -5}, 0.5);
	/* The ball's outline lies within its cube's, 0.5 / 4.5 wide. */
	assert_in_range(rect.lower[0], 200 + 200 * 0.5 / 5.5 - 1, 200 + 200 * 0.5 / 4.5);
	assert_in_range(rect.upper[0], 200 + 200 * 1.5 / 5, 200 + 200 * 1.5 / 4.5 + 1);
	assert_in_range(rect.lower[1], 100 + 100 * 1.5 / 5.5 - 1, 100 + 100 * 1.5 / 4.5);
	assert_in_range(rect.upper[1], 100 + 100 * 2.5 / 5, 100 + 100 * 2.5 / 4.5 + 1);
	screen_rect_add(&rect, CLIP, size, (gi_vec3d){0, 0, 0}, 1); /* around the eye */
	assert_int_equal(rect.lower[0], 0);
	assert_int_equal(rect.upper[0], 400);
	assert_int_equal(rect.lower[1], 0);
	assert_int_equal(rect.upper[1], 200);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_all_that_is_hidden_is_marked),
	    cmocka_unit_test(test_little_else_is_marked),
	    cmocka_unit_test(test_rect_holds_the_ball),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
