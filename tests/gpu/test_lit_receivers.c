/* Receivers in the light of lights without a surface: closed forms with and without something in the way, who draws a
 * light, and what moves against a context that was made at once. */
#include "harmonics.h"
#include "pieces.h"

#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 3, CEILING = 4 };

/* Above a black floor; the plate hides the light from the last one. */
static const float AT[POINTS][3] = {{0, 1, 0}, {1, .5f, -.5f}, {-1, 1, 0}};
static const float NORMALS[POINTS][3] = {{0, 1, 0}, {0, .6f, .8f}, {0, 1, 0}};
static const float LAMP[3] = {.5f, CEILING, .5f};
static const float INTENSITY[3] = {10, 5, 1};

typedef struct subject {
	gi_context *gi;
	gi_object plate;
	gi_receivers facing, round;
	gi_light light;
} subject;

static gi_receivers add_receivers(gi_context *gi, bool facing)
{
	gi_receivers_def def = gi_receivers_def_default();
	gi_receivers out;
	def.positions = AT[0];
	def.normals = facing ? NORMALS[0] : NULL;
	def.count = POINTS;
	def.harmonics = facing ? 0 : 2;
	assert_gi(gi_create_receivers(gi, &def, &out));
	return out;
}

static gi_light_def lamp_def(gi_light_type type)
{
	gi_light_def def = gi_light_def_default();
	def.type = type;
	memcpy(def.position, LAMP, sizeof LAMP);
	memcpy(def.direction, (float[]){0, -1, 0}, sizeof def.direction);
	memcpy(def.intensity, INTENSITY, sizeof INTENSITY);
	return def;
}

static subject create(gi_light_type type)
{
	gi_context_def def = harness_def();
	subject s = {.gi = harness_context(&def)};
	engine_mesh floor, plate;
	assert_true(shape_quad((float[]){-4, 0, -4}, (float[]){0, 0, 8}, (float[]){8, 0, 0}, 4, 4, &floor));
	harness_add(s.gi, &(harness_object){.name = "floor"}, &floor);
	assert_true(shape_box((float[]){-.4f, 0, -.4f}, (float[]){.4f, .02f, .4f}, 1, false, &plate));
	s.plate = harness_add(s.gi, &(harness_object){.name = "plate", .position = {-.6f, 1.8f, .1f}}, &plate);
	s.facing = add_receivers(s.gi, true);
	s.round = add_receivers(s.gi, false);
	const gi_light_def lamp = lamp_def(type);
	assert_gi(gi_create_light(s.gi, &lamp, &s.light));
	assert_gi(gi_commit(s.gi));
	harness_update(s.gi);
	return s;
}

static void read(const subject *s, float facing[4 * POINTS], float round[36 * POINTS])
{
	uint32_t count;
	assert_gi(gi_read_receivers(s->gi, s->facing, facing, POINTS, &count));
	assert_int_equal(count, POINTS);
	assert_gi(gi_read_receivers(s->gi, s->round, round, 9 * POINTS, &count));
	assert_int_equal(count, 9 * POINTS);
}

/* What a light from one direction leaves of a cosine lobe after the second band: 1/4 + cos/2 + 5/32 (3 cos^2 - 1). */
static double second_band(double cosine)
{
	return .25 + cosine / 2 + 5.0 / 32 * (3 * cosine * cosine - 1);
}

/* Red irradiance of what faces the light at a point, and the cosine to its normal. */
static double facing_light(gi_light_type type, int point, double *cosine)
{
	double to[3] = {0, 1, 0}, square = 1;
	for (int k = 0; k < 3 && type == GI_LIGHT_POINT; k++)
		to[k] = (double)(LAMP[k] - AT[point][k]);
	if (type == GI_LIGHT_POINT)
		square = to[0] * to[0] + to[1] * to[1] + to[2] * to[2];
	*cosine = 0;
	for (int k = 0; k < 3; k++)
		*cosine += to[k] * (double)NORMALS[point][k] / sqrt(square);
	return (double)INTENSITY[0] / square;
}

