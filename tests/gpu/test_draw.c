/* The picture: direct light against closed forms, shadows, modes that add up, nothing drawn twice. */
#include "target.h"

#include "scenes/body.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979;

enum { SIZE = 64 };

/* Looks straight down, parallel, at [-half, half] x [-half, half] of the plane y = 0: pixel (i, j) sees x to the right
 * and -z up. */
static gi_view look_down(float half, float height)
{
	gi_view view = gi_view_default();
	const float world[16] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1};
	const float depth = 2 * height;
	const float clip[16] = {1 / half, 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, -1 / depth, 0, 0, 0, 0, 1};
	memcpy(view.view_from_world, world, sizeof world);
	memcpy(view.clip_from_view, clip, sizeof clip);
	view.width = view.height = SIZE;
	return view;
}

static void draw(gi_context *gi, target *t, const gi_view *view)
{
	target_draw(t, gi, *view);
}

static const float *pixel(const target *t, int x, int y)
{
	return t->pixels + 4 * (y * SIZE + x);
}

/* A floor of 4 x 4 facing up, and above it a lamp of 1 x 0.6 facing down whose middle is (0.2, 2, 0.1). */
static const float LAMP_LOWER[2] = {-0.3f, -0.2f}, LAMP_UPPER[2] = {0.7f, 0.4f}, LAMP_HEIGHT = 2;

static void add_floor(gi_context *gi, float rho, uint32_t faces)
{
	engine_mesh mesh;
	const float corner[3] = {-2, 0, -2}, u[3] = {0, 0, 4}, v[3] = {4, 0, 0};
	assert_true(shape_quad(corner, u, v, faces, faces, &mesh));
	harness_add(gi, &(harness_object){.name = "floor", .rho = {rho, rho, rho}}, &mesh);
}

static void add_lamp(gi_context *gi, float exitance, uint32_t faces)
{
	engine_mesh mesh;
	const float corner[3] = {LAMP_LOWER[0], LAMP_HEIGHT, LAMP_LOWER[1]},
		    u[3] = {LAMP_UPPER[0] - LAMP_LOWER[0], 0, 0};
	const float v[3] = {0, 0, LAMP_UPPER[1] - LAMP_LOWER[1]};
	assert_true(shape_quad(corner, u, v, faces, faces, &mesh));
	harness_add(gi, &(harness_object){.name = "lamp", .exitance = {exitance, exitance / 2, 0}}, &mesh);
}

static gi_object add_box(gi_context *gi, float x, float y, float z, float half)
{
	engine_mesh mesh;
	assert_true(
	    shape_box((const float[]){-half, -half, -half}, (const float[]){half, half, half}, 2, false, &mesh));
	return harness_add(gi, &(harness_object){.name = "box", .rho = {0.5f, 0.5f, 0.5f}, .position = {x, y, z}},
			   &mesh);
}

static void commit(gi_context *gi)
{
	assert_gi(gi_commit(gi));
	harness_update(gi);
}

/* From an element to a parallel rectangle with one corner straight above it (Howell, configuration B-4). */
static double corner_factor(double a, double b, double c)
{
	const double x = a / c, y = b / c, p = sqrt(1 + x * x), q = sqrt(1 + y * y);
	return (x / p * atan(y / p) + y / q * atan(x / q)) / (2 * PI);
}

/* From (x, 0, z) to a rectangle at that height. */
static double rectangle_factor(double x, double z, const float lower[2], const float upper[2], double height)
{
	const double x0 = lower[0] - x, x1 = upper[0] - x, z0 = lower[1] - z, z1 = upper[1] - z;
	return corner_factor(x1, z1, height) - corner_factor(x0, z1, height) - corner_factor(x1, z0, height) +
	       corner_factor(x0, z0, height);
}

static double pixel_x(int x)
{
	return 4.0 * (x + 0.5) / SIZE - 2;
}

static double pixel_z(int y)
{
	return 2 - 4.0 * (y + 0.5) / SIZE;
}

/* A floor and a lamp above it; the caller commits. */
static gi_context *lit_floor(float rho, float exitance, uint32_t faces)
{
	gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	add_floor(gi, rho, 4);
	add_lamp(gi, exitance, faces);
	return gi;
}

