/* EXT_lights_image_based: which way its faces look, what turns and scales them, and what comes of broken ones. */
#define _XOPEN_SOURCE 700 /* mkdtemp */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "scene_files.h"

/* Two texels by two: red says the sign, blue the axis (0, 128, 255), green the place: 0 and 85 in the upper row, 170
 * and 255 in the lower one. In the order of the faces. */
static const char *const cube[6] = {
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAFUlEQVR42mP4z8DwPxSIVzH8/88AACg7"
    "Bfs9m4CfAAAAAElFTkSuQmCC",
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAE0lEQVR42mNgAIJQIF7FwPCfAQAIWwH/"
    "Cfo5jQAAAABJRU5ErkJggg==",
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAFklEQVR42mP4z9DwP7SB4f+qhv//GwA0"
    "Owf7h/FUvQAAAABJRU5ErkJggg==",
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAFklEQVR42mNgYGhgCG1gYFjVwPC/AQAU"
    "WwP/zg707wAAAABJRU5ErkJggg==",
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAE0lEQVR42mP4z/D/fyiQWPUfCABAIwn3"
    "fBP/dQAAAABJRU5ErkJggg==",
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAFklEQVR42mNgYPjPEPqfgWHVf4b//wEg"
    "QwX7h7+GrQAAAABJRU5ErkJggg==",
};

/* One texel of 255 188 0, alpha a fifth: 5, 2.5 and 0. */
#define RGBD "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP4v4fBGAAGaAHv3+ucYAAAAABJRU5ErkJggg=="

static const double PI = 3.14159265358979323846;

static char text[16384];

static void add(const char *part)
{
	assert_true(strlen(text) + strlen(part) < sizeof text);
	strcat(text, part);
}

static void begin(const char *light, const char *reference)
{
	text[0] = '\0';
	add("{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[],\"extensions\":{"
	    "\"EXT_lights_image_based\":");
	add(reference);
	add("}}],\"extensionsUsed\":[\"EXT_lights_image_based\"],\"extensionsRequired\":[\"EXT_lights_image_based\"],"
	    "\"extensions\":{\"EXT_lights_image_based\":{\"lights\":[{\"name\":\"noon\"");
	add(light);
	add("}]}},\"images\":[");
}

static void add_image(const char *base64, bool last)
{
	add("{\"uri\":\"data:image/png;base64,");
	add(base64);
	add(last ? "\"}]}" : "\"},");
}

static engine_scene load_cube(const char *light)
{
	begin(light, "{\"light\":0}");
	for (int k = 0; k < 6; k++)
		add_image(cube[k], k == 5);
	return load(write_text("a.gltf", text));
}

#define FACES ",\"specularImages\":[[0,1,2,3,4,5],[0,0,0,0,0,0]],\"specularImageSize\":2"

/* As gi_set_sky_image lays pictures round the scene. */
static const float *seen_at(const engine_sky *sky, const double d[3])
{
	const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
	const double column = (atan2(d[0], -d[2]) / (2 * PI) + .5) * sky->width;
	const double row = acos(d[1] / length) / PI * sky->height;
	return sky->radiance + 3 * ((size_t)row * sky->width + (size_t)fmin(column, sky->width - 1));
}

/* Green of a texel of a face, in linear light. */
static float green_of(int k)
{
	return (float)engine_linear_of_srgb((double[]){0, 85, 170, 255}[k] / 255);
}

/* Looking at the middle of a face from inside, with this up and its right hand: all that the extension says of faces is
 * that they are OpenGL's mirrored. */
static void check_face(const engine_sky *sky, int face, const double right[3], const double up[3], float scale)
{
	double ahead[3];
	for (int k = 0; k < 3; k++)
		ahead[k] = up[(k + 1) % 3] * right[(k + 2) % 3] - up[(k + 2) % 3] * right[(k + 1) % 3];
	for (int k = 0; k < 4; k++) {
		double d[3];
		for (int c = 0; c < 3; c++)
			d[c] = ahead[c] + (k % 2 ? .5 : -.5) * right[c] + (k / 2 ? -.5 : .5) * up[c];
		const float wanted[3] = {face % 2 ? 0 : scale, scale * green_of(k),
					 scale * (float)engine_linear_of_srgb((double[]){0, 128, 255}[face / 2] / 255)};
		check_floats(seen_at(sky, d), wanted, 3, 1e-5f * scale);
	}
}

static const double X[3] = {1, 0, 0}, Y[3] = {0, 1, 0}, Z[3] = {0, 0, 1}, LEFT[3] = {-1, 0, 0}, BACK[3] = {0, 0, -1};

static void faces_are_seen_from_inside(void **state)
{
	(void)state;
	engine_scene scene = load_cube(FACES);
	assert_string_equal(scene.warning, "the file holds no faces");
	assert_true(scene.sky.radiance && scene.sky.width == 2 * scene.sky.height);
	check_face(&scene.sky, 0, Z, Y, 1);
	check_face(&scene.sky, 1, BACK, Y, 1);
	check_face(&scene.sky, 2, LEFT, BACK, 1);
	check_face(&scene.sky, 3, LEFT, Z, 1);
	check_face(&scene.sky, 4, LEFT, Y, 1);
	check_face(&scene.sky, 5, X, Y, 1);
	engine_scene_free(&scene);
}

