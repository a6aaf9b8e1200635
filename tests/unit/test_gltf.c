/* glTF: what it becomes, what is told, which files are refused with which words, and that no damage crashes. */
#define _XOPEN_SOURCE 700 /* mkdtemp */
#include "gltf_files.h"

#include <time.h>

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
	assert_true(area_of(object) == 1);
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
	check_gltf_told(ONE_NODE(",\"name\":\"n\",\"extras\":{\"gi\":{\"scheme\":\"butterfly\"}}"),
			"extras.gi.scheme other than");
	check_gltf_told(ONE_NODE(",\"extras\":{\"gi\":{\"levels\":1.5}}"), "extras.gi.levels");
	check_gltf_told(ONE_NODE(",\"extras\":{\"gi\":{\"levels\":99}}"), "0 to 8");
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

static void check_material(const char *text, const float rho[3], const float radiance[3], const char *words)
{
	engine_scene scene = load_gltf(text);
	check_floats(scene.materials[0].rho, rho, 3, 1e-6f);
	check_floats(scene.materials[0].radiance, radiance, 3, 1e-6f);
	if (!strstr(scene.warning, words))
		fail_msg("\"%s\" does not say \"%s\"", scene.warning, words);
	engine_scene_free(&scene);
}

/* One number out of range costs that number, with a word about it. */
static void impossible_materials_are_mended(void **state)
{
	(void)state;
	const float black[3] = {0, 0, 0}, grey[3] = {0.5f, 0.5f, 0.5f};
	check_material(ONE_MATERIAL("\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0.4,7,1]}"),
		       (const float[3]){0.98f, 0.4f, 0.98f}, black,
		       "get 0.98 (nothing gives back all light) (\"paint\")");
	check_material(ONE_MATERIAL("\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,-0.1,0.5,1]}"),
		       (const float[3]){0.5f, 0, 0.5f}, black, "negative");
	check_material(ONE_MATERIAL("\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.2,1e999,0.2,1]}"), grey, black,
		       "no finite numbers");
	check_material(ONE_MATERIAL("\"emissiveFactor\":[-1,2,0]"), grey, (const float[3]){0, 2, 0}, "emit");
	check_material(ONE_MATERIAL("\"emissiveFactor\":[1e30,0,0]"), grey, (const float[3]){3e11f, 0, 0}, "emit");
	check_material(ONE_MATERIAL("\"emissiveFactor\":\"red\""), grey, black, "emissions");
	check_material(ONE_MATERIAL("\"emissiveFactor\":[1,0,0],\"extensions\":{\"KHR_materials_emissive_strength\":"
				    "{\"emissiveStrength\":-2}}"),
		       grey, black, "emit");
}

