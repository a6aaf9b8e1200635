/* Lights without a surface in pictures, pixel by pixel: against closed forms with shadows, who shows them, and no light
 * where walls are. */
#include "pieces.h"
#include "target.h"

#include "scenes/shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979;

enum { SIZE = 128 };

/* From above, straight down, parallel: pixel x, y is the floor's x, -z, from -half to half. Nothing above `top` is
 * seen. */
static void look(gi_context *gi, target *t, float half, float top, gi_mode mode)
{
	gi_view view = gi_view_default();
	const float world[16] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, -top, 1};
	const float clip[16] = {1 / half, 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, -2 / (top + 1), 0, 0, 0, -1, 1};
	memcpy(view.view_from_world, world, sizeof world);
	memcpy(view.clip_from_view, clip, sizeof clip);
	view.mode = mode;
	target_draw(t, gi, view);
}

static float red_at(const target *t, int x, int y)
{
	return t->pixels[4 * (y * SIZE + x)];
}

/* Where a pixel's middle is on the floor. */
static void place_of(int x, int y, double half, double at[2])
{
	at[0] = half * ((2 * x + 1.0) / SIZE - 1);
	at[1] = -half * ((2 * y + 1.0) / SIZE - 1);
}

static gi_context *open_scene(void)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .1f;
	return harness_context(&def);
}

static gi_object add_square(gi_context *gi, float y, float side, uint32_t cells, bool both)
{
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-side / 2, y, -side / 2}, (float[]){0, 0, side}, (float[]){side, 0, 0}, cells,
			       cells, &mesh));
	const harness_object like = {.name = "square", .rho = {.5f, .5f, .5f}, .double_sided = both};
	return harness_add(gi, &like, &mesh);
}

/* A floor, and a square of two sides at some height above it; sides, metres, and cells. */
static gi_context *open_floor(float side, uint32_t cells, float height, float above, uint32_t above_cells)
{
	gi_context *gi = open_scene();
	add_square(gi, 0, side, cells, false);
	add_square(gi, height, above, above_cells, true);
	assert_gi(gi_commit(gi));
	return gi;
}

static gi_light add_light(gi_context *gi, const gi_light_def *def)
{
	gi_light light;
	assert_gi(gi_create_light(gi, def, &light));
	return light;
}

static gi_light_def def_of(gi_light_type type, float intensity)
{
	gi_light_def def = gi_light_def_default();
	def.type = type;
	memcpy(def.position, (float[]){.1f, 2, -.2f}, sizeof def.position);
	memcpy(def.direction, (float[]){.3f, -1, .2f}, sizeof def.direction);
	for (int c = 0; c < 3; c++)
		def.intensity[c] = intensity;
	return def;
}

/* Light on the floor at x, z with nothing in between, and where the way to it meets the height of 1. */
static double light_at(const gi_light_def *d, double x, double z, double above[2])
{
	if (d->type == GI_LIGHT_DIRECTIONAL) {
		above[0] = x - .3;
		above[1] = z - .2;
		return d->intensity[0] / sqrt(1 + .3 * .3 + .2 * .2);
	}
	const double to[3] = {.1 - x, 2, -.2 - z}, square = to[0] * to[0] + 4 + to[2] * to[2];
	above[0] = x + to[0] / 2;
	above[1] = z + to[2] / 2;
	double cone = 1;
	if (d->type == GI_LIGHT_SPOT) {
		const double cosine = (-.3 * to[0] + 2 - .2 * to[2]) / sqrt(square * (1 + .3 * .3 + .2 * .2));
		const double outer = cos((double)d->outer_angle), inner = cos((double)d->inner_angle);
		cone = fmin(fmax((cosine - outer) / (inner - outer), 0), 1);
	}
	return d->intensity[0] * 2 / (square * sqrt(square)) * cone * cone;
}

