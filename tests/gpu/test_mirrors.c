/* What is reflected to leaves by way of mirrors and glass: a room with an ideal mirror for a wall is half of a room
 * twice as long; then updates against scenes made at once. */
#include "harness.h"
#include "scenes/body.h"
#include "scenes/cornell.h"
#include "scenes/shapes.h"
#include "snapshot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const float GREY[3] = {0.6f, 0.5f, 0.4f}, RED[3] = {0.7f, 0.2f, 0.1f}, BLACK[3] = {0, 0, 0},
		   LAMP[3] = {40, 40, 40};

/* Leaves a metre. */
enum { FINE = 4 };

static gi_object add(gi_context *gi, const char *name, engine_mesh *mesh, const float *rho, const float *exitance)
{
	const scene_body body = {.name = name, .rho = rho, .exitance = exitance};
	gi_object out;
	assert_gi(scene_add_body(gi, &body, mesh, &out));
	return out;
}

static gi_object add_quad(gi_context *gi, const char *name, const float corner[3], const float u[3], const float v[3],
			  uint32_t n, uint32_t m, const float *rho, const float *exitance)
{
	engine_mesh mesh;
	assert_true(shape_quad(corner, u, v, n, m, &mesh));
	return add(gi, name, &mesh, rho, exitance);
}

/* Of a width in x, 2 m high and deep; the left wall, x = 0, is red. Open at the right, where x = width. */
static void add_walls(gi_context *gi, float width)
{
	const uint32_t n = FINE * (uint32_t)width, m = FINE * 2;
	const float x[3] = {width, 0, 0}, y[3] = {0, 2, 0}, z[3] = {0, 0, 2};
	add_quad(gi, "floor", (const float[]){0, 0, 0}, z, x, m, n, GREY, NULL);
	add_quad(gi, "ceiling", (const float[]){0, 2, 0}, x, z, n, m, GREY, NULL);
	add_quad(gi, "back", (const float[]){0, 0, 0}, x, y, n, m, GREY, NULL);
	add_quad(gi, "front", (const float[]){0, 0, 2}, y, x, m, n, GREY, NULL);
	add_quad(gi, "left", (const float[]){0, 0, 0}, y, z, m, m, RED, NULL);
}

/* Of 0.8 by 0.8 m below the ceiling. */
static void add_lamp(gi_context *gi, float x)
{
	add_quad(gi, "lamp", (const float[]){x - 0.4f, 1.95f, 0.6f}, (const float[]){0.8f, 0, 0},
		 (const float[]){0, 0, 0.8f}, 2, 2, BLACK, LAMP);
}

static gi_context *open_room(float tolerance, uint32_t photons)
{
	gi_context_def def = harness_def();
	def.row_tolerance = tolerance;
	def.caustic_photons = photons;
	def.sky = GI_SKY_OFF;
	return harness_context(&def);
}

static gi_leaf *read_leaves(gi_context *gi, uint32_t *count)
{
	assert_gi(gi_read_leaves(gi, NULL, 0, count));
	gi_leaf *leaves = calloc(*count + 1, sizeof *leaves);
	assert_non_null(leaves);
	assert_gi(gi_read_leaves(gi, leaves, *count, count));
	return leaves;
}

static gi_leaf *half_with_mirror(const float reflectance[3], float tolerance, uint32_t photons, uint32_t *count)
{
	gi_context *gi = open_room(tolerance, photons);
	add_walls(gi, 2);
	add_lamp(gi, 1);
	engine_mesh mesh;
	assert_true(shape_quad((const float[]){2, 0, 0}, (const float[]){0, 0, 2}, (const float[]){0, 2, 0}, 2 * FINE,
			       2 * FINE, &mesh));
	const gi_material black = {.rho = {0}};
	gi_specular mirror = {0};
	memcpy(mirror.reflectance, reflectance, sizeof mirror.reflectance);
	gi_object_def def = scene_mesh_def(&mesh);
	def.name = "mirror";
	def.materials = &black;
	def.specular = &mirror;
	def.material_count = 1;
	gi_object out;
	assert_gi(gi_create_object(gi, &def, &out));
	engine_mesh_free(&mesh);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	gi_leaf *leaves = read_leaves(gi, count);
	gi_context_destroy(gi);
	return leaves;
}

