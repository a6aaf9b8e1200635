/* Means of textures over triangles: exact where a texel is cut, wrapped as asked, in linear light. */
#include "mesh.h"
#include "texture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 7, HEIGHT = 5 };

/* Red by column, green by row, blue a chessboard, alpha by both. */
static engine_texture make_texture(void)
{
	engine_texture t = {.pixels = {WIDTH, HEIGHT, malloc(4 * WIDTH * HEIGHT)}, .mean = {.1f, .2f, .3f, .4f}};
	assert_non_null(t.pixels.rgba);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const uint8_t texel[4] = {(uint8_t)(x * 40), (uint8_t)(y * 60), (uint8_t)((x + y) % 2 * 255),
						  (uint8_t)(x * 10 + y * 30)};
			memcpy(t.pixels.rgba + 4 * (y * WIDTH + x), texel, sizeof texel);
		}
	return t;
}

static int wrapped(int number, int size, engine_wrap wrap)
{
	const int turn = ((number % (2 * size)) + 2 * size) % (2 * size);
	if (wrap == ENGINE_WRAP_CLAMP)
		return number < 0 ? 0 : number < size ? number : size - 1;
	return wrap == ENGINE_WRAP_REPEAT ? turn % size : turn < size ? turn : 2 * size - 1 - turn;
}

/* The mean of very many points. */
static void sample(const engine_texture *t, const engine_texture_use *use, const float uvs[3][2], double mean[4])
{
	enum { SIDE = 300 };
	memset(mean, 0, 4 * sizeof *mean);
	for (int i = 0; i < SIDE * SIDE; i++) {
		double a = (i % SIDE + .5) / SIDE, b = (i / SIDE + .5) / SIDE; /* two numbers, even over the triangle */
		if (a + b > 1) {
			a = 1 - a;
			b = 1 - b;
		}
		double at[2], place[2];
		for (int k = 0; k < 2; k++)
			at[k] = (1 - a - b) * (double)uvs[0][k] + a * (double)uvs[1][k] + b * (double)uvs[2][k];
		for (int k = 0; k < 2; k++)
			place[k] = (double)use->transform[k][0] * at[0] + (double)use->transform[k][1] * at[1] +
				   (double)use->transform[k][2];
		const int x = wrapped((int)floor(place[0] * WIDTH), WIDTH, use->wrap[0]),
			  y = wrapped((int)floor(place[1] * HEIGHT), HEIGHT, use->wrap[1]);
		const uint8_t *texel = t->pixels.rgba + 4 * (y * WIDTH + x);
		for (int c = 0; c < 4; c++)
			mean[c] += (c < 3 ? engine_linear_of_srgb(texel[c] / 255.0) : texel[c] / 255.0) / (SIDE * SIDE);
	}
}

static void expect_mean(const engine_texture *t, const engine_texture_use *use, const float uvs[3][2])
{
	double wanted[4];
	float mean[4];
	sample(t, use, uvs, wanted);
	engine_texture_mean(t, use, uvs, mean);
	for (int c = 0; c < 4; c++)
		if (!(fabs((double)mean[c] - wanted[c]) < 5e-3))
			fail_msg("channel %d: %g is not %g", c, (double)mean[c], wanted[c]);
}

static void as_points_say(void **state)
{
	(void)state;
	static const float triangles[][3][2] = {{{0, 0}, {1, 0}, {0, 1}},
						{{.1f, .2f}, {.13f, .22f}, {.05f, .9f}},
						{{.9f, .9f}, {.2f, .3f}, {.95f, .1f}},
						{{-1.3f, 2.2f}, {1.7f, -.4f}, {.3f, 1.9f}},
						{{.31f, .31f}, {.32f, .31f}, {.31f, .32f}}};
	engine_texture t = make_texture();
	for (size_t k = 0; k < sizeof triangles / sizeof *triangles; k++)
		for (int wrap = 0; wrap < 9; wrap++) {
			engine_texture_use use = engine_texture_use_of(1);
			use.wrap[0] = (engine_wrap)(wrap % 3);
			use.wrap[1] = (engine_wrap)(wrap / 3);
			expect_mean(&t, &use, triangles[k]);
			const float turned[2][3] = {{.8f, -.6f, .2f}, {.6f, 1.3f, -.7f}};
			memcpy(use.transform, turned, sizeof turned);
			expect_mean(&t, &use, triangles[k]);
		}
	free(t.pixels.rgba);
}

/* A triangle of whole texels, and one that is half of one. */
static void exact(void **state)
{
	(void)state;
	engine_texture t = make_texture();
	const engine_texture_use use = engine_texture_use_of(1);
	const float one[3][2] = {{2.0f / 7, .2f}, {3.0f / 7, .2f}, {2.0f / 7, .4f}};
	float mean[4];
	engine_texture_mean(&t, &use, one, mean);
	assert_true(fabs((double)mean[0] - engine_linear_of_srgb(80 / 255.0)) < 1e-6);
	assert_true(fabs((double)mean[1] - engine_linear_of_srgb(60 / 255.0)) < 1e-6);
	assert_true(fabs((double)mean[2] - 1) < 1e-6);
	free(t.pixels.rgba);
}

/* A line has what lies in its middle; no coordinates, or very many texels, the mean of all. */
static void degenerate(void **state)
{
	(void)state;
	engine_texture t = make_texture();
	const engine_texture_use use = engine_texture_use_of(1);
	const float point[3][2] = {{.5f, .5f}, {.5f, .5f}, {.5f, .5f}};
	const float none[3][2] = {{ENGINE_NO_UV, ENGINE_NO_UV}, {ENGINE_NO_UV, ENGINE_NO_UV}, {0, 0}};
	const float large[3][2] = {{0, 0}, {1000, 0}, {0, 1000}}, line[3][2] = {{0, 0}, {900000, 0}, {0, .2f}};
	float mean[4];
	engine_texture_mean(&t, &use, point, mean);
	assert_true(fabs((double)mean[0] - engine_linear_of_srgb(120 / 255.0)) < 1e-6);
	engine_texture_mean(&t, &use, none, mean);
	assert_memory_equal(mean, t.mean, sizeof mean);
	engine_texture_mean(&t, &use, large, mean);
	assert_memory_equal(mean, t.mean, sizeof mean);
	engine_texture_mean(&t, &use, line, mean); /* soon, and about the first row */
	assert_true(fabs((double)mean[1]) < 1e-6 && fabs((double)mean[2] - 3.0 / 7) < .2);
	free(t.pixels.rgba);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(as_points_say), cmocka_unit_test(exact),
					   cmocka_unit_test(degenerate)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
