/* glTF of all kinds that exporters write and not every reader takes: what each becomes, and what is told of it.
 *
 * A file is a square (1 m2, z = 0, front towards +z) or cube (edge 1, about its middle) and what a test adds; numbers
 * go to kinds.bin.
 */
#define _XOPEN_SOURCE 700 /* mkdtemp, mkfifo */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "import_shape.h"
#include "scene_files.h"

#include <sys/stat.h>
#include <time.h>

/* ---- files ------------------------------------------------------------------------------------------------------- */

static uint8_t bytes[1 << 16];
static size_t byte_count;
static char views[1 << 14], accessors[1 << 14];
static int accessor_count;
static char text[1 << 20];

enum { UNSIGNED_BYTE = 5121, SHORT = 5122, UNSIGNED_SHORT = 5123, FLOAT = 5126 };

/* Appends an accessor and returns its number; more: further members, e.g. ",\"normalized\":true". */
static int add(const void *data, size_t size, int type, int count, const char *shape, const char *more)
{
	size_t length = strlen(views), used = strlen(accessors);
	memcpy(bytes + byte_count, data, size);
	snprintf(views + length, sizeof views - length, "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}",
		 accessor_count ? "," : "", byte_count, size);
	snprintf(accessors + used, sizeof accessors - used,
		 "%s{\"bufferView\":%d,\"componentType\":%d,\"count\":%d,\"type\":\"%s\"%s}", accessor_count ? "," : "",
		 accessor_count, type, count, shape, more);
	byte_count += (size + 3) / 4 * 4;
	return accessor_count++;
}

#define ADD_FLOATS(data, count, shape) add(data, sizeof(data), FLOAT, count, shape, "")