static snapshot doubled(float tolerance)
{
	gi_context *gi = open_room(tolerance, 0);
	add_walls(gi, 4);
	add_quad(gi, "right", (const float[]){4, 0, 0}, (const float[]){0, 0, 2}, (const float[]){0, 2, 0}, 2 * FINE,
		 2 * FINE, RED, NULL);
	add_lamp(gi, 1);
	add_lamp(gi, 3);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	const snapshot s = snapshot_take(gi);
	gi_context_destroy(gi);
	return s;
}

static void centre_of(const gi_leaf *l, double out[3])
{
	for (int c = 0; c < 3; c++)
		out[c] = 0.25 * ((double)l->corners[0][c] + l->corners[1][c] + l->corners[2][c] + l->corners[3][c]);
}

/* Whose middle is there; count: none. */
static uint32_t find_leaf(const gi_leaf *leaves, uint32_t count, const double p[3])
{
	for (uint32_t k = 0; k < count; k++) {
		double q[3];
		centre_of(&leaves[k], q);
		if (fabs(p[0] - q[0]) + fabs(p[1] - q[1]) + fabs(p[2] - q[2]) < 1e-3)
			return k;
	}
	return count;
}

/* Of each leaf of the doubled room the one in the half: itself, or what it is the image of. */
static uint32_t *fold(const gi_leaf *leaves, uint32_t count)
{
	uint32_t *out = calloc(count + 1, sizeof *out);
	assert_non_null(out);
	for (uint32_t k = 0; k < count; k++) {
		double p[3];
		centre_of(&leaves[k], p);
		p[0] = p[0] > 2 ? 4 - p[0] : p[0];
		out[k] = find_leaf(leaves, count, p);
		assert_true(out[k] < count);
	}
	return out;
}

/* H in the half, whose mirror leaves `reflectance` of the light: the doubled room's rows, in which links to images
 * count so much. */
static double *solve_folded(const snapshot *s, const uint32_t *folded, const float reflectance[3])
{
	double *h = calloc(3 * (size_t)s->leaf_count + 1, sizeof *h),
	       *next = calloc(3 * (size_t)s->leaf_count + 1, sizeof *h);
	assert_true(h && next);
	for (int sweep = 0; sweep < 60; sweep++) {
		memset(next, 0, 3 * (size_t)s->leaf_count * sizeof *next);
		for (uint64_t l = 0; l < s->link_count; l++) {
			const gi_link *link = &s->links[l];
			const uint32_t from = folded[link->first_leaf];
			const bool image = from != link->first_leaf;
			for (uint32_t c = 0; c < 3; c++) {
				const double b = s->leaves[from].exitance[c] + s->leaves[from].rho[c] * h[3 * from + c];
				next[3 * link->leaf + c] +=
				    (double)link->weight * b * (image ? (double)reflectance[c] : 1.0);
			}
		}
		memcpy(h, next, 3 * (size_t)s->leaf_count * sizeof *h);
	}
	free(next);
	return h;
}

/* Error of a channel: of the mean, and RMS by leaf, of those leaves that both rooms have. */
static void compare(const gi_leaf *half, uint32_t count, const snapshot *s, const double *wanted, uint32_t c,
		    double *mean, double *rms)
{
	double squared = 0, square = 0, sum = 0, sum_wanted = 0;
	for (uint32_t k = 0; k < count; k++) {
		double p[3];
		centre_of(&half[k], p);
		const uint32_t other = find_leaf(s->leaves, s->leaf_count, p);
		if (other == s->leaf_count)
			continue;
		const double a = (double)half[k].irradiance[c], b = wanted[3 * other + c], area = half[k].area;
		squared += area * (a - b) * (a - b);
		square += area * b * b;
		sum += area * a;
		sum_wanted += area * b;
	}
	*mean = sum / sum_wanted - 1;
	*rms = sqrt(squared / square);
}

