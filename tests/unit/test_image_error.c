/* Errors of pictures (tests/bench/image_error.h) by hand. */
#include "../bench/image_error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 24 };

static void check_near(double got, double wanted, double tolerance, const char *what, int line)
{
	printf("%s: %.9g, wanted %.9g +- %.2g\n", what, got, wanted, tolerance);
	if (!(fabs(got - wanted) <= tolerance))
		_fail(__FILE__, line);
}

#define CHECK_NEAR(got, wanted, tolerance) check_near(got, wanted, tolerance, #got, __LINE__)

static linear_image filled(float value)
{
	linear_image image;
	assert_true(linear_image_create(SIDE, SIDE, &image));
	for (int k = 0; k < 3 * SIDE * SIDE; k++)
		image.rgb[k] = value;
	return image;
}

/* 0.3 for 0.2: 0.01 / (0.04 + 0.01). */
static void test_relative_mse(void **state)
{
	(void)state;
	linear_image picture = filled(0.3f), truth[2] = {filled(0.2f), filled(0.2f)};
	CHECK_NEAR(image_relative_mse(&picture, truth), 0.2, 1e-6);
	CHECK_NEAR(image_relative_mse(&truth[0], truth), 0, 0);
	/* One pixel of a channel in ten thousand is ten thousand times less. */
	for (int k = 0; k < 3 * SIDE * SIDE; k++)
		picture.rgb[k] = k == 17 ? 0.3f : 0.2f;
	CHECK_NEAR(image_relative_mse(&picture, truth), 0.2 / (3 * SIDE * SIDE), 1e-9);
	linear_image_free(&picture);
	linear_image_free(&truth[0]);
	linear_image_free(&truth[1]);
}

/* Noise of the truth drops out: halves off to either side of it say of a picture in between that it is perfect, but for
 * what their own distance takes away, and of one apart what the mean of both would say. */
static void test_noise_of_the_truth_drops_out(void **state)
{
	(void)state;
	linear_image picture = filled(0.5f), truth[2] = {filled(0.2f), filled(0.2f)};
	srand(1);
	for (int half = 0; half < 2; half++)
		for (int k = 0; k < 3 * SIDE * SIDE; k++)
			truth[half].rgb[k] += 0.02f * ((float)rand() / (float)RAND_MAX - 0.5f);
	/* A half's variance is 3.3e-5; without the product it would show as 0.0007. */
	CHECK_NEAR(image_relative_mse(&picture, truth), 0.09 / 0.05, 0.01);
	for (int k = 0; k < 3 * SIDE * SIDE; k++)
		picture.rgb[k] = 0.2f;
	CHECK_NEAR(image_relative_mse(&picture, truth), 0, 0.0001);
	linear_image_free(&picture);
	linear_image_free(&truth[0]);
	linear_image_free(&truth[1]);
}

static void fill_bytes(uint8_t *rgb, int value)
{
	memset(rgb, value, 3 * SIDE * SIDE);
}

/* Of even pictures only the luminance term is left: (2 a b + c) / (a^2 + b^2 + c), c = (0.01 * 255)^2. */
static void test_ssim_of_even_pictures(void **state)
{
	(void)state;
	static uint8_t a[3 * SIDE * SIDE], b[3 * SIDE * SIDE];
	fill_bytes(a, 100);
	fill_bytes(b, 100);
	CHECK_NEAR(image_ssim(a, b, SIDE, SIDE), 1, 1e-9);
	fill_bytes(b, 200);
	const double c = 2.55 * 2.55;
	CHECK_NEAR(image_ssim(a, b, SIDE, SIDE), (2.0 * 100 * 200 + c) / (100.0 * 100 + 200 * 200 + c), 1e-9);
	fill_bytes(a, 0);
	fill_bytes(b, 255);
	CHECK_NEAR(image_ssim(a, b, SIDE, SIDE), c / (255.0 * 255 + c), 1e-9);
}

/* A pattern and its negative about the same mean: every window's structure is opposite, so that with variance v the
 * result is close to (c - 2 v) / (c + 2 v), c = (0.03 * 255)^2. */
static void test_ssim_of_a_negative(void **state)
{
	(void)state;
	static uint8_t a[3 * SIDE * SIDE], b[3 * SIDE * SIDE];
	for (int k = 0; k < SIDE * SIDE; k++) {
		const int up = (k % SIDE + k / SIDE) % 2;
		memset(a + 3 * k, up ? 148 : 108, 3);
		memset(b + 3 * k, up ? 108 : 148, 3);
	}
	const double c = 7.65 * 7.65, v = 20 * 20;
	CHECK_NEAR(image_ssim(a, a, SIDE, SIDE), 1, 1e-9);
	CHECK_NEAR(image_ssim(a, b, SIDE, SIDE), (c - 2 * v) / (c + 2 * v), 1e-4);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_relative_mse),
	    cmocka_unit_test(test_noise_of_the_truth_drops_out),
	    cmocka_unit_test(test_ssim_of_even_pictures),
	    cmocka_unit_test(test_ssim_of_a_negative),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