static void begin(void)
{
	static const float square[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
	static const uint16_t square_corners[6] = {0, 1, 2, 0, 2, 3};
	static const float cube[8][3] = {{-.5f, -.5f, -.5f}, {.5f, -.5f, -.5f}, {-.5f, .5f, -.5f}, {.5f, .5f, -.5f},
					 {-.5f, -.5f, .5f},  {.5f, -.5f, .5f},  {-.5f, .5f, .5f},  {.5f, .5f, .5f}};
	static const uint16_t cube_corners[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
						  2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
	byte_count = 0;
	accessor_count = 0;
	views[0] = accessors[0] = '\0';
	ADD_FLOATS(square, 4, "VEC3");
	add(square_corners, sizeof square_corners, UNSIGNED_SHORT, 6, "SCALAR", "");
	ADD_FLOATS(cube, 8, "VEC3");
	add(cube_corners, sizeof cube_corners, UNSIGNED_SHORT, 36, "SCALAR", "");
}

#define SQUARE "{\"attributes\":{\"POSITION\":0},\"indices\":1}"
#define CUBE "{\"attributes\":{\"POSITION\":2},\"indices\":3}"
#define MESHES "\"meshes\":[{\"primitives\":[" SQUARE "]},{\"primitives\":[" CUBE "]}]"
#define PAINTED(material)                                                                                              \
	"\"nodes\":[{\"mesh\":0},{\"mesh\":1}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},"         \
	"\"indices\":1,\"material\":0}]},{\"primitives\":[" CUBE "]}],\"materials\":[{\"name\":\"paint\"" material     \
	"}]"

/* The file of these members and the accessors so far. */
static const char *finish(const char *members)
{
	write_file("kinds.bin", bytes, byte_count);
	snprintf(text, sizeof text,
		 "{\"asset\":{\"version\":\"2.0\"},%s,\"buffers\":[{\"byteLength\":%zu,\"uri\":\"kinds.bin\"}],"
		 "\"bufferViews\":[%s],\"accessors\":[%s]}",
		 members, byte_count, views, accessors);
	return write_text("kinds.gltf", text);
}

static engine_scene load_kind(const char *members)
{
	return load(finish(members));
}

static void check_tells(const engine_scene *scene, const char *words)
{
	if (words[0] ? !strstr(scene->warning, words) : scene->warning[0] != '\0')
		fail_msg("\"%s\" is not \"%s\"", scene->warning, words);
}

static void check_kind(const char *members, uint32_t objects, const char *words)
{
	engine_scene scene = load_kind(members);
	assert_int_equal(scene.object_count, objects);
	check_tells(&scene, words);
	engine_scene_free(&scene);
}

/* ---- places ------------------------------------------------------------------------------------------------------ */

static void to_world(const engine_pose *pose, const float *point, double out[3])
{
	double q[4] = {pose->rotation[0], pose->rotation[1], pose->rotation[2], pose->rotation[3]}, v[3], c[3], d[3];
	for (int k = 0; k < 3; k++)
		v[k] = (double)point[k] * (double)pose->scale[k];
	for (int k = 0; k < 3; k++)
		c[k] = q[(k + 1) % 3] * v[(k + 2) % 3] - q[(k + 2) % 3] * v[(k + 1) % 3] + q[3] * v[k];
	for (int k = 0; k < 3; k++)
		d[k] = q[(k + 1) % 3] * c[(k + 2) % 3] - q[(k + 2) % 3] * c[(k + 1) % 3];
	for (int k = 0; k < 3; k++)
		out[k] = v[k] + 2 * d[k] + (double)pose->translation[k];
}

/* The farthest that a vertex of an object lies from the nearest of these 8 points, metres. */
static double farthest_from(const engine_scene_object *object, const engine_pose *pose, const double points[8][3])
{
	double farthest = 0;
	for (uint32_t v = 0; v < object->mesh.vertex_count; v++) {
		double at[3], nearest = INFINITY;
		to_world(pose, object->mesh.positions + 3 * (size_t)v, at);
		for (int k = 0; k < 8; k++)
			nearest = fmin(nearest,
				       hypot(hypot(at[0] - points[k][0], at[1] - points[k][1]), at[2] - points[k][2]));
		farthest = fmax(farthest, nearest);
	}
	return farthest;
}

/* The cube's corners through a matrix of three rows. */
static void cube_through(const double m[3][4], double points[8][3])
{
	for (int k = 0; k < 8; k++) {
		const double p[3] = {(k & 1) - 0.5, (k >> 1 & 1) - 0.5, (k >> 2) - 0.5};
		for (int row = 0; row < 3; row++)
			points[k][row] = m[row][0] * p[0] + m[row][1] * p[1] + m[row][2] * p[2] + m[row][3];
	}
}

/* Signed volume in the world, by the divergence theorem: positive while fronts look outward. */
static double volume_of(const engine_scene *scene)
{
	engine_mesh world;
	double volume = 0;
	assert_true(engine_scene_merge(scene, &world, message, sizeof message));
	for (uint32_t i = 0; i < world.index_count; i += 3) {
		const float *a = world.positions + 3 * (size_t)world.indices[i];
		const float *b = world.positions + 3 * (size_t)world.indices[i + 1];
		const float *c = world.positions + 3 * (size_t)world.indices[i + 2];
		volume += (double)(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
				   a[2] * (b[0] * c[1] - b[1] * c[0])) /
			  6;
	}
	engine_mesh_free(&world);
	return volume;
}

/* A cube turned by 45 degrees about z below a node that halves y and mirrors it for sign -1. */
static void sheared_cubes_are_baked(void **state)
{
	(void)state;
	for (int sign = -1; sign <= 1; sign += 2) {
		char members[1024];
		const double c = sqrt(0.5), h = 0.5 * sign;
		const double m[3][4] = {{c, -c, 0, 0.25}, {h * c, h * c, 0, 0}, {0, 0, 1, 3}};
		double points[8][3];
		begin();
		snprintf(members, sizeof members,
			 "\"nodes\":[{\"mesh\":1,\"rotation\":[0,0,0.38268343236509,0.92387953251129],\"translation\":["
			 "0.25,0,3]},"
			 "{\"scale\":[1,%g,1],\"children\":[0]}]," MESHES,
			 h);
		engine_scene scene = load_kind(members);
		cube_through(m, points);
		double farthest = farthest_from(&scene.objects[0], &scene.objects[0].rest, points);
		printf("sheared cube, y scaled by %g: corners within %.2g m, volume %.7f of 0.5\n", h, farthest,
		       volume_of(&scene));
		assert_true(farthest < 1e-6);
		assert_true(fabs(volume_of(&scene) - 0.5) < 1e-6);
		check_tells(&scene, "");
		engine_scene_free(&scene);
	}
}

/* The same below a node that moves and turns: the shear goes along as a part of the body. */
static void sheared_cubes_move(void **state)
{
	(void)state;
	static const float times[2] = {0, 1}, places[2][3] = {{0, 0, 0}, {0, 4, 0}};
	static const float turns[2][4] = {{0, 0, 0, 1}, {0, 0.70710678f, 0, 0.70710678f}}; /* 90 degrees about y */
	const double c = sqrt(0.5);
	begin();
	ADD_FLOATS(times, 2, "SCALAR");
	ADD_FLOATS(places, 2, "VEC3");
	ADD_FLOATS(turns, 2, "VEC4");
	engine_scene scene = load_kind(
	    "\"nodes\":[{\"mesh\":1,\"rotation\":[0,0,0.38268343,0.92387953]},{\"scale\":[1,0.5,1],\"children\":[0]},"
	    "{\"children\":[1]}]," MESHES ",\"animations\":[{\"samplers\":[{\"input\":4,\"output\":5},{\"input\":4,"
	    "\"output\":6}],\"channels\":[{\"sampler\":0,\"target\":{\"node\":2,\"path\":\"translation\"}},{"
	    "\"sampler\":1,"
	    "\"target\":{\"node\":2,\"path\":\"rotation\"}}]}]");
	/* x to -z, z to x */
	const double m[3][4] = {{0, 0, 1, 0}, {0.5 * c, 0.5 * c, 0, 4}, {-c, c, 0, 0}};
	double points[8][3];
	engine_pose pose;
	cube_through(m, points);
	assert_true(engine_scene_pose(&scene, 0, 1, &pose));
	double farthest = farthest_from(&scene.objects[0], &pose, points);
	printf("moved sheared cube: corners within %.2g m\n", farthest);
	assert_true(farthest < 2e-6);
	assert_true(scene.objects[0].animated && !scene.objects[0].scale_animated);
	engine_scene_free(&scene);
}

/* Turning below a parent of uneven scale changes the shape: the body keeps that of rest, and turns. */
static void turning_shears_are_told(void **state)
{
	(void)state;
	static const float times[2] = {0, 1}, turns[2][4] = {{0, 0, 0, 1}, {0, 0, 0.38268343f, 0.92387953f}};
	begin();
	ADD_FLOATS(times, 2, "SCALAR");
	ADD_FLOATS(turns, 2, "VEC4");
	engine_scene scene =
	    load_kind("\"nodes\":[{\"mesh\":1},{\"scale\":[1,0.5,1],\"children\":[0]}]," MESHES ",\"animations\":[{"
		      "\"samplers\":[{\"input\":4,\"output\":5}],\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,"
		      "\"path\":\"rotation\"}}]}]");
	engine_pose pose;
	assert_true(scene.objects[0].scale_animated);
	assert_true(engine_scene_pose(&scene, 0, 1, &pose));
	CHECK3(pose.scale, 1, 0.5f, 1);
	assert_true(fabsf(pose.rotation[2]) > 0.2f);
	engine_scene_free(&scene);
}

static void a_scale_of_0_hides_an_object_for_a_time(void **state)
{
	(void)state;
	static const float times[3] = {0, 1, 2}, scales[3][3] = {{0, 0, 0}, {2, 2, 2}, {0, 0, 0}};
	begin();
	ADD_FLOATS(times, 3, "SCALAR");
	ADD_FLOATS(scales, 3, "VEC3");
	engine_scene scene = load_kind(
	    "\"nodes\":[{\"mesh\":0},{\"mesh\":1,\"scale\":[0,0,0]}]," MESHES ",\"animations\":[{\"samplers\":[{"
	    "\"input\":4,\"output\":5,\"interpolation\":\"STEP\"}],\"channels\":[{\"sampler\":0,\"target\":{"
	    "\"node\":1,\"path\":\"scale\"}}]}]");
	engine_pose pose;
	assert_int_equal(scene.object_count, 2);
	assert_true(scene.objects[1].vanishes);
	CHECK3(scene.objects[1].rest.scale, 2, 2, 2);
	assert_false(engine_scene_pose(&scene, 1, 0.5, &pose));
	assert_true(engine_scene_pose(&scene, 1, 1.5, &pose));
	assert_false(engine_scene_pose(&scene, 1, 2, &pose));
	engine_scene_free(&scene);
}

/* Of keys of one time the last counts. */
static void equal_times_keep_the_last(void **state)
{
	(void)state;
	static const float times[4] = {0, 1, 1, 2}, places[4][3] = {{0, 0, 0}, {9, 9, 9}, {2, 0, 0}, {4, 0, 0}};
	begin();
	ADD_FLOATS(times, 4, "SCALAR");
	ADD_FLOATS(places, 4, "VEC3");
	engine_scene scene =
	    load_kind("\"nodes\":[{\"mesh\":0}]," MESHES ",\"animations\":[{\"samplers\":[{\"input\":4,\"output\":5}],"
		      "\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"translation\"}}]}]");
	engine_pose pose;
	for (int k = 1; k < 8; k++) {
		assert_true(engine_scene_pose(&scene, 0, 0.25 * k, &pose));
		CHECK3(pose.translation, 0.5f * (float)k, 0, 0);
	}
	check_tells(&scene, "equal times");
	engine_scene_free(&scene);
}

static void instances_are_objects(void **state)
{
	(void)state;
	static const float places[3][3] = {{0, 0, 0}, {2, 0, 0}, {0, 0, 5}},
			   scales[3][3] = {{1, 1, 1}, {2, 2, 2}, {1, 1, 3}};
	begin();
	ADD_FLOATS(places, 3, "VEC3");
	ADD_FLOATS(scales, 3, "VEC3");
	engine_scene scene = load_kind("\"nodes\":[{\"mesh\":0},{\"mesh\":1,\"name\":\"cube\",\"translation\":[0,7,0],"
				       "\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":4,"
				       "\"SCALE\":5}}}}],\"extensionsRequired\":[\"EXT_mesh_gpu_instancing\"]," MESHES);
	assert_int_equal(scene.object_count, 4);
	check_tells(&scene, "");
	for (int k = 0; k < 3; k++) {
		CHECK3(scene.objects[1 + k].rest.translation, places[k][0], places[k][1] + 7, places[k][2]);
		CHECK3(scene.objects[1 + k].rest.scale, scales[k][0], scales[k][1], scales[k][2]);
		assert_int_equal(scene.objects[1 + k].mesh.face_count, 12);
	}
	assert_string_equal(scene.objects[3].name, "cube#3");
	engine_scene_free(&scene);
}

/* ---- shapes ------------------------------------------------------------------------------------------------------ */

/* Joint 0 halves and lifts, joint 1 is away; the node's own place does not count. */
static void skins_stand_as_at_rest(void **state)
{
	(void)state;
	static uint8_t joints[8][4];
	static float weights[8][4], inverse[2][16];
	for (int v = 0; v < 8; v++) {
		weights[v][0] = 1;
		joints[v][0] = 1;
	}
	for (int i = 0; i < 16; i += 5)
		inverse[0][i] = inverse[1][i] = 1;
	begin();
	add(joints, sizeof joints, UNSIGNED_BYTE, 8, "VEC4", "");
	ADD_FLOATS(weights, 8, "VEC4");
	ADD_FLOATS(inverse, 2, "MAT4");
	engine_scene scene = load_kind(
	    "\"nodes\":[{\"name\":\"away\",\"translation\":[50,0,0]},{\"scale\":[0.01,0.01,0.01],\"translation\":[0,3,"
	    "0]},"
	    "{\"mesh\":0,\"skin\":0,\"translation\":[9,9,9]}],\"skins\":[{\"joints\":[0,1],\"inverseBindMatrices\":6}],"
	    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":2,\"JOINTS_0\":4,\"WEIGHTS_0\":5},\"indices\":"
	    "3}]}]");
	const double m[3][4] = {{0.01, 0, 0, 0}, {0, 0.01, 0, 3}, {0, 0, 0.01, 0}};
	double points[8][3];
	cube_through(m, points);
	double farthest = farthest_from(&scene.objects[0], &scene.objects[0].rest, points);
	printf("skinned cube of 1 cm: corners within %.2g m\n", farthest);
	assert_true(farthest < 1e-6);
	check_tells(&scene, "skins are read as they are at rest");
	engine_scene_free(&scene);
}

static void morph_targets_stand_at_their_weights(void **state)
{
	(void)state;
	static const float lift[4][3] = {{0, 0, 4}, {0, 0, 4}, {0, 0, 4}, {0, 0, 4}};
	begin();
	ADD_FLOATS(lift, 4, "VEC3");
	engine_scene scene = load_kind(
	    "\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"weights\":[0.5]}],\"meshes\":[{\"weights\":[0.25],"
	    "\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"targets\":[{\"POSITION\":4}]}]}]");
	for (int k = 0; k < 2; k++) {
		double at[3];
		to_world(&scene.objects[k].rest, scene.objects[k].mesh.positions, at);
		assert_true(fabs(at[2] - (k ? 2 : 1)) < 1e-6);
	}
	engine_scene_free(&scene);
}

/* The mesh of object 0 as it follows its joints and targets, in the world; how many of its vertices are at none of the
 * points. */
static uint32_t count_astray(const engine_scene *scene, double time_s, const double (*points)[3], int count)
{
	const engine_scene_object *object = &scene->objects[0];
	engine_followers followers;
	engine_pose pose;
	float moved[3 * 16];
	uint32_t astray = 0;
	assert_true(object->deforms && object->mesh.vertex_count <= 16);
	assert_true(engine_scene_follow(scene, 0, object->mesh.positions, object->mesh.vertex_count, &followers));
	engine_scene_shape(scene, 0, &followers, time_s, moved);
	assert_true(engine_scene_pose(scene, 0, time_s, &pose));
	for (uint32_t v = 0; v < object->mesh.vertex_count; v++) {
		double at[3], nearest = INFINITY;
		to_world(&pose, moved + 3 * v, at);
		for (int k = 0; k < count; k++)
			nearest = fmin(nearest,
				       hypot(hypot(at[0] - points[k][0], at[1] - points[k][1]), at[2] - points[k][2]));
		astray += nearest > 3e-6; /* floats of up to 12 */
	}
	engine_followers_free(&followers);
	return astray;
}

/* Half of the weight is on a joint that stays, half on one that goes, grows and turns; points far from the origin. */
static void skins_move(void **state)
{
	(void)state;
	static const float times[2] = {0, 2}, places[2][3] = {{0, 3, 0}, {8, 3, 0}},
			   turns[2][4] = {{0, 0, 0, 1}, {0, .70710678f, 0, .70710678f}};
	static uint8_t joints[8][4];
	static float weights[8][4], inverse[2][16];
	for (int v = 0; v < 8; v++) {
		weights[v][0] = weights[v][1] = .5f;
		joints[v][1] = 1;
	}
	for (int i = 0; i < 16; i += 5)
		inverse[0][i] = inverse[1][i] = 1;
	begin();
	add(joints, sizeof joints, UNSIGNED_BYTE, 8, "VEC4", "");
	ADD_FLOATS(weights, 8, "VEC4");
	ADD_FLOATS(inverse, 2, "MAT4");
	ADD_FLOATS(times, 2, "SCALAR");
	ADD_FLOATS(places, 2, "VEC3");
	ADD_FLOATS(turns, 2, "VEC4");
	engine_scene scene = load_kind(
	    "\"nodes\":[{\"translation\":[10,0,0]},{\"scale\":[2,2,2],\"translation\":[0,3,0]},"
	    "{\"mesh\":0,\"skin\":0,\"translation\":[9,9,9]}],\"skins\":[{\"joints\":[0,1],\"inverseBindMatrices\":6}],"
	    "\"animations\":[{\"samplers\":[{\"input\":7,\"output\":8},{\"input\":7,\"output\":9}],\"channels\":["
	    "{\"sampler\":0,\"target\":{\"node\":1,\"path\":\"translation\"}},"
	    "{\"sampler\":1,\"target\":{\"node\":1,\"path\":\"rotation\"}}]}],"
	    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":2,\"JOINTS_0\":4,\"WEIGHTS_0\":5},\"indices\":"
	    "3}]}]");
	check_tells(&scene, "");
	assert_false(scene.objects[0].animated);
	assert_true(scene.duration_s == 2);
	for (int k = 0; k <= 2; k++) {
		/* (1 + 2 turned) / 2, by 0, 45 and 90 degrees about y. */
		const double angle = k * .78539816339745, c = cos(angle), s = sin(angle);
		const double m[3][4] = {{.5 + c, 0, s, 5 + 2 * k}, {0, 1.5, 0, 1.5}, {-s, 0, .5 + c, 0}};
		double points[8][3];
		cube_through(m, points);
		assert_int_equal(count_astray(&scene, k, (const double(*)[3])points, 8), 0);
	}
	engine_scene_free(&scene);
}

/* Weights of two targets, on a node that mirrors, one that shears and one that does neither. */
static void morph_targets_move(void **state)
{
	(void)state;
	static const float times[2] = {0, 1}, lift[4][3] = {{0, 0, 4}, {0, 0, 4}, {0, 0, 4}, {0, 0, 4}},
			   pull[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0}},
			   keys[2][2] = {{.5f, 0}, {.25f, 1}};
	static const struct {
		const char *place;
		double m[3][4];
	} nodes[3] = {{"\"translation\":[1,2,3]", {{1, 0, 0, 1}, {0, 1, 0, 2}, {0, 0, 1, 3}}},
		      {"\"scale\":[-1,1,2]", {{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 2, 0}}},
		      {"\"matrix\":[1,0,0,0,0.5,1,0,0,0,0,1,0,2,0,0,1]", {{1, .5, 0, 2}, {0, 1, 0, 0}, {0, 0, 1, 0}}}};
	for (int n = 0; n < 3; n++) {
		static char members[2048];
		begin();
		ADD_FLOATS(lift, 4, "VEC3");
		ADD_FLOATS(pull, 4, "VEC3");
		ADD_FLOATS(times, 2, "SCALAR");
		ADD_FLOATS(keys, 4, "SCALAR");
		snprintf(
		    members, sizeof members,
		    "\"nodes\":[{\"mesh\":0,%s}],\"animations\":[{\"samplers\":[{\"input\":6,\"output\":7}],"
		    "\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"weights\"}}]}],"
		    "\"meshes\":[{\"weights\":[0.25,0],\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,"
		    "\"targets\":[{\"POSITION\":4},{\"POSITION\":5}]}]}]",
		    nodes[n].place);
		engine_scene scene = load_kind(members);
		for (int k = 0; k <= 2; k++) {
			const double t = k / 2., lifted = 4 * (.5 - .25 * t), pulled = t;
			double points[4][3];
			for (int v = 0; v < 4; v++) {
				const double p[3] = {(1 + pulled) * (v == 1 || v == 2), (1 + 2 * pulled) * (v >= 2),
						     lifted};
				for (int row = 0; row < 3; row++)
					points[v][row] = nodes[n].m[row][0] * p[0] + nodes[n].m[row][1] * p[1] +
							 nodes[n].m[row][2] * p[2] + nodes[n].m[row][3];
			}
			assert_int_equal(count_astray(&scene, t, (const double(*)[3])points, 4), 0);
		}
		engine_scene_free(&scene);
	}
}

/* Sixteen count, a seventeenth is told; one that is too short for its mesh is told too. */
static void left_out_morph_targets_are_told(void **state)
{
	(void)state;
	static const float lift[4][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
	char targets[800] = "", ones[80] = "", members[1200];
	for (int k = 1; k <= 17; k++) {
		strcat(targets, k > 1 ? ",{\"POSITION\":4}" : "{\"POSITION\":4}");
		strcat(ones, k > 1 ? ",1" : "1");
		begin();
		ADD_FLOATS(lift, k == 1 ? 3 : 4, "VEC3");
		snprintf(members, sizeof members,
			 "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"weights\":[%s],\"primitives\":[{\"attributes\":{"
			 "\"POSITION\":0},\"indices\":1,\"targets\":[%s]}]}]",
			 ones, targets);
		check_kind(members, 1,
			   k == 1   ? "attributes POSITION are left out: it has fewer elements than there are positions"
			   : k > 16 ? "morph targets beyond 16 active ones are left out"
				    : "");
	}
}

/* A mesh is read without what of it cannot be, and that is told. */
static void broken_attributes_are_told(void **state)
{
	(void)state;
	static const float three[3][3] = {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}};
	begin();
	ADD_FLOATS(three, 3, "VEC3");
	check_kind(
	    "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"COLOR_0\":4},"
	    "\"indices\":1}]}]",
	    1, "attributes COLOR_0 are left out: it has fewer elements than there are positions");
	check_kind("\"nodes\":[{\"mesh\":0,\"skin\":0}],\"skins\":[{\"joints\":[0]}],\"meshes\":[{\"primitives\":[{"
		   "\"attributes\":{\"POSITION\":0,\"JOINTS_0\":4,\"WEIGHTS_0\":99},\"indices\":1}]}]",
		   1, "attributes WEIGHTS_0 are left out: an accessor is missing");
	check_kind("\"nodes\":[{\"mesh\":0}],\"extensionsRequired\":[\"FOO_bar\"]," MESHES, 1,
		   "extensions that the file requires are not read (\"FOO_bar\")");
}

/* Sparse numbers out of order would be looked for in vain: another shape, without a word. */
static void sparse_numbers_must_rise(void **state)
{
	(void)state;
	static const uint16_t falling[2] = {2, 1}, same[2] = {1, 1};
	static const float corners[2][3] = {{0, 1, 0}, {1, 0, 0}};
	for (int k = 0; k < 2; k++) {
		begin();
		add(k ? same : falling, sizeof same, UNSIGNED_SHORT, 2, "SCALAR", "");
		ADD_FLOATS(corners, 2, "VEC3");
		size_t used = strlen(accessors);
		snprintf(accessors + used, sizeof accessors - used,
			 ",{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{\"count\":2,\"indices\":{"
			 "\"bufferView\":4,\"componentType\":5123},\"values\":{\"bufferView\":5}}}");
		check_kind("\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[" SQUARE
			   ",{\"attributes\":{\"POSITION\":6}}]}]",
			   1, "parts of meshes are left out: a sparse accessor's indices do not rise");
	}
}

/* The square with its third corner moved to (3, 3, 0), and one that has no bytes but for two corners. */
static void sparse_accessors(void **state)
{
	(void)state;
	static const uint16_t third[1] = {2}, two[2] = {1, 2};
	static const float moved[1][3] = {{3, 3, 0}}, corners[2][3] = {{1, 0, 0}, {0, 1, 0}};
	begin();
	add(third, sizeof third, UNSIGNED_SHORT, 1, "SCALAR", "");
	ADD_FLOATS(moved, 1, "VEC3");
	add(two, sizeof two, UNSIGNED_SHORT, 2, "SCALAR", "");
	ADD_FLOATS(corners, 2, "VEC3");
	size_t used = strlen(accessors);
	snprintf(accessors + used, sizeof accessors - used,
		 ",{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"sparse\":{\"count\":1,"
		 "\"indices\":{"
		 "\"bufferView\":4,\"componentType\":5123},\"values\":{\"bufferView\":5}}},"
		 "{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{\"count\":2,\"indices\":{"
		 "\"bufferView\":6,\"componentType\":5123},\"values\":{\"bufferView\":7}}}");
	engine_scene scene = load_kind(
	    "\"nodes\":[{\"mesh\":0},{\"mesh\":1}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":8},"
	    "\"indices\":1}]},{\"primitives\":[{\"attributes\":{\"POSITION\":9}}]}]");
	assert_int_equal(scene.object_count, 2);
	printf("areas of sparse meshes: %g of 3, %g of 0.5\n", area_of(&scene.objects[0]), area_of(&scene.objects[1]));
	assert_true(fabs(area_of(&scene.objects[0]) - 3) < 1e-6);
	assert_true(fabs(area_of(&scene.objects[1]) - 0.5) < 1e-6);
	engine_scene_free(&scene);
}