static void test_doubled_room(void **state)
{
	(void)state;
	harness_require_context();
	static const float mirrors[2][3] = {{1, 1, 1}, {0.5f, 0.8f, 0.2f}};
	snapshot all = doubled(0.02f);
	uint32_t *folded = fold(all.leaves, all.leaf_count), count;
	for (int m = 0; m < 2; m++) {
		double *wanted = solve_folded(&all, folded, mirrors[m]);
		gi_leaf *half = half_with_mirror(mirrors[m], 0.05f, 65536, &count);
		for (uint32_t c = 0; c < 3; c++) {
			double mean, rms;
			compare(half, count, &all, wanted, c, &mean, &rms);
			printf("mirror of reflectance %.1f: mean %+.2f %%, RMS by leaf %.2f %%\n",
			       (double)mirrors[m][c], 100 * mean, 100 * rms);
			assert_true(fabs(mean) < 0.01);
			assert_true(rms < 0.04);
		}
		free(half);
		free(wanted);
	}
	free(folded);
	snapshot_free(&all);
}

static gi_object add_ball(gi_context *gi, const char *name, const gi_specular *specular)
{
	engine_mesh mesh;
	assert_true(shape_sphere(0.4f, 4, &mesh));
	const gi_material black = {.rho = {0}};
	gi_object_def def = scene_mesh_def(&mesh);
	def.name = name;
	def.materials = &black;
	def.specular = specular;
	def.material_count = 1;
	def.mobility = GI_MOBILITY_MOVABLE;
	gi_object out;
	assert_gi(gi_create_object(gi, &def, &out));
	engine_mesh_free(&mesh);
	return out;
}

/* ---- against path tracing ---- */

static bool is_one_of(const gi_leaf *leaf, const gi_object *objects, int count)
{
	bool found = false;
	for (int k = 0; k < count; k++)
		found = found || leaf->object.index1 == objects[k].index1;
	return found;
}

/* RMS of H by leaf, of all but the balls' leaves, the noise of the paths taken out. */
static double error_of(gi_context *gi, const gi_object balls[2], uint32_t paths)
{
	uint32_t count;
	gi_leaf *leaves = read_leaves(gi, &count);
	float *truth[2];
	for (uint32_t k = 0; k < 2; k++) {
		truth[k] = calloc(3 * (size_t)count + 1, sizeof *truth[k]);
		assert_non_null(truth[k]);
		assert_gi(
		    gi_trace_paths(gi, &(gi_path_options){.paths = paths, .seed = k + 1}, truth[k], count, &count));
	}
	double squared = 0, square = 0;
	for (uint32_t k = 0; k < 3 * count; k++) {
		const gi_leaf *leaf = &leaves[k / 3];
		const double h = leaf->irradiance[k % 3], one = truth[0][k], two = truth[1][k];
		const double area = is_one_of(leaf, balls, 2) ? 0 : leaf->area;
		squared += area * (h - one) * (h - two);
		square += area * one * two;
	}
	free(truth[0]);
	free(truth[1]);
	free(leaves);
	return sqrt(fmax(squared, 0) / square);
}

/* In the Cornell box with two balls, white ones, or a mirror and one of glass. */
static double box_error(const gi_specular *balls, uint32_t paths)
{
	gi_context_def context_def = harness_def();
	context_def.row_tolerance = 0.024f;
	context_def.caustic_photons = 65536;
	gi_context *gi = harness_context(&context_def);
	cornell_def def = cornell_def_default();
	def.buddha = false;
	def.wall_levels = 2;
	def.ball_faces = 6;
	def.ball_specular = balls;
	cornell box;
	assert_gi(cornell_create(gi, &def, &box));
	assert_gi(gi_commit(gi));
	harness_update(gi);
	const double error = error_of(gi, box.balls, paths);
	gi_context_destroy(gi);
	return error;
}

