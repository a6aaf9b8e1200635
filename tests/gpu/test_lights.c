/* Lights without a surface on leaves: suns, points and spots against closed forms, what a change of them costs, moves
 * against scenes that were made at once, bounds under a budget, and their coming and going. */
#include "pieces.h"

#include "scenes/shapes.h"

#include <glad/gl.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979;

static gi_context *open_scene(gi_sky sky)
{
	gi_context_def def = harness_def();
	def.row_tolerance = .1f;
	def.sky = sky;
	return harness_context(&def);
}

/* A square of cells x cells leaves, counter-clockwise seen from where it faces. */
static gi_object add_plate(gi_context *gi, const float corner[3], const float u[3], const float v[3], uint32_t cells,
			   float rho)
{
	engine_mesh mesh;
	assert_true(shape_quad(corner, u, v, cells, cells, &mesh));
	return harness_add(gi, &(harness_object){.name = "plate", .rho = {rho, rho, rho}}, &mesh);
}

/* Of side `side` about the y axis, facing up. */
static gi_object add_floor(gi_context *gi, float y, float side, uint32_t cells, float rho)
{
	return add_plate(gi, (float[]){-side / 2, y, -side / 2}, (float[]){0, 0, side}, (float[]){side, 0, 0}, cells,
			 rho);
}

static gi_light add_light(gi_context *gi, const gi_light_def *def)
{
	gi_light light;
	assert_gi(gi_create_light(gi, def, &light));
	return light;
}

static gi_light_def sun_of(float x, float y, float z, float irradiance)
{
	gi_light_def def = gi_light_def_default();
	def.type = GI_LIGHT_DIRECTIONAL;
	def.direction[0] = x;
	def.direction[1] = y;
	def.direction[2] = z;
	def.intensity[0] = irradiance;
	def.intensity[1] = irradiance / 2;
	def.intensity[2] = 0;
	return def;
}

static gi_light_def point_at(float x, float y, float z, float intensity)
{
	gi_light_def def = gi_light_def_default();
	const float at[3] = {x, y, z};
	memcpy(def.position, at, sizeof at);
	for (int c = 0; c < 3; c++)
		def.intensity[c] = intensity;
	return def;
}

/* Red light that falls on an object, W. */
static double flux_on(const snapshot *s, gi_object object)
{
	double flux = 0;
	for (uint32_t k = 0; k < s->leaf_count; k++)
		if (s->leaves[k].object.index1 == object.index1)
			flux += (double)s->leaves[k].area * s->leaves[k].irradiance[0];
	return flux;
}

static void expect_near(double found, double wanted, double tolerance, const char *what)
{
	if (!(fabs(found - wanted) <= tolerance * fabs(wanted)))
		fail_msg("%s: %.6g, not %.6g (%.2g off, %.2g allowed)", what, found, wanted, found / wanted - 1,
			 tolerance);
}

/* ---- closed forms ---- */

static void test_sun_on_open_plate(void **state)
{
	(void)state;
	gi_context *gi = open_scene(GI_SKY_AUTO);
	add_floor(gi, 0, 2, 4, 0);
	assert_gi(gi_commit(gi));
	gi_light sun = {0};
	for (int k = 0; k < 5; k++) {
		const double angle = k * 22.4 / 180 * PI;
		const gi_light_def def = sun_of((float)sin(angle), -(float)cos(angle), 0, 700);
		if (k == 0)
			sun = add_light(gi, &def);
		else
			assert_gi(gi_set_light(gi, sun, &def));
		const gi_report r = harness_update(gi);
		assert_int_equal(r.light_rays, 16 * 16);
		snapshot s = snapshot_take(gi);
		for (uint32_t leaf = 0; leaf < s.leaf_count; leaf++) {
			expect_near(s.leaves[leaf].irradiance[0], 700 * cos(angle), 1e-5, "E cos theta");
			expect_near(s.leaves[leaf].irradiance[1], 350 * cos(angle), 1e-5, "E cos theta, green");
			assert_true(s.leaves[leaf].irradiance[2] == 0);
		}
		snapshot_free(&s);
	}
	/* From below: its back is black. */
	gi_light_def def = sun_of(0, 1, 0, 700);
	assert_gi(gi_set_light(gi, sun, &def));
	assert_int_equal(harness_update(gi).light_rays, 0);
	snapshot s = snapshot_take(gi);
	for (uint32_t leaf = 0; leaf < s.leaf_count; leaf++)
		assert_true(s.leaves[leaf].irradiance[0] == 0);
	snapshot_free(&s);
	gi_context_destroy(gi);
}