/* KHR_mesh_quantization: the square in 1/32767ths. */
static void quantized_positions(void **state)
{
	(void)state;
	static const int16_t square[4][4] = {{0, 0, 0, 0}, {32767, 0, 0, 0}, {32767, 32767, 0, 0}, {0, 32767, 0, 0}};
	begin();
	int accessor = add(square, sizeof square, SHORT, 4, "VEC3", ",\"normalized\":true");
	char *view = strstr(views, "\"byteOffset\":"); /* the stride belongs to the last view */
	for (char *next = view; (next = strstr(next + 1, "\"byteOffset\":"));)
		view = next;
	memmove(view + 15, view, strlen(view) + 1);
	memcpy(view, "\"byteStride\":8,", 15);
	assert_int_equal(accessor, 4);
	engine_scene scene =
	    load_kind("\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":4},"
		      "\"indices\":1}]}],\"extensionsRequired\":[\"KHR_mesh_quantization\"]");
	assert_true(fabs(area_of(&scene.objects[0]) - 1) < 1e-6);
	check_tells(&scene, "");
	engine_scene_free(&scene);
}

/* Coordinates of a map, 500 km east and 4,100 km north: taken to the middle before they become floats. */
static void map_coordinates_keep_their_digits(void **state)
{
	(void)state;
	begin();
	engine_scene scene = load_kind(
	    "\"nodes\":[{\"mesh\":1,\"translation\":[500000.125,20,-4100000.375]},{\"mesh\":1,\"translation\":"
	    "[500003.375,20,-4100000.125],\"scale\":[0.01,0.01,0.01]},{\"camera\":0,\"translation\":[500001,21,"
	    "-4099999.75]}]," MESHES ",\"cameras\":[{\"perspective\":{\"yfov\":1}}]");
	const engine_pose *a = &scene.objects[0].rest, *b = &scene.objects[1].rest;
	engine_scene_camera camera;
	assert_true(engine_scene_camera_at(&scene, 0, &camera));
	printf("moved by %.0f %.0f %.0f m: 3.25 m apart became %.7f\n", scene.origin[0], scene.origin[1],
	       scene.origin[2], (double)(b->translation[0] - a->translation[0]));
	CHECK3(((const float[3]){b->translation[0] - a->translation[0], b->translation[1] - a->translation[1],
				 b->translation[2] - a->translation[2]}),
	       3.25f, 0, 0.25f);
	CHECK3(((const float[3]){camera.eye[0] - a->translation[0], camera.eye[1] - a->translation[1],
				 camera.eye[2] - a->translation[2]}),
	       0.875f, 1, 0.625f);
	assert_true(fabs(scene.origin[0] + (double)a->translation[0] - 500000.125) < 1e-6);
	check_tells(&scene, "far from the origin");
	engine_scene_free(&scene);
}