/* A square of 0.6 m a metre above the floor hides the light; `blur` metres about its edges are not judged. */
static void expect_shadow(const target *t, double half, const gi_light_def *d, double blur)
{
	int lit = 0, dark = 0;
	for (int y = 2; y < SIZE - 2; y++)
		for (int x = 2; x < SIZE - 2; x++) {
			double at[2], above[2];
			place_of(x, y, half, at);
			const double wanted = light_at(d, at[0], at[1], above) * .5 / PI;
			const double inside = .3 - fmax(fabs(above[0]), fabs(above[1]));
			const double found = red_at(t, x, y), due = inside > 0 ? 0 : wanted;
			if (fabs(inside) < blur)
				continue;
			lit += inside < 0 && wanted > 0;
			dark += inside > 0;
			if (!(fabs(found - due) <= 2e-3 * d->intensity[0]))
				fail_msg("type %d, radius %g, (%.3f, %.3f): %g, not %g", (int)d->type,
					 (double)d->radius, at[0], at[1], found, due);
		}
	assert_true(lit > 1000 && dark > 500);
}

static void test_shadows(void **state)
{
	(void)state;
	target t = target_make(SIZE);
	gi_context *gi = open_floor(4, 4, 1, .6f, 1);
	gi_light_def def = def_of(GI_LIGHT_POINT, 40);
	const gi_light light = add_light(gi, &def);
	for (int soft = 0; soft < 2; soft++)
		for (gi_light_type type = GI_LIGHT_POINT; type <= GI_LIGHT_DIRECTIONAL; type++) {
			def = def_of(type, 40);
			def.inner_angle = .3f;
			def.outer_angle = .7f;
			def.radius = soft ? .04f : 0;
			def.angular_radius = soft ? .02f : 0;
			assert_gi(gi_set_light(gi, light, &def));
			harness_update(gi);
			/* The square itself is above what is seen. */
			look(gi, &t, .9f, .9f, GI_MODE_DIRECT);
			expect_shadow(&t, .9, &def, soft ? .05 : .012);
		}
	/* A spot that is too wide for one map. */
	def = def_of(GI_LIGHT_SPOT, 40);
	def.inner_angle = 0;
	def.outer_angle = 1.4f;
	assert_gi(gi_set_light(gi, light, &def));
	harness_update(gi);
	look(gi, &t, .9f, .9f, GI_MODE_DIRECT);
	expect_shadow(&t, .9, &def, .012);
	gi_context_destroy(gi);
	target_free(&t);
}

/* Half way through a penumbra half of the light arrives, and it is as wide as it should be. */
static void test_penumbra(void **state)
{
	(void)state;
	target t = target_make(SIZE);
	gi_context *gi = open_floor(4, 4, 1, .6f, 1);
	gi_light_def def = def_of(GI_LIGHT_DIRECTIONAL, 10);
	memcpy(def.direction, (float[]){0, -1, 0}, sizeof def.direction);
	def.angular_radius = .04f;
	add_light(gi, &def);
	harness_update(gi);
	look(gi, &t, .4f, .9f, GI_MODE_DIRECT);
	/* Along z = 0 a disc of radius 0.04 is covered from one side by a straight edge at x = 0.3. */
	for (int x = 0; x < SIZE; x++) {
		double at[2];
		place_of(x, SIZE / 2, .4, at);
		const double u = fmin(fmax((at[0] - .3) / tan(.04), -1), 1);
		const double share = .5 + (u * sqrt(1 - u * u) + asin(u)) / PI;
		const double found = red_at(&t, x, SIZE / 2) / (10 * .5 / PI);
		if (at[0] > 0 && !(fabs(found - share) < .08))
			fail_msg("x %.3f: %.3f of the light, not %.3f", at[0], found, share);
	}
	gi_context_destroy(gi);
	target_free(&t);
}

static double mean_of(const target *t)
{
	double sum = 0;
	for (int y = 0; y < SIZE; y++)
		for (int x = 0; x < SIZE; x++)
			sum += red_at(t, x, y);
	return sum / (SIZE * SIZE);
}