/* A well of 1 x 1 m, 1 m deep, with black walls. */
static void test_sun_in_a_well(void **state)
{
	(void)state;
	static const float walls[4][3][3] = {{{-.5f, 0, -.5f}, {0, 1, 0}, {0, 0, 1}},
					     {{.5f, 0, -.5f}, {0, 0, 1}, {0, 1, 0}},
					     {{-.5f, 0, -.5f}, {1, 0, 0}, {0, 1, 0}},
					     {{-.5f, 0, .5f}, {0, 1, 0}, {1, 0, 0}}};
	static const float slopes[4][2] = {{.37f, 0}, {.215f, .44f}, {-.13f, .71f}, {.9f, -.3f}};
	gi_context *gi = open_scene(GI_SKY_AUTO);
	const gi_object bottom = add_floor(gi, 0, 1, 16, 0);
	for (int k = 0; k < 4; k++)
		add_plate(gi, walls[k][0], walls[k][1], walls[k][2], 1, 0);
	assert_gi(gi_commit(gi));
	gi_light_def def = sun_of(0, -1, 0, 1000);
	const gi_light sun = add_light(gi, &def);
	for (int k = 0; k < 4; k++) {
		def.direction[0] = slopes[k][0];
		def.direction[2] = slopes[k][1];
		assert_gi(gi_set_light(gi, sun, &def));
		harness_update(gi);
		snapshot s = snapshot_take(gi);
		const double x = fabs(slopes[k][0]), z = fabs(slopes[k][1]);
		const double lit = (1 - x) * (1 - z), cosine = 1 / sqrt(1 + x * x + z * z);
		expect_near(flux_on(&s, bottom), 1000 * cosine * lit, .006, "lit share of a well's bottom");
		snapshot_free(&s);
	}
	gi_context_destroy(gi);
}

/* Solid angle of a rectangle of half sides a and b at distance d before its middle. */
static double solid_angle(double a, double b, double d)
{
	return 4 * atan(a * b / (d * sqrt(a * a + b * b + d * d)));
}

static void test_point_over_plate(void **state)
{
	(void)state;
	gi_context *gi = open_scene(GI_SKY_AUTO);
	const gi_object plate = add_floor(gi, 0, 2, 16, 0), blocker = add_floor(gi, 1, .5f, 1, 0);
	assert_gi(gi_set_pose(gi, blocker, (gi_pose){{0, 50, 0}, {0, 0, 0, 1}}));
	assert_gi(gi_commit(gi));
	gi_light_def def = point_at(0, 2, 0, 80);
	const gi_light point = add_light(gi, &def);
	harness_update(gi);
	snapshot s = snapshot_take(gi);
	for (uint32_t leaf = 0; leaf < s.leaf_count; leaf++) {
		float c[3], n[3];
		leaf_centre_and_normal(&s.leaves[leaf], c, n);
		if (s.leaves[leaf].object.index1 != plate.index1)
			continue;
		const double d2 = (double)c[0] * c[0] + 4 + (double)c[2] * c[2];
		/* The mean over a leaf of 12.5 cm is that of its middle but for some thousandth. */
		expect_near(s.leaves[leaf].irradiance[0], 80 * 2 / (d2 * sqrt(d2)), .004, "I cos / d^2");
	}
	expect_near(flux_on(&s, plate), 80 * solid_angle(1, 1, 2), 1e-5, "I times the plate's solid angle");
	snapshot_free(&s);
	assert_gi(gi_set_pose(gi, blocker, (gi_pose){{.013f, 0, -.021f}, {0, 0, 0, 1}}));
	harness_update(gi);
	s = snapshot_take(gi);
	expect_near(flux_on(&s, plate), 80 * (solid_angle(1, 1, 2) - solid_angle(.25, .25, 1)), 2e-3,
		    "with something in between");
	snapshot_free(&s);
	/* A ball of light: shadows are softer, and as dark. */
	def.radius = .1f;
	assert_gi(gi_set_light(gi, point, &def));
	harness_update(gi);
	s = snapshot_take(gi);
	expect_near(flux_on(&s, plate), 80 * (solid_angle(1, 1, 2) - solid_angle(.25, .25, 1)), 4e-3,
		    "soft, with something in between");
	snapshot_free(&s);
	gi_context_destroy(gi);
}