static void primitives_join_into_one_connected_mesh(void **state)
{
	(void)state;
	engine_scene scene = load_gltf(ONE_PRIMITIVE(
	    SQUARE ",{\"attributes\":{\"POSITION\":0},\"mode\":5},{\"attributes\":{\"POSITION\":0},\"mode\":6}"));
	const engine_mesh *mesh = &scene.objects[0].mesh;
	assert_int_equal(mesh->vertex_count, 4); /* welded */
	/* The strip 0 1 2, 1 3 2 brings one new face; the fan 0 1 2, 0 2 3 is the square again. */
	assert_int_equal(mesh->face_count, 3);
	assert_memory_equal(mesh->indices + 6, ((uint32_t[]){1, 3, 2}), 12);
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

/* The square and a node with the given members: what the members break is the node alone. */
#define TWO_NODES(members) HEAD "\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"name\":\"n\"" members "}]," MESH TAIL

static void check_one_left(const char *text, const char *words)
{
	engine_scene scene = load_gltf(text);
	assert_int_equal(scene.object_count, 1);
	if (!strstr(scene.warning, words))
		fail_msg("\"%s\" does not say \"%s\"", scene.warning, words);
	engine_scene_free(&scene);
}

static void bad_transforms_cost_their_objects(void **state)
{
	(void)state;
	check_one_left(TWO_NODES(",\"scale\":[1,0,1]"),
		       "scale is 0 (or whose transform is singular) are left out (\"n\")");
	check_one_left(TWO_NODES(",\"matrix\":[1,0,0,0, 0,1,0,0, 1,1,0,0, 0,0,0,1]"), "singular");
	check_one_left(TWO_NODES(",\"translation\":[1,2]"), "too few");
	check_one_left(TWO_NODES(",\"translation\":[1,2,1e999]"), "no finite number");
	check_one_left(TWO_NODES(",\"matrix\":[1,0,0,0.5, 0,1,0,0, 0,0,1,0, 0,0,0,1]"), "last row");
	check_one_left(TWO_NODES(",\"matrix\":[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,2]"), "last row");
	check_one_left(TWO_NODES(",\"translation\":[2e9,0,0]"), "beyond 1e9 m");
	check_one_left(TWO_NODES(",\"scale\":[1e300,1e300,1e300]"), "beyond 1e9 m");
	check_one_left(TWO_NODES(",\"scale\":[2e9,2e9,2e9]"), "beyond 1e9 m");
	check_one_left(TWO_NODES(",\"scale\":[1e-12,1e-12,1e-12]"), "below 1e-23 m2");
	check_gltf_told(TWO_NODES(",\"rotation\":[0,0,0,0]"), "unit quaternion");
	check_gltf_refused(ONE_NODE(",\"scale\":[0,0,0]"), "none of its 2 faces can be used: objects whose scale is 0");
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
	check_gltf_told(HEAD "\"nodes\":[{\"camera\":0}],\"cameras\":[{\"perspective\":{\"yfov\":4}}]}", "yfov");
	check_gltf_told(HEAD "\"nodes\":[{\"camera\":0}],\"cameras\":[{\"orthographic\":{\"xmag\":1}}]}",
			"orthographic");
	check_gltf_told(HEAD "\"nodes\":[{\"camera\":3}]}", "cameras that the file does not hold");
}

/* ---- glTF: animation --------------------------------------------------------------------------------------------- */

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
	/* A scale of 0 hides; on the way there it is smaller, unless it goes at once. */
	scene = load_gltf(ANIMATED("scale", "{\"input\":2,\"output\":10,\"interpolation\":\"STEP\"}"));
	assert_true(scene.objects[0].vanishes && !scene.objects[0].scale_animated);
	engine_scene_free(&scene);
	scene = load_gltf(ANIMATED("scale", "{\"input\":2,\"output\":10}"));
	engine_pose pose;
	assert_true(scene.objects[0].vanishes && scene.objects[0].scale_animated);
	assert_false(engine_scene_pose(&scene, 0, 1, &pose));
	assert_true(engine_scene_pose(&scene, 0, 2, &pose));
	engine_scene_free(&scene);
}

/* A channel that makes no sense leaves its node at rest. */
static void check_at_rest(const char *text, const char *words)
{
	engine_scene scene = load_gltf(text);
	assert_false(scene.objects[0].animated);
	assert_true(scene.duration_s == 0);
	if (!strstr(scene.warning, words))
		fail_msg("\"%s\" does not say \"%s\"", scene.warning, words);
	engine_scene_free(&scene);
}