static void test_cornell_box(void **state)
{
	(void)state;
	harness_require_context();
	static const gi_specular balls[2] = {{.reflectance = {0.92f, 0.92f, 0.92f}},
					     {.transmittance = {1, 0.9f, 0.8f}, .index = 1.5f}};
	/* What lamps send through glass paths find by chance. */
	const uint32_t paths = harness_is_long() ? 8192 : 1024;
	const double white = box_error(NULL, 256), smooth = box_error(balls, paths);
	printf("error of H by leaf: %.2f %% with white balls, %.2f %% with a mirror and a glass one\n", 100 * white,
	       100 * smooth);
	assert_true(smooth < 0.03);
}

/* ---- energy ---- */

/* A room of rho and E alike everywhere: H = E / (1 - rho) on every leaf, whatever mirrors and clear glass are in it. */
static void check_furnace(const gi_specular *specular)
{
	static const float half[3] = {0.5f, 0.5f, 0.5f}, one[3] = {1, 1, 1};
	gi_context *gi = open_room(0.05f, 65536);
	engine_mesh mesh;
	assert_true(shape_box((const float[]){0, 0, 0}, (const float[]){2, 2, 2}, 6, true, &mesh));
	const gi_object room = add(gi, "room", &mesh, half, one), ball = add_ball(gi, "ball", specular);
	assert_gi(gi_set_pose(gi, ball, (gi_pose){.position = {1.2f, 1, 0.9f}, .rotation = {0, 0, 0, 1}}));
	assert_gi(gi_commit(gi));
	harness_update(gi);
	uint32_t count;
	gi_leaf *leaves = read_leaves(gi, &count);
	float *paths = calloc(3 * (size_t)count + 1, sizeof *paths);
	assert_non_null(paths);
	assert_gi(gi_trace_paths(gi, NULL, paths, count, &count));
	double rows = 0, traced = 0, squared = 0, area = 0;
	for (uint32_t k = 0; k < count; k++) {
		const double off = leaves[k].irradiance[0] / 2 - 1,
			     a = leaves[k].object.index1 == room.index1 ? leaves[k].area : 0;
		rows += a * off;
		squared += a * off * off;
		traced += a * (paths[3 * k] / 2 - 1);
		area += a;
	}
	printf("%s in a furnace: rows %+.3f %%, RMS %.2f %%, paths %+.3f %%\n",
	       specular->index > 0 ? "glass" : "a mirror", 100 * rows / area, 100 * sqrt(squared / area),
	       100 * traced / area);
	assert_true(fabs(rows / area) < 0.002);
	assert_true(fabs(traced / area) < 0.002);
	assert_true(sqrt(squared / area) < 0.02);
	free(paths);
	free(leaves);
	gi_context_destroy(gi);
}

static void test_furnace(void **state)
{
	(void)state;
	harness_require_context();
	check_furnace(&(gi_specular){.reflectance = {1, 1, 1}});
	check_furnace(&(gi_specular){.transmittance = {1, 1, 1}, .index = 1.5f});
}

/* A room and a ball that shine and are grey, the ball a mirror besides: what it gives and what it reflects together are
 * more than any surface gives. */