static double clamped(double x)
{
	return fmin(fmax(x, 0), 1);
}

/* What a spot at (0, 3, 0) that shines down sends to a point of the floor. */
static double spot_light(const gi_light_def *d, double x, double z)
{
	const double d2 = x * x + 9 + z * z, cosine = 3 / sqrt(d2), outer = cos((double)d->outer_angle);
	const double cone = clamped((cosine - outer) / (cos((double)d->inner_angle) - outer));
	const double far = d->range > 0 ? d2 / ((double)d->range * d->range) : 0;
	return d->intensity[0] * cosine / d2 * cone * cone * fmax(1 - far * far, 0);
}

static void test_spot(void **state)
{
	(void)state;
	gi_context *gi = open_scene(GI_SKY_AUTO);
	const gi_object plate = add_floor(gi, 0, 4, 24, 0);
	assert_gi(gi_commit(gi));
	gi_light_def def = point_at(0, 3, 0, 50);
	def.type = GI_LIGHT_SPOT;
	memcpy(def.direction, (float[]){0, -7, 0}, sizeof def.direction);
	def.inner_angle = .2f;
	def.outer_angle = .5f;
	const gi_light spot = add_light(gi, &def);
	for (int k = 0; k < 2; k++) {
		def.range = k ? 3.5f : 0;
		assert_gi(gi_set_light(gi, spot, &def));
		harness_update(gi);
		snapshot s = snapshot_take(gi);
		double wanted = 0;
		for (uint32_t leaf = 0; leaf < s.leaf_count; leaf++) {
			const gi_leaf *l = &s.leaves[leaf];
			double mean = 0;
			for (int n = 0; n < 64; n++) {
				const double u = (n % 8 + .5) / 8, v = (n / 8 + .5) / 8;
				const double x = l->corners[0][0] + u * ((double)l->corners[2][0] - l->corners[0][0]);
				const double z = l->corners[0][2] + v * ((double)l->corners[2][2] - l->corners[0][2]);
				mean += spot_light(&def, x, z) / 64;
			}
			wanted += mean * l->area;
			assert_true(fabs(l->irradiance[0] - mean) <= .02 * 50 / 9);
		}
		expect_near(flux_on(&s, plate), wanted, 2e-3, k ? "a spot's flux, with a range" : "a spot's flux");
		snapshot_free(&s);
	}
	gi_context_destroy(gi);
}

/* In a closed room all that a light gives is absorbed in the end: sum (1 - rho) H A = 4 pi I. */
static void test_light_is_kept(void **state)
{
	(void)state;
	gi_context *gi = open_scene(GI_SKY_OFF);
	engine_mesh mesh;
	assert_true(shape_box((float[]){-1, 0, -1}, (float[]){1, 2, 1}, 6, true, &mesh));
	harness_add(gi, &(harness_object){.name = "room", .rho = {.7f, .5f, .2f}}, &mesh);
	add_block(gi, &(harness_object){.name = "block", .rho = {.4f, .4f, .4f}},
		  (box){{-.3f, .2f, -.4f}, {.2f, .8f, .1f}});
	assert_gi(gi_commit(gi));
	const gi_light_def def = point_at(.4f, 1.3f, .3f, 10);
	add_light(gi, &def);
	solve(gi);
	snapshot s = snapshot_take(gi);
	for (int c = 0; c < 3; c++) {
		double absorbed = 0;
		for (uint32_t k = 0; k < s.leaf_count; k++)
			absorbed += (1 - (double)s.leaves[k].rho[c]) * s.leaves[k].irradiance[c] * s.leaves[k].area;
		expect_near(absorbed, 4 * PI * 10, .02, "what a room absorbs");
	}
	expect_sane_rows(&s);
	assert_true(snapshot_light_error(gi, &s, harness_paths(1024)) < .04);
	snapshot_free(&s);
	gi_context_destroy(gi);
}