/* A mesh whose own positions are far from its zero, brought back by its node. */
static void meshes_far_from_their_own_zero(void **state)
{
	(void)state;
	static const int32_t east = 4000000;
	float far[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
	for (int v = 0; v < 4; v++)
		far[v][0] += (float)east;
	begin();
	ADD_FLOATS(far, 4, "VEC3");
	engine_scene scene =
	    load_kind("\"nodes\":[{\"mesh\":0,\"translation\":[-4000000.125,0,0]}],\"meshes\":[{\"primitives\":[{"
		      "\"attributes\":{\"POSITION\":4},\"indices\":1}]}]");
	engine_mesh world;
	float least = 1, most = 0;
	assert_true(engine_scene_merge(&scene, &world, message, sizeof message));
	for (uint32_t v = 0; v < world.vertex_count; v++) {
		least = fminf(least, world.positions[3 * v]);
		most = fmaxf(most, world.positions[3 * v]);
	}
	printf("square at 4,000 km moved back by as much and 1/8: x from %g to %g\n", (double)least, (double)most);
	assert_true(least == -0.125f && most == 0.875f);
	engine_mesh_free(&world);
	engine_scene_free(&scene);
}

/* ---- materials --------------------------------------------------------------------------------------------------- */

#define BLACK "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGNgYGAAAAAEAAH2FzhVAAAAAElFTkSuQmCC"
#define HALF_WHITE "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAAD0lEQVR4nGP4//8/AwMDAA74Av7Ji4P1AAAAAElFTkSuQmCC"
#define GREY_188                                                                                                       \
	"/9j/4AAQSkZJRgABAQAAAQABAAD/"                                                                                 \
	"2wBDAAIBAQEBAQIBAQECAgICAgQDAgICAgUEBAMEBgUGBgYFBgYGBwkIBgcJBwYGCAsICQoKCgoKBggLDA"                           \
	"sKDAkKCgr/wAALCAAIAAgBAREA/8QAFAABAAAAAAAAAAAAAAAAAAAACP/EABQQAQAAAAAAAAAAAAAAAAAAAAD/2gAIAQEAAD8AeD//2Q=="

/* 188 of 255 in grey, however it is stored; the last two PNG say other gammas and a palette. */
#define GREY_PNG "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR42mPYAwAAvgC9frpVRgAAAABJRU5ErkJggg=="
#define GREY_ALPHA_PNG "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAQAAAC1HAwCAAAAC0lEQVR42mPYkwIAAd8BISgeu2EAAAAASUVORK5CYII="
#define RGB_16_PNG "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABEAIAAADA54+dAAAAC0lEQVR42mPYAwYAD3MEaWmKYZsAAAAASUVORK5CYII="
#define RGBA_16_PNG "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABEAYAAABPhRjKAAAADUlEQVR42mPYAwacnAAYYAR7UpQlyAAAAABJRU5ErkJggg=="
#define LINEAR_PNG                                                                                                     \
	"iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAABGdBTUEAAYagMeiWXwAAAAxJREFUeNpj2LNnDwAEbAI1XRHvIAAAAABJRU5E" \
	"rkJggg=="
#define PALETTE_PNG                                                                                                    \
	"iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAMAAAAoyzS7AAAABlBMVEUAAAC8vLzjhKCoAAAAAnRSTlMAKEMmZcIAAAAKSURBVHjaY2AEAAAD" \
	"AALmfadnAAAAAElFTkSuQmCC"
#define PROGRESSIVE_JPEG                                                                                               \
	"/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAAMCAgICAgMCAgIDAwMDBAYEBAQEBAgGBgUGCQgKCgkICQkKDA8MCgsOCwkJDRENDg8Q"         \
	"EBEQCgwSExIQEw8QEBD/wgALCAAIAAgBAREA/8QAFAABAAAAAAAAAAAAAAAAAAAAB//aAAgBAQAAAAFQ/8QAFBABAAAAAAAAAAAA"         \
	"AAAAAAAAAP/aAAgBAQABBQJ//8QAFBABAAAAAAAAAAAAAAAAAAAAAP/aAAgBAQAGPwJ//8QAFBABAAAAAAAAAAAAAAAAAAAAAP/a"         \
	"AAgBAQABPyF//9oACAEBAAAAEH//xAAUEAEAAAAAAAAAAAAAAAAAAAAA/9oACAEBAAE/EH//2Q=="
#define CMYK_JPEG                                                                                                      \
	"/9j/7gAOQWRvYmUAZAAAAAAC/9sAQwACAQEBAQECAQEBAgICAgIEAwICAgIFBAQDBAYFBgYGBQYGBgcJCAYHCQcGBggLCAkKCgoK"         \
	"CgYICwwLCgwJCgoK/9sAQwECAgICAgIFAwMFCgcGBwoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoKCgoK"         \
	"CgoKCgoK/8AAFAgACAAIBAERAAIRAQMRAQQRAP/EABUAAQEAAAAAAAAAAAAAAAAAAAgK/8QAFBABAAAAAAAAAAAAAAAAAAAAAP/E"         \
	"ABQBAQAAAAAAAAAAAAAAAAAAAAD/xAAUEQEAAAAAAAAAAAAAAAAAAAAA/9oADgQBAAIRAxEEAAA/AJ/wPB//2Q=="

static void check_emits(const char *image, float expected, const char *words)
{
	char members[4096];
	begin();
	snprintf(
	    members, sizeof members,
	    PAINTED(",\"emissiveFactor\":[1,1,0],\"emissiveTexture\":{\"index\":0},\"extensions\":{"
		    "\"KHR_materials_emissive_strength\":{\"emissiveStrength\":4}}") ",\"textures\":[{\"source\":0}],"
										     "\"images\":[{\"uri\":\"%s\"}]",
	    image);
	engine_scene scene = load_kind(members);
	printf("emissive texture: L %g of %g\n", (double)scene.materials[0].radiance[0], (double)expected);
	check_floats(scene.materials[0].radiance, (const float[3]){expected, expected, 0}, 3, 0.01f);
	check_tells(&scene, words);
	engine_scene_free(&scene);
}

/* In linear light: 188 of 255 is about a half. */
static void emissive_textures_are_read(void **state)
{
	(void)state;
	check_emits("data:image/png;base64," BLACK, 0, "");
	check_emits("data:image/png;base64," HALF_WHITE, 2, "");
	check_emits("data:image/jpeg;base64," GREY_188, 2.01f, "");
	check_emits("data:image/png;base64," GREY_PNG, 2.01f, "");
	check_emits("data:image/png;base64," GREY_ALPHA_PNG, 2.01f, "");
	check_emits("data:image/png;base64," RGB_16_PNG, 2.01f, "");
	check_emits("data:image/png;base64," RGBA_16_PNG, 2.01f, "");
	check_emits("data:image/png;base64," LINEAR_PNG, 2.01f, "");
	check_emits("data:image/png;base64," PALETTE_PNG, 2.01f, "");
	check_emits("data:image/jpeg;base64," PROGRESSIVE_JPEG, 2.01f, "");
	check_emits("data:image/jpeg;base64," CMYK_JPEG, 2.01f, "");
	check_emits("data:image/webp;base64,UklGRgAAAABXRUJQ", 4, "it is neither PNG nor JPEG");
	check_emits("data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGNg", 4, "cut off");
	check_emits("../../../../etc/passwd", 4, "emissive textures are left out: lies outside");
	check_emits("none.png", 4, "emissive textures are left out: cannot be opened");
}

/* Corners keep their coordinates; the factor stays apart from the picture. */
static void textures_come_with_their_coordinates(void **state)
{
	(void)state;
	static const float uvs[4][2] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
	begin();
	ADD_FLOATS(uvs, 4, "VEC2");
	engine_scene scene = load_kind(
	    "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_1\":4},"
	    "\"indices\":1,\"material\":0}]}],\"materials\":[{\"pbrMetallicRoughness\":{\"metallicFactor\":0,"
	    "\"baseColorFactor\":[0.5,1,1,1],\"baseColorTexture\":{\"index\":0,\"texCoord\":1,\"extensions\":{"
	    "\"KHR_texture_transform\":{\"offset\":[0.25,0],\"scale\":[2,1]}}}}}],\"textures\":[{\"source\":0,"
	    "\"sampler\":0}],\"samplers\":[{\"wrapS\":33071}],"
	    "\"images\":[{\"uri\":\"data:image/png;base64," HALF_WHITE "\"}]");
	const engine_mesh *mesh = &scene.objects[0].mesh;
	const engine_scene_material *m = &scene.materials[0];
	check_tells(&scene, "");
	assert_true(scene.texture_count == 1 && scene.textures[0].pixels.width == 2 && m->rho_texture.number == 1);
	check_floats(m->rho, (const float[3]){.25f, .5f, .5f}, 3, 1e-5f);
	check_floats(m->rho_factor, (const float[3]){.5f, 1, 1}, 3, 1e-5f);
	check_floats(m->rho_texture.transform[0], (const float[6]){2, 0, .25f, 0, 1, 0}, 6, 1e-6f);
	assert_true(m->rho_texture.wrap[0] == ENGINE_WRAP_CLAMP && m->rho_texture.wrap[1] == ENGINE_WRAP_REPEAT);
	assert_true(mesh->face_count == 2 && mesh->uvs);
	for (uint32_t k = 0; k < mesh->index_count; k++) {
		const float *p = mesh->positions + 3 * mesh->indices[k];
		check_floats(mesh->uvs + 2 * k, (const float[2]){p[0], 1 - p[1]}, 2, 1e-6f);
	}
	engine_scene_free(&scene);
}

static void faces_of_little_alpha_let_light_through(void **state)
{
	(void)state;
	static const char left_out[] = "faces that let light through (alpha below a half) are left out (2, first: ";
	begin();
	check_kind(
	    PAINTED(",\"alphaMode\":\"BLEND\",\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorFactor\":"
		    "[0.9,0.9,0.9,0]}"),
	    1, left_out);
	check_kind(
	    PAINTED(",\"alphaMode\":\"BLEND\",\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorFactor\":"
		    "[0.9,0.9,0.9,0.4]}"),
	    1, left_out);
	check_kind(
	    PAINTED(",\"alphaMode\":\"BLEND\",\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorFactor\":"
		    "[0.9,0.9,0.9,0.6]}"),
	    2, "taken as opaque");
	check_kind(PAINTED(",\"alphaMode\":\"MASK\",\"alphaCutoff\":0.8,\"pbrMetallicRoughness\":{\"metallicFactor\":0,"
			   "\"baseColorFactor\":[0.9,0.9,0.9,0.6]}"),
		   1, left_out);
	/* without a mode alpha has no meaning */
	check_kind(PAINTED(",\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorFactor\":[0.9,0.9,0.9,0]}"), 2,
		   "");
}

static void check_smooth(const char *members, const float rho[3], const float mirror[3], const float glass[3],
			 float index)
{
	engine_scene scene = load_kind(members);
	const engine_scene_material *m = &scene.materials[scene.objects[0].mesh.face_materials[0]];
	for (int c = 0; c < 3; c++) {
		assert_float_equal(m->rho[c], rho[c], 1e-6);
		assert_float_equal(m->mirror[c], mirror[c], 1e-6);
		assert_float_equal(m->glass[c], glass[c], 1e-6);
		assert_true(m->rho[c] + m->mirror[c] <= 1 && m->rho[c] + m->glass[c] <= 1);
	}
	assert_float_equal(m->index, index, 1e-6);
	check_tells(&scene, "");
	engine_scene_free(&scene);
}

static void smooth_metals_are_mirrors_and_what_transmits_is_glass(void **state)
{
	(void)state;
	static const float none[3] = {0, 0, 0}, white[3] = {1, 1, 1};
	begin();
	check_smooth(PAINTED(",\"pbrMetallicRoughness\":{\"roughnessFactor\":0.05,\"baseColorFactor\":[1,0.8,0.4,1]}"),
		     none, (float[]){1, .8f, .4f}, none, 0);
	check_smooth(PAINTED(",\"pbrMetallicRoughness\":{\"roughnessFactor\":0,\"metallicFactor\":0.25,"
			     "\"baseColorFactor\":[0.8,0.8,0.4,1]}"),
		     (float[]){.6f, .6f, .3f}, (float[]){.2f, .2f, .1f}, none, 0);
	check_smooth(PAINTED(",\"pbrMetallicRoughness\":{\"roughnessFactor\":0,\"metallicFactor\":0,"
			     "\"baseColorFactor\":[1,1,1,1]},\"extensions\":{\"KHR_materials_transmission\":{"
			     "\"transmissionFactor\":1},\"KHR_materials_ior\":{\"ior\":1.33}}"),
		     none, none, white, 1.33f);
	check_smooth(PAINTED(",\"pbrMetallicRoughness\":{\"roughnessFactor\":0,\"metallicFactor\":0,"
			     "\"baseColorFactor\":[0.5,2,1,1]},\"extensions\":{\"KHR_materials_transmission\":{"
			     "\"transmissionFactor\":0.5},\"KHR_materials_ior\":{\"ior\":0}}"),
		     (float[]){.25f, .5f, .5f}, none, (float[]){.25f, .5f, .5f}, 1);
}

static void what_is_not_read_is_told(void **state)
{
	(void)state;
	begin();
	check_kind(PAINTED(",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.9,0.6,0.3,1]}"), 2,
		   "rough metals are taken as diffuse");
	check_kind(PAINTED(",\"pbrMetallicRoughness\":{\"metallicFactor\":0}"), 2, "");
	check_kind(PAINTED(",\"extensions\":{\"KHR_materials_unlit\":{}}"), 2,
		   "uses of KHR_materials_unlit are not read (\"paint\")");
	check_kind(PAINTED(",\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1}}"), 2,
		   "rough glass is taken as clear");
	check_kind(PAINTED(",\"extensions\":{\"KHR_materials_volume\":{}}"), 2,
		   "uses of KHR_materials_volume are not read");
	check_kind(PAINTED(",\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{\"diffuseFactor\":[0.1,0.2,0.3,1]"
			   "}}"),
		   2, "");
	check_kind(
	    PAINTED(",\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{\"specularFactor\":[0.9,0.5,0.5]}}"), 2,
	    "specular colours of the specular-glossiness model are not read");
	check_kind(PAINTED(",\"normalTexture\":{\"index\":0}"), 2, "textures of roughness, metal and normals");
	check_kind(
	    PAINTED(",\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorTexture\":{\"index\":0,\"extensions\":{"
		    "\"KHR_texture_transform\":{\"scale\":[2,2]}}}}"),
	    2, "textures of base colours are left out: the texture names no image (\"paint\")");
	check_told(finish("\"nodes\":[{\"camera\":0}],\"cameras\":[{\"perspective\":{\"yfov\":1}}]"),
		   "the file holds no faces");
}

/* White counts once however often, and not at all where no face has it. */
static void white_is_told_once(void **state)
{
	(void)state;
	engine_scene scene;
	char *end;
	begin();
	check_kind("\"nodes\":[{\"mesh\":0}]," MESHES ",\"materials\":[{\"pbrMetallicRoughness\":{\"metallicFactor\":0,"
		   "\"baseColorFactor\":[1,1,1,1]}}]",
		   1, "");
	scene = load_kind(
	    "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":0},"
	    "{\"attributes\":{\"POSITION\":2},\"material\":1},{\"attributes\":{\"POSITION\":2},\"material\":1}]}],"
	    "\"materials\":[{\"name\":\"chalk\",\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorFactor\":"
	    "[1,1,1,1]}},{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorFactor\":[1,0.2,0.2,1]}}]");
	check_tells(&scene, "get 0.98 (nothing gives back all light) (2, first: \"chalk\")");
	end = strstr(scene.warning, "0.98");
	assert_null(strstr(end + 1, "0.98"));
	CHECK3(scene.materials[1].rho, 0.98f, 0.2f, 0.2f);
	engine_scene_free(&scene);
}