static void test_shining_mirror(void **state)
{
	(void)state;
	harness_require_context();
	static const float half[3] = {0.5f, 0.5f, 0.5f};
	gi_context *gi = open_room(0.05f, 65536);
	engine_mesh mesh;
	assert_true(shape_box((const float[]){0, 0, 0}, (const float[]){2, 2, 2}, 6, true, &mesh));
	const gi_object room = add(gi, "room", &mesh, half, half),
			ball = add_ball(gi, "ball", &(gi_specular){.reflectance = {0.5f, 0.5f, 0.5f}});
	assert_gi(
	    gi_set_material(gi, ball, 0, (gi_material){.rho = {0.5f, 0.5f, 0.5f}, .exitance = {0.5f, 0.5f, 0.5f}}));
	assert_gi(gi_set_pose(gi, ball, (gi_pose){.position = {1.2f, 1, 0.45f}, .rotation = {0, 0, 0, 1}}));
	assert_gi(gi_commit(gi));
	const gi_report report = harness_update(gi);
	uint32_t count;
	gi_leaf *leaves = read_leaves(gi, &count);
	float *paths = calloc(3 * (size_t)count + 1, sizeof *paths);
	assert_non_null(paths);
	assert_gi(gi_trace_paths(gi, &(gi_path_options){.paths = 1024}, paths, count, &count));
	double squared = 0, square = 0, largest = 0, true_largest = 0, stray = 0;
	for (uint32_t k = 0; k < count; k++) {
		const gi_leaf *l = &leaves[k];
		if (l->object.index1 != room.index1)
			continue;
		const double b = l->radiosity[0], wanted = 0.5 + 0.5 * paths[3 * k];
		squared += l->area * (b - wanted) * (b - wanted);
		square += l->area * wanted * wanted;
		largest = fmax(largest, b);
		true_largest = fmax(true_largest, wanted);
		stray = fmax(stray, fabs(0.5 + 0.5 * (double)l->irradiance[0] - b));
	}
	printf("a mirror that shines: RMS of B %.2f %%, largest %.3f for %.3f, B - T B %.2g with the bound %.2g, "
	       "outcome %d\n",
	       100 * sqrt(squared / square), largest, true_largest, stray, (double)report.solve_bound,
	       (int)report.outcome);
	assert_true(sqrt(squared / square) < 0.03);
	assert_true(stray <= 2 * (double)report.solve_bound + 1e-5);
	free(paths);
	free(leaves);
	gi_context_destroy(gi);
}

/* ---- what moves ---- */

enum { MOVERS = 3, FRAMES = 10 };

typedef struct moving {
	gi_context *gi;
	gi_object movers[MOVERS]; /* a mirror ball, a glass ball, a block */
} moving;

static const gi_specular MIRROR = {.reflectance = {0.9f, 0.8f, 0.5f}},
			 GLASS = {.transmittance = {0.8f, 0.9f, 1}, .index = 1.5f};

/* Open at the right, where a sky looks in. */
static moving open_moving(const gi_pose *poses, gi_sky sky)
{
	gi_context_def def = harness_def();
	def.row_tolerance = 0.1f;
	def.caustic_photons = 1024;
	def.sky = sky;
	memcpy(def.sky_exitance, (const float[]){2, 3, 5}, sizeof def.sky_exitance);
	moving m = {.gi = harness_context(&def)};
	add_walls(m.gi, 2);
	add_lamp(m.gi, 1);
	m.movers[0] = add_ball(m.gi, "mirror ball", &MIRROR);
	m.movers[1] = add_ball(m.gi, "glass ball", &GLASS);
	engine_mesh mesh;
	assert_true(
	    shape_box((const float[]){-0.2f, -0.2f, -0.2f}, (const float[]){0.2f, 0.2f, 0.2f}, 2, false, &mesh));
	m.movers[2] = add(m.gi, "block", &mesh, RED, NULL);
	for (int k = 0; k < MOVERS; k++)
		assert_gi(gi_set_pose(m.gi, m.movers[k], poses[k]));
	assert_gi(gi_commit(m.gi));
	return m;
}

static float random_float(uint32_t *state)
{
	*state = *state * 1664525u + 1013904223u;
	return (float)(*state >> 8) * 0x1p-24f;
}

static gi_pose random_pose(uint32_t *state)
{
	gi_pose pose = gi_pose_identity();
	for (int c = 0; c < 3; c++)
		pose.position[c] = 1 + 1.1f * (random_float(state) - 0.5f);
	for (int c = 0; c < 4; c++)
		pose.rotation[c] = random_float(state) - 0.5f;
	return pose;
}