/* A room with a window, lit by a sun: H against paths. */
static void test_sun_through_a_window(void **state)
{
	(void)state;
	static const float parts[4][3][3] = {{{-1, 0, -1}, {0, 2, 0}, {0, 0, .6f}},
					     {{-1, 0, .4f}, {0, 2, 0}, {0, 0, .6f}},
					     {{-1, 0, -.4f}, {0, .7f, 0}, {0, 0, .8f}},
					     {{-1, 1.6f, -.4f}, {0, .4f, 0}, {0, 0, .8f}}};
	gi_context *gi = open_scene(GI_SKY_AUTO);
	for (int k = 0; k < 4; k++) {
		engine_mesh mesh;
		assert_true(shape_quad(parts[k][0], parts[k][1], parts[k][2], 3, 3, &mesh));
		harness_add(gi, &(harness_object){.name = "wall", .rho = {.6f, .6f, .6f}, .double_sided = true}, &mesh);
	}
	add_floor(gi, 0, 2, 8, .7f);
	add_plate(gi, (float[]){-1, 2, -1}, (float[]){2, 0, 0}, (float[]){0, 0, 2}, 4, .7f);
	add_plate(gi, (float[]){1, 0, -1}, (float[]){0, 0, 2}, (float[]){0, 2, 0}, 4, .5f);
	add_plate(gi, (float[]){-1, 0, -1}, (float[]){2, 0, 0}, (float[]){0, 2, 0}, 4, .5f);
	add_plate(gi, (float[]){-1, 0, 1}, (float[]){0, 2, 0}, (float[]){2, 0, 0}, 4, .5f);
	assert_gi(gi_commit(gi));
	const gi_light_def def = sun_of(1, -.9f, .2f, 800);
	add_light(gi, &def);
	solve(gi);
	snapshot s = snapshot_take(gi);
	assert_true(snapshot_light_error(gi, &s, harness_paths(1024)) < .05);
	snapshot_free(&s);
	gi_context_destroy(gi);
}

/* ---- what changes cost ---- */

/* A room with a block that moves, a ball that moves, and three lights. */
typedef struct lit_room {
	gi_context *gi;
	gi_object block, ball;
	gi_light lights[3];
	gi_light_def defs[3];
} lit_room;

static void add_all_lights(lit_room *r)
{
	r->defs[0] = point_at(.4f, 1.6f, .3f, 10);
	r->defs[0].radius = .05f;
	r->defs[1] = point_at(-.5f, 1.7f, -.5f, 25);
	r->defs[1].type = GI_LIGHT_SPOT;
	memcpy(r->defs[1].direction, (float[]){.4f, -1, .3f}, sizeof r->defs[1].direction);
	r->defs[2] = sun_of(.6f, -1, .1f, 100);
	r->defs[2].angular_radius = .02f;
	for (int k = 0; k < 3; k++)
		r->lights[k] = add_light(r->gi, &r->defs[k]);
}

/* Open above, so that the sun comes in. */
static lit_room open_lit_room(float rho)
{
	lit_room r = {.gi = open_scene(GI_SKY_ON)};
	add_floor(r.gi, 0, 2, 10, rho);
	add_plate(r.gi, (float[]){1, 0, -1}, (float[]){0, 0, 2}, (float[]){0, 1, 0}, 6, rho);
	add_plate(r.gi, (float[]){-1, 0, -1}, (float[]){2, 0, 0}, (float[]){0, 1, 0}, 6, rho);
	r.block = add_block(r.gi, &(harness_object){.name = "block", .rho = {rho, rho, rho}},
			    (box){{-.2f, 0, -.2f}, {.2f, .4f, .2f}});
	r.ball = add_ball(r.gi, &(harness_object){.name = "ball", .rho = {rho, rho, rho}}, .2f);
	assert_gi(gi_set_mobility(r.gi, r.block, GI_MOBILITY_MOVABLE));
	return r;
}

static gi_pose pose_at(float x, float y, float z, float turn)
{
	return (gi_pose){{x, y, z}, {0, sinf(turn / 2), 0, cosf(turn / 2)}};
}