static void test_who_shows_it(void **state)
{
	(void)state;
	target t = target_make(SIZE);
	gi_context *gi = open_floor(2, 16, .5f, .3f, 2);
	gi_light_def def = def_of(GI_LIGHT_POINT, 10);
	const gi_light light = add_light(gi, &def);
	double mean[3][3];
	for (gi_light_shown shown = GI_LIGHT_BY_PIXELS; shown <= GI_LIGHT_BY_HOST; shown++) {
		def.shown = shown;
		assert_gi(gi_set_light(gi, light, &def));
		assert_int_equal(harness_update(gi).light_rays > 0, shown == GI_LIGHT_BY_PIXELS);
		for (gi_mode mode = GI_MODE_GLOBAL; mode <= GI_MODE_INDIRECT; mode++) {
			look(gi, &t, .9f, .4f, mode);
			mean[shown][mode] = mean_of(&t);
		}
		assert_true(fabs(mean[shown][GI_MODE_GLOBAL] - mean[shown][GI_MODE_DIRECT] -
				 mean[shown][GI_MODE_INDIRECT]) < 1e-5 * mean[0][0]);
	}
	const double direct = mean[GI_LIGHT_BY_PIXELS][GI_MODE_DIRECT];
	const double bounced = mean[GI_LIGHT_BY_HOST][GI_MODE_GLOBAL];
	assert_true(direct > 0 && bounced > 0 && bounced < .2 * direct);
	assert_true(mean[GI_LIGHT_BY_LEAVES][GI_MODE_DIRECT] == 0 && mean[GI_LIGHT_BY_HOST][GI_MODE_DIRECT] == 0);
	/* By leaves the same light, as coarse as they are. */
	assert_true(fabs(mean[GI_LIGHT_BY_LEAVES][GI_MODE_GLOBAL] - direct - bounced) < .01 * direct);
	assert_true(fabs(mean[GI_LIGHT_BY_PIXELS][GI_MODE_INDIRECT] - bounced) < 1e-4 * direct);
	/* Off: black; another colour: another picture, of the same maps. */
	def.shown = GI_LIGHT_BY_PIXELS;
	def.intensity[0] = 30;
	assert_gi(gi_set_light(gi, light, &def));
	harness_update(gi);
	look(gi, &t, .9f, .4f, GI_MODE_DIRECT);
	assert_true(fabs(mean_of(&t) - 3 * direct) < 1e-4 * direct);
	def.enabled = false;
	assert_gi(gi_set_light(gi, light, &def));
	harness_update(gi);
	look(gi, &t, .9f, .4f, GI_MODE_GLOBAL);
	assert_true(mean_of(&t) == 0);
	gi_context_destroy(gi);
	target_free(&t);
}

/* A room whose walls have no thickness is dark inside, to the last pixel of its floor, whatever shines on it. */
static void test_walls_keep_light_out(void **state)
{
	(void)state;
	target t = target_make(SIZE);
	gi_context *gi = open_scene();
	engine_mesh mesh;
	assert_true(shape_box((float[]){-1, 0, -1}, (float[]){1, 2, 1}, 4, true, &mesh));
	harness_add(gi, &(harness_object){.name = "room", .rho = {.5f, .5f, .5f}}, &mesh);
	assert_gi(gi_commit(gi));
	gi_light_def def = def_of(GI_LIGHT_DIRECTIONAL, 1000);
	const gi_light sun = add_light(gi, &def);
	gi_light_def point = def_of(GI_LIGHT_POINT, 1000);
	memcpy(point.position, (float[]){1.4f, 1.2f, 1.7f}, sizeof point.position);
	add_light(gi, &point);
	for (int k = 0; k < 12; k++) {
		def.direction[0] = sinf((float)k * .53f);
		def.direction[1] = -.1f - .11f * (float)k;
		def.direction[2] = cosf((float)k * .53f);
		assert_gi(gi_set_light(gi, sun, &def));
		harness_update(gi);
		look(gi, &t, .9999f, 1.9f, GI_MODE_GLOBAL);
		for (int y = 0; y < SIZE; y++)
			for (int x = 0; x < SIZE; x++)
				if (red_at(&t, x, y) > 0)
					fail_msg("sun %d, pixel %d %d: %g", k, x, y, (double)red_at(&t, x, y));
	}
	gi_context_destroy(gi);
	target_free(&t);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_shadows),
	    cmocka_unit_test(test_penumbra),
	    cmocka_unit_test(test_who_shows_it),
	    cmocka_unit_test(test_walls_keep_light_out),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
