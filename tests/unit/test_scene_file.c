/* Scene files: what glTF, OBJ and PLY become, which files are refused with which words, and that no damage crashes.
 *
 * Every file is written here, into a temporary folder that the group removes.
 */
#define _POSIX_C_SOURCE 200809L /* mkdtemp */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "engine/mesh_clean.h"
#include "engine/scene_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* scene.bin: what all the glTF files here take their numbers from. Offsets in bytes stand beside the fields. */
typedef struct binary {
	float square[4][3];      /*   0: unit square in z = 0, front towards +z */
	uint16_t indices[6];     /*  48: two triangles */
	float times[3];          /*  60: 0 1 2 s */
	float positions[3][3];   /*  72: translation keys */
	float rotations[3][4];   /* 108: 0, 90, 180 degrees about y */
	float bad[4][3];         /* 156: the square with a NaN */
	float cubic[9][3];       /* 204: in-tangent, value, out-tangent of three keys */
	float flat[4][3];        /* 312: all on one line */
	uint16_t far_indices[6]; /* 360: one out of range */
	float scales[3][3];      /* 372: 1, 2, 2 */
	float zero_scales[3][3]; /* 408: 1, 0, 1 */
	float times_falling[3];  /* 444 */
} binary;                        /* 456 */

static const float half = 0.70710678f;

static binary make_binary(void)
{
	return (binary){
	    .square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
	    .indices = {0, 1, 2, 0, 2, 3},
	    .times = {0, 1, 2},
	    .positions = {{0, 0, 0}, {2, 0, 0}, {2, 4, 0}},
	    .rotations = {{0, 0, 0, 1}, {0, half, 0, half}, {0, 1, 0, 0}},
	    .bad = {{0, 0, 0}, {1, NAN, 0}, {1, 1, 0}, {0, 1, 0}},
	    .cubic = {{0}, {0, 0, 0}, {3, 0, 0}, {3, 0, 0}, {2, 0, 0}, {0}, {0}, {2, 4, 0}, {0}},
	    .flat = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}},
	    .far_indices = {0, 1, 2, 0, 2, 4},
	    .scales = {{1, 1, 1}, {2, 2, 2}, {2, 2, 2}},
	    .zero_scales = {{1, 1, 1}, {0, 1, 1}, {1, 1, 1}},
	    .times_falling = {0, 2, 1},
	};
}

/* clang-format off */
#define VIEW(offset, length) "{\"buffer\":0,\"byteOffset\":" #offset ",\"byteLength\":" #length "}"
#define ACCESSOR(view, component, count, type) \
	"{\"bufferView\":" #view ",\"componentType\":" #component ",\"count\":" #count ",\"type\":\"" type "\"}"

/* Accessors: 0 square, 1 indices, 2 times, 3 positions, 4 rotations, 5 bad, 6 cubic, 7 flat, 8 far, 9 scales,
 * 10 zero scales, 11 falling times.
 */
#define ACCESSORS \
	"\"bufferViews\":[" VIEW(0, 48) "," VIEW(48, 12) "," VIEW(60, 12) "," VIEW(72, 36) "," VIEW(108, 48) "," \
	VIEW(156, 48) "," VIEW(204, 108) "," VIEW(312, 48) "," VIEW(360, 12) "," VIEW(372, 36) "," VIEW(408, 36) "," \
	VIEW(444, 12) "],\"accessors\":[" ACCESSOR(0, 5126, 4, "VEC3") "," ACCESSOR(1, 5123, 6, "SCALAR") "," \
	ACCESSOR(2, 5126, 3, "SCALAR") "," ACCESSOR(3, 5126, 3, "VEC3") "," ACCESSOR(4, 5126, 3, "VEC4") "," \
	ACCESSOR(5, 5126, 4, "VEC3") "," ACCESSOR(6, 5126, 9, "VEC3") "," ACCESSOR(7, 5126, 4, "VEC3") "," \
	ACCESSOR(8, 5123, 6, "SCALAR") "," ACCESSOR(9, 5126, 3, "VEC3") "," ACCESSOR(10, 5126, 3, "VEC3") "," \
	ACCESSOR(11, 5126, 3, "SCALAR") "]"
#define BUFFER "\"buffers\":[{\"byteLength\":456,\"uri\":\"scene%20file.bin\"}]"
#define HEAD "{\"asset\":{\"version\":\"2.0\"},"
#define TAIL "," BUFFER "," ACCESSORS "}"
#define SQUARE "{\"attributes\":{\"POSITION\":0},\"indices\":1}"
#define MESH "\"meshes\":[{\"primitives\":[" SQUARE "]}]"
#define ONE_NODE(members) HEAD "\"nodes\":[{\"mesh\":0" members "}]," MESH TAIL
#define ONE_MATERIAL(members) \
	HEAD "\"nodes\":[{\"mesh\":0}],\"materials\":[{\"name\":\"paint\"," members "}],\"meshes\":[{" \
	"\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":0}]}]" TAIL