static void test_what_changes_cost(void **state)
{
	(void)state;
	lit_room r = open_lit_room(.5f);
	assert_gi(gi_set_pose(r.gi, r.ball, pose_at(-.5f, .5f, .4f, 0)));
	assert_gi(gi_commit(r.gi));
	add_all_lights(&r);
	gi_report report = harness_update(r.gi);
	assert_true(report.light_rays > 0 && report.rays > report.light_rays);
	snapshot s = snapshot_take(r.gi);
	for (int k = 0; k < 20 && report.outcome != GI_OUTCOME_AT_REST; k++)
		report = harness_update(r.gi);
	assert_int_equal(report.outcome, GI_OUTCOME_AT_REST);
	assert_int_equal(report.dispatches, 0);
	/* A new colour: a solve. */
	r.defs[0].intensity[0] = 30;
	assert_gi(gi_set_light(r.gi, r.lights[0], &r.defs[0]));
	report = harness_update(r.gi);
	assert_int_equal(report.rays, 0);
	assert_int_equal(report.dirty_rows, 0);
	assert_true(report.outcome == GI_OUTCOME_CONVERGED && report.pass_ms[GI_PASS_LIGHTS] > 0);
	snapshot brighter = snapshot_take(r.gi);
	assert_true(snapshot_distance(&s, &brighter) > .05 * snapshot_largest(&s));
	snapshot_free(&s);
	/* Off and on again. */
	r.defs[0].enabled = false;
	assert_gi(gi_set_light(r.gi, r.lights[0], &r.defs[0]));
	assert_int_equal(harness_update(r.gi).rays, 0);
	r.defs[0].enabled = true;
	assert_gi(gi_set_light(r.gi, r.lights[0], &r.defs[0]));
	assert_int_equal(harness_update(r.gi).rays, 0);
	s = snapshot_take(r.gi);
	for (uint32_t k = 0; k < s.leaf_count; k++)
		assert_true(fabsf(s.leaves[k].radiosity[0] - brighter.leaves[k].radiosity[0]) <=
			    2e-2 * snapshot_largest(&s));
	snapshot_free(&s);
	snapshot_free(&brighter);
	gi_context_destroy(r.gi);
}

static void test_what_moves_cost(void **state)
{
	(void)state;
	lit_room r = open_lit_room(.5f);
	assert_gi(gi_set_pose(r.gi, r.ball, pose_at(-.5f, .5f, .4f, 0)));
	assert_gi(gi_commit(r.gi));
	add_all_lights(&r);
	gi_report report = harness_update(r.gi);
	const uint64_t all = report.light_rays;
	/* The same values: nothing. */
	assert_gi(gi_set_light(r.gi, r.lights[0], &r.defs[0]));
	for (int k = 0; k < 20 && report.outcome != GI_OUTCOME_AT_REST; k++)
		report = harness_update(r.gi);
	assert_int_equal(harness_update(r.gi).dispatches, 0);
	/* One light moves: its rays, no row's. */
	r.defs[1].position[0] += .1f;
	assert_gi(gi_set_light(r.gi, r.lights[1], &r.defs[1]));
	report = harness_update(r.gi);
	assert_true(report.light_rays > 0 && report.light_rays < all / 2 && report.rays == report.light_rays);
	/* A ball moves: rays of leaves that may see the change. */
	assert_gi(gi_set_pose(r.gi, r.ball, pose_at(-.5f, .55f, .4f, 0)));
	report = harness_update(r.gi);
	assert_true(report.light_rays > 0 && report.light_rays < all / 2);
	/* Nobody needs it any more. */
	for (int k = 0; k < 3; k++)
		assert_gi(gi_destroy_light(r.gi, r.lights[k]));
	harness_update(r.gi);
	snapshot s = snapshot_take(r.gi);
	for (uint32_t k = 0; k < s.leaf_count; k++)
		assert_true(s.leaves[k].irradiance[0] == 0 && s.leaves[k].radiosity[0] == 0);
	snapshot_free(&s);
	gi_context_destroy(r.gi);
}

/* ---- moves ---- */

static uint32_t seed;

static float random_between(float from, float to)
{
	seed = seed * 1664525u + 1013904223u;
	return from + (to - from) * (float)(seed >> 8) / 16777216.0f;
}