static void broken_animations_are_left_out(void **state)
{
	(void)state;
	check_at_rest(ANIMATED("translation", "{\"input\":11,\"output\":3}"), "times must rise");
	check_at_rest(ANIMATED("translation", "{\"input\":0,\"output\":3}"), "type");
	check_at_rest(ANIMATED("translation", "{\"input\":2,\"output\":3,\"interpolation\":\"CUBICSPLINE\"}"),
		      "fewer values");
	check_at_rest(ANIMATED("translation", "{\"input\":2,\"output\":4}"), "type");
	check_at_rest(ANIMATED("translation", "{\"input\":2,\"output\":3,\"interpolation\":\"MAGIC\"}"),
		      "interpolation");
	check_at_rest(ANIMATED("translation", "{\"input\":2,\"output\":99}"), "accessor");
	check_at_rest(ANIMATED("weights", "{\"input\":2,\"output\":3}"), "morph targets");
	check_at_rest(ANIMATED("colour", "{\"input\":2,\"output\":3}"), "without a node, a property");
	check_at_rest(HEAD "\"nodes\":[{\"mesh\":0,\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}],\"animations\":[{"
			   "\"samplers\":[{\"input\":2,\"output\":3}],\"channels\":[{\"sampler\":0,\"target\":{"
			   "\"node\":0,\"path\":\"translation\"}}]}]," MESH TAIL,
		      "nodes with a matrix");
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
	check_gltf_refused(HEAD "\"nodes\":[{\"mesh\":7}]}", "holds no faces that can be used: meshes or skins");
	check_gltf_refused(HEAD "\"nodes\":[{\"mesh\":-1}]}", "meshes");
	check_gltf_refused(HEAD "\"nodes\":{}}", "array");
	check_gltf_told(HEAD "\"nodes\":[7]}", "members of \"nodes\" that are no objects are taken as empty");
	check_gltf_told(HEAD "\"nodes\":[{\"mesh\":0},{\"camera\":0},null],\"cameras\":[7]," MESH TAIL,
			"members of \"cameras\" that are no objects");
	check_gltf_told(HEAD "\"nodes\":[{\"extensions\":[1,{\"FOO_bar\":1}]}]}", "holds no faces");
	check_gltf_told(HEAD "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"children\":[1]},{\"children\":[0]}]}",
			"another's child already");
	check_gltf_told(HEAD "\"nodes\":[{\"children\":[1,1]},{}]}", "another's child already");
	check_gltf_told(HEAD "\"nodes\":[{\"children\":[1]},{\"children\":[0]}]}", "their own parents");
	check_gltf_refused(HEAD "\"buffers\":[{\"byteLength\":4,\"uri\":\"missing.bin\"}]}", "missing.bin");
	check_gltf_refused(HEAD "\"buffers\":[{\"byteLength\":4,\"uri\":\"data:text/plain,abcd\"}]}", "base64");
	check_gltf_refused(HEAD "\"buffers\":[{\"byteLength\":99,\"uri\":\"data:;base64,AAAA\"}]}",
			   "3 bytes of the 99");
}

/* Alone in its file, broken geometry leaves nothing to show; beside something it costs itself. */
static void broken_geometry_is_left_out(void **state)
{
	(void)state;
	check_gltf_refused(ONE_PRIMITIVE("{\"attributes\":{\"POSITION\":7},\"indices\":1}"), "none of its 2 faces");
	check_gltf_refused(ONE_PRIMITIVE("{\"attributes\":{\"POSITION\":1},\"indices\":1}"), "type");
	check_gltf_refused(ONE_PRIMITIVE("{\"attributes\":{\"POSITION\":0},\"indices\":0}"), "type");
	check_gltf_refused(ONE_PRIMITIVE("{\"attributes\":{},\"indices\":1}"), "missing");
	check_gltf_refused(
	    HEAD "\"nodes\":[{\"mesh\":0}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":400,"
		 "\"type\":\"VEC3\"},{}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":456}]," BUFFER "," MESH "}",
	    "past the end");
	/* One buffer of two is not there. */
	check_one_left(HEAD
		       "\"nodes\":[{\"mesh\":0},{\"mesh\":1}],\"meshes\":[{\"primitives\":[" SQUARE
		       "]},{\"primitives\":[{\"attributes\":{\"POSITION\":2}}]}],\"buffers\":[{\"byteLength\":456,"
		       "\"uri\":\"scene%20file.bin\"},{\"byteLength\":48,\"uri\":\"gone.bin\"}],\"bufferViews\":"
		       "[" VIEW(0, 48) "," VIEW(48, 12) ",{\"buffer\":1,\"byteLength\":48}],\"accessors\":"
							"[" ACCESSOR(0, 5126, 4, "VEC3") "," ACCESSOR(
							    1, 5123, 6, "SCALAR") "," ACCESSOR(2, 5126, 4, "VEC3") "]}",
		       "a buffer cannot be opened (No such file or directory) (\"gone.bin\"); parts of meshes");
	check_one_left(ONE_PRIMITIVE(SQUARE ",{\"attributes\":{\"POSITION\":1}}"), "parts of meshes are left out");
	engine_scene scene = load_gltf(ONE_PRIMITIVE("{\"attributes\":{\"POSITION\":5},\"indices\":1}"));
	assert_int_equal(scene.objects[0].mesh.face_count, 1); /* 0 2 3; 0 1 2 has the NaN */
	assert_non_null(strstr(scene.warning, "not finite"));
	engine_scene_free(&scene);
	scene = load_gltf(ONE_PRIMITIVE("{\"attributes\":{\"POSITION\":0},\"indices\":8}"));
	assert_int_equal(scene.objects[0].mesh.face_count, 1);
	assert_non_null(strstr(scene.warning, "corner that is not there"));
	engine_scene_free(&scene);
}