#define ONE_PRIMITIVE(primitive) \
	HEAD "\"nodes\":[{\"mesh\":0,\"name\":\"thing\"}],\"meshes\":[{\"primitives\":[" primitive "]}]" TAIL
#define ANIMATED(path, sampler) \
	HEAD "\"nodes\":[{\"mesh\":0}],\"animations\":[{\"samplers\":[" sampler "],\"channels\":[{\"sampler\":0," \
	"\"target\":{\"node\":0,\"path\":\"" path "\"}}]}]," MESH TAIL
/* clang-format on */

static char folder[64];
static char message[512];

/* Path of a file in the temporary folder; two may be in use at once. */
static const char *path_of(const char *name)
{
	static char paths[2][256];
	static int turn;
	char *path = paths[turn ^= 1];
	snprintf(path, sizeof paths[0], "%s/%s", folder, name);
	return path;
}

static const char *write_file(const char *name, const void *bytes, size_t size)
{
	const char *path = path_of(name);
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	assert_int_equal(fwrite(bytes, 1, size, file), size);
	fclose(file);
	return path;
}

static const char *write_text(const char *name, const char *text)
{
	return write_file(name, text, strlen(text));
}

static engine_scene load(const char *path)
{
	engine_scene scene;
	message[0] = '\0';
	if (!engine_scene_load(path, &scene, message, sizeof message))
		fail_msg("%s", message);
	return scene;
}

static engine_scene load_gltf(const char *text)
{
	return load(write_text("a.gltf", text));
}

/* The file is refused with one line that has these words in it, and nothing is left in the scene. */
static void check_refused(const char *path, const char *words)
{
	engine_scene scene;
	memset(&scene, 0xff, sizeof scene);
	message[0] = '\0';
	assert_false(engine_scene_load(path, &scene, message, sizeof message));
	if (!strstr(message, words))
		fail_msg("\"%s\" does not say \"%s\"", message, words);
	assert_null(strchr(message, '\n'));
	assert_ptr_equal(strstr(message, path), message);
	assert_null(scene.objects);
	assert_int_equal(scene.object_count, 0);
}

static void check_gltf_refused(const char *text, const char *words)
{
	check_refused(write_text("a.gltf", text), words);
}

static void check_floats(const float *values, const float *expected, int count, float tolerance)
{
	for (int i = 0; i < count; i++) {
		if (!(fabsf(values[i] - expected[i]) <= tolerance))
			fail_msg("value %d is %g, not %g", i, (double)values[i], (double)expected[i]);
	}
}

#define CHECK3(values, x, y, z) check_floats(values, (const float[3]){x, y, z}, 3, 1e-5f)

static int make_folder(void **state)
{
	(void)state;
	strcpy(folder, "/tmp/relume-scene-XXXXXX");
	if (!mkdtemp(folder))
		return -1;
	binary bytes = make_binary();
	write_file("scene file.bin", &bytes, sizeof bytes);
	return 0;
}

static int remove_folder(void **state)
{
	(void)state;
	static const char *const names[] = {"scene file.bin", "a.gltf", "a.glb", "a.obj", "a.mtl", "a.ply", "a.txt"};
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		unlink(path_of(names[i]));
	return rmdir(folder);
}

/* ---- glTF: content ----------------------------------------------------------------------------------------------- */

static void a_node_becomes_an_object(void **state)
{
	(void)state;
	engine_scene scene =
	    load_gltf(ONE_NODE(",\"name\":\"wall\",\"translation\":[1,2,3],\"rotation\":[0,1,0,0],\"scale\":[2,3,4]"));
	assert_int_equal(scene.object_count, 1);
	const engine_scene_object *object = &scene.objects[0];
	assert_string_equal(object->name, "wall");
	assert_int_equal(object->mesh.face_count, 2);
	assert_int_equal(object->mesh.vertex_count, 4);
	assert_int_equal(object->scheme, ENGINE_SCHEME_BILINEAR);
	assert_int_equal(object->levels, 0);
	assert_false(object->animated || object->double_sided || scene.has_camera);
	CHECK3(object->rest.translation, 1, 2, 3);
	CHECK3(object->rest.scale, 2, 3, 4);
	assert_true(fabsf(fabsf(object->rest.rotation[1]) - 1) < 1e-6f);
	assert_int_equal(scene.material_count, 1);
	CHECK3(scene.materials[0].rho, 0.5f, 0.5f, 0.5f);
	assert_string_equal(scene.warning, "");
	engine_scene_free(&scene);
	engine_scene_free(&scene);
}