static moving open_at_random(uint32_t *random, gi_sky sky)
{
	gi_pose poses[MOVERS];
	for (int k = 0; k < MOVERS; k++)
		poses[k] = random_pose(random);
	return open_moving(poses, sky);
}

static uint64_t count_specular(const snapshot *s)
{
	uint64_t count = 0;
	for (uint64_t k = 0; k < s->link_count; k++)
		count += s->links[k].specular;
	return count;
}

static void expect_rebuilt(gi_context *gi, const char *when)
{
	snapshot updated = snapshot_take(gi);
	assert_true(count_specular(&updated) > 100);
	gi_invalidate(gi);
	harness_update(gi);
	snapshot rebuilt = snapshot_take(gi);
	snapshot_expect_same_rows(&updated, &rebuilt, when);
	snapshot_free(&updated);
	snapshot_free(&rebuilt);
}

/* Balls and block move at random, one or more of them a frame, under budgets and without. */
static void move_and_compare(gi_sky sky, uint32_t frames)
{
	uint32_t random = 11;
	gi_pose poses[MOVERS];
	for (int k = 0; k < MOVERS; k++)
		poses[k] = random_pose(&random);
	moving m = open_moving(poses, sky);
	harness_update(m.gi);
	for (uint32_t frame = 0; frame < frames; frame++) {
		for (int k = 0; k < MOVERS; k++) {
			if (random_float(&random) < 0.5f)
				poses[k] = random_pose(&random);
			assert_gi(gi_set_pose(m.gi, m.movers[k], poses[k]));
		}
		assert_gi(gi_update(m.gi, frame % 3 == 1 ? &(gi_budget){.rays = 500} : NULL));
		if (frame % 2 == 0)
			continue;
		harness_update(m.gi);
		expect_rebuilt(m.gi, "after a move");
	}
	gi_context_destroy(m.gi);
}

static void test_moves(void **state)
{
	(void)state;
	harness_require_context();
	move_and_compare(GI_SKY_OFF, harness_is_long() ? 100 : FRAMES);
}

static void test_moves_under_sky(void **state)
{
	(void)state;
	harness_require_context();
	move_and_compare(GI_SKY_ON, harness_is_long() ? 100 : FRAMES);
}

/* Each of these changes what is seen in mirrors: another material, an object that goes, comes, is hidden or shown. */
static void test_other_changes(void **state)
{
	(void)state;
	harness_require_context();
	uint32_t random = 3;
	moving m = open_at_random(&random, GI_SKY_OFF);
	harness_update(m.gi);
	assert_gi(gi_set_specular(m.gi, m.movers[0], 0, (gi_specular){.reflectance = {0.3f, 0.9f, 0.9f}}));
	harness_update(m.gi);
	expect_rebuilt(m.gi, "another mirror");
	assert_gi(gi_set_hidden(m.gi, m.movers[2], true));
	harness_update(m.gi);
	expect_rebuilt(m.gi, "a block that is hidden");
	gi_object second = add_ball(m.gi, "second mirror", &MIRROR);
	assert_gi(gi_set_pose(m.gi, second, (gi_pose){.position = {1.5f, 0.5f, 1.5f}, .rotation = {0, 0, 0, 1}}));
	assert_gi(gi_commit(m.gi));
	assert_gi(gi_update(m.gi, &(gi_budget){.rays = 300}));
	harness_update(m.gi);
	expect_rebuilt(m.gi, "a mirror that came");
	gi_destroy_object(m.gi, m.movers[2]);
	assert_gi(gi_commit(m.gi));
	harness_update(m.gi);
	expect_rebuilt(m.gi, "a block that went");
	gi_context_destroy(m.gi);
}