static void move_something(lit_room *r, gi_pose poses[2], bool hidden[2])
{
	const int what = (int)random_between(0, 8.999f);
	if (what < 2) {
		poses[what] = pose_at(random_between(-.7f, .7f), random_between(0, .9f), random_between(-.7f, .7f),
				      random_between(0, 6));
	} else if (what < 4) {
		hidden[what - 2] = !hidden[what - 2];
	} else if (what < 6) {
		const int k = (int)random_between(0, 2.999f);
		r->defs[k].enabled = !r->defs[k].enabled;
	} else {
		gi_light_def *d = &r->defs[what - 6];
		for (int c = 0; c < 3; c += 2) {
			d->position[c] = random_between(-.8f, .8f);
			d->direction[c] = random_between(-.8f, .8f);
		}
		d->intensity[1] = random_between(1, 30);
	}
}

static void put(const lit_room *r, const gi_pose poses[2], const bool hidden[2])
{
	const gi_object objects[2] = {r->block, r->ball};
	for (int k = 0; k < 2; k++) {
		assert_gi(gi_set_pose(r->gi, objects[k], poses[k]));
		assert_gi(gi_set_hidden(r->gi, objects[k], hidden[k]));
	}
	for (int k = 0; k < 3; k++)
		assert_gi(gi_set_light(r->gi, r->lights[k], &r->defs[k]));
}

/* In a black scene H is what lights bring, with nothing of the solve in it. */
static void expect_same_light(gi_context *a, gi_context *b, int frame)
{
	snapshot x = snapshot_take(a), y = snapshot_take(b);
	assert_int_equal(x.leaf_count, y.leaf_count);
	for (uint32_t k = 0; k < x.leaf_count; k++)
		if (memcmp(x.leaves[k].irradiance, y.leaves[k].irradiance, sizeof x.leaves[k].irradiance) != 0)
			fail_msg("frame %d, leaf %u: %.9g, made at once %.9g", frame, k,
				 (double)x.leaves[k].irradiance[1], (double)y.leaves[k].irradiance[1]);
	snapshot_free(&x);
	snapshot_free(&y);
}

static void test_moves_equal_a_rebuild(void **state)
{
	(void)state;
	const int frames = harness_is_long() ? 400 : 40;
	lit_room r = open_lit_room(0);
	gi_pose poses[2] = {pose_at(0, 0, 0, 0), pose_at(-.5f, .5f, .4f, 0)};
	bool hidden[2] = {false, false};
	assert_gi(gi_commit(r.gi));
	add_all_lights(&r);
	seed = 7;
	for (int frame = 0; frame < frames; frame++) {
		for (int k = (int)random_between(0, 2.999f); k >= 0; k--)
			move_something(&r, poses, hidden);
		put(&r, poses, hidden);
		/* Budgets leave lights as they are. */
		const gi_budget budget = {.rays = 200};
		assert_gi(gi_update(r.gi, frame % 3 ? &budget : NULL));
		if (frame % 8 == 7) {
			lit_room fresh = open_lit_room(0);
			memcpy(fresh.defs, r.defs, sizeof r.defs);
			for (int k = 0; k < 3; k++)
				fresh.lights[k] = add_light(fresh.gi, &fresh.defs[k]);
			put(&fresh, poses, hidden);
			assert_gi(gi_commit(fresh.gi));
			assert_gi(gi_update(fresh.gi, NULL));
			expect_same_light(r.gi, fresh.gi, frame);
			gi_context_destroy(fresh.gi);
		}
		if (frame % 16 == 15)
			assert_gi(gi_commit(r.gi));
	}
	gi_context_destroy(r.gi);
}

