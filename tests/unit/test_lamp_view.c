/* The window of a lamp's depth maps: it holds what is before the lamp as every sample sees it, no more than that, and
 * the same wherever the lamp is. */
#include "lamp_view.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

enum { SAMPLES = 16, MAP_SIZE = 512 };

/* One metre a side, that looks along z. */
static lamp_polygon square(void)
{
	return (lamp_polygon){.corner = {{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}},
			      .normal = {0, 0, 1},
			      .exitance = {1, 1, 1},
			      .power = 1};
}

/* Turned by 30 degrees about z, then y and z exchanged by a quarter about x, and moved. */
static gi_object_data placed(bool aside)
{
	if (!aside)
		return (gi_object_data){.row0 = {1, 0, 0, 0}, .row1 = {0, 1, 0, 0}, .row2 = {0, 0, 1, 0}};
	const float c = sqrtf(0.75f), s = 0.5f;
	return (gi_object_data){.row0 = {c, -s, 0, 3}, .row1 = {0, 0, -1, -5}, .row2 = {s, c, 0, 7}};
}

static gi_vec3d world_of(const gi_object_data *d, gi_vec3d p)
{
	const gi_vec4 rows[3] = {d->row0, d->row1, d->row2};
	double out[3];
	for (int r = 0; r < 3; r++)
		out[r] = gi_vec3d_dot(gi_vec3d_from(rows[r]), p) + rows[r].w;
	return (gi_vec3d){out[0], out[1], out[2]};
}

/* From lower to upper in the lamp's frame. */
static lamp_box box_of(const gi_object_data *d, gi_vec3d lower, gi_vec3d upper)
{
	lamp_box box;
	for (int k = 0; k < 8; k++)
		box.corner[k] = world_of(
		    d, (gi_vec3d){k & 1 ? upper.x : lower.x, k & 2 ? upper.y : lower.y, k & 4 ? upper.z : lower.z});
	return box;
}

static bool fit(bool aside, gi_vec3d lower, gi_vec3d upper, lamp_view *view, gi_vec4 samples[SAMPLES])
{
	const lamp_polygon polygon = square();
	const gi_object_data object = placed(aside);
	const lamp_box box = box_of(&object, lower, upper);
	*view = (lamp_view){.map_size = MAP_SIZE};
	lamp_view_place(view, &polygon, &object, SAMPLES, samples);
	return lamp_view_fit(view, &polygon, &box, 1);
}

/* Corners of the box as each sample sees them, and how much of the window to each side nobody needs. */
static void holds_all_and_no_more(void **state)
{
	(void)state;
	const gi_vec3d lower = {-0.3, 0.1, 1}, upper = {0.4, 0.9, 2};
	gi_vec4 samples[SAMPLES];
	lamp_view view;
	assert_true(fit(false, lower, upper, &view, samples));
	assert_false(view.hemisphere);
	assert_true(view.nearest <= 1 && view.nearest > 0.9);
	assert_true(view.farthest >= 2 && view.farthest < 2.1);
	for (int axis = 0; axis < 2; axis++) {
		double least = INFINITY, most = -INFINITY;
		for (int k = 0; k < 8 * SAMPLES; k++) {
			const double x = axis ? (k & 2 ? upper.y : lower.y) : (k & 1 ? upper.x : lower.x);
			const double slope = (x - (double)(&samples[k / 8].x)[axis]) / (k & 4 ? upper.z : lower.z);
			least = fmin(least, slope);
			most = fmax(most, slope);
		}
		assert_true(view.lower[axis] <= least + 1e-6 && view.lower[axis] > least - 1e-6);
		assert_true(view.upper[axis] >= most - 1e-6 && view.upper[axis] < most + 1e-6);
	}
}

/* Of a box that the lamp's plane cuts, the part before it. */
static void what_lies_behind_does_not_count(void **state)
{
	(void)state;
	gi_vec4 samples[SAMPLES];
	lamp_view view;
	assert_false(fit(false, (gi_vec3d){-1, -1, -2}, (gi_vec3d){1, 1, -1}, &view, samples));
	assert_true(fit(false, (gi_vec3d){-9, -9, -2}, (gi_vec3d){9, 9, 3}, &view, samples));
	assert_true(view.hemisphere); /* it reaches past any slope */
	assert_true(view.farthest >= 3 + 9);
	assert_true(view.nearest > 0 && view.nearest < 0.02 * view.farthest);
}

static void wherever_the_lamp_is(void **state)
{
	(void)state;
	const gi_vec3d lower = {-0.7, -0.2, 0.8}, upper = {0.1, 0.3, 1.5};
	gi_vec4 samples[SAMPLES];
	lamp_view here, there;
	assert_true(fit(false, lower, upper, &here, samples));
	assert_true(fit(true, lower, upper, &there, samples));
	assert_true(fabs(here.nearest - there.nearest) < 1e-5 && fabs(here.farthest - there.farthest) < 1e-5);
	for (int axis = 0; axis < 2; axis++) {
		assert_true(fabs(here.lower[axis] - there.lower[axis]) < 1e-5);
		assert_true(fabs(here.upper[axis] - there.upper[axis]) < 1e-5);
	}
}

/* The window that shaders get is a square with a border about what was fitted, on steps of its width. */
static void the_map_has_a_border(void **state)
{
	(void)state;
	gi_vec4 samples[SAMPLES];
	const lamp_polygon polygon = square();
	lamp_view view;
	gi_lamp lamp = {0};
	assert_true(fit(false, (gi_vec3d){-0.3, 0.1, 1}, (gi_vec3d){0.4, 0.9, 2}, &view, samples));
	lamp_view_fill(&view, &polygon, true, &lamp);
	for (int axis = 0; axis < 2; axis++) {
		const double offset = (double)(axis ? lamp.map.w : lamp.map.z), scale = (double)lamp.map.x;
		const double from = view.lower[axis] * scale + offset, to = view.upper[axis] * scale + offset;
		assert_true(from >= 3.9 / MAP_SIZE && to <= 1 - 3.9 / MAP_SIZE);
		assert_true(to - from > 0.3);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(holds_all_and_no_more),
	    cmocka_unit_test(what_lies_behind_does_not_count),
	    cmocka_unit_test(wherever_the_lamp_is),
	    cmocka_unit_test(the_map_has_a_border),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