/* The view hangs above the lamp, whose back is culled. */
static void check_open_floor(uint32_t faces)
{
	const float exitance = 10, rho = 0.8f;
	gi_context *gi = lit_floor(rho, exitance, faces);
	commit(gi);
	target t = target_make(SIZE);
	gi_view view = look_down(2, 5);
	view.mode = GI_MODE_DIRECT;
	draw(gi, &t, &view);
	for (int y = 0; y < SIZE; y += 7)
		for (int x = 0; x < SIZE; x += 7) {
			const double expected =
			    rho * exitance *
			    rectangle_factor(pixel_x(x), pixel_z(y), LAMP_LOWER, LAMP_UPPER, LAMP_HEIGHT) / PI;
			const float *got = pixel(&t, x, y);
			/* The contour's angles are a fit of relative error 2e-4. */
			if (fabs(got[0] - expected) > 0.005 * expected ||
			    fabs(got[1] - expected / 2) > 0.005 * expected)
				fail_msg("pixel %d %d: %g %g, expected %g", x, y, (double)got[0], (double)got[1],
					 expected);
			assert_float_equal(got[2], 0, 0);
			assert_float_equal(got[3], 1, 0);
		}
	target_free(&t);
	gi_context_destroy(gi);
}

static void test_open_floor(void **state)
{
	(void)state;
	harness_require_context();
	check_open_floor(1);
}

/* Its faces are joined: the same picture. */
static void test_lamp_of_many_faces(void **state)
{
	(void)state;
	harness_require_context();
	check_open_floor(8);
}

static void test_shadow_is_black(void **state)
{
	(void)state;
	harness_require_context();
	gi_context *gi = lit_floor(0.8f, 10, 2);
	gi_object box = add_box(gi, 0.2f, 1.0f, 0.1f, 0.8f);
	commit(gi);
	target t = target_make(SIZE);
	gi_view view = look_down(2, 5);
	view.mode = GI_MODE_DIRECT;
	draw(gi, &t, &view);
	/* Seen from above the box's lit top hides its shadow; far from it the floor is lit as if it were not there. */
	const float *top = pixel(&t, SIZE / 2, SIZE / 2);
	assert_true(top[0] > 0.1f);
	/* Away with the box from the camera's way, but not from the lamp's: look from below the box. */
	view.clip_from_view[10] = -1 / 0.15f;
	draw(gi, &t, &view);
	const float *below = pixel(&t, (int)((0.2 + 2) / 4 * SIZE), (int)((2 - 0.1) / 4 * SIZE));
	assert_float_equal(below[0], 0, 0);
	assert_float_equal(below[3], 1, 0);
	/* The box goes away, and the light is back. */
	gi_pose pose = gi_pose_identity();
	pose.position[0] = 30;
	assert_gi(gi_set_pose(gi, box, pose));
	harness_update(gi);
	draw(gi, &t, &view);
	assert_true(pixel(&t, (int)((0.2 + 2) / 4 * SIZE), (int)((2 - 0.1) / 4 * SIZE))[0] > 0.1f);
	target_free(&t);
	gi_context_destroy(gi);
}

/* A plate of 1 x 1 half way between floor and lamp: what it covers of the lamp is a rectangle, so every pixel of its
 * soft shadow is known. 1 is the brightest pixel without the plate. */
static void check_soft_shadow(float exitance, const target *t, double *rms, double *most)
{
	const float bottom = 1;
	const double brightest =
	    0.8 * (double)exitance * rectangle_factor(0.2, 0.1, LAMP_LOWER, LAMP_UPPER, LAMP_HEIGHT) / PI;
	double squares = 0;
	*most = 0;
	for (int y = 0; y < SIZE; y++)
		for (int x = 0; x < SIZE; x++) {
			const double at[2] = {pixel_x(x), pixel_z(y)};
			float lower[2], upper[2];
			for (int axis = 0; axis < 2; axis++) {
				const double scale = LAMP_HEIGHT / bottom, from = at[axis] + (-0.5 - at[axis]) * scale,
					     to = at[axis] + (0.5 - at[axis]) * scale;
				lower[axis] = (float)fmin(fmax(from, LAMP_LOWER[axis]), LAMP_UPPER[axis]);
				upper[axis] = (float)fmin(fmax(to, LAMP_LOWER[axis]), LAMP_UPPER[axis]);
			}
			const double seen = rectangle_factor(at[0], at[1], LAMP_LOWER, LAMP_UPPER, LAMP_HEIGHT) -
					    rectangle_factor(at[0], at[1], lower, upper, LAMP_HEIGHT);
			const double error =
			    (double)pixel(t, x, y)[0] / brightest - 0.8 * (double)exitance * seen / PI / brightest;
			squares += error * error;
			*most = fmax(*most, fabs(error));
		}
	*rms = sqrt(squares / (SIZE * SIZE));
}

