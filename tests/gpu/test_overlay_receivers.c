/* Receivers and probes over the picture: where they are, how large, and the light they have; what hides them. */
#include "target.h"

#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 128 };

static const double PI = 3.14159265358979;

/* From above, straight down, parallel: pixels are x and -z, each -1..1. What is above `top` is not seen. */
static gi_view look_down(float top, gi_overlay overlay)
{
	gi_view view = gi_view_default();
	const float world[16] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, -top, 1};
	const float clip[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -2 / (top + 1), 0, 0, 0, -1, 1};
	memcpy(view.view_from_world, world, sizeof world);
	memcpy(view.clip_from_view, clip, sizeof clip);
	view.width = view.height = SIZE;
	view.overlay = overlay;
	return view;
}

static const float *pixel_at(const target *t, double x, double z)
{
	const int column = (int)(.5 * (x + 1) * SIZE), row = (int)(.5 * (1 - z) * SIZE);
	return t->pixels + 4 * (row * SIZE + column);
}

/* Pixels of the two that differ. */
static int count_other(const target *a, const target *b)
{
	int count = 0;
	for (int k = 0; k < SIZE * SIZE; k++)
		count += memcmp(a->pixels + 4 * k, b->pixels + 4 * k, 3 * sizeof(float)) != 0;
	return count;
}

/* A lamp that faces down beside a floor of two colours. */
static gi_context *open_scene(void)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .1f;
	def.pixel_lamps = 1;
	gi_context *gi = harness_context(&def);
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-1, 0, -1}, (float[]){0, 0, 2}, (float[]){2, 0, 0}, 2, 2, &mesh));
	harness_add(gi, &(harness_object){.name = "floor", .rho = {.6f, .2f, .1f}}, &mesh);
	assert_true(shape_quad((float[]){.2f, 1.5f, -.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 1, 1, &mesh));
	harness_add(gi, &(harness_object){.name = "lamp", .exitance = {10, 8, 6}}, &mesh);
	return gi;
}

static gi_receivers add_point(gi_context *gi, const float at[3], const float *normal)
{
	gi_receivers_def def = gi_receivers_def_default();
	gi_receivers out;
	def.positions = at;
	def.normals = normal;
	def.count = 1;
	def.harmonics = normal ? 0 : 2;
	assert_gi(gi_create_receivers(gi, &def, &out));
	return out;
}

static void expect_light(const target *t, double x, double z, const float *irradiance)
{
	const float *found = pixel_at(t, x, z);
	for (int c = 0; c < 3; c++)
		if (!(fabs(found[c] - irradiance[c] / PI) <= 2e-3 * irradiance[c]))
			fail_msg("(%g, %g): %g, not %g", x, z, (double)found[c], irradiance[c] / PI);
}

/* In its place, the colour of its light, of the size that was asked for; from behind there is none. */
static void a_disc(void **state)
{
	(void)state;
	static const float at[3] = {-.4f, .3f, .2f}, up[3] = {0, 1, 0}, down[3] = {0, -1, 0};
	gi_context *gi = open_scene();
	const gi_receivers point = add_point(gi, at, up);
	target plain = target_make(SIZE), over = target_make(SIZE);
	float light[4];
	uint32_t count;
	assert_gi(gi_commit(gi));
	harness_update(gi);
	assert_gi(gi_read_receivers(gi, point, light, 1, &count));
	assert_true(light[0] > .1f);
	gi_view view = look_down(1, GI_OVERLAY_RECEIVERS);
	target_draw(&plain, gi, look_down(1, GI_OVERLAY_NONE));
	for (int sized = 0; sized < 2; sized++) {
		view.overlay_radius = sized ? .04f : 0;
		const double radius = sized ? .04 * SIZE / 2 : 6;
		target_draw(&over, gi, view);
		expect_light(&over, (double)at[0], (double)at[2], light);
		const int other = count_other(&plain, &over);
		printf("  %d pixels, %.0f due\n", other, PI * radius * radius);
		assert_true(fabs(other - PI * radius * radius) < 4 * radius);
	}
	view.overlay_radius = .5f; /* more than a twentieth of the picture */
	target_draw(&over, gi, view);
	assert_true(abs(count_other(&plain, &over) - (int)(PI * .05 * .05 * SIZE * SIZE)) < .2 * SIZE);
	/* It follows with the next update. */
	const float there[3] = {.5f, .3f, -.6f};
	view.overlay_radius = 0;
	assert_gi(gi_set_receivers(gi, point, there, NULL));
	harness_update(gi);
	assert_gi(gi_read_receivers(gi, point, light, 1, &count));
	target_draw(&over, gi, view);
	expect_light(&over, (double)there[0], (double)there[2], light);
	assert_memory_equal(pixel_at(&over, (double)at[0], (double)at[2]),
			    pixel_at(&plain, (double)at[0], (double)at[2]), 4 * sizeof(float));
	assert_gi(gi_set_receivers(gi, point, there, down));
	harness_update(gi);
	target_draw(&over, gi, view);
	assert_int_equal(count_other(&plain, &over), 0);
	assert_gi(gi_set_receivers(gi, point, there, up));
	harness_update(gi);
	assert_gi(gi_destroy_receivers(gi, point));
	target_draw(&over, gi, view);
	assert_int_equal(count_other(&plain, &over), 0);
	target_free(&plain);
	target_free(&over);
	gi_context_destroy(gi);
}