/* By 90 degrees about y: what was towards +z is towards +x then, a right hand that was -x is +z. */
static void they_are_turned_and_scaled(void **state)
{
	(void)state;
	engine_scene scene = load_cube(FACES ",\"intensity\":3,\"rotation\":[0,0.70710678,0,0.70710678]");
	check_face(&scene.sky, 4, Z, Y, 3);
	check_face(&scene.sky, 0, X, Y, 3);
	check_face(&scene.sky, 2, Z, LEFT, 3);
	engine_scene_free(&scene);
}

static void colours_may_be_divided_by_alpha(void **state)
{
	(void)state;
	begin(",\"specularImages\":[[0,0,0,0,0,0]]", "{\"light\":0}");
	add_image(RGBD, true);
	engine_scene scene = load(write_text("a.gltf", text));
	for (uint32_t k = 0; k < scene.sky.width * scene.sky.height; k++)
		check_floats(scene.sky.radiance + 3 * k, (const float[3]){5, 2.5f, 0}, 3, .02f);
	engine_scene_free(&scene);
}

/* The irradiance of a sky of 2 everywhere, of which the upper half has 2 cos more than the lower one has less: its
 * radiance is 2 + 3 / 2 y in these bands; the band of squares adds where it is given. */
#define COEFFICIENTS(up, squares)                                                                                      \
	",\"irradianceCoefficients\":[[22.27332,22.27332,22.27332],[" up "," up "," up "],[0,0,0],[0,0,0],[0,0,0],"    \
	"[0,0,0],[" squares "," squares "," squares "],[0,0,0],[0,0,0]]"

static void coefficients_stand_in(void **state)
{
	(void)state;
	begin(COEFFICIENTS("0", "0"), "{\"light\":0}");
	add_image(RGBD, true);
	engine_scene scene = load(write_text("a.gltf", text));
	assert_non_null(strstr(scene.warning, "are read by their coefficients: it has no specularImages (\"noon\")"));
	for (uint32_t k = 0; k < scene.sky.width * scene.sky.height; k++)
		check_floats(scene.sky.radiance + 3 * k, (const float[3]){2, 2, 2}, 3, 1e-4f);
	engine_scene_free(&scene);
	/* L = 2 + y: the coefficient of y is 1 / 0.4886025, its irradiance's 2 pi / 3 of that */
	begin(COEFFICIENTS("4.286497", "0") ",\"intensity\":0.5,\"specularImages\":[[0,1,2]]", "{\"light\":0}");
	add_image(RGBD, true);
	scene = load(write_text("a.gltf", text));
	for (int k = -9; k <= 9; k++) {
		const double d[3] = {sqrt(1 - .01 * k * k), .1 * k, 0};
		assert_true(fabs((double)seen_at(&scene.sky, d)[1] - .5 * (2 + .1 * k)) < .02);
	}
	engine_scene_free(&scene);
}

static void broken_ones_cost_themselves(void **state)
{
	(void)state;
	static const struct {
		const char *light, *reference, *words;
	} kinds[] = {
	    {"", "{\"light\":0}", "image-based lights are left out: it has no specularImages (\"noon\")"},
	    {"", "{\"light\":1}", "left out: the file does not hold it"},
	    {"", "{}", "left out: the file does not hold it"},
	    {"", "7", "left out: the file does not hold it"},
	    {",\"specularImages\":[[0,0,0,0,0]]", "{\"light\":0}", "left out: its specularImages are not six images"},
	    {",\"specularImages\":[[0,0,0,0,0,0,0]]", "{\"light\":0}", "left out: its specularImages are not six"},
	    {",\"specularImages\":[[0,0,0,0,0,9]]", "{\"light\":0}", "left out: its specularImages are not six images"},
	    {",\"specularImages\":[]", "{\"light\":0}", "left out: its specularImages are not six images"},
	    {",\"specularImages\":[[0,0,0,0,0,1]]", "{\"light\":0}", "left out: its PNG is broken or cut off"},
	    {",\"specularImages\":[[0,0,0,0,0,0]],\"intensity\":-1", "{\"light\":0}", "left out: its intensity"},
	    {",\"specularImages\":[[0,0,0,0,0,0]],\"rotation\":[0,0,0,0]", "{\"light\":0}", "no unit quaternion"},
	    {",\"irradianceCoefficients\":[[1,1,1]]", "{\"light\":0}", "left out: it has no specularImages"},
	};
	for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
		begin(kinds[k].light, kinds[k].reference);
		add_image(RGBD, false);
		add_image("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGNg", true);
		engine_scene scene = load(write_text("a.gltf", text));
		if (!strstr(scene.warning, kinds[k].words))
			fail_msg("\"%s\" is not \"%s\"", scene.warning, kinds[k].words);
		assert_null(scene.sky.radiance);
		engine_scene_free(&scene);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(faces_are_seen_from_inside),      cmocka_unit_test(they_are_turned_and_scaled),
	    cmocka_unit_test(colours_may_be_divided_by_alpha), cmocka_unit_test(coefficients_stand_in),
	    cmocka_unit_test(broken_ones_cost_themselves),
	};
	return cmocka_run_group_tests_name("skies of glTF", tests, make_folder, remove_folder);
}