/* A plate below the lamp, depth maps of so many texels a side. */
static void draw_soft_shadow(uint32_t map_size, double *rms, double *most)
{
	gi_context_def def = harness_def();
	def.shadow_map_size = map_size;
	gi_context *gi = harness_context(&def);
	add_floor(gi, 0.8f, 4);
	add_lamp(gi, 10, 2);
	engine_mesh mesh;
	assert_true(shape_box((const float[]){-0.5f, 1, -0.5f}, (const float[]){0.5f, 1.001f, 0.5f}, 2, false, &mesh));
	harness_add(gi, &(harness_object){.name = "plate"}, &mesh);
	commit(gi);
	target t = target_make(SIZE);
	gi_view view = look_down(2, 5);
	view.mode = GI_MODE_DIRECT;
	view.clip_from_view[10] = -1 / 0.5f; /* from under the plate */
	draw(gi, &t, &view);
	check_soft_shadow(10, &t, rms, most);
	printf("soft shadow, maps of %u texels: off by %.4f of the brightest pixel (RMS), %.4f at most\n", map_size,
	       *rms, *most);
	target_free(&t);
	gi_context_destroy(gi);
}

static void test_soft_shadow(void **state)
{
	(void)state;
	harness_require_context();
	double rms[3], most[3];
	draw_soft_shadow(64, &rms[0], &most[0]);
	draw_soft_shadow(gi_context_def_default().shadow_map_size, &rms[1], &most[1]);
	draw_soft_shadow(2048, &rms[2], &most[2]);
	/* A lamp of 16 samples, each seen in two looks: steps of 1/32 (0.03), and rounded corners of the penumbra. */
	assert_true(rms[1] < 0.01 && rms[2] < 0.01);
	assert_true(most[1] < 0.06 && most[2] < 0.06);
	assert_true(rms[0] > 1.5 * rms[1]); /* the size counts */
}

/* The direct picture of a floor with the shadow of a ball whose cage is a coarse sphere. */
static target ball_shadow(uint32_t levels, bool fine_shadows)
{
	gi_context_def def = harness_def();
	def.fine_shadows = fine_shadows;
	def.shadow_map_size = 1024;
	gi_context *gi = harness_context(&def);
	add_floor(gi, 0.8f, 4);
	add_lamp(gi, 10, 2);
	engine_mesh mesh;
	assert_true(shape_sphere(0.6f, 2, &mesh));
	harness_add(
	    gi,
	    &(harness_object){
		.name = "ball", .scheme = GI_SCHEME_CATMULL_CLARK, .levels = levels, .position = {0.2f, 0.8f, 0.1f}},
	    &mesh);
	commit(gi);
	target t = target_make(SIZE);
	gi_view view = look_down(2, 5);
	view.mode = GI_MODE_DIRECT;
	draw(gi, &t, &view);
	gi_context_destroy(gi);
	return t;
}

/* RMS over the floor's pixels, by the brightest; those over the ball are black in all of them. */
static double picture_distance(const target *a, const target *b)
{
	double squares = 0, brightest = 0;
	for (int k = 0; k < SIZE * SIZE; k++) {
		const double d = (double)a->pixels[4 * k] - (double)b->pixels[4 * k];
		squares += d * d;
		brightest = fmax(brightest, (double)b->pixels[4 * k]);
	}
	return sqrt(squares / (SIZE * SIZE)) / brightest;
}

/* Of leaves or of what is drawn, against the shadow of leaves 16 times as fine. */
static void test_fine_shadows(void **state)
{
	(void)state;
	harness_require_context();
	target exact = ball_shadow(3, true), leaves = ball_shadow(0, false), drawn = ball_shadow(0, true);
	const double by_leaves = picture_distance(&leaves, &exact), by_drawn = picture_distance(&drawn, &exact);
	printf("shadow of a coarse ball: cast by its leaves off by %.4f of the brightest pixel (RMS), by what is drawn "
	       "%.4f\n",
	       by_leaves, by_drawn);
	assert_true(by_leaves > 0 && by_drawn < 0.5 * by_leaves);
	target_free(&exact);
	target_free(&leaves);
	target_free(&drawn);
}

static void add_scene(gi_context *gi)
{
	add_floor(gi, 0.8f, 4);
	add_lamp(gi, 10, 2);
	add_box(gi, -0.6f, 0.5f, 0.4f, 0.5f);
}

static void test_modes_add_up(void **state)
{
	(void)state;
	harness_require_context();
	gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	add_scene(gi);
	commit(gi);
	target global = target_make(SIZE), direct = target_make(SIZE), indirect = target_make(SIZE);
	gi_view view = look_down(2, 5);
	draw(gi, &global, &view);
	view.mode = GI_MODE_DIRECT;
	draw(gi, &direct, &view);
	view.mode = GI_MODE_INDIRECT;
	draw(gi, &indirect, &view);
	float brightest = 0;
	for (int k = 0; k < SIZE * SIZE * 4; k++) {
		if (k % 4 == 3)
			continue;
		assert_float_equal(direct.pixels[k] + indirect.pixels[k], global.pixels[k], 1e-4);
		brightest = fmaxf(brightest, indirect.pixels[k]);
	}
	assert_true(brightest > 1e-3f);
	target_free(&global);
	target_free(&direct);
	target_free(&indirect);
	gi_context_destroy(gi);
}

