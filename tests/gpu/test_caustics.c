/* Light of a small lamp through a mirror ball and a glass ball, in a black box, against light traced forward through
 * smooth balls; then what moves. */
#include "harness.h"
#include "scenes/body.h"
#include "scenes/shapes.h"

#include "../reference/light_trace.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const float BLACK[3] = {0, 0, 0}, LAMP[3] = {1000, 1000, 1000};

/* A room of 2 x 2 x 2 m, floor at y = 0, of leaves of 0.2 m: a mirror ball spreads its light over all of them, and
 * each gets some hundred of the photons. */
enum { CELLS = 10, PHOTONS = 131072 };
static const float BALL[3] = {0.1f, 0.7f, -0.1f}, RADIUS = 0.4f;

typedef struct box_scene {
	gi_context *gi;
	gi_object room, lamp, ball;
} box_scene;

static gi_specular ball_specular(bool glass)
{
	gi_specular s = {.index = 1.5f};
	for (int c = 0; c < 3; c++)
		(glass ? s.transmittance : s.reflectance)[c] = glass ? 1.0f : 0.9f;
	return s;
}

static gi_object add_ball(gi_context *gi, bool glass, uint32_t faces)
{
	engine_mesh mesh;
	assert_true(shape_sphere(RADIUS, faces, &mesh));
	const gi_material black = {.rho = {0}};
	const gi_specular specular = ball_specular(glass);
	gi_object_def def = scene_mesh_def(&mesh);
	def.name = glass ? "glass ball" : "mirror ball";
	def.materials = &black;
	def.specular = &specular;
	def.material_count = 1;
	memcpy(def.pose.position, BALL, sizeof BALL);
	gi_object ball;
	assert_gi(gi_create_object(gi, &def, &ball));
	engine_mesh_free(&mesh);
	return ball;
}

static gi_object add_quad(gi_context *gi, const char *name, const float corner[3], const float u[3], const float v[3],
			  uint32_t cells, const float exitance[3])
{
	engine_mesh mesh;
	assert_true(shape_quad(corner, u, v, cells, cells, &mesh));
	const scene_body body = {.name = name, .rho = BLACK, .exitance = exitance};
	gi_object out;
	assert_gi(scene_add_body(gi, &body, &mesh, &out));
	return out;
}

static box_scene open_box(bool glass, uint32_t faces, uint32_t photons)
{
	gi_context_def def = harness_def();
	def.caustic_photons = photons;
	def.row_tolerance = 0.1f;
	def.sky = GI_SKY_OFF; /* gi_commit chooses it by what sticks out of the room */
	box_scene s = {.gi = harness_context(&def)};
	engine_mesh mesh;
	assert_true(shape_box((const float[]){-1, 0, -1}, (const float[]){1, 2, 1}, CELLS, true, &mesh));
	const scene_body room = {.name = "room", .rho = BLACK};
	assert_gi(scene_add_body(s.gi, &room, &mesh, &s.room));
	s.lamp = add_quad(s.gi, "lamp", (const float[]){-0.05f, 1.99f, -0.05f}, (const float[]){0.1f, 0, 0},
			  (const float[]){0, 0, 0.1f}, 1, LAMP);
	s.ball = add_ball(s.gi, glass, faces);
	assert_gi(gi_commit(s.gi));
	return s;
}

/* ---- the reference's copy ---- */

typedef struct copy {
	light_scene scene;
	light_surface surfaces[3];
	float *positions, *normals;
	uint32_t *corners, *surface_of;
} copy;

enum { REFERENCE_FACES = 96 };

static void add_vertex(copy *c, const float p[3], const float n[3])
{
	memcpy(c->positions + 3 * (size_t)c->scene.vertex_count, p, 3 * sizeof *p);
	memcpy(c->normals + 3 * (size_t)c->scene.vertex_count, n, 3 * sizeof *n);
	c->scene.vertex_count++;
}

static void add_triangle(copy *c, uint32_t a, uint32_t b, uint32_t d, uint32_t surface)
{
	const uint32_t corners[3] = {a, b, d};
	memcpy(c->corners + 3 * (size_t)c->scene.triangle_count, corners, sizeof corners);
	c->surface_of[c->scene.triangle_count++] = surface;
}

static void add_reference_ball(copy *c)
{
	engine_mesh mesh;
	assert_true(shape_sphere(RADIUS, REFERENCE_FACES, &mesh));
	const uint32_t first = c->scene.vertex_count;
	for (uint32_t v = 0; v < mesh.vertex_count; v++) {
		float p[3], n[3];
		for (int k = 0; k < 3; k++) {
			n[k] = mesh.positions[3 * v + (uint32_t)k] / RADIUS;
			p[k] = mesh.positions[3 * v + (uint32_t)k] + BALL[k];
		}
		add_vertex(c, p, n);
	}
	for (uint32_t f = 0; f < mesh.face_count; f++) {
		const uint32_t *q = mesh.indices + 4 * f;
		add_triangle(c, first + q[0], first + q[1], first + q[2], 2);
		add_triangle(c, first + q[0], first + q[2], first + q[3], 2);
	}
	engine_mesh_free(&mesh);
}

