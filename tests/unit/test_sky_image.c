/* Pictures of the sky become means of patches: exact where they are uniform, with all of their light, and finer round
 * what is small and bright. */
#include "sky_image.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>

static const double PI = 3.14159265358979323846;
static const double IDENTITY[4] = {0, 0, 0, 1};

/* What a picture's patches have in sum. */
typedef struct summary {
	double light[3], angle; /* of patches that are not cut */
	gi_vec3d towards;       /* of the light, not normalised */
	uint32_t leaves, fine;
	int least; /* size of the smallest, cells */
} summary;

static uint32_t add_patch(const sky_image *s, uint32_t n, sky_patch p, summary *out)
{
	if (s->split[n]) {
		uint32_t next = n + 1;
		for (int k = 0; k < 4; k++)
			next = add_patch(s, next, sky_patch_child(p, k), out);
		return next;
	}
	const double angle = sky_patch_angle(p), half = 0.5 * p.size;
	const gi_vec3d d = sky_direction(p.face, p.i + half, p.j + half);
	const float *mean = s->mean[n];
	const double light = angle * ((double)mean[0] + (double)mean[1] + (double)mean[2]);
	for (int c = 0; c < 3; c++)
		out->light[c] += angle * (double)mean[c];
	out->angle += angle;
	out->towards = gi_vec3d_add(out->towards, (gi_vec3d){light * d.x, light * d.y, light * d.z});
	out->leaves++;
	out->fine += s->fine[n];
	out->least = p.size < out->least ? p.size : out->least;
	return n + 1;
}

static summary sum_up(const sky_image *s)
{
	summary out = {.least = SKY_GRID};
	uint32_t next = 0;
	for (int face = 0; face < SKY_FACES; face++)
		next = add_patch(s, next, (sky_patch){face, 0, 0, SKY_GRID}, &out);
	assert_int_equal(next, s->node_count);
	assert_true(next <= SKY_MOST_NODES);
	return out;
}

static float *allocate_texels(uint32_t width, uint32_t height)
{
	float *texels = calloc(3 * (size_t)width * height, sizeof *texels);
	assert_non_null(texels);
	return texels;
}

static sky_image *make(float *texels, uint32_t width, uint32_t height, const double rotation[4])
{
	sky_image *s = sky_image_make(texels, width, height, rotation);
	assert_non_null(s);
	free(texels);
	return s;
}

static void expect_near(double value, double wanted, double relative)
{
	if (!(fabs(value - wanted) <= relative * fabs(wanted)))
		fail_msg("%.9g is not %.9g", value, wanted);
}

static void uniform(void **state)
{
	(void)state;
	static const uint32_t sizes[][2] = {{1, 1}, {7, 5}, {1, 300}, {300, 150}, {4099, 21}};
	for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
		const uint32_t texels = sizes[k][0] * sizes[k][1];
		float *white = allocate_texels(sizes[k][0], sizes[k][1]);
		for (uint32_t t = 0; t < 3 * texels; t++)
			white[t] = (float)(1 + t % 3);
		sky_image *s = make(white, sizes[k][0], sizes[k][1], IDENTITY);
		for (uint32_t n = 0; n < s->node_count; n++)
			for (int c = 0; c < 3; c++)
				expect_near((double)s->mean[n][c], PI * (1 + c), 3e-7);
		const summary sum = sum_up(s);
		expect_near(sum.angle, 4 * PI, 1e-12);
		assert_true(sum.leaves == 6 * 64 && sum.fine == 0);
		sky_image_free(s);
	}
}

/* Directions there and back. */
static void places(void **state)
{
	(void)state;
	for (int face = 0; face < SKY_FACES; face++)
		for (int k = 0; k < 400; k++) {
			const double i = SKY_GRID * fmod(.5 + k * .754877666, 1),
				     j = SKY_GRID * fmod(.5 + k * .569840291, 1);
			int found;
			double at_i, at_j;
			sky_place_of(sky_direction(face, i, j), &found, &at_i, &at_j);
			assert_int_equal(found, face);
			assert_true(fabs(at_i - i) < 1e-9 && fabs(at_j - j) < 1e-9);
		}
}