/* Red at three corners, green at the fourth: the triangle of red ones is red. A primitive without colours has none. */
static void colours_of_vertices_are_read(void **state)
{
	(void)state;
	static const uint8_t colors[4][4] = {{255, 0, 0, 255}, {255, 0, 0, 255}, {255, 0, 0, 255}, {0, 255, 0, 255}};
	begin();
	add(colors, sizeof colors, UNSIGNED_BYTE, 4, "VEC4", ",\"normalized\":true");
	engine_scene scene = load_kind("\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{"
				       "\"POSITION\":0,\"COLOR_0\":4},\"indices\":1,"
				       "\"material\":0},{\"attributes\":{\"POSITION\":2},\"material\":0}]}],"
				       "\"materials\":[{\"pbrMetallicRoughness\":{"
				       "\"metallicFactor\":0,\"baseColorFactor\":[0.8,0.8,0.8,1]}}]");
	const engine_mesh *mesh = &scene.objects[0].mesh;
	CHECK_FACE(&scene, 0, 0.8f, 0, 0);
	CHECK_FACE(&scene, 1, 0.8f * 2 / 3, 0.8f / 3, 0);
	check_tells(&scene, "");
	assert_true(mesh->face_count == 4 && mesh->colors[4 * 6] < 0);
	engine_scene_free(&scene);
}