static void faces_without_area_are_dropped(void **state)
{
	(void)state;
	engine_scene scene = load_gltf(ONE_PRIMITIVE(SQUARE ",{\"attributes\":{\"POSITION\":7},\"indices\":1}"));
	assert_int_equal(scene.objects[0].mesh.face_count, 2);
	assert_int_equal(scene.objects[0].mesh.vertex_count, 4);
	assert_non_null(strstr(scene.warning, "faces without area are dropped (2, first: \"thing\")"));
	engine_scene_free(&scene);
}

static void warnings_name_what_is_left_out(void **state)
{
	(void)state;
	static const char faceless[] = "the file holds no faces";
	check_gltf_told(ONE_PRIMITIVE(""), faceless);
	check_gltf_told(ONE_PRIMITIVE("{\"attributes\":{\"POSITION\":0},\"mode\":0}"), "points and lines are not read");
	check_gltf_told(HEAD "\"nodes\":[{\"mesh\":0,\"name\":\"thing\"}],\"meshes\":[{\"primitives\":\"x\"}]" TAIL,
			faceless);
	check_gltf_told(HEAD "\"nodes\":[{\"mesh\":0,\"name\":\"thing\"}],\"meshes\":[{}]" TAIL, faceless);
	check_gltf_told(ONE_NODE(",\"extensions\":{\"FOO_bar\":{}},\"name\":\"n\""),
			"uses of FOO_bar are not read (\"n\")");
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

static void damaged_files_never_crash(void **state)
{
	(void)state;
	static uint8_t glb[8192];
	damage("a.glb", glb, make_glb(glb), 2000);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_node_becomes_an_object),
	    cmocka_unit_test(extras_choose_the_refinement),
	    cmocka_unit_test(materials_are_read),
	    cmocka_unit_test(impossible_materials_are_mended),
	    cmocka_unit_test(primitives_join_into_one_connected_mesh),
	    cmocka_unit_test(names_are_unique),
	    cmocka_unit_test(many_nodes_of_one_name),
	    cmocka_unit_test(only_the_chosen_scene_is_read),
	    cmocka_unit_test(an_empty_scene_is_no_error),
	    cmocka_unit_test(mirrored_nodes_keep_their_fronts),
	    cmocka_unit_test(bad_transforms_cost_their_objects),
	    cmocka_unit_test(the_camera_is_found),
	    cmocka_unit_test(keys_are_interpolated),
	    cmocka_unit_test(step_and_cubic_keys),
	    cmocka_unit_test(rotations_turn_evenly),
	    cmocka_unit_test(parents_move_their_children),
	    cmocka_unit_test(animated_scales_are_told),
	    cmocka_unit_test(broken_animations_are_left_out),
	    cmocka_unit_test(broken_gltf_is_refused),
	    cmocka_unit_test(broken_geometry_is_left_out),
	    cmocka_unit_test(faces_without_area_are_dropped),
	    cmocka_unit_test(warnings_name_what_is_left_out),
	    cmocka_unit_test(binary_gltf),
	    cmocka_unit_test(damaged_files_never_crash),
	};
	return cmocka_run_group_tests_name("gltf", tests, make_gltf_folder, remove_folder);
}