static void expect_closed_form(const subject *s, gi_light_type type)
{
	float facing[4 * POINTS], round[36 * POINTS];
	read(s, facing, round);
	for (int p = 0; p < POINTS; p++) {
		double cosine;
		const double e = facing_light(type, p, &cosine);
		const bool hidden = p == POINTS - 1;
		const double wanted = hidden ? 0 : e * fmax(cosine, 0), bands = hidden ? 0 : e * second_band(cosine);
		printf("point %d: %.5f W/m2 (%.5f), by harmonics %.5f (%.5f)\n", p, (double)facing[4 * p], wanted,
		       harmonics_along(round + 36 * p, 9, NORMALS[p], 0), bands);
		assert_float_equal(facing[4 * p], wanted, 1e-4 * e);
		assert_float_equal(harmonics_along(round + 36 * p, 9, NORMALS[p], 0), bands, 1e-4 * e);
		assert_float_equal(facing[4 * p + 1], wanted / 2, 1e-4 * e);
	}
}

static void test_closed_forms(void **state)
{
	(void)state;
	harness_require_context();
	/* The plate is between the last point and the lamp; a sun comes from straight above. */
	subject s = create(GI_LIGHT_POINT);
	expect_closed_form(&s, GI_LIGHT_POINT);
	gi_light_def sun = lamp_def(GI_LIGHT_DIRECTIONAL);
	assert_gi(gi_set_light(s.gi, s.light, &sun));
	assert_gi(gi_set_pose(s.gi, s.plate, (gi_pose){{-1, 1.8f, .1f}, {0, 0, 0, 1}}));
	harness_update(s.gi);
	expect_closed_form(&s, GI_LIGHT_DIRECTIONAL);
	gi_context_destroy(s.gi);
}

static void expect_dark(const subject *s)
{
	float facing[4 * POINTS], round[36 * POINTS];
	read(s, facing, round);
	for (int p = 0; p < POINTS; p++)
		for (int c = 0; c < 3; c++)
			assert_true(facing[4 * p + c] == 0 && round[36 * p + c] == 0);
}

/* Off, drawn by the host, and gone: nothing of it is left, and all of it comes back. */
static void test_switches(void **state)
{
	(void)state;
	harness_require_context();
	subject s = create(GI_LIGHT_POINT);
	gi_light_def def = lamp_def(GI_LIGHT_POINT);
	def.enabled = false;
	assert_gi(gi_set_light(s.gi, s.light, &def));
	harness_update(s.gi);
	expect_dark(&s);
	def.enabled = true;
	def.shown = GI_LIGHT_BY_HOST;
	assert_gi(gi_set_light(s.gi, s.light, &def));
	harness_update(s.gi);
	expect_dark(&s);
	def.shown = GI_LIGHT_BY_PIXELS;
	assert_gi(gi_set_light(s.gi, s.light, &def));
	harness_update(s.gi);
	expect_closed_form(&s, GI_LIGHT_POINT);
	assert_gi(gi_destroy_light(s.gi, s.light));
	harness_update(s.gi);
	expect_dark(&s);
	gi_context_destroy(s.gi);
}

/* What moves, alone and together, is what a rebuild says, bit for bit; where nothing moves nothing is traced. */
static void test_moves(void **state)
{
	(void)state;
	harness_require_context();
	subject s = create(GI_LIGHT_POINT);
	float facing[2][4 * POINTS], round[2][36 * POINTS], points[POINTS][3];
	for (int frame = 0; frame < 9; frame++) {
		const float step = .07f * (float)frame;
		gi_light_def def = lamp_def(GI_LIGHT_POINT);
		def.position[0] += step;
		for (int p = 0; p < POINTS; p++)
			for (int k = 0; k < 3; k++)
				points[p][k] = AT[p][k] + (k == 2 ? step : 0);
		if (frame % 3 != 0)
			assert_gi(gi_set_light(s.gi, s.light, &def));
		if (frame % 3 != 1)
			assert_gi(gi_set_pose(s.gi, s.plate, (gi_pose){{-.6f + step, 1.8f, .1f}, {0, 0, 0, 1}}));
		if (frame % 3 != 2)
			assert_gi(gi_set_receivers(s.gi, s.facing, points[0], NULL));
		harness_update(s.gi);
		read(&s, facing[0], round[0]);
		gi_invalidate(s.gi);
		harness_update(s.gi);
		read(&s, facing[1], round[1]);
		assert_memory_equal(facing[0], facing[1], sizeof facing[0]);
		assert_memory_equal(round[0], round[1], sizeof round[0]);
	}
	assert_int_equal(harness_update(s.gi).light_rays, 0);
	gi_context_destroy(s.gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_closed_forms),
	    cmocka_unit_test(test_switches),
	    cmocka_unit_test(test_moves),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