/* Where the file gives no factor, colours are times 1; alpha of vertices counts as that of pictures does. */
static void colours_of_vertices_without_a_factor(void **state)
{
	(void)state;
	static const float colors[4][4] = {{.5f, .25f, 0, .4f}, {.5f, .25f, 0, .4f}, {.5f, .25f, 0, .6f}, {1, 1, 1, 1}};
	static const char *const modes[] = {"", ",\"alphaMode\":\"MASK\"",
					    ",\"alphaMode\":\"MASK\",\"alphaCutoff\":0.45"};
	static const uint32_t faces[] = {2, 1, 2};
	for (int k = 0; k < 3; k++) {
		char text[512];
		begin();
		ADD_FLOATS(colors, 4, "VEC4");
		snprintf(text, sizeof text,
			 "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"
			 "\"COLOR_0\":4},\"indices\":1,\"material\":0}]}],\"materials\":[{\"pbrMetallicRoughness\":{"
			 "\"metallicFactor\":0}%s}]",
			 modes[k]);
		engine_scene scene = load_kind(text);
		assert_int_equal(scene.objects[0].mesh.face_count, faces[k]);
		if (faces[k] == 2)
			CHECK_FACE(&scene, 0, .5f, .25f, 0);
		else
			CHECK_FACE(&scene, 0, 2.0f / 3, .5f, 1.0f / 3);
		engine_scene_free(&scene);
	}
}