/* Bounds under a budget hold with lights in the scene that brighten and move. */
static void test_bounds_are_certified(void **state)
{
	(void)state;
	lit_room r = open_lit_room(.7f);
	gi_pose poses[2] = {pose_at(0, 0, 0, 0), pose_at(-.5f, .5f, .4f, 0)};
	const bool hidden[2] = {false, false};
	assert_gi(gi_commit(r.gi));
	add_all_lights(&r);
	harness_update(r.gi);
	seed = 3;
	bool waited = false;
	for (int frame = 0; frame < 6; frame++) {
		for (int k = 0; k < 2; k++)
			poses[k] =
			    pose_at(random_between(-.6f, .6f), random_between(.1f, .6f), random_between(-.6f, .6f), 1);
		r.defs[frame % 3].intensity[0] = random_between(1, 100);
		r.defs[0].position[0] = random_between(-.6f, .6f);
		put(&r, poses, hidden);
		const gi_budget budget = {.rays = 500};
		assert_gi(gi_update(r.gi, &budget));
		assert_gi(gi_finish(r.gi));
		gi_report report;
		assert_gi(gi_get_report(r.gi, &report));
		waited = waited || report.waiting_rows > 0;
		snapshot coarse = snapshot_take(r.gi);
		gi_context *exact_gi = r.gi;
		const gi_report exact = harness_update(exact_gi);
		snapshot fine = snapshot_take(exact_gi);
		const double off = snapshot_distance(&coarse, &fine);
		const double bound = (double)report.solve_bound + report.stale_bound + exact.solve_bound;
		if (!(off <= bound))
			fail_msg("frame %d: B is off by %g, certified was %g", frame, off, bound);
		snapshot_free(&coarse);
		snapshot_free(&fine);
	}
	assert_true(waited);
	gi_context_destroy(r.gi);
}

/* A lamp comes before a floor that has half as much light of a sun as the lamp could bring. What rows of the floor may
 * gain is to be told from what they bring: by all of H a third less would be certified than they are off by. */
static void test_lights_are_no_rows(void **state)
{
	(void)state;
	gi_context *gi = open_scene(GI_SKY_OFF);
	add_floor(gi, 0, .2f, 6, .05f);
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-.6f, 0, -.6f}, (float[]){1.2f, 0, 0}, (float[]){0, 0, 1.2f}, 2, 2, &mesh));
	const gi_object lamp = harness_add(gi, &(harness_object){.name = "lamp", .exitance = {700, 700, 700}}, &mesh);
	assert_gi(gi_set_pose(gi, lamp, pose_at(0, 20, 0, 0)));
	/* Below the lamp, wherever that is. */
	gi_light_def sun = sun_of(1, -.4f, 0, 940);
	sun.intensity[1] = sun.intensity[2] = sun.intensity[0];
	add_light(gi, &sun);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	assert_gi(gi_set_pose(gi, lamp, pose_at(0, .4f, 0, 0)));
	assert_gi(gi_update(gi, &(gi_budget){.rays = 1}));
	assert_gi(gi_finish(gi));
	gi_report report;
	assert_gi(gi_get_report(gi, &report));
	snapshot coarse = snapshot_take(gi);
	const gi_report exact = harness_update(gi);
	snapshot fine = snapshot_take(gi);
	const double off = snapshot_distance(&coarse, &fine),
		     bound = (double)report.solve_bound + report.stale_bound + exact.solve_bound;
	print_message("B off by %.3g, certified %.3g\n", off, bound);
	assert_true(report.waiting_rows > 0 && off > 10);
	assert_true(off <= bound);
	snapshot_free(&coarse);
	snapshot_free(&fine);
	gi_context_destroy(gi);
}

/* ---- coming and going ---- */

static uint32_t objects_of_opengl(void)
{
	uint32_t count = 0;
	glUseProgram(0); /* one that is in use outlives its deletion */
	for (GLuint name = 1; name < 4096; name++)
		count += glIsBuffer(name) + glIsTexture(name) + glIsProgram(name) + glIsFramebuffer(name) +
			 glIsVertexArray(name) + glIsSampler(name);
	return count;
}

static void test_hundred_rounds(void **state)
{
	(void)state;
	const uint32_t before = objects_of_opengl();
	lit_room r = open_lit_room(.5f);
	for (int k = 0; k < 3; k++) { /* commits keep memory for the next one */
		assert_gi(gi_commit(r.gi));
		harness_update(r.gi);
	}
	const uint32_t objects = objects_of_opengl();
	gi_light stale = {0};
	for (int round = 0; round < 100; round++) {
		gi_light lights[5];
		const int count = 1 + round % 5;
		for (int k = 0; k < count; k++) {
			const gi_light_def def =
			    k % 2 ? sun_of(.1f * (float)k, -1, 0, 10) : point_at(.2f * (float)k, 1, 0, 5);
			lights[k] = add_light(r.gi, &def);
		}
		assert_false(gi_light_is_valid(r.gi, stale));
		assert_gi(gi_update(r.gi, NULL));
		for (int k = 0; k < count; k++)
			assert_gi(gi_destroy_light(r.gi, lights[(k + round) % count]));
		stale = lights[0];
		if (round % 10 == 9)
			assert_gi(gi_commit(r.gi));
		assert_gi(gi_update(r.gi, NULL));
	}
	assert_gi(gi_finish(r.gi));
	assert_int_equal(objects_of_opengl(), objects);
	gi_context_destroy(r.gi);
	assert_int_equal(objects_of_opengl(), before);
}