static void extras_choose_the_refinement(void **state)
{
	(void)state;
	engine_scene scene = load_gltf(ONE_NODE(",\"extras\":{\"gi\":{\"scheme\":\"catmull-clark\",\"levels\":3}}"));
	const engine_mesh *mesh = &scene.objects[0].mesh;
	assert_int_equal(scene.objects[0].scheme, ENGINE_SCHEME_CATMULL_CLARK);
	assert_int_equal(scene.objects[0].levels, 3);
	assert_int_equal(mesh->face_count, 1); /* 0 1 2 and 0 2 3 were a quad with the diagonal 0-2 */
	assert_int_equal(mesh->face_counts[0], 4);
	assert_true((mesh->indices[0] == 0 && mesh->indices[2] == 2) ||
		    (mesh->indices[0] == 2 && mesh->indices[2] == 0));
	double normal[3];
	engine_mesh_face_normal(mesh, mesh->indices, 4, normal);
	assert_true(normal[2] > 0.99);
	engine_scene_free(&scene);
	scene = load_gltf(ONE_NODE(",\"extras\":{\"gi\":{\"scheme\":\"loop\",\"levels\":1}}"));
	assert_int_equal(scene.objects[0].scheme, ENGINE_SCHEME_LOOP);
	assert_int_equal(scene.objects[0].mesh.face_count, 2);
	engine_scene_free(&scene);
	check_gltf_refused(ONE_NODE(",\"name\":\"n\",\"extras\":{\"gi\":{\"scheme\":\"butterfly\"}}"),
			   "extras.gi.scheme of node \"n\"");
	check_gltf_refused(ONE_NODE(",\"extras\":{\"gi\":{\"levels\":1.5}}"), "extras.gi.levels");
	check_gltf_refused(ONE_NODE(",\"extras\":{\"gi\":{\"levels\":99}}"), "0 to 8");
}

static void materials_are_read(void **state)
{
	(void)state;
	engine_scene scene = load_gltf(ONE_MATERIAL(
	    "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.1,0.2,0.3,1]},\"emissiveFactor\":[1,0.5,0.25],"
	    "\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":8}},\"doubleSided\":true"));
	assert_int_equal(scene.material_count, 1);
	assert_string_equal(scene.materials[0].name, "paint");
	CHECK3(scene.materials[0].rho, 0.1f, 0.2f, 0.3f);
	CHECK3(scene.materials[0].radiance, 8, 4, 2);
	assert_true(scene.materials[0].double_sided);
	assert_true(scene.objects[0].double_sided);
	engine_scene_free(&scene);
	scene = load_gltf(ONE_MATERIAL("\"emissiveFactor\":[1,1,1]"));
	CHECK3(scene.materials[0].rho, 0.5f, 0.5f, 0.5f); /* not stated */
	CHECK3(scene.materials[0].radiance, 1, 1, 1);
	engine_scene_free(&scene);
}

static void impossible_materials_are_refused(void **state)
{
	(void)state;
	check_gltf_refused(ONE_MATERIAL("\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,1]}"), "0.98");
	check_gltf_refused(ONE_MATERIAL("\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,-0.1,0.5,1]}"),
			   "\"paint\"");
	check_gltf_refused(ONE_MATERIAL("\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,1e999,0.5,1]}"), "finite");
	check_gltf_refused(ONE_MATERIAL("\"emissiveFactor\":[-1,0,0]"), "emits -1 0 0");
	check_gltf_refused(
	    ONE_MATERIAL("\"emissiveFactor\":[1,0,0],\"extensions\":{\"KHR_materials_emissive_strength\":"
			 "{\"emissiveStrength\":-2}}"),
	    "emits");
	check_gltf_refused(ONE_MATERIAL("\"emissiveFactor\":\"red\""), "emissiveFactor");
}

static void primitives_join_into_one_connected_mesh(void **state)
{
	(void)state;
	engine_scene scene = load_gltf(ONE_PRIMITIVE(
	    SQUARE ",{\"attributes\":{\"POSITION\":0},\"mode\":5},{\"attributes\":{\"POSITION\":0},\"mode\":6}"));
	const engine_mesh *mesh = &scene.objects[0].mesh;
	assert_int_equal(mesh->vertex_count, 4); /* welded */
	assert_int_equal(mesh->face_count, 6);
	assert_memory_equal(mesh->indices + 6, ((uint32_t[]){0, 1, 2, 1, 3, 2}), 24);  /* strip */
	assert_memory_equal(mesh->indices + 12, ((uint32_t[]){0, 1, 2, 0, 2, 3}), 24); /* fan */
	engine_scene_free(&scene);
}

static void names_are_unique(void **state)
{
	(void)state;
	engine_scene scene =
	    load_gltf(HEAD "\"nodes\":[{\"mesh\":0,\"name\":\"a\"},{\"mesh\":0,\"name\":\"a\"},{\"mesh\":0},"
			   "{\"mesh\":0,\"name\":\"a\\nb\"}]," MESH TAIL);
	assert_int_equal(scene.object_count, 4);
	assert_string_equal(scene.objects[0].name, "a");
	assert_string_equal(scene.objects[1].name, "a#2");
	assert_string_equal(scene.objects[2].name, "object2");
	assert_string_equal(scene.objects[3].name, "a b");
	engine_scene_free(&scene);
}