/* ---- files that mean harm ---------------------------------------------------------------------------------------- */

/* Seconds of processor time to load, printed; nothing is asked of them. */
static double time_to_load(const char *path, const char *what)
{
	engine_scene scene;
	clock_t began = clock();
	bool loaded = engine_scene_load(path, &scene, message, sizeof message);
	double seconds = (double)(clock() - began) / CLOCKS_PER_SEC;
	printf("%s: %s after %.3f s%s%s\n", what, loaded ? "read" : "refused", seconds, loaded ? "" : ": ",
	       loaded ? "" : message);
	engine_scene_free(&scene);
	return seconds;
}

/* A chain of nodes, each scaled by one animation of 500 keys, with an object at every one of the last. */
static void long_chains(void **state)
{
	(void)state;
	enum { NODES = 3000, KEYS = 500 };
	static float times[KEYS];
	static uint8_t scales[KEYS][4];
	for (int k = 0; k < KEYS; k++) {
		times[k] = (float)k;
		scales[k][0] = scales[k][1] = scales[k][2] = 1;
	}
	begin();
	ADD_FLOATS(times, KEYS, "SCALAR");
	add(scales, sizeof scales, UNSIGNED_BYTE, KEYS, "VEC4", "");
	char *members = malloc(1 << 19);
	assert_non_null(members);
	size_t used = (size_t)sprintf(members, "\"nodes\":[");
	for (int n = 0; n < NODES; n++)
		used += (size_t)sprintf(members + used, "%s{\"mesh\":0,\"children\":[%d]}", n ? "," : "", n + 1);
	used += (size_t)sprintf(members + used,
				",{}],%s,\"animations\":[{\"samplers\":[{\"input\":4,\"output\":5}],\"channels\":[",
				MESHES);
	for (int n = 0; n < NODES; n++)
		used +=
		    (size_t)sprintf(members + used, "%s{\"sampler\":0,\"target\":{\"node\":%d,\"path\":\"rotation\"}}",
				    n ? "," : "", n);
	sprintf(members + used, "]}]");
	engine_scene scene = load_kind(members);
	assert_int_equal(scene.object_count, NODES);
	assert_true(scene.objects[NODES - 1].animated);
	engine_scene_free(&scene);
	time_to_load(path_of("kinds.gltf"), "a chain of 3,000 animated nodes, each an object");
	free(members);
}