/* What waiting rows leave B off by is certified, though anything may have come into sight of a mirror. */
static void check_bounds(const gi_material *ball)
{
	uint32_t random = 23, waited = 0;
	moving m = open_at_random(&random, GI_SKY_OFF);
	assert_gi(gi_set_material(m.gi, m.movers[0], 0, *ball));
	harness_update(m.gi);
	for (uint32_t frame = 0; frame < (harness_is_long() ? 60u : 6u); frame++) {
		gi_report before, after;
		assert_gi(gi_set_pose(m.gi, m.movers[frame % MOVERS], random_pose(&random)));
		assert_gi(gi_update(m.gi, &(gi_budget){.rays = 2000}));
		assert_gi(gi_finish(m.gi));
		assert_gi(gi_get_report(m.gi, &before));
		snapshot part = snapshot_take(m.gi);
		after = harness_update(m.gi);
		snapshot whole = snapshot_take(m.gi);
		const double bound =
		    (double)before.solve_bound + (double)before.stale_bound + (double)after.solve_bound;
		assert_true(snapshot_distance(&part, &whole) <= bound);
		waited += before.waiting_rows > 0;
		snapshot_free(&part);
		snapshot_free(&whole);
	}
	assert_true(waited > 0);
	gi_context_destroy(m.gi);
}

static void test_bounds(void **state)
{
	(void)state;
	harness_require_context();
	check_bounds(&(gi_material){.rho = {0}});
	check_bounds(&(gi_material){.rho = {0.05f, 0.1f, 0.4f}, .exitance = {2, 1, 1}});
}

/* Behind the last mirror rows are those of a scene that never had one. */
static void test_last_mirror(void **state)
{
	(void)state;
	harness_require_context();
	uint32_t random = 3;
	moving m = open_at_random(&random, GI_SKY_OFF);
	harness_update(m.gi);
	assert_gi(gi_set_hidden(m.gi, m.movers[0], true));
	gi_destroy_object(m.gi, m.movers[1]);
	assert_gi(gi_update(m.gi, &(gi_budget){.rays = 300}));
	assert_gi(gi_commit(m.gi));
	for (int k = 0; k < 3; k++)
		assert_gi(gi_update(m.gi, &(gi_budget){.rays = 300}));
	harness_update(m.gi);
	snapshot updated = snapshot_take(m.gi);
	assert_int_equal(count_specular(&updated), 0);
	gi_invalidate(m.gi);
	harness_update(m.gi);
	snapshot rebuilt = snapshot_take(m.gi);
	snapshot_expect_same_rows(&updated, &rebuilt, "without mirrors");
	snapshot_free(&updated);
	snapshot_free(&rebuilt);
	gi_context_destroy(m.gi);
}

/* ---- all of it together ---- */

static gi_object add_wax(gi_context *gi, float x)
{
	static const gi_subsurface wax = {{14, 6, 30}, {.2f, .3f, 2}, 1.4f};
	engine_mesh mesh;
	assert_true(shape_sphere(0.3f, 4, &mesh));
	gi_object_def def = scene_mesh_def(&mesh);
	def.name = "wax";
	def.subsurface = &wax;
	def.pose.position[0] = x;
	def.pose.position[1] = 0.4f;
	def.pose.position[2] = 1.6f;
	gi_object out;
	assert_gi(gi_create_object(gi, &def, &out));
	engine_mesh_free(&mesh);
	return out;
}

