/* Off-line ray tracing (tests/bench/path_tracer.h) against closed forms, and its parts against each other. */
#include "../bench/caustic_map.h"
#include "../bench/path_tracer.h"
#include "../bench/trace_box.h"
#include "../reference/exact.h"
#include "scenes/cornell.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static void check_near(double got, double wanted, double tolerance, const char *what, int line)
{
	printf("%s: %.6g, wanted %.6g +- %.2g\n", what, got, wanted, tolerance);
	if (!(fabs(got - wanted) <= tolerance))
		_fail(__FILE__, line);
}

#define CHECK_NEAR(got, wanted, tolerance) check_near(got, wanted, tolerance, #got, __LINE__)

enum { SIDE = 16 };

static trace_object *add_quad(trace_scene *scene, const float corner[3], const float u[3], const float v[3], float rho,
			      float exitance)
{
	trace_object *o = trace_scene_add_quad(scene, corner, u, v);
	assert_non_null(o);
	for (int c = 0; c < 3; c++) {
		o->rho[c] = rho;
		o->exitance[c] = exitance;
	}
	return o;
}

/* Looks from an eye along -z at what is `half` wide to every side one unit away. */
static path_tracer_def look(const trace_scene *scene, float x, float y, float z, float half)
{
	path_tracer_def def = {.scene = scene, .seed = 1};
	def.camera = (trace_camera){.eye = {x, y, z},
				    .forward = {0, 0, -1},
				    .right = {half, 0, 0},
				    .up = {0, half, 0},
				    .width = SIDE,
				    .height = SIDE};
	return def;
}

static linear_image render(const path_tracer_def *def, uint32_t samples)
{
	linear_image image;
	assert_true(linear_image_create(SIDE, SIDE, &image));
	path_tracer *tracer = path_tracer_create(def);
	assert_non_null(tracer);
	assert_true(path_tracer_add(tracer, samples));
	assert_int_equal(path_tracer_samples(tracer), samples);
	path_tracer_picture(tracer, &image);
	path_tracer_destroy(tracer);
	return image;
}

static double mean_of(const linear_image *image)
{
	double sum = 0;
	for (int k = 0; k < 3 * SIDE * SIDE; k++)
		sum += (double)image->rgb[k];
	return sum / (3 * SIDE * SIDE);
}

static double mean_rendered(const path_tracer_def *def, uint32_t samples)
{
	linear_image image = render(def, samples);
	const double mean = mean_of(&image);
	linear_image_free(&image);
	return mean;
}

/* ---- the furnace ---- */

static void add_room(trace_scene *scene, float rho, float exitance)
{
	const float quads[6][3][3] = {
	    {{-1, -1, -1}, {0, 0, 2}, {2, 0, 0}}, {{-1, 1, -1}, {2, 0, 0}, {0, 0, 2}},
	    {{-1, -1, -1}, {0, 2, 0}, {0, 0, 2}}, {{1, -1, -1}, {0, 0, 2}, {0, 2, 0}},
	    {{-1, -1, -1}, {2, 0, 0}, {0, 2, 0}}, {{-1, -1, 1}, {0, 2, 0}, {2, 0, 0}},
	};
	for (int k = 0; k < 6; k++)
		add_quad(scene, quads[k][0], quads[k][1], quads[k][2], rho, exitance);
}

/* Radiance is E / (pi (1 - rho)) everywhere, however light is split into what is drawn and what is met. */
static void test_furnace(void **state)
{
	(void)state;
	trace_scene scene = {0};
	add_room(&scene, 0.6f, 2);
	path_tracer_def def = look(&scene, 0.1f, -0.2f, 0.3f, 1);
	const double all = 2 / (PI * 0.4), direct = 2 / PI * 1.6;
	CHECK_NEAR(mean_rendered(&def, 256), all, 0.004 * all);
	def.light = GI_MODE_DIRECT;
	CHECK_NEAR(mean_rendered(&def, 64), direct, 0.004 * direct);
	def.light = GI_MODE_INDIRECT;
	CHECK_NEAR(mean_rendered(&def, 256), all - direct, 0.006 * all);
	trace_scene_free(&scene);
}

/* A mirror that reflects all light in it, and clear glass, change nothing. */
static void test_furnace_with_mirror_and_glass(void **state)
{
	(void)state;
	trace_scene scene = {0};
	add_room(&scene, 0.6f, 2);
	trace_object *mirror = add_quad(&scene, (const float[]){-0.8f, -0.7f, -0.8f}, (const float[]){0.9f, 0, 0},
					(const float[]){0, 0.9f, 0.1f}, 0, 0);
	/* Its back lies in the wall: it is black. */
	glm_vec3_one(mirror->specular.reflectance);
	mirror->world[3][2] = -0.199f;
	path_tracer_def def = look(&scene, 0.1f, -0.2f, 0.3f, 1);
	def.paths_alone = true;
	const double all = 2 / (PI * 0.4);
	/* What hides behind the mirror is darker by what its back takes: only what is seen in it counts here. */
	def.camera.eye[0] = -0.4f;
	def.camera.eye[1] = -0.3f;
	glm_vec3_scale(def.camera.right, 0.2f, def.camera.right);
	glm_vec3_scale(def.camera.up, 0.2f, def.camera.up);
	CHECK_NEAR(mean_rendered(&def, 256), all, 0.02 * all);
	trace_scene_free(&scene);
}