static void test_what_is_refused(void **state)
{
	(void)state;
	gi_context *gi = open_scene(GI_SKY_AUTO), *other = open_scene(GI_SKY_AUTO);
	gi_light light = {1, 1, 1};
	gi_light_def def = {0};
	assert_int_equal(gi_create_light(gi, &def, &light), GI_ERROR_INVALID_DEF);
	assert_int_equal(light.index1, 0);
	const struct {
		size_t at;
		gi_light_type type;
		float value;
	} wrong[] = {{offsetof(gi_light_def, intensity), GI_LIGHT_POINT, -1},
		     {offsetof(gi_light_def, intensity), GI_LIGHT_POINT, 2e12f},
		     {offsetof(gi_light_def, intensity), GI_LIGHT_POINT, NAN},
		     {offsetof(gi_light_def, position), GI_LIGHT_POINT, INFINITY},
		     {offsetof(gi_light_def, direction), GI_LIGHT_SPOT, NAN},
		     {offsetof(gi_light_def, outer_angle), GI_LIGHT_SPOT, 0},
		     {offsetof(gi_light_def, outer_angle), GI_LIGHT_SPOT, 1.58f},
		     {offsetof(gi_light_def, inner_angle), GI_LIGHT_SPOT, .8f},
		     {offsetof(gi_light_def, range), GI_LIGHT_POINT, -1},
		     {offsetof(gi_light_def, radius), GI_LIGHT_POINT, -1},
		     {offsetof(gi_light_def, angular_radius), GI_LIGHT_DIRECTIONAL, .6f}};
	for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
		def = gi_light_def_default();
		def.type = wrong[k].type;
		memcpy((char *)&def + wrong[k].at, &wrong[k].value, sizeof wrong[k].value);
		assert_int_equal(gi_create_light(gi, &def, &light), GI_ERROR_INVALID_ARGUMENT);
	}
	def = gi_light_def_default();
	gi_light_def none = def;
	none.type = GI_LIGHT_DIRECTIONAL;
	none.direction[2] = 0;
	assert_int_equal(gi_create_light(gi, &none, &light), GI_ERROR_INVALID_ARGUMENT);
	for (int k = 0; k < GI_MOST_LIGHTS; k++)
		assert_gi(gi_create_light(gi, &def, &light));
	gi_light more;
	assert_int_equal(gi_create_light(gi, &def, &more), GI_ERROR_INVALID_ARGUMENT);
	assert_int_equal(gi_set_light(other, light, &def), GI_ERROR_INVALID_HANDLE);
	assert_int_equal(gi_get_light(gi, (gi_light){0}, &def), GI_ERROR_INVALID_HANDLE);
	assert_gi(gi_destroy_light(gi, light));
	assert_int_equal(gi_destroy_light(gi, light), GI_ERROR_INVALID_HANDLE);
	assert_gi(gi_create_light(gi, &def, &more));
	assert_int_equal(more.index1, light.index1);
	assert_false(gi_light_is_valid(gi, light));
	gi_context_destroy(gi);
	gi_context_destroy(other);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_sun_on_open_plate),     cmocka_unit_test(test_sun_in_a_well),
	    cmocka_unit_test(test_point_over_plate),      cmocka_unit_test(test_spot),
	    cmocka_unit_test(test_light_is_kept),         cmocka_unit_test(test_sun_through_a_window),
	    cmocka_unit_test(test_what_changes_cost),     cmocka_unit_test(test_what_moves_cost),
	    cmocka_unit_test(test_moves_equal_a_rebuild), cmocka_unit_test(test_bounds_are_certified),
	    cmocka_unit_test(test_lights_are_no_rows),    cmocka_unit_test(test_hundred_rounds),
	    cmocka_unit_test(test_what_is_refused),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