static void test_empty_scene(void **state)
{
	(void)state;
	harness_require_context();
	gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	gi_view view = look_down(2, 5);
	assert_int_equal(gi_draw(gi, &view), GI_ERROR_NOT_COMMITTED);
	commit(gi);
	target t = target_make(SIZE);
	draw(gi, &t, &view);
	for (int k = 0; k < SIZE * SIZE * 4; k++)
		assert_float_equal(t.pixels[k], 0, 0);
	target_free(&t);
	gi_context_destroy(gi);
}

/* The shadow of a ball about (0.2, 1, 0.1): of its own leaves, or of what is drawn about a smaller cage. */
static void draw_ball_shadow(float cage_radius, uint32_t cage_faces, float drawn_radius, target *t)
{
	gi_context_def context_def = harness_def();
	context_def.fine_shadows = drawn_radius > cage_radius;
	gi_context *gi = harness_context(&context_def);
	add_floor(gi, 0.8f, 4);
	add_lamp(gi, 10, 1);
	engine_mesh cage, drawn;
	assert_true(shape_sphere(cage_radius, cage_faces, &cage) && shape_sphere(drawn_radius, 6, &drawn));
	uint32_t *triangles = calloc(drawn.index_count, 2 * sizeof *triangles), count = 0;
	assert_non_null(triangles);
	for (uint32_t k = 0; k < drawn.index_count; k += 4)
		for (uint32_t c = 0; c < 6; c++)
			triangles[count++] = drawn.indices[k + (uint32_t[]){0, 1, 2, 0, 2, 3}[c]];
	gi_object_def def = scene_mesh_def(&cage);
	def.pose.position[0] = 0.2f;
	def.pose.position[1] = 1;
	def.pose.position[2] = 0.1f;
	if (context_def.fine_shadows) {
		def.draw_positions = drawn.positions;
		def.draw_vertex_count = drawn.vertex_count;
		def.draw_indices = triangles;
		def.draw_index_count = count;
	}
	gi_object ball;
	assert_gi(gi_create_object(gi, &def, &ball));
	free(triangles);
	engine_mesh_free(&cage);
	engine_mesh_free(&drawn);
	commit(gi);
	gi_view view = look_down(2, 5);
	view.mode = GI_MODE_DIRECT;
	view.clip_from_view[10] = -1 / 0.4f; /* from under the ball */
	draw(gi, t, &view);
	gi_context_destroy(gi);
}

/* What is drawn may lie outside of the leaves: all of it casts a shadow. */
static void test_fine_shadow(void **state)
{
	(void)state;
	harness_require_context();
	target t = target_make(SIZE);
	float *leaves = calloc(SIZE * SIZE, 4 * sizeof *leaves);
	assert_non_null(leaves);
	draw_ball_shadow(0.5f, 6, 0.5f, &t);
	memcpy(leaves, t.pixels, 4 * sizeof *leaves * SIZE * SIZE);
	for (uint32_t faces = 2; faces <= 6; faces += 4) {
		draw_ball_shadow(0.3f, faces, 0.5f, &t);
		double squares = 0, brightest = 0;
		for (int k = 0; k < SIZE * SIZE; k++) {
			const double off = (double)t.pixels[4 * k] - (double)leaves[4 * k];
			squares += off * off;
			brightest = fmax(brightest, leaves[4 * k]);
		}
		const double rms = sqrt(squares / (SIZE * SIZE));
		printf("shadow of what is drawn: off by %.4f of the brightest pixel (RMS)\n", rms / brightest);
		assert_true(rms < 0.005 * brightest);
	}
	free(leaves);
	target_free(&t);
}

static void test_rest_draws_no_shadows(void **state)
{
	(void)state;
	harness_require_context();
	gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	add_scene(gi);
	commit(gi);
	target first = target_make(SIZE), second = target_make(SIZE);
	gi_view view = look_down(2, 5);
	gi_report report;
	draw(gi, &first, &view);
	assert_gi(gi_finish(gi));
	assert_gi(gi_get_report(gi, &report));
	assert_true(report.pass_ms[GI_PASS_SHADOW] > 0);
	draw(gi, &second, &view);
	assert_gi(gi_finish(gi));
	assert_gi(gi_get_report(gi, &report));
	assert_float_equal(report.pass_ms[GI_PASS_SHADOW], 0, 0);
	assert_true(report.pass_ms[GI_PASS_DRAW] > 0);
	assert_memory_equal(first.pixels, second.pixels, sizeof(float) * SIZE * SIZE * 4);
	target_free(&first);
	target_free(&second);
	gi_context_destroy(gi);
}

/* More lamps than are drawn per pixel: what is left out reaches the floor through the leaves, so that the picture stays
 * as bright. */