/* 5,000 nodes called "a" and one called "a#3": 42 s where each name was looked for among all. */
static void many_nodes_of_one_name(void **state)
{
	(void)state;
	enum { COUNT = 5000 };
	static const char node[] = "{\"mesh\":0,\"name\":\"a\"},";
	char *text = malloc(COUNT * sizeof node + 8192);
	assert_non_null(text);
	size_t length = (size_t)sprintf(text, HEAD "\"nodes\":[");
	for (int i = 0; i < COUNT; i++)
		length += (size_t)sprintf(text + length, i == 1 ? "{\"mesh\":0,\"name\":\"a#3\"}," : node);
	sprintf(text + length, "%s", "{}]," MESH TAIL);
	clock_t began = clock();
	engine_scene scene = load_gltf(text);
	assert_true((double)(clock() - began) / CLOCKS_PER_SEC < 5);
	free(text);
	assert_int_equal(scene.object_count, COUNT);
	assert_string_equal(scene.objects[1].name, "a#3");
	assert_string_equal(scene.objects[2].name, "a#2");
	assert_string_equal(scene.objects[3].name, "a#4");
	assert_string_equal(scene.objects[COUNT - 1].name, "a#5000");
	engine_scene_free(&scene);
}

static void only_the_chosen_scene_is_read(void **state)
{
	(void)state;
	engine_scene scene =
	    load_gltf(HEAD "\"scene\":1,\"scenes\":[{\"nodes\":[0]},{\"nodes\":[2]}],\"nodes\":["
			   "{\"mesh\":0,\"name\":\"no\"},{\"mesh\":0,\"name\":\"yes\"},{\"children\":[1]}]," MESH TAIL);
	assert_int_equal(scene.object_count, 1);
	assert_string_equal(scene.objects[0].name, "yes");
	engine_scene_free(&scene);
}

static void an_empty_scene_is_no_error(void **state)
{
	(void)state;
	engine_scene scene = load_gltf("{\"asset\":{\"version\":\"2.0\"}}");
	assert_int_equal(scene.object_count, 0);
	engine_scene_free(&scene);
}

static void mirrored_nodes_keep_their_fronts(void **state)
{
	(void)state;
	engine_scene scene = load_gltf(ONE_NODE(",\"scale\":[-2,1,1]"));
	engine_mesh world;
	double normal[3];
	CHECK3(scene.objects[0].rest.scale, 2, 1, 1);
	assert_true(engine_scene_merge(&scene, &world, message, sizeof message));
	engine_mesh_face_normal(&world, world.indices, 3, normal);
	assert_true(normal[2] > 0.99); /* z is not mirrored, so what faced +z still does */
	float lowest = 0;
	for (uint32_t v = 0; v < world.vertex_count; v++)
		lowest = fminf(lowest, world.positions[3 * v]);
	assert_true(fabsf(lowest + 2) < 1e-6f);
	engine_mesh_free(&world);
	engine_scene_free(&scene);
}

static void bad_transforms_are_refused(void **state)
{
	(void)state;
	check_gltf_refused(ONE_NODE(",\"name\":\"n\",\"scale\":[1,0,1]"), "\"n\" is singular");
	check_gltf_refused(ONE_NODE(",\"rotation\":[0,0,0,0]"), "quaternion");
	check_gltf_refused(ONE_NODE(",\"matrix\":[1,0,0,0, 0.5,1,0,0, 0,0,1,0, 0,0,0,1]"), "sheared");
	check_gltf_refused(ONE_NODE(",\"matrix\":[1,0,0,0, 0,1,0,0, 1,1,0,0, 0,0,0,1]"), "singular");
	check_gltf_refused(ONE_NODE(",\"translation\":[1,2]"), "translation");
	check_gltf_refused(ONE_NODE(",\"matrix\":[1,0,0,0.5, 0,1,0,0, 0,0,1,0, 0,0,0,1]"), "last row 0.5 0 0 1");
	check_gltf_refused(ONE_NODE(",\"matrix\":[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,2]"), "last row 0 0 0 2");
	check_gltf_refused(ONE_NODE(",\"translation\":[2e15,0,0]"), "beyond 1e15 m");
	check_gltf_refused(ONE_NODE(",\"scale\":[1e300,1e300,1e300]"), "beyond 1e15 m");
}

static void the_camera_is_found(void **state)
{
	(void)state;
	engine_scene scene =
	    load_gltf(HEAD "\"nodes\":[{\"translation\":[0,1,5],\"children\":[1]},{\"camera\":0,"
			   "\"scale\":[2,2,2],\"rotation\":[0,0.70710678,0,0.70710678]}],"
			   "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.7,\"znear\":0.1}}]}");
	engine_scene_camera camera;
	assert_true(scene.has_camera);
	assert_true(engine_scene_camera_at(&scene, 0, &camera));
	CHECK3(camera.eye, 0, 1, 5);
	CHECK3(camera.target, -1, 1, 5); /* -z turned by 90 degrees about y */
	CHECK3(camera.up, 0, 1, 0);
	assert_true(camera.vertical_fov == 0.7f);
	engine_scene_free(&scene);
	check_gltf_refused(HEAD "\"nodes\":[{\"camera\":0}],\"cameras\":[{\"perspective\":{\"yfov\":4}}]}", "yfov");
}

/* ---- glTF: animation --------------------------------------------------------------------------------------------- */

