/* What is measured in pictures, in pictures whose light is known: the camera's place of a floor point, penumbrae,
 * distances. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "picture_measures.h"

#include <math.h>
#include <stdlib.h>

enum { SIDE = 400 };

static picture make_picture(void)
{
	picture p = {SIDE, SIDE, calloc(3 * SIDE * SIDE, sizeof(float))};
	assert_non_null(p.rgb);
	return p;
}

/* The floor point that the demo's camera sees in a pixel: eye at y 2.75, z 10.4, 40 degrees high, looking along -z. */
static bool floor_of_pixel(int x, int y, double *fx, double *fz)
{
	const double half = tan(20 * 3.14159265358979 / 180);
	const double right = (2 * (x + 0.5) / SIDE - 1) * half, up = (1 - 2 * (y + 0.5) / SIDE) * half;
	if (up >= 0)
		return false;
	const double far = -2.75 / up;
	*fx = right * far;
	*fz = 10.4 - far;
	return true;
}

/* Radiance of the floor by a function of its place. */
static picture floor_picture(double (*light)(double x, double z))
{
	picture p = make_picture();
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++) {
			double fx, fz;
			if (!floor_of_pixel(x, y, &fx, &fz))
				continue;
			for (int c = 0; c < 3; c++)
				p.rgb[3 * (y * SIDE + x) + c] = (float)((c + 1) * light(fx, fz));
		}
	return p;
}

static double plane(double x, double z)
{
	return 5 + 2 * x - z;
}

static void points_of_the_floor_are_found(void **state)
{
	(void)state;
	picture p = floor_picture(plane);
	double rgb[3];
	for (int k = 0; k < 20; k++) {
		const double x = -2 + 0.2 * k, z = 0.5 + 0.1 * k;
		picture_floor(&p, x, z, rgb);
		for (int c = 0; c < 3; c++)
			assert_true(fabs(rgb[c] - (c + 1) * plane(x, z)) < 2e-3);
	}
	picture_floor_mean(&p, (floor_part){0.5, 1, 1.5, 2}, rgb);
	assert_true(fabs(rgb[0] - plane(1, 1.5)) < 1e-3);
	picture_free(&p);
}

/* An edge along z at x = 1: the lamp's visible share rises over 0.4 m. */
static double ramp(double x, double z)
{
	return fmin(fmax((x - 0.8) / 0.4, 0), 1) * floor_unshadowed(x, z) / 2;
}

static void penumbra_is_as_wide_as_it_is(void **state)
{
	(void)state;
	picture p = floor_picture(ramp);
	double share[SHADOW_SAMPLES];
	const floor_line across = {{0.5, 1}, {1.5, 1}}, slanted = {{0.5, 0.8}, {1.5, 1.8}},
			 within = {{0.85, 1}, {1.1, 1}};
	picture_shadow(&p, &across, share);
	assert_true(fabs(penumbra_width(&across, share) - 0.8 * 0.4) < 0.004);
	picture_shadow(&p, &slanted, share);
	assert_true(fabs(penumbra_width(&slanted, share) - 0.8 * 0.4 * sqrt(2)) < 0.008);
	picture_shadow(&p, &within, share);
	assert_true(isnan(penumbra_width(&within, share)));
	picture_free(&p);
}

/* Nearly a point from so far: E A cos cos' / (pi r^2) * rho / pi, and less to the sides. */
static void lamp_alone(void **state)
{
	(void)state;
	const double area = 1.3 * 1.05, near_point = 38.8 * area / (3.14159265 * 5.5 * 5.5) * 0.73 / 3.14159265;
	assert_true(fabs(floor_unshadowed(0, 0) / near_point - 1) < 0.03);
	assert_true(floor_unshadowed(2, 0) < floor_unshadowed(1, 0) && floor_unshadowed(1, 0) < floor_unshadowed(0, 0));
	assert_true(fabs(floor_unshadowed(-1, 2) - floor_unshadowed(1, -2)) < 1e-12);
}

static void distances_are_as_they_are_defined(void **state)
{
	(void)state;
	picture a = make_picture(), b = make_picture();
	for (int k = 0; k < 3 * SIDE * SIDE; k++) {
		b.rgb[k] = 2;
		a.rgb[k] = 2.2f;
	}
	for (int k = 0; k < 300; k++)
		b.rgb[k] = 100; /* a lamp */
	for (int k = 300; k < 600; k++)
		a.rgb[k] = 100; /* and its edge */
	const picture_distance d = picture_compare(&a, &b, 10);
	assert_true(fabs(d.rms_of_mean - 0.1) < 1e-5);
	assert_true(fabs(d.relative_mse - 0.04 / (4 + 0.04)) < 1e-5);
	double rgb[3];
	picture_mean(&b, (picture_part){0.5, 0.5, 0.5, 0.5}, rgb);
	assert_true(rgb[0] == 2 && rgb[2] == 2);
	picture_free(&a);
	picture_free(&b);
}

static double twice(double x, double z)
{
	return 2 * plane(x, z);
}

static void floors_are_compared_by_cells(void **state)
{
	(void)state;
	picture a = floor_picture(twice), b = floor_picture(plane);
	const floor_distance d = picture_compare_floor(&a, &b, (floor_part){0, 1, 1, 2}, 4);
	assert_true(fabs(d.b - 2 * plane(0.5, 1.5)) < 1e-2 && fabs(d.a - 2 * d.b) < 2e-2);
	assert_true(fabs(d.relative_rms - 1) < 1e-3);
	picture_free(&a);
	picture_free(&b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(points_of_the_floor_are_found),
	    cmocka_unit_test(penumbra_is_as_wide_as_it_is),
	    cmocka_unit_test(lamp_alone),
	    cmocka_unit_test(distances_are_as_they_are_defined),
	    cmocka_unit_test(floors_are_compared_by_cells),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