static void test_lamps_beyond_the_cap(void **state)
{
	(void)state;
	harness_require_context();
	gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	add_floor(gi, 0.8f, 32);
	enum { SIDE = 7 };
	for (int k = 0; k < SIDE * SIDE; k++) {
		engine_mesh mesh;
		const float corner[3] = {-1.8f + 0.5f * (float)(k % SIDE), 1.5f, -1.8f + 0.5f * (float)(k / SIDE)};
		assert_true(shape_quad(corner, (const float[]){0.3f, 0, 0}, (const float[]){0, 0, 0.3f}, 1, 1, &mesh));
		harness_add(gi, &(harness_object){.name = "lamp", .exitance = {1, 1, 1}}, &mesh);
	}
	commit(gi);
	target t = target_make(SIZE);
	gi_view view = look_down(2, 5);
	draw(gi, &t, &view);
	/* The floor's leaves are an eighth of a metre wide and their rows as coarse as the defaults: a few per cent. */
	for (int y = 8; y < SIZE - 4; y += 8)
		for (int x = 8; x < SIZE - 4; x += 8) {
			double sum = 0;
			for (int k = 0; k < SIDE * SIDE; k++) {
				const float lower[2] = {-1.8f + 0.5f * (float)(k % SIDE),
							-1.8f + 0.5f * (float)(k / SIDE)};
				const float upper[2] = {lower[0] + 0.3f, lower[1] + 0.3f};
				sum += rectangle_factor(pixel_x(x), pixel_z(y), lower, upper, 1.5);
			}
			const double expected = 0.8 * sum / PI, got = pixel(&t, x, y)[0];
			if (fabs(got - expected) > 0.03 * expected)
				fail_msg("pixel %d %d: %g, expected %g", x, y, got, expected);
		}
	target_free(&t);
	gi_context_destroy(gi);
}

static void test_overlays(void **state)
{
	(void)state;
	harness_require_context();
	gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	add_scene(gi);
	commit(gi);
	target plain = target_make(SIZE), over = target_make(SIZE);
	gi_view view = look_down(2, 5);
	draw(gi, &plain, &view);
	view.overlay = GI_OVERLAY_WIREFRAME;
	draw(gi, &over, &view);
	/* Lines darken some pixels and change nothing else. */
	int darker = 0;
	for (int k = 0; k < SIZE * SIZE; k++) {
		assert_true(over.pixels[4 * k] <= plain.pixels[4 * k]);
		darker += over.pixels[4 * k] < plain.pixels[4 * k];
	}
	assert_in_range(darker, SIZE, SIZE * SIZE / 2);
	/* Everything is new after the first update; the heat map is bright all over, and within a display's range. */
	view.overlay = GI_OVERLAY_DIRTY;
	draw(gi, &over, &view);
	for (int k = 0; k < SIZE * SIZE * 4; k++)
		assert_true(over.pixels[k] >= 0 && over.pixels[k] <= 1);
	assert_true(pixel(&over, 2, 2)[0] > 0.3f);
	for (view.overlay = GI_OVERLAY_RESIDUAL; view.overlay <= GI_OVERLAY_BLOCKERS; view.overlay++) {
		draw(gi, &over, &view);
		for (int k = 0; k < SIZE * SIZE * 4; k++)
			assert_true(over.pixels[k] >= 0 && over.pixels[k] <= 1);
	}
	target_free(&plain);
	target_free(&over);
	gi_context_destroy(gi);
}

/* A floor of four leaves a side and a lamp above it, which a plate hides from half of the floor. */
static gi_context *half_lit_floor(void)
{
	gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	add_floor(gi, 0.8f, 4);
	add_lamp(gi, 10, 2);
	engine_mesh mesh;
	assert_true(shape_box((const float[]){-4, 1, -4}, (const float[]){0, 1.01f, 4}, 1, false, &mesh));
	harness_add(gi, &(harness_object){.name = "plate"}, &mesh);
	commit(gi);
	return gi;
}

static const float OVER_FLOOR[3] = {0.9f, 0.5f, 0.9f};

