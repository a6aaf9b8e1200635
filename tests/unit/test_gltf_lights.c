/* KHR_lights_punctual: values, places over time, and what is broken. */
#include "gltf_files.h"

#include <math.h>
#include <string.h>

#define LIGHTS(list) "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[" list "]}},"
#define LIT(number, members) "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":" #number "}}" members "}"
#define LIT_SCENE(lights, nodes) HEAD LIGHTS(lights) "\"nodes\":[{\"mesh\":0}," nodes "]," MESH TAIL

static void expect_vector(const float found[3], float x, float y, float z)
{
	assert_float_equal(found[0], x, 1e-5);
	assert_float_equal(found[1], y, 1e-5);
	assert_float_equal(found[2], z, 1e-5);
}

static void test_values(void **state)
{
	(void)state;
	engine_scene scene = load_gltf(
	    LIT_SCENE("{\"type\":\"point\",\"name\":\"bulb\",\"intensity\":100,\"color\":[1,0.5,0],\"range\":7},"
		      "{\"type\":\"spot\",\"intensity\":3,\"spot\":{\"innerConeAngle\":0.2,\"outerConeAngle\":0.6}},"
		      "{\"type\":\"directional\"},{\"type\":\"spot\"}",
		      LIT(0, ",\"translation\":[1,2,3]") "," LIT(1, ",\"name\":\"torch\"") "," LIT(2, "") "," LIT(
			  3, "") "," LIT(0, ",\"scale\":[9,9,9]")));
	assert_string_equal(scene.warning, "");
	assert_int_equal(scene.light_count, 5);
	const engine_scene_light *l = scene.lights;
	assert_string_equal(l[0].name, "bulb");
	assert_true(l[0].type == ENGINE_LIGHT_POINT && l[0].range == 7 && !l[0].animated);
	expect_vector(l[0].intensity, 100, 50, 0);
	assert_string_equal(l[1].name, "torch");
	assert_true(l[1].type == ENGINE_LIGHT_SPOT && l[1].inner_angle == .2f && l[1].outer_angle == .6f);
	assert_true(l[2].type == ENGINE_LIGHT_DIRECTIONAL && l[2].range == 0);
	expect_vector(l[2].intensity, 1, 1, 1);
	assert_true(l[3].inner_angle == 0 && fabsf(l[3].outer_angle - .785398f) < 1e-5f);
	expect_vector(l[4].intensity, 100, 50, 0); /* a scale is no light's */
	float place[3], direction[3];
	assert_true(engine_scene_light_at(&scene, 0, 0, place, direction));
	expect_vector(place, 1, 2, 3);
	expect_vector(direction, 0, 0, -1);
	assert_false(engine_scene_light_at(&scene, 5, 0, place, direction));
	engine_scene_free(&scene);
}

/* 0, 90, 180 degrees about y in two seconds, below a node that moves the light by (0, 1, 0). */
static void test_motion(void **state)
{
	(void)state;
	engine_scene scene = load_gltf(
	    HEAD
		LIGHTS("{\"type\":\"spot\"}") "\"nodes\":[{\"mesh\":0},{\"children\":[2],\"translation\":[0,1,0]}," LIT(
		    0, ",\"translation\":[1,0,0]") "],\"animations\":[{\"samplers\":[{\"input\":2,\"output\":4}],"
						   "\"channels\":[{\"sampler\":0,\"target\":{\"node\":1,\"path\":"
						   "\"rotation\"}}]}]," MESH TAIL);
	assert_int_equal(scene.light_count, 1);
	assert_true(scene.lights[0].animated);
	float place[3], direction[3];
	assert_true(engine_scene_light_at(&scene, 0, 0, place, direction));
	expect_vector(place, 1, 1, 0);
	expect_vector(direction, 0, 0, -1);
	assert_true(pose_at(&scene, 0, 1).translation[0] == 0);
	assert_true(engine_scene_light_at(&scene, 0, 1, place, direction));
	expect_vector(place, 0, 1, -1);
	expect_vector(direction, -1, 0, 0);
	engine_scene_free(&scene);
	scene = load_gltf(LIT_SCENE("{\"type\":\"point\"}", LIT(0, ",\"scale\":[0,0,0]")));
	assert_int_equal(scene.light_count, 1);
	assert_false(engine_scene_light_at(&scene, 0, 0, place, direction));
	engine_scene_free(&scene);
}

static void test_what_is_broken(void **state)
{
	(void)state;
	static const char *const broken[][2] = {
	    {"{\"type\":\"area\"}", "its type is unknown"},
	    {"{}", "its type is unknown"},
	    {"{\"type\":\"point\",\"intensity\":-1}", "below 0"},
	    {"{\"type\":\"point\",\"intensity\":\"much\"}", "no finite number"},
	    {"{\"type\":\"point\",\"color\":[1,1]}", "no finite number"},
	    {"{\"type\":\"spot\",\"spot\":{\"outerConeAngle\":2}}", "cone angles"},
	    {"{\"type\":\"spot\",\"spot\":{\"innerConeAngle\":0.8}}", "cone angles"},
	    {"", "does not hold"},
	};
	for (size_t k = 0; k < sizeof broken / sizeof *broken; k++) {
		char text[4096];
		snprintf(text, sizeof text, "%s%s%s", HEAD "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[",
			 broken[k][0], "]}},\"nodes\":[{\"mesh\":0}," LIT(0, ",\"name\":\"bad\"") "]," MESH TAIL);
		engine_scene scene = load_gltf(text);
		assert_int_equal(scene.light_count, 0);
		assert_int_equal(scene.object_count, 1);
		if (!strstr(scene.warning, broken[k][1]) || !strstr(scene.warning, "\"bad\""))
			fail_msg("%s: %s", broken[k][0], scene.warning);
		engine_scene_free(&scene);
	}
	check_gltf_told(LIT_SCENE("{\"type\":\"point\"}", LIT(0.5, "")), "does not hold");
	check_gltf_told(LIT_SCENE("{\"type\":\"point\"}", LIT(-1, "")), "does not hold");
	check_gltf_refused(HEAD LIGHTS("{\"type\":\"point\"") "\"nodes\":[{\"mesh\":0}]," MESH TAIL, "is no JSON");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_values),
	    cmocka_unit_test(test_motion),
	    cmocka_unit_test(test_what_is_broken),
	};
	return cmocka_run_group_tests(tests, make_gltf_folder, remove_folder);
}