/* 200 nodes, a mesh of 300 primitives, each the same 3,000 corners. */
static void copies_without_end_are_refused(void **state)
{
	(void)state;
	static float strip[3000][3];
	for (int v = 0; v < 3000; v++) {
		strip[v][0] = (float)(v / 2);
		strip[v][1] = (float)(v % 2);
	}
	begin();
	ADD_FLOATS(strip, 3000, "VEC3");
	char *members = malloc(1 << 16);
	assert_non_null(members);
	size_t used = (size_t)sprintf(members, "\"nodes\":[");
	for (int n = 0; n < 200; n++)
		used += (size_t)sprintf(members + used, "%s{\"mesh\":0}", n ? "," : "");
	used += (size_t)sprintf(members + used, "],\"meshes\":[{\"primitives\":[");
	for (int p = 0; p < 300; p++)
		used += (size_t)sprintf(members + used, "%s{\"attributes\":{\"POSITION\":4},\"mode\":5}", p ? "," : "");
	sprintf(members + used, "]}]");
	const char *path = finish(members);
	check_refused(path, "they need 13 GB (5396");
	time_to_load(path, "540 million corners from 30 kB");
	free(members);
}

/* The file outside is there, and large enough. */
static void buffers_stay_in_the_folder(void **state)
{
	(void)state;
	static const char *const names[] = {"../secret.bin", "..%2fsecret.bin", "%2e%2e/secret.bin",
					    "sub/../../secret.bin"};
	char path[256], members[512];
	snprintf(path, sizeof path, "%s/sub", folder);
	assert_int_equal(mkdir(path, 0700), 0);
	write_text("secret.bin", "secret");
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		snprintf(members, sizeof members,
			 "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":4,\"uri\":\"%s\"}]}", names[i]);
		check_refused(write_text("sub/a.gltf", members),
			      i == 3 ? "cannot be opened" : "outside of the scene's folder");
	}
	check_refused(write_text("sub/a.gltf",
				 "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":4,\"uri\":"
				 "\"/etc/passwd\"}]}"),
		      "absolute");
	check_refused(write_text("sub/a.gltf",
				 "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":4,\"uri\":"
				 "\"%2fetc/passwd\"}]}"),
		      "absolute");
	check_refused(write_text("sub/a.gltf",
				 "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":4,\"uri\":"
				 "\"a%00b\"}]}"),
		      "zero byte");
	unlink(path_of("sub/a.gltf"));
	rmdir(path);
}

/* A FIFO that nobody writes to is not waited for. */
static void pipes_are_not_read(void **state)
{
	(void)state;
	assert_int_equal(mkfifo(path_of("pipe.gltf"), 0600), 0);
	check_refused(path_of("pipe.gltf"), "not a file");
	check_refused(write_text("a.gltf", "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":4,\"uri\":"
					   "\"pipe.gltf\"}]}"),
		      "not a file");
}

/* Instances, a skin, sparse values, an animation and a texture in one file, damaged a few thousand times. */
static void damaged_files_never_crash(void **state)
{
	(void)state;
	static const float places[3][3] = {{0, 0, 0}, {2, 0, 0}, {0, 0, 5}}, times[2] = {0, 1};
	static uint8_t joints[8][4];
	static float weights[8][4];
	for (int v = 0; v < 8; v++)
		weights[v][0] = 1;
	begin();
	ADD_FLOATS(places, 3, "VEC3");
	ADD_FLOATS(times, 2, "SCALAR");
	add(joints, sizeof joints, UNSIGNED_BYTE, 8, "VEC4", "");
	ADD_FLOATS(weights, 8, "VEC4");
	finish("\"nodes\":[{\"mesh\":0,\"skin\":0},{\"mesh\":1,\"extensions\":{\"EXT_mesh_gpu_instancing\":{"
	       "\"attributes\":{"
	       "\"TRANSLATION\":4}}},\"scale\":[1,2,1],\"children\":[2]},{\"mesh\":1,\"rotation\":[0,0,0.38268343,0."
	       "92387953]}],"
	       "\"skins\":[{\"joints\":[2]}],\"materials\":[{\"emissiveFactor\":[1,1,1],\"emissiveTexture\":{\"index\":"
	       "0}}],"
	       "\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"data:image/png;base64," HALF_WHITE
	       "\"}],\"animations\":[{"
	       "\"samplers\":[{\"input\":5,\"output\":4}],\"channels\":[{\"sampler\":0,\"target\":{\"node\":1,\"path\":"
	       "\"translation\"}}]}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":2,\"JOINTS_0\":6,"
	       "\"WEIGHTS_0\":7},"
	       "\"indices\":3,\"material\":0,\"targets\":[{\"POSITION\":2}]}],\"weights\":[0.5]},{\"primitives\":[" CUBE
	       "]}]");
	damage("a.gltf", (const uint8_t *)text, strlen(text), 3000);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(sheared_cubes_are_baked),
	    cmocka_unit_test(sheared_cubes_move),
	    cmocka_unit_test(turning_shears_are_told),
	    cmocka_unit_test(a_scale_of_0_hides_an_object_for_a_time),
	    cmocka_unit_test(equal_times_keep_the_last),
	    cmocka_unit_test(instances_are_objects),
	    cmocka_unit_test(skins_stand_as_at_rest),
	    cmocka_unit_test(morph_targets_stand_at_their_weights),
	    cmocka_unit_test(skins_move),
	    cmocka_unit_test(morph_targets_move),
	    cmocka_unit_test(left_out_morph_targets_are_told),
	    cmocka_unit_test(broken_attributes_are_told),
	    cmocka_unit_test(sparse_numbers_must_rise),
	    cmocka_unit_test(sparse_accessors),
	    cmocka_unit_test(quantized_positions),
	    cmocka_unit_test(map_coordinates_keep_their_digits),
	    cmocka_unit_test(meshes_far_from_their_own_zero),
	    cmocka_unit_test(emissive_textures_are_read),
	    cmocka_unit_test(textures_come_with_their_coordinates),
	    cmocka_unit_test(faces_of_little_alpha_let_light_through),
	    cmocka_unit_test(smooth_metals_are_mirrors_and_what_transmits_is_glass),
	    cmocka_unit_test(what_is_not_read_is_told),
	    cmocka_unit_test(white_is_told_once),
	    cmocka_unit_test(colours_of_vertices_are_read),
	    cmocka_unit_test(colours_of_vertices_without_a_factor),
	    cmocka_unit_test(long_chains),
	    cmocka_unit_test(copies_without_end_are_refused),
	    cmocka_unit_test(buffers_stay_in_the_folder),
	    cmocka_unit_test(pipes_are_not_read),
	    cmocka_unit_test(damaged_files_never_crash),
	};
	return cmocka_run_group_tests_name("gltf_kinds", tests, make_folder, remove_folder);
}