static void test_pick(void **state)
{
	(void)state;
	harness_require_context();
	gi_context *gi = half_lit_floor();
	uint32_t leaf, count;
	gi_leaf leaves[256];
	assert_gi(gi_read_leaves(gi, leaves, 256, &count));
	assert_gi(gi_pick_leaf(gi, OVER_FLOOR, (const float[]){0, -2, 0}, &leaf));
	assert_true(leaf < count && count <= 256);
	for (int axis = 0; axis < 3; axis++) {
		float lower = INFINITY, upper = -INFINITY;
		for (int k = 0; k < 4; k++) {
			lower = fminf(lower, leaves[leaf].corners[k][axis]);
			upper = fmaxf(upper, leaves[leaf].corners[k][axis]);
		}
		const float at = axis == 1 ? 0 : OVER_FLOOR[axis];
		assert_true(lower <= at && at <= upper && upper - lower < 1.01f);
	}
	assert_gi(gi_pick_leaf(gi, (const float[]){0.1f, 0.5f, 0.1f}, (const float[]){0, 1, 0}, &leaf));
	assert_true(leaf < count && leaves[leaf].exitance[0] > 0);
	/* Past all, and the lamp from behind. */
	assert_gi(gi_pick_leaf(gi, OVER_FLOOR, (const float[]){0, 1, 1}, &leaf));
	assert_int_equal(leaf, GI_NO_LEAF);
	assert_gi(gi_pick_leaf(gi, (const float[]){0.1f, 9, 0.1f}, (const float[]){0, -1, 0}, &leaf));
	assert_true(leaf < count && leaves[leaf].exitance[0] == 0);
	assert_int_equal(gi_pick_leaf(gi, OVER_FLOOR, (const float[]){0, 0, 0}, &leaf), GI_ERROR_INVALID_ARGUMENT);
	gi_context_destroy(gi);
}

/* Is the pixel's colour that of a picked leaf: more blue than red? Of heat maps none is that bright and blue. */
static bool is_picked(const float *colour)
{
	return colour[1] > 0.3f && colour[2] > 3 * colour[0];
}

/* Colours of the row of a leaf on the lit side, seen from above: itself, what it sees of the others. */
static void test_row_overlays(void **state)
{
	(void)state;
	harness_require_context();
	gi_context *gi = half_lit_floor();
	target t = target_make(SIZE);
	gi_view view = look_down(2, 5);
	view.clip_from_view[10] = -1 / 0.5f; /* from under the plate */
	assert_gi(gi_pick_leaf(gi, OVER_FLOOR, (const float[]){0, -1, 0}, &view.overlay_leaf));
	for (view.overlay = GI_OVERLAY_SENDERS; view.overlay <= GI_OVERLAY_BLOCKERS; view.overlay++) {
		draw(gi, &t, &view);
		int picked = 0;
		for (int k = 0; k < SIZE * SIZE; k++)
			picked += is_picked(t.pixels + 4 * k);
		assert_in_range(picked, SIZE * SIZE / 32, SIZE * SIZE / 8); /* one of sixteen */
	}
	view.overlay = GI_OVERLAY_SENDERS;
	view.overlay_leaf = GI_NO_LEAF; /* there is none: nothing is picked, nothing is known */
	draw(gi, &t, &view);
	for (int k = 0; k < SIZE * SIZE; k++)
		assert_false(is_picked(t.pixels + 4 * k));
	target_free(&t);
	gi_context_destroy(gi);
}

/* ---- two rooms ---- */

/* ---- mirrors and glass ---- */

/* Every pixel is the lamp's radiance times `share` within [lower, upper] of the plane, dark beyond; edges are no
 * matter. */
static void check_seen(const target *t, double exitance, double share, const float lower[2], const float upper[2])
{
	for (int y = 0; y < SIZE; y++)
		for (int x = 0; x < SIZE; x++) {
			const double px = pixel_x(x), pz = pixel_z(y), edge = 0.08;
			const bool inside = px > lower[0] + edge && px < upper[0] - edge && pz > lower[1] + edge &&
					    pz < upper[1] - edge;
			const bool outside = px < lower[0] - edge || px > upper[0] + edge || pz < lower[1] - edge ||
					     pz > upper[1] + edge;
			const double wanted = inside ? exitance / PI * share : 0;
			if (inside || outside)
				assert_float_equal(pixel(t, x, y)[0], wanted, 1e-5 * exitance);
			if (inside)
				assert_float_equal(pixel(t, x, y)[1], wanted / 2, 1e-5 * exitance);
		}
}

/* A floor that is a mirror, seen from straight above: the lamp over it faces away from the camera. */
static void test_mirror(void **state)
{
	(void)state;
	harness_require_context();
	gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-2, 0, -2}, (float[]){0, 0, 4}, (float[]){4, 0, 0}, 4, 4, &mesh));
	const gi_object floor = harness_add(gi, &(harness_object){.name = "floor"}, &mesh);
	assert_gi(gi_set_specular(gi, floor, 0, (gi_specular){.reflectance = {.8f, .8f, .8f}}));
	add_lamp(gi, 100, 2);
	commit(gi);
	target t = target_make(SIZE);
	const gi_view view = look_down(2, 3);
	draw(gi, &t, &view);
	check_seen(&t, 100, .8, LAMP_LOWER, LAMP_UPPER);
	/* No longer one: black. */
	assert_gi(gi_set_specular(gi, floor, 0, (gi_specular){.index = 1}));
	harness_update(gi);
	draw(gi, &t, &view);
	check_seen(&t, 0, 0, LAMP_LOWER, LAMP_UPPER);
	target_free(&t);
	gi_context_destroy(gi);
}