/* A sun of one texel anywhere, before a dim sky: all its light, from where it stands. */
static void sun(uint32_t width, uint32_t height, uint32_t column, uint32_t row)
{
	float *texels = allocate_texels(width, height);
	for (uint32_t t = 0; t < 3 * width * height; t++)
		texels[t] = .01f;
	const double angle = 2 * PI / width * (cos(PI * row / height) - cos(PI * (row + 1.0) / height));
	for (int c = 0; c < 3; c++)
		texels[3 * (row * width + column) + (uint32_t)c] = (float)(1000 / angle);
	sky_image *s = make(texels, width, height, IDENTITY);
	const summary sum = sum_up(s);
	const double dim = PI * .01 * (4 * PI - angle), length = sqrt(gi_vec3d_dot(sum.towards, sum.towards));
	const gi_vec3d d = sky_image_direction(s, column + .5, row + .5);
	const double off = acos(fmin(1, gi_vec3d_dot(d, sum.towards) / length)) * 180 / PI;
	printf("  %u x %u: %u patches, %u of much light, the least %.2f degrees; light %.4f %% off, from %.3f degrees "
	       "off\n",
	       width, height, sum.leaves, sum.fine, 90.0 * sum.least / SKY_GRID,
	       100 * (sum.light[0] / (1000 * PI + dim) - 1), off);
	for (int c = 0; c < 3; c++)
		expect_near(sum.light[c], 1000 * PI + dim, 5e-3);
	assert_true(off < .1 + 90.0 / height); /* half a texel */
	assert_true(sum.fine >= 1 && sum.fine <= 32);
	sky_image_free(s);
}

static void suns(void **state)
{
	(void)state;
	sun(32, 16, 11, 5);
	sun(256, 128, 17, 40);
	sun(1024, 512, 700, 100);
	sun(2048, 1024, 3, 511);
	sun(2048, 1024, 1024, 300);
	sun(2000, 999, 1999, 998);
	sun(512, 256, 100, 0);
}

/* A picture turned by a quarter is one whose columns go round by a quarter. */
static void rotation(void **state)
{
	(void)state;
	enum { WIDTH = 64, HEIGHT = 32 };
	float *plain = allocate_texels(WIDTH, HEIGHT), *moved = allocate_texels(WIDTH, HEIGHT);
	for (uint32_t k = 0; k < WIDTH * HEIGHT; k++)
		for (uint32_t c = 0; c < 3; c++) {
			const float value = (float)((k * 7919 + c * 31) % 101);
			plain[3 * k + c] = value;
			moved[3 * (k - k % WIDTH + (k + WIDTH / 4) % WIDTH) + c] = value;
		}
	/* From -z towards +x, which is about -y. */
	const double quarter[4] = {0, -sqrt(.5), 0, sqrt(.5)};
	sky_image *a = make(plain, WIDTH, HEIGHT, quarter), *b = make(moved, WIDTH, HEIGHT, IDENTITY);
	assert_int_equal(a->node_count, b->node_count);
	for (uint32_t n = 0; n < a->node_count; n++)
		for (int c = 0; c < 3; c++)
			expect_near((double)a->mean[n][c], (double)b->mean[n][c], 1e-5);
	sky_image_free(a);
	sky_image_free(b);
}

/* Black is black, and one texel of light in a black sky keeps its own patches. */
static void black(void **state)
{
	(void)state;
	sky_image *s = make(allocate_texels(16, 8), 16, 8, IDENTITY);
	const summary none = sum_up(s);
	assert_true(none.light[0] == 0 && none.light[1] == 0 && none.light[2] == 0 && none.leaves == 6 * 64);
	sky_image_free(s);
	float *texels = allocate_texels(512, 256);
	texels[3 * (512 * 77 + 99) + 1] = 1e11f;
	s = make(texels, 512, 256, IDENTITY);
	const summary one = sum_up(s);
	assert_true(one.light[1] > 0 && one.light[0] == 0 && one.light[2] == 0);
	expect_near(one.light[1], PI * 1e11 * sky_image_texel_angle(s, 77), 5e-3);
	sky_image_free(s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(uniform),  cmocka_unit_test(places), cmocka_unit_test(suns),
	    cmocka_unit_test(rotation), cmocka_unit_test(black),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