/* Makes one of the changes that a host may make, at random. */
static void change_something(moving *m, gi_object *wax, uint32_t *random)
{
	const uint32_t what = (uint32_t)(random_float(random) * 10);
	const float grey = 0.3f * random_float(random);
	switch (what) {
	case 0:
		assert_gi(gi_set_specular(m->gi, m->movers[2], 0, (gi_specular){.reflectance = {0.2f, 0.3f, 0.1f}}));
		break;
	case 1:
		assert_gi(gi_set_specular(m->gi, m->movers[2], 0, (gi_specular){0}));
		break;
	case 2:
		assert_gi(gi_set_hidden(m->gi, m->movers[0], random_float(random) < 0.5f));
		assert_gi(gi_set_hidden(m->gi, m->movers[1], random_float(random) < 0.5f));
		break;
	case 3:
		gi_destroy_object(m->gi, *wax);
		assert_gi(gi_commit(m->gi));
		*wax = add_wax(m->gi, 0.5f);
		break;
	case 4:
		assert_gi(gi_commit(m->gi));
		break;
	case 5:
		gi_destroy_object(m->gi, m->movers[0]);
		m->movers[0] = add_ball(m->gi, "another mirror", &MIRROR);
		assert_gi(gi_set_pose(m->gi, m->movers[0], random_pose(random)));
		assert_gi(gi_set_mobility(m->gi, m->movers[0], GI_MOBILITY_STATIC));
		assert_gi(gi_commit(m->gi));
		break;
	case 6:
		assert_gi(gi_set_material(m->gi, m->movers[1], 0,
					  (gi_material){.rho = {grey / 3, grey / 3, 0}, .exitance = {grey, 0, 0}}));
		break;
	case 7:
		assert_gi(gi_set_sky(m->gi, GI_SKY_ON, (float[]){grey < 0.15f ? 0 : grey, 0, 0}));
		break;
	case 8:
		assert_gi(gi_set_pixel_lamps(m->gi, grey < 0.15f ? 0 : 4));
		assert_gi(gi_set_hidden(m->gi, *wax, grey < 0.15f));
		break;
	default:
		gi_invalidate(m->gi);
	}
}

static void test_random_changes(void **state)
{
	(void)state;
	harness_require_context();
	uint32_t random = 5;
	moving m = open_at_random(&random, GI_SKY_ON);
	gi_object wax = add_wax(m.gi, 1.5f);
	assert_gi(gi_commit(m.gi));
	harness_update(m.gi);
	for (uint32_t step = 0; step < (harness_is_long() ? 60u : 12u); step++) {
		change_something(&m, &wax, &random);
		if (random_float(&random) < 0.5f)
			assert_gi(gi_set_pose(m.gi, m.movers[step % MOVERS], random_pose(&random)));
		gi_view view = gi_view_default();
		const gi_budget budget = {.rays = 300 + step * 100,
					  .view = random_float(&random) < 0.5f ? &view : NULL};
		const bool part = random_float(&random) < 0.7f;
		gi_report before, after, again;
		assert_gi(gi_update(m.gi, part ? &budget : NULL));
		assert_gi(gi_finish(m.gi));
		assert_gi(gi_get_report(m.gi, &before));
		snapshot first = snapshot_take(m.gi);
		after = harness_update(m.gi);
		snapshot updated = snapshot_take(m.gi);
		const double bound =
		    (double)before.solve_bound + (double)before.stale_bound + (double)after.solve_bound;
		assert_true(snapshot_distance(&first, &updated) <= bound);
		gi_invalidate(m.gi);
		gi_reset_radiosity(m.gi);
		again = harness_update(m.gi);
		snapshot rebuilt = snapshot_take(m.gi);
		snapshot_expect_same_rows(&updated, &rebuilt, "at random");
		assert_true(snapshot_distance(&rebuilt, &updated) <=
			    (double)after.solve_bound + (double)again.solve_bound);
		snapshot_free(&first);
		snapshot_free(&updated);
		snapshot_free(&rebuilt);
	}
	if (harness_is_long()) {
		assert_gi(gi_reload_shaders(m.gi));
		harness_update(m.gi);
		expect_rebuilt(m.gi, "after shaders were read again");
	}
	gi_context_destroy(m.gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_doubled_room),  cmocka_unit_test(test_cornell_box),
	    cmocka_unit_test(test_furnace),       cmocka_unit_test(test_shining_mirror),
	    cmocka_unit_test(test_moves),         cmocka_unit_test(test_moves_under_sky),
	    cmocka_unit_test(test_other_changes), cmocka_unit_test(test_bounds),
	    cmocka_unit_test(test_last_mirror),   cmocka_unit_test(test_random_changes),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