/* ---- one lamp ---- */

/* The irradiance that a lamp gives to a point of the floor, whose normal is +z. */
static double lamp_irradiance(double x, double y, const double corners[12], double exitance)
{
	const double point[3] = {x, y, 0}, normal[3] = {0, 0, 1};
	return exitance * fmax(exact_element_polygon(point, normal, corners, 4), 0);
}

/* A lamp over a floor, beside the view: each pixel against the closed form. */
static void test_lamp(void **state)
{
	(void)state;
	trace_scene scene = {0};
	add_quad(&scene, (const float[]){-4, -4, 0}, (const float[]){8, 0, 0}, (const float[]){0, 8, 0}, 0.5f, 0);
	add_quad(&scene, (const float[]){0.6f, -0.4f, 0.8f}, (const float[]){0, 0.8f, 0}, (const float[]){0.7f, 0, 0},
		 0, 10);
	const double lamp[12] = {0.6, -0.4, 0.8, 0.6, 0.4, 0.8, 1.3, 0.4, 0.8, 1.3, -0.4, 0.8};
	const path_tracer_def def = look(&scene, -0.4f, 0, 1, 0.5f);
	linear_image image = render(&def, 256);
	double worst = 0, squares = 0;
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++) {
			const double at_x = -0.4 + 0.5 * (2 * (x + 0.5) / SIDE - 1),
				     at_y = 0.5 * (1 - 2 * (y + 0.5) / SIDE);
			const double wanted = 0.5 / PI * lamp_irradiance(at_x, at_y, lamp, 10);
			const double error = (double)image.rgb[3 * (y * SIDE + x)] / wanted - 1;
			worst = fmax(worst, fabs(error));
			squares += error * error;
		}
	CHECK_NEAR(worst, 0, 0.02);
	CHECK_NEAR(sqrt(squares / (SIDE * SIDE)), 0, 0.005);
	linear_image_free(&image);
	trace_scene_free(&scene);
}

/* A mirror upright on a floor shows the lamp again, behind it: the caustic is that image's light, where the mirror is
 * large enough. By photons and by paths alone. */
static void test_mirror_caustic(void **state)
{
	(void)state;
	/* So dark that what the floor gives to itself, by the mirror too, is below 0.1 %. */
	const float rho = 0.01f;
	trace_scene scene = {0};
	add_quad(&scene, (const float[]){-1, -1, 0}, (const float[]){2, 0, 0}, (const float[]){0, 2, 0}, rho, 0);
	trace_object *mirror = add_quad(&scene, (const float[]){-1, -0.7f, 0}, (const float[]){0, 1.4f, 0},
					(const float[]){0, 0, 0.5f}, 0, 0);
	glm_vec3_copy((vec3){0.8f, 0.8f, 0.8f}, mirror->specular.reflectance);
	add_quad(&scene, (const float[]){1.2f, -0.4f, 0.8f}, (const float[]){0, 0.8f, 0}, (const float[]){0.5f, 0, 0},
		 0, 10);
	const double image[12] = {-3.7, -0.4, 0.8, -3.7, 0.4, 0.8, -3.2, 0.4, 0.8, -3.2, -0.4, 0.8};
	path_tracer_def def = look(&scene, 0, 0, 1, 0.5f);
	def.antialias = true;
	def.light = GI_MODE_INDIRECT;
	double wanted = 0;
	for (int k = 0; k < SIDE * SIDE; k++)
		wanted += 0.8 * (double)rho / PI *
			  lamp_irradiance(0.5 * (2 * (k % SIDE + 0.5) / SIDE - 1),
					  0.5 * (2 * (k / SIDE + 0.5) / SIDE - 1), image, 10) /
			  (SIDE * SIDE);
	CHECK_NEAR(mean_rendered(&def, 2048), wanted, 0.01 * wanted);
	def.paths_alone = true;
	CHECK_NEAR(mean_rendered(&def, 4096), wanted, 0.02 * wanted);
	trace_scene_free(&scene);
}

/* Photons and what they light in turn make the picture that paths alone find. */
static void test_photons(void **state)
{
	(void)state;
	trace_scene scene = {0};
	float view_from_world[16], clip_from_view[16];
	assert_true(trace_box_balls(&scene));
	cornell_camera(1, view_from_world, clip_from_view);
	path_tracer_def def = {.scene = &scene,
			       .camera = trace_camera_make(view_from_world, clip_from_view, SIDE, SIDE),
			       .light = GI_MODE_INDIRECT,
			       .antialias = true,
			       .seed = 1};
	const double photons = mean_rendered(&def, 512);
	def.paths_alone = true;
	CHECK_NEAR(photons / mean_rendered(&def, 2048), 1, 0.01);
	trace_scene_free(&scene);
}