static engine_pose pose_at(const engine_scene *scene, uint32_t object, double time_s)
{
	engine_pose pose;
	assert_true(engine_scene_pose(scene, object, time_s, &pose));
	return pose;
}

static void keys_are_interpolated(void **state)
{
	(void)state;
	engine_scene scene = load_gltf(ANIMATED("translation", "{\"input\":2,\"output\":3}"));
	assert_true(scene.duration_s == 2);
	assert_true(scene.objects[0].animated);
	assert_false(scene.objects[0].scale_animated);
	CHECK3(scene.objects[0].rest.translation, 0, 0, 0);
	CHECK3(pose_at(&scene, 0, -1).translation, 0, 0, 0);
	CHECK3(pose_at(&scene, 0, 0.25).translation, 0.5f, 0, 0);
	CHECK3(pose_at(&scene, 0, 1).translation, 2, 0, 0);
	CHECK3(pose_at(&scene, 0, 1.5).translation, 2, 2, 0);
	CHECK3(pose_at(&scene, 0, 99).translation, 2, 4, 0);
	engine_pose unchanged;
	assert_false(engine_scene_pose(&scene, 0, (double)NAN, &unchanged));
	assert_false(engine_scene_pose(&scene, 1, 0, &unchanged));
	engine_scene_free(&scene);
}

static void step_and_cubic_keys(void **state)
{
	(void)state;
	engine_scene scene =
	    load_gltf(ANIMATED("translation", "{\"input\":2,\"output\":3,\"interpolation\":\"STEP\"}"));
	CHECK3(pose_at(&scene, 0, 0.999).translation, 0, 0, 0);
	CHECK3(pose_at(&scene, 0, 1).translation, 2, 0, 0);
	CHECK3(pose_at(&scene, 0, 1.999).translation, 2, 0, 0);
	engine_scene_free(&scene);
	scene = load_gltf(ANIMATED("translation", "{\"input\":2,\"output\":6,\"interpolation\":\"CUBICSPLINE\"}"));
	CHECK3(pose_at(&scene, 0, 0).translation, 0, 0, 0);
	CHECK3(pose_at(&scene, 0, 0.5).translation, 1, 0, 0); /* 0.5 (0 + 2) + 0.125 (3 - 3) */
	CHECK3(pose_at(&scene, 0, 1.5).translation, 2, 2, 0);
	CHECK3(pose_at(&scene, 0, 2).translation, 2, 4, 0);
	engine_scene_free(&scene);
}

static void rotations_turn_evenly(void **state)
{
	(void)state;
	engine_scene scene = load_gltf(ANIMATED("rotation", "{\"input\":2,\"output\":4}"));
	engine_pose pose = pose_at(&scene, 0, 0.5);
	float sign = pose.rotation[3] < 0 ? -1 : 1;
	assert_true(fabsf(sign * pose.rotation[1] - sinf(0.39269908f)) < 1e-6f); /* 45 degrees about y */
	engine_scene_free(&scene);
}

static void parents_move_their_children(void **state)
{
	(void)state;
	engine_scene scene = load_gltf(
	    HEAD "\"nodes\":[{\"children\":[1]},{\"mesh\":0,\"translation\":[0,0,1]}],\"animations\":[{\"samplers\":["
		 "{\"input\":2,\"output\":4},{\"input\":2,\"output\":3}],\"channels\":["
		 "{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"rotation\"}},"
		 "{\"sampler\":1,\"target\":{\"node\":0,\"path\":\"translation\"}},"
		 "{\"sampler\":1,\"target\":{\"node\":0,\"path\":\"weights\"}}]}]," MESH TAIL);
	assert_true(scene.objects[0].animated);
	CHECK3(pose_at(&scene, 0, 0).translation, 0, 0, 1);
	CHECK3(pose_at(&scene, 0, 1).translation, 3, 0, 0); /* z turned onto x, moved by 2 */
	CHECK3(pose_at(&scene, 0, 2).translation, 2, 4, -1);
	engine_scene_free(&scene);
}

static void animated_scales_are_told(void **state)
{
	(void)state;
	engine_scene scene = load_gltf(ANIMATED("scale", "{\"input\":2,\"output\":9}"));
	assert_true(scene.objects[0].scale_animated);
	CHECK3(pose_at(&scene, 0, 1).scale, 2, 2, 2);
	engine_scene_free(&scene);
	check_gltf_refused(ANIMATED("scale", "{\"input\":2,\"output\":10}"), "at 1 s");
}

static void broken_animations_are_refused(void **state)
{
	(void)state;
	check_gltf_refused(ANIMATED("translation", "{\"input\":11,\"output\":3}"), "times must rise");
	check_gltf_refused(ANIMATED("translation", "{\"input\":2,\"output\":0}"), "4 values for 3 keys");
	check_gltf_refused(ANIMATED("translation", "{\"input\":2,\"output\":4}"), "type");
	check_gltf_refused(ANIMATED("translation", "{\"input\":2,\"output\":3,\"interpolation\":\"MAGIC\"}"), "MAGIC");
	check_gltf_refused(ANIMATED("translation", "{\"input\":2,\"output\":99}"), "accessors");
}