/* Two triangles a leaf of room and lamp, in the library's order; the ball of its own. */
static copy make_copy(const gi_leaf *leaves, uint32_t count, bool glass)
{
	copy c = {.surfaces = {{.index = 0}, {.exitance = {1000, 1000, 1000}}, {.index = 1.5f}}};
	const uint32_t triangles = 2 * count + 12 * REFERENCE_FACES * REFERENCE_FACES, vertices = 4 * count + triangles;
	const gi_specular specular = ball_specular(glass);
	memcpy(c.surfaces[2].specular, specular.reflectance, sizeof specular.reflectance);
	memcpy(c.surfaces[2].transmittance, specular.transmittance, sizeof specular.transmittance);
	c.positions = calloc(3 * (size_t)vertices, sizeof(float));
	c.normals = calloc(3 * (size_t)vertices, sizeof(float));
	c.corners = calloc(3 * (size_t)triangles, sizeof(uint32_t));
	c.surface_of = calloc(triangles, sizeof(uint32_t));
	assert_true(c.positions && c.normals && c.corners && c.surface_of);
	for (uint32_t k = 0; k < count; k++) {
		const uint32_t first = c.scene.vertex_count;
		for (int v = 0; v < 4; v++)
			add_vertex(&c, leaves[k].corners[v], (const float[]){0, 1, 0});
		const uint32_t surface = leaves[k].exitance[0] > 0 ? 1 : 0;
		add_triangle(&c, first, first + 1, first + 2, surface);
		add_triangle(&c, first, first + 2, first + 3, surface);
	}
	add_reference_ball(&c);
	c.scene.positions = c.positions;
	c.scene.normals = c.normals;
	c.scene.corners = c.corners;
	c.scene.surface_of = c.surface_of;
	return c;
}

static void free_copy(copy *c)
{
	free(c->positions);
	free(c->normals);
	free(c->corners);
	free(c->surface_of);
}

/* ---- the light ---- */

static uint32_t read_diffuse(gi_context *gi, gi_object ball, gi_leaf **out)
{
	uint32_t count, kept = 0;
	assert_gi(gi_read_leaves(gi, NULL, 0, &count));
	gi_leaf *leaves = calloc(count, sizeof *leaves);
	assert_non_null(leaves);
	assert_gi(gi_read_leaves(gi, leaves, count, &count));
	for (uint32_t k = 0; k < count; k++)
		if (leaves[k].object.index1 != ball.index1)
			leaves[kept++] = leaves[k];
	*out = leaves;
	return kept;
}

/* H with the ball less H with a black one: what came through it, W. */
static double *caustic_flux(bool glass, uint32_t faces, uint32_t photons, gi_leaf **leaves, uint32_t *count)
{
	double *flux = NULL;
	for (int with = 0; with < 2; with++) {
		box_scene s = open_box(glass, faces, photons);
		if (!with)
			assert_gi(gi_set_specular(s.gi, s.ball, 0, (gi_specular){0}));
		harness_update(s.gi);
		if (with)
			free(*leaves);
		*count = read_diffuse(s.gi, s.ball, leaves);
		flux = flux ? flux : calloc(*count, sizeof *flux);
		assert_non_null(flux);
		for (uint32_t k = 0; k < *count; k++)
			flux[k] += (with ? 1 : -1) * (double)(*leaves)[k].irradiance[1] * (*leaves)[k].area;
		gi_context_destroy(s.gi);
	}
	return flux;
}

static void check_flux(bool glass, uint32_t faces)
{
	gi_leaf *leaves = NULL;
	uint32_t count;
	double *flux = caustic_flux(glass, faces, PHOTONS, &leaves, &count);
	copy c = make_copy(leaves, count, glass);
	c.scene.surfaces = c.surfaces;
	light_result truth;
	assert_true(light_trace(&c.scene, harness_is_long() ? 64000000 : 8000000, 1, &truth));
	double sum = 0, wanted = 0, squared = 0, square = 0;
	for (uint32_t k = 0; k < count; k++) {
		const double right = truth.specular[2 * k].rgb[1] + truth.specular[2 * k + 1].rgb[1];
		sum += flux[k];
		wanted += right;
		squared += (flux[k] - right) * (flux[k] - right) / (leaves[k].area + 1e-12);
		square += right * right / (leaves[k].area + 1e-12);
	}
	const double total = sum / wanted - 1, rms = sqrt(squared / square);
	printf("%s ball of %u faces: %.4f W of %.4f (%+.2f %%), RMS by leaf %.2f %%\n", glass ? "glass" : "mirror",
	       6 * faces * faces, sum, wanted, 100 * total, 100 * rms);
	assert_true(fabs(total) < 0.02);
	assert_true(rms < 0.1);
	light_result_free(&truth);
	free_copy(&c);
	free(flux);
	free(leaves);
}