/* A slab of glass before a floor that shines: (1 - 0.04) squared of it, at both surfaces. */
static void test_glass(void **state)
{
	(void)state;
	harness_require_context();
	static const float LOWER[2] = {-1, -1}, UPPER[2] = {1, 1};
	gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-1, 0, -1}, (float[]){0, 0, 2}, (float[]){2, 0, 0}, 2, 2, &mesh));
	harness_add(gi, &(harness_object){.name = "floor", .exitance = {100, 50, 0}}, &mesh);
	assert_true(shape_box((float[]){-1.9f, .5f, -1.9f}, (float[]){1.9f, .7f, 1.9f}, 2, false, &mesh));
	const gi_object slab = harness_add(gi, &(harness_object){.name = "slab"}, &mesh);
	assert_gi(gi_set_specular(gi, slab, 0, (gi_specular){.transmittance = {1, 1, 1}, .index = 1.5f}));
	commit(gi);
	target t = target_make(SIZE);
	const gi_view view = look_down(2, 3);
	draw(gi, &t, &view);
	check_seen(&t, 100, .96 * .96, LOWER, UPPER);
	/* Dark glass in it. */
	assert_true(shape_box((float[]){-1.8f, .55f, -1.8f}, (float[]){1.8f, .65f, 1.8f}, 2, false, &mesh));
	const gi_object dark = harness_add(gi, &(harness_object){.name = "dark"}, &mesh);
	assert_gi(gi_set_specular(gi, dark, 0, (gi_specular){.transmittance = {.5f, .5f, .5f}, .index = 1.5f}));
	commit(gi);
	draw(gi, &t, &view);
	check_seen(&t, 100, .25 * .96 * .96 * .96 * .96, LOWER, UPPER);
	target_free(&t);
	gi_context_destroy(gi);
}

static const float CEILING = 2.6f, WALL_END = 0.15f;

static void add_wall(gi_context *gi, const float corner[3], const float u[3], const float v[3])
{
	engine_mesh mesh;
	assert_true(shape_quad(corner, u, v, 4, 4, &mesh));
	harness_add(gi, &(harness_object){.name = "wall", .rho = {0.8f, 0.8f, 0.8f}}, &mesh);
}

static void add_block(gi_context *gi, const char *name, const float lower[3], const float upper[3])
{
	engine_mesh mesh;
	assert_true(shape_box(lower, upper, 2, false, &mesh));
	harness_add(gi, &(harness_object){.name = name, .rho = {0.8f, 0.8f, 0.8f}}, &mesh);
}

/* A lit room of x from -4 to 0, a dark one from WALL_END to 4, a thick wall with a closed door between them; a lamp of
 * 0.8 x 0.8 under the lit room's ceiling, whose light would reach most of the dark room's far wall flatter than 75
 * degrees from its normal. */
static void add_rooms(gi_context *gi)
{
	add_wall(gi, (const float[]){-4, 0, -2}, (const float[]){0, 0, 4}, (const float[]){8, 0, 0});
	add_wall(gi, (const float[]){-4, CEILING, -2}, (const float[]){8, 0, 0}, (const float[]){0, 0, 4});
	add_wall(gi, (const float[]){-4, 0, -2}, (const float[]){8, 0, 0}, (const float[]){0, CEILING, 0});
	add_wall(gi, (const float[]){-4, 0, 2}, (const float[]){0, CEILING, 0}, (const float[]){8, 0, 0});
	add_wall(gi, (const float[]){-4, 0, -2}, (const float[]){0, CEILING, 0}, (const float[]){0, 0, 4});
	add_wall(gi, (const float[]){4, 0, -2}, (const float[]){0, 0, 4}, (const float[]){0, CEILING, 0});
	add_block(gi, "left", (const float[]){0, 0, -2}, (const float[]){WALL_END, CEILING, -0.45f});
	add_block(gi, "right", (const float[]){0, 0, 0.45f}, (const float[]){WALL_END, CEILING, 2});
	add_block(gi, "lintel", (const float[]){0, 2.1f, -0.45f}, (const float[]){WALL_END, CEILING, 0.45f});
	add_block(gi, "door", (const float[]){0.05f, 0, -0.45f}, (const float[]){0.1f, 2.1f, 0.45f});
	engine_mesh mesh;
	assert_true(shape_quad((const float[]){-1.9f, CEILING - 0.01f, -0.4f}, (const float[]){0.8f, 0, 0},
			       (const float[]){0, 0, 0.8f}, 1, 1, &mesh));
	harness_add(gi, &(harness_object){.name = "lamp", .exitance = {10, 10, 10}}, &mesh);
}