/* ---- glTF: damage ------------------------------------------------------------------------------------------------ */

static void broken_gltf_is_refused(void **state)
{
	(void)state;
	check_gltf_refused("{\"asset\":{\"version\":\"2.0\"", "no JSON");
	check_gltf_refused("[]", "no JSON");
	check_gltf_refused("{\"asset\":{\"version\":\"1.0\"}}", "2.x");
	check_gltf_refused(HEAD "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]}",
			   "KHR_draco_mesh_compression");
	check_gltf_refused(HEAD "\"nodes\":[{\"mesh\":7}]}", "meshes");
	check_gltf_refused(HEAD "\"nodes\":[{\"mesh\":-1}]}", "meshes");
	check_gltf_refused(HEAD "\"nodes\":{}}", "array");
	check_gltf_refused(HEAD "\"nodes\":[7]}", "objects");
	check_gltf_refused(HEAD "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"children\":[1]},{\"children\":[0]}]}",
			   "no tree");
	check_gltf_refused(HEAD "\"nodes\":[{\"children\":[1,1]},{}]}", "no tree");
	check_gltf_refused(HEAD "\"nodes\":[{\"children\":[1]},{\"children\":[0]}]}", "no tree");
	check_gltf_refused(HEAD "\"buffers\":[{\"byteLength\":4,\"uri\":\"missing.bin\"}]}", "missing.bin");
	check_gltf_refused(HEAD "\"buffers\":[{\"byteLength\":4,\"uri\":\"data:text/plain,abcd\"}]}", "base64");
	check_gltf_refused(HEAD "\"buffers\":[{\"byteLength\":99,\"uri\":\"data:;base64,AAAA\"}]}",
			   "3 bytes of the 99");
}

static void broken_geometry_is_refused(void **state)
{
	(void)state;
	check_gltf_refused(ONE_PRIMITIVE("{\"attributes\":{\"POSITION\":5},\"indices\":1}"), "vertex 1 is not finite");
	check_gltf_refused(ONE_PRIMITIVE("{\"attributes\":{\"POSITION\":0},\"indices\":8}"), "out of range");
	check_gltf_refused(ONE_PRIMITIVE("{\"attributes\":{\"POSITION\":7},\"indices\":1}"), "none of its 2 faces");
	check_gltf_refused(ONE_PRIMITIVE("{\"attributes\":{\"POSITION\":1},\"indices\":1}"), "type");
	check_gltf_refused(ONE_PRIMITIVE("{\"attributes\":{\"POSITION\":0},\"indices\":0}"), "type");
	check_gltf_refused(ONE_PRIMITIVE("{\"attributes\":{},\"indices\":1}"), "missing");
	check_gltf_refused(
	    HEAD "\"nodes\":[{\"mesh\":0}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":400,"
		 "\"type\":\"VEC3\"},{}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":456}]," BUFFER "," MESH "}",
	    "past the end");
}

static void faces_without_area_are_dropped(void **state)
{
	(void)state;
	engine_scene scene = load_gltf(ONE_PRIMITIVE(SQUARE ",{\"attributes\":{\"POSITION\":7},\"indices\":1}"));
	assert_int_equal(scene.objects[0].mesh.face_count, 2);
	assert_int_equal(scene.objects[0].mesh.vertex_count, 4);
	assert_non_null(strstr(scene.warning, "2 faces without area"));
	engine_scene_free(&scene);
}

/* What is left out of the scene is said. */
static void check_warned(const char *text, const char *words)
{
	engine_scene scene = load_gltf(text);
	if (!strstr(scene.warning, words))
		fail_msg("\"%s\" does not say \"%s\"", scene.warning, words);
	engine_scene_free(&scene);
}

static void warnings_name_what_is_left_out(void **state)
{
	(void)state;
	static const char faceless[] = "\"thing\" has no face";
	check_warned(ONE_PRIMITIVE(""), faceless);
	check_warned(ONE_PRIMITIVE("{\"attributes\":{\"POSITION\":0},\"mode\":0}"), faceless);
	check_warned(HEAD "\"nodes\":[{\"mesh\":0,\"name\":\"thing\"}],\"meshes\":[{\"primitives\":\"x\"}]" TAIL,
		     faceless);
	check_warned(HEAD "\"nodes\":[{\"mesh\":0,\"name\":\"thing\"}],\"meshes\":[{}]" TAIL, faceless);
	check_warned(HEAD "\"extensionsRequired\":[\"KHR_mesh_quantization\",\"FOO_bar\"]}", "requires FOO_bar");
}