static void test_mirror_flux(void **state)
{
	(void)state;
	harness_require_context();
	check_flux(false, 16);
}

static void test_glass_flux(void **state)
{
	(void)state;
	harness_require_context();
	check_flux(true, 16);
}

/* ---- what moves ---- */

enum { MOVERS = 3, FRAMES = 12 };

typedef struct moving_box {
	box_scene box;
	gi_object movers[MOVERS]; /* a glass ball, a mirror ball, a block */
} moving_box;

static moving_box open_moving(const gi_pose *poses)
{
	moving_box m = {.box = open_box(true, 8, 4096)};
	m.movers[0] = m.box.ball;
	m.movers[1] = add_ball(m.box.gi, false, 6);
	engine_mesh mesh;
	assert_true(
	    shape_box((const float[]){-0.2f, -0.2f, -0.2f}, (const float[]){0.2f, 0.2f, 0.2f}, 2, false, &mesh));
	const scene_body block = {.name = "block", .rho = BLACK, .moves = true};
	assert_gi(scene_add_body(m.box.gi, &block, &mesh, &m.movers[2]));
	for (int k = 0; k < MOVERS; k++)
		assert_gi(gi_set_pose(m.box.gi, m.movers[k], poses[k]));
	assert_gi(gi_commit(m.box.gi));
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
		pose.position[c] = (c == 1 ? 0.9f : 0.0f) + 1.1f * (random_float(state) - 0.5f);
	for (int c = 0; c < 4; c++)
		pose.rotation[c] = random_float(state) - 0.5f;
	return pose;
}

static gi_leaf *read_all(gi_context *gi, uint32_t *count)
{
	assert_gi(gi_read_leaves(gi, NULL, 0, count));
	gi_leaf *leaves = calloc(*count, sizeof *leaves);
	assert_non_null(leaves);
	assert_gi(gi_read_leaves(gi, leaves, *count, count));
	return leaves;
}

/* No surface reflects, so that irradiance is what lamps and photons bring: the same bits as of a scene made at once. */
static void check_same_as_new(moving_box *m, const gi_pose *poses)
{
	uint32_t count, new_count;
	moving_box fresh = open_moving(poses);
	harness_update(fresh.box.gi);
	gi_leaf *leaves = read_all(m->box.gi, &count), *new_leaves = read_all(fresh.box.gi, &new_count);
	assert_int_equal(count, new_count);
	for (uint32_t k = 0; k < count; k++)
		assert_memory_equal(leaves[k].irradiance, new_leaves[k].irradiance, sizeof leaves[k].irradiance);
	free(leaves);
	free(new_leaves);
	gi_context_destroy(fresh.box.gi);
}

/* Nothing moves any more: photons that a budget left out come frame by frame, and then there is nothing to do. */
static void comes_to_rest(gi_context *gi)
{
	gi_report report = {0};
	for (int frame = 0; frame < 5000 && report.outcome != GI_OUTCOME_AT_REST; frame++) {
		assert_gi(gi_update(gi, &(gi_budget){.ms = 4}));
		assert_gi(gi_finish(gi));
		assert_gi(gi_get_report(gi, &report));
	}
	assert_int_equal(report.outcome, GI_OUTCOME_AT_REST);
}

/* One or two of them move a frame, some frames none. */
static void test_moves(void **state)
{
	(void)state;
	harness_require_context();
	uint32_t random = 7;
	gi_pose poses[MOVERS];
	for (int k = 0; k < MOVERS; k++)
		poses[k] = random_pose(&random);
	moving_box m = open_moving(poses);
	for (uint32_t frame = 0; frame < (harness_is_long() ? 100u : FRAMES); frame++) {
		for (int k = 0; k < MOVERS; k++)
			if (random_float(&random) < 0.4f)
				poses[k] = random_pose(&random);
		for (int k = 0; k < MOVERS; k++)
			assert_gi(gi_set_pose(m.box.gi, m.movers[k], poses[k]));
		/* Under a budget some photons are traced later; an exact update traces all. */
		assert_gi(gi_update(m.box.gi, frame % 3 ? &(gi_budget){.ms = 1} : NULL));
		if (frame % 4 == 3) {
			harness_update(m.box.gi);
			check_same_as_new(&m, poses);
		}
	}
	poses[0].position[0] += 0.1f;
	assert_gi(gi_set_pose(m.box.gi, m.movers[0], poses[0]));
	comes_to_rest(m.box.gi);
	check_same_as_new(&m, poses);
	gi_context_destroy(m.box.gi);
}