/* E along a normal by the coefficients, as gi.h has them. */
static void irradiance_along(const float (*c)[4], const double n[3], float out[3])
{
	const double y[9] = {.282095,
			     .488603 * n[1],
			     .488603 * n[2],
			     .488603 * n[0],
			     1.092548 * n[0] * n[1],
			     1.092548 * n[1] * n[2],
			     .315392 * (3 * n[2] * n[2] - 1),
			     1.092548 * n[0] * n[2],
			     .546274 * (n[0] * n[0] - n[1] * n[1])};
	for (int channel = 0; channel < 3; channel++) {
		double sum = 0;
		for (int k = 0; k < 9; k++)
			sum += y[k] * c[k][channel];
		out[channel] = (float)fmax(sum, 0);
	}
}

/* Lit by the ball's normal at each pixel, in every convention of depths. */
static void a_ball(void **state)
{
	(void)state;
	static const float at[3] = {-.3f, .3f, .1f};
	static const double RADIUS = .1;
	gi_context *gi = open_scene();
	const gi_receivers point = add_point(gi, at, NULL);
	target over = target_make(SIZE), other = target_make(SIZE);
	float light[9][4], due[3];
	uint32_t count;
	assert_gi(gi_commit(gi));
	harness_update(gi);
	assert_gi(gi_read_receivers(gi, point, light[0], 9, &count));
	gi_view view = look_down(1, GI_OVERLAY_RECEIVERS);
	view.overlay_radius = (float)RADIUS;
	target_draw(&over, gi, view);
	for (int k = -3; k <= 3; k++) {
		/* The middle of a pixel. */
		const double pitch = 2.0 / SIZE, x = pitch * (floor((at[0] + .02 * k) / pitch) + .5),
			     z = pitch * (floor((double)at[2] / pitch) + .5);
		const double n[3] = {(x - at[0]) / RADIUS,
				     sqrt(1 - pow((x - at[0]) / RADIUS, 2) - pow((z - at[2]) / RADIUS, 2)),
				     (z - at[2]) / RADIUS};
		irradiance_along((const float(*)[4])light, n, due);
		expect_light(&over, x, z, due);
	}
	/* z of 0..1, and the nearer the larger. */
	view.clip_zero_to_one = true;
	view.clip_from_view[10] *= .5f;
	view.clip_from_view[14] = .5f * view.clip_from_view[14] + .5f;
	target_draw(&other, gi, view);
	assert_int_equal(count_other(&over, &other), 0);
	target_free(&over);
	target_free(&other);
	gi_context_destroy(gi);
}