static size_t make_glb(uint8_t *glb)
{
	static const char json[] =
	    HEAD "\"nodes\":[{\"mesh\":0,\"extras\":{\"gi\":{\"scheme\":\"loop\"}}}],\"materials\":["
		 "{\"emissiveFactor\":[1,1,1]}],\"animations\":[{\"samplers\":[{\"input\":2,\"output\":4}],"
		 "\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"rotation\"}}]}]," MESH
		 ",\"buffers\":[{\"byteLength\":456}]," ACCESSORS "}";
	binary bytes = make_binary();
	uint32_t json_size = (uint32_t)(sizeof json - 1 + 3) / 4 * 4, size = 28 + json_size + (uint32_t)sizeof bytes;
	const uint32_t head[5] = {0x46546c67, 2, size, json_size, 0x4e4f534a};
	const uint32_t chunk[2] = {sizeof bytes, 0x004e4942};
	memcpy(glb, head, sizeof head);
	memset(glb + 20, ' ', json_size);
	memcpy(glb + 20, json, sizeof json - 1);
	memcpy(glb + 20 + json_size, chunk, sizeof chunk);
	memcpy(glb + 28 + json_size, &bytes, sizeof bytes);
	return size;
}

static void binary_gltf(void **state)
{
	(void)state;
	static uint8_t glb[8192];
	size_t size = make_glb(glb);
	engine_scene scene = load(write_file("a.glb", glb, size));
	assert_int_equal(scene.object_count, 1);
	assert_int_equal(scene.objects[0].mesh.face_count, 2);
	assert_true(scene.objects[0].animated);
	engine_scene_free(&scene);
}

/* ---- OBJ and PLY ------------------------------------------------------------------------------------------------- */

static const char obj_text[] = "mtllib a.mtl\n"
			       "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n"
			       "vt 0 0\nvt 1 1\nvn 0 0 1\nvn 0 1 0\n"
			       "o left\nusemtl lamp\nf 1/1/1 2/2/2 3/1/1 4/1/2\nusemtl wall\nf 2/1/2 5/2/1 3/2/2\n"
			       "o right\nf 5 6 3\n";
static const char mtl_text[] = "newmtl lamp\nKd 0.25 0.5 0.75\nKe 3 2 1\nnewmtl wall\nKd 0.1 0.1 0.1\n";

static void obj_files(void **state)
{
	(void)state;
	write_text("a.mtl", mtl_text);
	engine_scene scene = load(write_text("a.obj", obj_text));
	assert_int_equal(scene.object_count, 2);
	const engine_mesh *mesh = &scene.objects[0].mesh;
	assert_string_equal(scene.objects[0].name, "left");
	assert_int_equal(mesh->face_count, 2);
	assert_int_equal(mesh->face_counts[0], 4); /* polygons stay */
	assert_int_equal(mesh->vertex_count, 5);   /* connected across normals and materials */
	const engine_scene_material *lamp = &scene.materials[mesh->face_materials[0]];
	assert_string_equal(lamp->name, "lamp");
	CHECK3(lamp->rho, 0.25f, 0.5f, 0.75f);
	CHECK3(lamp->radiance, 3, 2, 1);
	assert_string_equal(scene.materials[mesh->face_materials[1]].name, "wall");
	engine_mesh merged;
	assert_true(engine_scene_merge(&scene, &merged, message, sizeof message));
	assert_int_equal(merged.vertex_count, 6);
	assert_int_equal(merged.face_count, 3);
	engine_mesh_free(&merged);
	engine_scene_free(&scene);
}

static void obj_files_without_their_library(void **state)
{
	(void)state;
	unlink(path_of("a.mtl"));
	engine_scene scene = load(write_text("a.obj", obj_text));
	assert_non_null(strstr(scene.warning, "a.mtl"));
	engine_scene_free(&scene);
	scene = load(write_text("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n"));
	CHECK3(scene.materials[scene.objects[0].mesh.face_materials[0]].rho, 0.5f, 0.5f, 0.5f);
	assert_string_equal(scene.warning, "");
	engine_scene_free(&scene);
}