static moving_box open_three(gi_pose *poses)
{
	uint32_t random = 7;
	for (int k = 0; k < MOVERS; k++)
		poses[k] = random_pose(&random);
	return open_moving(poses);
}

/* A block that stands in the way while rows are built anew for another reason. */
static void test_moves_while_rows_are_new(void **state)
{
	(void)state;
	harness_require_context();
	gi_pose poses[MOVERS];
	moving_box m = open_three(poses);
	const gi_pose away = poses[2];
	poses[2].position[0] = BALL[0];
	poses[2].position[1] = 1.3f;
	poses[2].position[2] = BALL[2];
	for (int k = 0; k < 2; k++) {
		const gi_pose before = poses[2];
		poses[2] = k ? away : before;
		assert_gi(gi_set_pose(m.box.gi, m.movers[2], poses[2]));
		gi_invalidate(m.box.gi);
		harness_update(m.box.gi);
		check_same_as_new(&m, poses);
	}
	gi_context_destroy(m.box.gi);
}

/* What one ball is of, other balls' photons see too. */
static void test_other_glass(void **state)
{
	(void)state;
	harness_require_context();
	gi_pose poses[MOVERS] = {gi_pose_identity(), gi_pose_identity(), gi_pose_identity()};
	const float at[MOVERS][3] = {{-0.42f, 1.2f, 0}, {0.42f, 0.8f, 0}, {0, 0.3f, 0.7f}};
	for (int k = 0; k < MOVERS; k++)
		memcpy(poses[k].position, at[k], sizeof at[k]);
	moving_box m = open_moving(poses);
	harness_update(m.box.gi);
	const gi_specular mirror = {.reflectance = {0.5f, 0.5f, 0.5f}};
	assert_gi(gi_set_specular(m.box.gi, m.movers[1], 0, mirror));
	harness_update(m.box.gi);
	uint32_t count, new_count;
	moving_box fresh = open_moving(poses);
	assert_gi(gi_set_specular(fresh.box.gi, fresh.movers[1], 0, mirror));
	harness_update(fresh.box.gi);
	gi_leaf *leaves = read_all(m.box.gi, &count), *new_leaves = read_all(fresh.box.gi, &new_count);
	assert_int_equal(count, new_count);
	for (uint32_t k = 0; k < count; k++)
		assert_memory_equal(leaves[k].irradiance, new_leaves[k].irradiance, sizeof leaves[k].irradiance);
	free(leaves);
	free(new_leaves);
	gi_context_destroy(fresh.box.gi);
	gi_context_destroy(m.box.gi);
}

/* ---- where the light goes ---- */

/* Sum of area times irradiance of an object's leaves, or of all but it; W, red. */
static double arriving_flux(const gi_leaf *leaves, uint32_t count, gi_object object, bool others)
{
	double flux = 0;
	for (uint32_t k = 0; k < count; k++)
		if ((leaves[k].object.index1 == object.index1) != others)
			flux += (double)leaves[k].area * (double)leaves[k].irradiance[0];
	return flux;
}

/* In a black room that is closed, all that the lamp emits arrives at its leaves, at the lamp's or in the ball: what a
 * mirror does not reflect. */
static void check_energy(bool glass)
{
	box_scene s = open_box(glass, 24, PHOTONS);
	harness_update(s.gi);
	uint32_t count;
	assert_gi(gi_read_leaves(s.gi, NULL, 0, &count));
	gi_leaf *leaves = calloc(count, sizeof *leaves);
	assert_non_null(leaves);
	assert_gi(gi_read_leaves(s.gi, leaves, count, &count));
	double emitted = 0;
	for (uint32_t k = 0; k < count; k++)
		emitted += (double)leaves[k].area * (double)leaves[k].exitance[0];
	const double arrived = arriving_flux(leaves, count, s.ball, true),
		     absorbed = (glass ? 0 : 0.1) * arriving_flux(leaves, count, s.ball, false);
	printf("%s ball: of %.3f W %.3f arrive, %.3f are absorbed: %+.2f %%\n", glass ? "glass" : "mirror", emitted,
	       arrived, absorbed, 100 * ((arrived + absorbed) / emitted - 1));
	assert_float_equal((arrived + absorbed) / emitted, 1, 0.005);
	free(leaves);
	gi_context_destroy(s.gi);
}

static void test_energy(void **state)
{
	(void)state;
	harness_require_context();
	check_energy(false);
	check_energy(true);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_mirror_flux),
	    cmocka_unit_test(test_glass_flux),
	    cmocka_unit_test(test_energy),
	    cmocka_unit_test(test_moves),
	    cmocka_unit_test(test_moves_while_rows_are_new),
	    cmocka_unit_test(test_other_glass),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