/* Looks along +x, parallel, at the dark room: its far wall, z to the right and y up from the bottom row on. */
static gi_view look_into_the_dark(void)
{
	gi_view view = gi_view_default();
	const float world[16] = {0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, -2, 0, 1};
	/* Depths from x = 0.2 on. */
	const float clip[16] = {0.5f, 0, 0, 0, 0, 0.5f, 0, 0, 0, 0, -0.5f, 0, 0, 0, -1.1f, 1};
	memcpy(view.view_from_world, world, sizeof world);
	memcpy(view.clip_from_view, clip, sizeof clip);
	view.width = view.height = SIZE;
	view.mode = GI_MODE_DIRECT;
	return view;
}

/* Direct light of the drawn pixels from column `first` on is exactly none. */
static void check_black(const target *t, int first, int least)
{
	int drawn = 0;
	for (int y = 0; y < SIZE; y++)
		for (int x = first; x < SIZE; x++) {
			const float *got = pixel(t, x, y);
			drawn += got[3] > 0;
			if (got[0] > 0)
				fail_msg("pixel %d %d: %g, expected none", x, y, (double)got[0]);
		}
	assert_true(drawn > least);
}

static void test_closed_door_keeps_light_out(void **state)
{
	(void)state;
	harness_require_context();
	gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	add_rooms(gi);
	commit(gi);
	target t = target_make(SIZE);
	gi_view view = look_into_the_dark();
	draw(gi, &t, &view);
	check_black(&t, 0, SIZE * SIZE / 2);
	/* From above, to half a metre over the floor, 8 m wide. */
	view = look_down(4, 5);
	view.mode = GI_MODE_DIRECT;
	view.clip_from_view[10] = -2;
	draw(gi, &t, &view);
	check_black(&t, SIZE / 2 + 2, SIZE * SIZE / 8);
	assert_true(pixel(&t, SIZE / 4, SIZE / 2)[0] > 0.05f);
	target_free(&t);
	gi_context_destroy(gi);
}

/* A floor of a dense medium is as bright as a diffuse one of its albedo; lamps do not light it once more per pixel. */
static void test_translucent(void **state)
{
	(void)state;
	harness_require_context();
	const gi_subsurface medium = {{1e5f, 1e5f, 1e5f}, {1e3f, 1e3f, 1e3f}, 1.3f};
	gi_context_def def = harness_def();
	gi_context *gi = harness_context(&def);
	engine_mesh mesh;
	assert_true(shape_quad((float[]){-2, 0, -2}, (float[]){0, 0, 4}, (float[]){4, 0, 0}, 32, 32, &mesh));
	gi_object_def floor = scene_mesh_def(&mesh);
	gi_object object;
	gi_material material;
	floor.subsurface = &medium;
	assert_gi(gi_create_object(gi, &floor, &object));
	assert_gi(gi_get_material(gi, object, 0, &material));
	engine_mesh_free(&mesh);
	add_lamp(gi, 10, 1);
	commit(gi);
	target t = target_make(SIZE);
	gi_view view = look_down(2, 5);
	draw(gi, &t, &view);
	for (int y = 6; y < SIZE - 6; y += 7)
		for (int x = 6; x < SIZE - 6; x += 7) {
			const double factor =
			    rectangle_factor(pixel_x(x), pixel_z(y), LAMP_LOWER, LAMP_UPPER, LAMP_HEIGHT);
			/* Of leaves of 1/8 m, interpolated, from rays. */
			assert_float_equal(pixel(&t, x, y)[0], (double)material.rho[0] * 10 * factor / PI,
					   .03 * 10 * factor / PI);
		}
	view.mode = GI_MODE_DIRECT;
	draw(gi, &t, &view);
	assert_float_equal(pixel(&t, SIZE / 2, SIZE / 2)[0], 0, 0);
	target_free(&t);
	gi_context_destroy(gi);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_open_floor),
	    cmocka_unit_test(test_lamp_of_many_faces),
	    cmocka_unit_test(test_shadow_is_black),
	    cmocka_unit_test(test_soft_shadow),
	    cmocka_unit_test(test_fine_shadows),
	    cmocka_unit_test(test_modes_add_up),
	    cmocka_unit_test(test_empty_scene),
	    cmocka_unit_test(test_fine_shadow),
	    cmocka_unit_test(test_rest_draws_no_shadows),
	    cmocka_unit_test(test_lamps_beyond_the_cap),
	    cmocka_unit_test(test_mirror),
	    cmocka_unit_test(test_glass),
	    cmocka_unit_test(test_translucent),
	    cmocka_unit_test(test_overlays),
	    cmocka_unit_test(test_pick),
	    cmocka_unit_test(test_row_overlays),
	    cmocka_unit_test(test_closed_door_keeps_light_out),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