/* Photons spread evenly over a plane: the irradiance is their flux over its area; none on the other side of it. */
static void test_caustic_map(void **state)
{
	(void)state;
	enum { GRID = 200 };
	caustic_photon *photons = calloc(GRID * GRID, sizeof *photons);
	assert_non_null(photons);
	for (int k = 0; k < GRID * GRID; k++)
		photons[k] =
		    (caustic_photon){.point = {(float)(k % GRID) / GRID - 0.5f, 0, (float)(k / GRID) / GRID - 0.5f},
				     .normal = {0, 1, 0},
				     .flux = {3.0f / (GRID * GRID), 2.0f / (GRID * GRID), 0}};
	caustic_map map = {0};
	assert_true(caustic_map_build(&map, photons, GRID * GRID, 0.05f));
	vec3 irradiance;
	caustic_map_irradiance(&map, (vec3){0.013f, 0, -0.22f}, (vec3){0, 1, 0}, irradiance);
	CHECK_NEAR((double)irradiance[0], 3, 0.03);
	CHECK_NEAR((double)irradiance[1], 2, 0.02);
	caustic_map_irradiance(&map, (vec3){0.013f, 0, -0.22f}, (vec3){0, -1, 0}, irradiance);
	CHECK_NEAR((double)irradiance[0], 0, 0);
	caustic_map_irradiance(&map, (vec3){0.5f - 0.5f / GRID, 0, 0}, (vec3){0, 1, 0}, irradiance);
	CHECK_NEAR((double)irradiance[0], 1.5, 0.03);
	caustic_map_free(&map);
	free(photons);
}

/* ---- the same bits ---- */

static void test_threads_change_nothing(void **state)
{
	(void)state;
	trace_scene scene = {0};
	add_quad(&scene, (const float[]){-1, -1, 0}, (const float[]){2, 0, 0}, (const float[]){0, 2, 0}, 0.5f, 0);
	trace_object *mirror =
	    add_quad(&scene, (const float[]){-1, -3, 0}, (const float[]){0, 6, 0}, (const float[]){0, 0, 4}, 0, 0);
	glm_vec3_one(mirror->specular.reflectance);
	mirror->moves = true;
	add_quad(&scene, (const float[]){1.2f, -0.4f, 0.8f}, (const float[]){0, 0.8f, 0}, (const float[]){0.5f, 0, 0},
		 0, 10);
	path_tracer_def def = look(&scene, 0, 0, 1, 0.5f);
	def.threads = 1;
	linear_image one = render(&def, 64);
	def.threads = 3;
	linear_image three = render(&def, 64);
	assert_memory_equal(one.rgb, three.rgb, 3 * SIDE * SIDE * sizeof *one.rgb);
	def.seed = 2;
	linear_image other = render(&def, 64);
	assert_memory_not_equal(one.rgb, other.rgb, 3 * SIDE * SIDE * sizeof *one.rgb);
	linear_image_free(&one);
	linear_image_free(&three);
	linear_image_free(&other);
	trace_scene_free(&scene);
}

/* Moved to a place and asked again it is the picture of one that was there from the start. */
static void test_update(void **state)
{
	(void)state;
	trace_scene scene = {0};
	add_quad(&scene, (const float[]){-4, -4, 0}, (const float[]){8, 0, 0}, (const float[]){0, 8, 0}, 0.5f, 0);
	add_quad(&scene, (const float[]){-1, -1, 2}, (const float[]){0, 2, 0}, (const float[]){2, 0, 0}, 0, 10);
	trace_object *board = add_quad(&scene, (const float[]){-0.2f, -0.2f, 0}, (const float[]){0.4f, 0, 0},
				       (const float[]){0, 0.4f, 0}, 0.3f, 0);
	board->moves = true;
	board->world[3][2] = 0.3f;
	const path_tracer_def def = look(&scene, 0, 0, 1, 0.5f);
	linear_image begun = render(&def, 16);
	gi_pose pose = gi_pose_identity();
	pose.position[2] = 0.6f;
	trace_object_set_pose(board, pose);
	linear_image moved;
	assert_true(linear_image_create(SIDE, SIDE, &moved));
	path_tracer *tracer = path_tracer_create(&def);
	assert_non_null(tracer);
	pose.position[2] = 0.3f;
	trace_object_set_pose(board, pose);
	assert_true(path_tracer_add(tracer, 3));
	path_tracer_update(tracer);
	assert_true(path_tracer_add(tracer, 16));
	path_tracer_picture(tracer, &moved);
	assert_memory_equal(begun.rgb, moved.rgb, 3 * SIDE * SIDE * sizeof *moved.rgb);
	path_tracer_destroy(tracer);
	linear_image_free(&begun);
	linear_image_free(&moved);
	trace_scene_free(&scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_furnace),
	    cmocka_unit_test(test_furnace_with_mirror_and_glass),
	    cmocka_unit_test(test_lamp),
	    cmocka_unit_test(test_mirror_caustic),
	    cmocka_unit_test(test_photons),
	    cmocka_unit_test(test_caustic_map),
	    cmocka_unit_test(test_threads_change_nothing),
	    cmocka_unit_test(test_update),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