/* Each of several sets has its own light. */
static void several_sets(void **state)
{
	(void)state;
	enum { SETS = 3, POINTS = 4 };
	gi_context *gi = open_scene();
	gi_receivers sets[SETS];
	float at[SETS][POINTS][3], up[POINTS][3];
	for (int s = 0; s < SETS; s++) {
		for (int k = 0; k < POINTS; k++) {
			const float place[3] = {.4f * (float)k - .6f, .2f + .1f * (float)s, .5f * (float)s - .5f};
			memcpy(at[s][k], place, sizeof place);
			memcpy(up[k], (float[]){0, 1, 0}, sizeof up[k]);
		}
		gi_receivers_def def = gi_receivers_def_default();
		def.positions = at[s][0];
		def.normals = s == 1 ? NULL : up[0];
		def.harmonics = s == 1 ? 1 : 0;
		def.count = POINTS;
		assert_gi(gi_create_receivers(gi, &def, &sets[s]));
	}
	assert_gi(gi_commit(gi));
	harness_update(gi);
	target over = target_make(SIZE);
	target_draw(&over, gi, look_down(1, GI_OVERLAY_RECEIVERS));
	for (int s = 0; s < SETS; s++) {
		float light[POINTS][4][4], due[3];
		uint32_t count;
		const uint32_t stride = s == 1 ? 4 : 1;
		assert_gi(gi_read_receivers(gi, sets[s], light[0][0], POINTS * stride, &count));
		assert_int_equal(count, POINTS * stride);
		for (uint32_t k = 0; k < POINTS; k++) {
			const float(*c)[4] = (const float(*)[4])(light[0] + k * stride);
			memcpy(due, c[0], sizeof due);
			for (int channel = 0; s == 1 && channel < 3; channel++) /* along y, the middle of the ball */
				due[channel] = .282095f * c[0][channel] + .488603f * c[1][channel];
			const float *found = pixel_at(&over, (double)at[s][k][0], (double)at[s][k][2]);
			for (int channel = 0; channel < 3; channel++)
				assert_true(fabs(found[channel] - due[channel] / PI) <= .02 * due[channel]);
		}
	}
	target_free(&over);
	gi_context_destroy(gi);
}

/* Surfaces before it; others behind it. And the picture beside it is what it was. */
static void what_hides_it(void **state)
{
	(void)state;
	static const float above[3] = {.4f, .6f, .4f}, below[3] = {.4f, .2f, .4f}, half_in[3] = {-.4f, 0, -.4f};
	gi_context *gi = open_scene();
	target plain = target_make(SIZE), over = target_make(SIZE);
	engine_mesh mesh;
	assert_true(shape_quad((float[]){.1f, .4f, .1f}, (float[]){0, 0, .6f}, (float[]){.6f, 0, 0}, 1, 1, &mesh));
	harness_add(gi, &(harness_object){.name = "shelf", .rho = {.3f, .3f, .3f}}, &mesh);
	const gi_receivers hidden = add_point(gi, below, NULL);
	assert_gi(gi_commit(gi));
	const gi_view view = look_down(1, GI_OVERLAY_RECEIVERS);
	/* No update so far: none has light. */
	target_draw(&plain, gi, look_down(1, GI_OVERLAY_NONE));
	target_draw(&over, gi, view);
	assert_int_equal(count_other(&plain, &over), 0);
	harness_update(gi);
	target_draw(&plain, gi, look_down(1, GI_OVERLAY_NONE));
	target_draw(&over, gi, view);
	assert_int_equal(count_other(&plain, &over), 0);
	assert_gi(gi_destroy_receivers(gi, hidden));
	add_point(gi, above, NULL);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	target_draw(&over, gi, view);
	const int seen = count_other(&plain, &over);
	assert_true(fabs(seen - PI * 36) < 24);
	/* Half of a ball stands out of the floor. */
	add_point(gi, half_in, NULL);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	target_draw(&over, gi, view);
	assert_true(fabs(count_other(&plain, &over) - 2 * PI * 36) < 48);
	target_free(&plain);
	target_free(&over);
	gi_context_destroy(gi);
}

static void misuse(void **state)
{
	(void)state;
	static const float radii[] = {-1, NAN, INFINITY, 2e9f};
	gi_context *gi = open_scene();
	target t = target_make(SIZE);
	gi_view view = look_down(1, GI_OVERLAY_RECEIVERS);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	target_draw(&t, gi, view); /* none: the picture alone */
	for (size_t k = 0; k < sizeof radii / sizeof *radii; k++) {
		view.overlay_radius = radii[k];
		assert_int_equal(target_try(&t, gi, view), GI_ERROR_INVALID_ARGUMENT);
	}
	view.overlay_radius = 0;
	view.overlay = (gi_overlay)(GI_OVERLAY_RECEIVERS + 1);
	assert_int_equal(target_try(&t, gi, view), GI_ERROR_INVALID_ARGUMENT);
	target_free(&t);
	gi_context_destroy(gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_disc),        cmocka_unit_test(a_ball), cmocka_unit_test(several_sets),
	    cmocka_unit_test(what_hides_it), cmocka_unit_test(misuse),
	};
	return cmocka_run_group_tests_name("overlay of receivers", tests, harness_open, harness_close);
}