static void broken_obj_files(void **state)
{
	(void)state;
	check_refused(write_text("a.obj", "v 0 0 0\nv nan 0 0\nv 1 1 0\nf 1 2 3\n"), "finite");
	check_refused(write_text("a.obj", "v 0 0 0\nv inf 0 0\nv 1 1 0\nf 1 2 3\n"), "finite");
	check_refused(write_text("a.obj", "v 0 0 0\nv 1e16 0 0\nv 1 1 0\nf 1 2 3\n"), "beyond 1e15 m");
	check_refused(write_text("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 9\n"), "range");
	check_refused(write_text("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), "area");
	check_refused(write_text("a.obj", "hello\n"), "");
	write_text("a.mtl", "newmtl m\nKd 1 1 1\n");
	check_refused(write_text("a.obj", "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n"),
		      "material \"m\"");
	write_text("a.mtl", mtl_text);
}

static const char ply_text[] = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
			       "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
			       "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

static void ply_files(void **state)
{
	(void)state;
	engine_scene scene = load(write_text("a.ply", ply_text));
	assert_int_equal(scene.object_count, 1);
	assert_int_equal(scene.objects[0].mesh.face_count, 1);
	assert_int_equal(scene.objects[0].mesh.face_counts[0], 4);
	assert_false(scene.objects[0].double_sided);
	CHECK3(scene.materials[0].rho, 0.5f, 0.5f, 0.5f);
	engine_scene_free(&scene);
}

static void ply_files_that_promise_too_much(void **state)
{
	(void)state;
	static const char rest[] = "property float x\nproperty float y\nproperty float z\nelement face 1\n"
				   "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n";
	static const char *const counts[] = {"4000000000", "99999999999999999999", "500"};
	for (int i = 0; i < 3; i++) {
		char text[512];
		snprintf(text, sizeof text, "ply\nformat ascii 1.0\nelement vertex %s\n%s", counts[i], rest);
		check_refused(write_text("a.ply", text), "vertices and faces in a file of");
	}
}

static void missing_and_foreign_files(void **state)
{
	(void)state;
	check_refused("/nowhere/at/all.gltf", "cannot be opened");
	check_refused("/nowhere/at/all.obj", "cannot be opened");
	check_refused(write_text("a.txt", "hello"), ".gltf, .glb, .obj or .ply");
	check_refused(write_text("a.ply", ""), "empty");
	check_refused(folder, "empty");
}

/* ---- damage at random -------------------------------------------------------------------------------------------- */

static uint32_t random_state;

/* xorshift32 (Marsaglia 2003): the same damage on every machine. */
static uint32_t next_random(void)
{
	random_state ^= random_state << 13;
	random_state ^= random_state >> 17;
	random_state ^= random_state << 5;
	return random_state;
}

/* Loading may fail or not; what loads must be sound. */
static void load_damaged(const char *name, const uint8_t *bytes, size_t size)
{
	engine_scene scene;
	message[0] = '\0';
	if (!engine_scene_load(write_file(name, bytes, size), &scene, message, sizeof message)) {
		assert_true(message[0] != '\0' && !strchr(message, '\n'));
		return;
	}
	for (uint32_t i = 0; i < scene.object_count; i++) {
		const engine_mesh *mesh = &scene.objects[i].mesh;
		engine_pose pose;
		for (uint32_t k = 0; k < mesh->index_count; k++)
			assert_true(mesh->indices[k] < mesh->vertex_count);
		for (uint32_t f = 0; f < mesh->face_count; f++)
			assert_true(mesh->face_materials[f] < scene.material_count);
		engine_scene_pose(&scene, i, 0.7, &pose);
	}
	engine_scene_free(&scene);
}

static void damage(const char *name, const uint8_t *bytes, size_t size, int flips)
{
	uint8_t *copy = malloc(size);
	assert_non_null(copy);
	for (size_t cut = 1; cut < size; cut += 1 + size / 97)
		load_damaged(name, bytes, cut);
	for (int i = 0; i < flips; i++) {
		memcpy(copy, bytes, size);
		for (uint32_t k = next_random() % 4 + 1; k > 0; k--)
			copy[next_random() % size] ^= (uint8_t)(1u << next_random() % 8);
		load_damaged(name, copy, size);
	}
	free(copy);
}

static void damaged_files_never_crash(void **state)
{
	(void)state;
	static uint8_t glb[8192];
	random_state = 20240607;
	write_text("a.mtl", mtl_text);
	damage("a.glb", glb, make_glb(glb), 2000);
	damage("a.obj", (const uint8_t *)obj_text, sizeof obj_text - 1, 500);
	damage("a.ply", (const uint8_t *)ply_text, sizeof ply_text - 1, 500);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_node_becomes_an_object),
	    cmocka_unit_test(extras_choose_the_refinement),
	    cmocka_unit_test(materials_are_read),
	    cmocka_unit_test(impossible_materials_are_refused),
	    cmocka_unit_test(primitives_join_into_one_connected_mesh),
	    cmocka_unit_test(names_are_unique),
	    cmocka_unit_test(many_nodes_of_one_name),
	    cmocka_unit_test(only_the_chosen_scene_is_read),
	    cmocka_unit_test(an_empty_scene_is_no_error),
	    cmocka_unit_test(mirrored_nodes_keep_their_fronts),
	    cmocka_unit_test(bad_transforms_are_refused),
	    cmocka_unit_test(the_camera_is_found),
	    cmocka_unit_test(keys_are_interpolated),
	    cmocka_unit_test(step_and_cubic_keys),
	    cmocka_unit_test(rotations_turn_evenly),
	    cmocka_unit_test(parents_move_their_children),
	    cmocka_unit_test(animated_scales_are_told),
	    cmocka_unit_test(broken_animations_are_refused),
	    cmocka_unit_test(broken_gltf_is_refused),
	    cmocka_unit_test(broken_geometry_is_refused),
	    cmocka_unit_test(faces_without_area_are_dropped),
	    cmocka_unit_test(warnings_name_what_is_left_out),
	    cmocka_unit_test(binary_gltf),
	    cmocka_unit_test(obj_files),
	    cmocka_unit_test(obj_files_without_their_library),
	    cmocka_unit_test(broken_obj_files),
	    cmocka_unit_test(ply_files),
	    cmocka_unit_test(ply_files_that_promise_too_much),
	    cmocka_unit_test(missing_and_foreign_files),
	    cmocka_unit_test(damaged_files_never_crash),
	};
	return cmocka_run_group_tests_name("scene_file", tests, make_folder, remove_folder);
}
