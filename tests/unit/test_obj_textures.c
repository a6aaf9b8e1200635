/* Pictures that material libraries name: where they lie on faces, what they are times, and what comes of those that
 * cannot be read. */
#define _XOPEN_SOURCE 700 /* mkdtemp */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "scene_files.h"

#include "engine/image.h"

#include <sys/stat.h>

/* Red, green; blue, white: linear light of such texels is as stored. */
static const uint8_t four[4 * 3] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
static const float RED[3] = {1, 0, 0}, GREEN[3] = {0, 1, 0}, BLUE[3] = {0, 0, 1}, WHITE[3] = {1, 1, 1};

/* A unit square from the origin, its texture coordinates its places. */
#define PLACES "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
#define MAPPED "mtllib m.mtl\n" PLACES "usemtl m\nf 1/1 2/2 3/3 4/4\n"

static void write_picture(const char *name, int width, int height, const uint8_t *rgb)
{
	assert_true(engine_image_write_png(path_of(name), width, height, rgb, message, sizeof message));
}

static engine_scene load_square(const char *library, const char *text)
{
	write_picture("four.png", 2, 2, four);
	write_text("m.mtl", library);
	return load(write_text("a.obj", text));
}

/* Mean over a small triangle about a place of the first face, whose texture coordinates are those of its corners'
 * places. */
static void texel_at(const engine_scene *scene, const engine_texture_use *use, const float *uvs, double x, double y,
		     float mean[4])
{
	float at[3][2];
	const float corners[3][2] = {{-.01f, -.01f}, {.01f, -.01f}, {0, .01f}};
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 2; i++) {
			const float u = (float)x + corners[k][0], v = (float)y + corners[k][1];
			at[k][i] = uvs[i] + u * (uvs[2 + i] - uvs[i]) + v * (uvs[6 + i] - uvs[i]);
		}
	assert_true(use->number >= 1 && use->number <= scene->texture_count);
	engine_texture_mean(&scene->textures[use->number - 1], use, at, mean);
}

/* What lies in the lower left, lower right, upper left and upper right quarter. */
static void check_quarters(const engine_scene *scene, const engine_texture_use *use, const float *quarters[4])
{
	for (int k = 0; k < 4; k++) {
		float mean[4];
		texel_at(scene, use, scene->objects[0].mesh.uvs, .25 + .5 * (k % 2), .25 + .5 * (k / 2), mean);
		check_floats(mean, quarters[k], 3, 1e-6f);
	}
}

/* A picture's top row lies where v is 1. */
static void pictures_lie_where_vt_says(void **state)
{
	(void)state;
	const float *upright[4] = {BLUE, WHITE, RED, GREEN}, *right[4] = {WHITE, WHITE, WHITE, WHITE};
	engine_scene scene = load_square("newmtl m\nKd 0.5 0.8 0.4\nmap_Kd four.png\n", MAPPED);
	const engine_scene_material *m = &scene.materials[0];
	assert_string_equal(scene.warning, "");
	CHECK3(m->rho, .25f, .4f, .2f);
	CHECK3(m->rho_factor, .5f, .8f, .4f);
	check_quarters(&scene, &m->rho_texture, upright);
	engine_scene_free(&scene);
	/* Numbers from the end, and texture coordinates that come after the face. */
	scene = load_square("newmtl m\nmap_Kd four.png\n",
			    "mtllib m.mtl\n" PLACES "usemtl m\nf -4/-4/1 -3/-3/1 -2/-2/1 -1/-1/1\n");
	check_quarters(&scene, &scene.materials[0].rho_texture, upright);
	CHECK3(scene.materials[0].rho_factor, 1, 1, 1);
	engine_scene_free(&scene);
	scene = load_square("newmtl m\nmap_Kd four.png\n",
			    "mtllib m.mtl\nusemtl m\nf 1/1 2/2 3/3 4/4\nvt .6 .1\nvt .9 .1\nvt .9 .4\nvt .6 .4\n"
			    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n");
	check_quarters(&scene, &scene.materials[0].rho_texture, right);
	engine_scene_free(&scene);
}

static void options_place_pictures(void **state)
{
	(void)state;
	const struct {
		const char *line;
		const float *quarters[4];
		bool clamp;
	} kinds[] = {
	    {"-o 0.5 0", {WHITE, BLUE, GREEN, RED}, false},
	    {"-o 0.5 0 0 -blendu off -clamp on", {WHITE, WHITE, GREEN, GREEN}, true},
	    {"-s -1 1 1", {WHITE, BLUE, GREEN, RED}, false},
	    {"-s 1 -1 1 -texres 64 -imfchan m", {RED, GREEN, BLUE, WHITE}, false},
	    {"-clamp off -s 0.5", {BLUE, BLUE, RED, RED}, false},
	    {"-unheard of", {BLUE, WHITE, RED, GREEN}, false},
	};
	for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
		char library[128];
		snprintf(library, sizeof library, "newmtl m\nmap_Kd %s four.png\n", kinds[k].line);
		engine_scene scene = load_square(library, MAPPED);
		const engine_scene_material *m = &scene.materials[0];
		assert_string_equal(scene.warning, "");
		check_quarters(&scene, &m->rho_texture, (const float **)kinds[k].quarters);
		assert_int_equal(m->rho_texture.wrap[0], kinds[k].clamp ? ENGINE_WRAP_CLAMP : ENGINE_WRAP_REPEAT);
		engine_scene_free(&scene);
	}
	write_picture("four by two.png", 2, 2, four);
	check_told(path_of("a.obj"), "");
	static const char *const names[] = {"newmtl m\nmap_Kd -s 1 1 1 four by two.png \n",
					    "newmtl m\nmap_Kd -s 1 1 1 \"four by two.png\"\n"};
	for (int k = 0; k < 2; k++) {
		engine_scene scene = load_square(names[k], MAPPED);
		assert_int_equal(scene.texture_count, 1);
		engine_scene_free(&scene);
	}
}

/* A face with a corner that has no vt, or one that is not there, has the mean of all. */
static void faces_without_vt_have_the_mean(void **state)
{
	(void)state;
	engine_scene scene =
	    load_square("newmtl m\nmap_Kd four.png\n", "mtllib m.mtl\n" PLACES "usemtl m\nf 1/1 2 3/3\nf 1/1 3/3 4/9\n"
						       "f 4//1 3//1 2//1\nf 1/x 2/2 4/4\n");
	const engine_mesh *mesh = &scene.objects[0].mesh;
	assert_int_equal(mesh->face_count, 4);
	for (uint32_t f = 0; f < 4; f++) {
		float at[3][2], mean[4];
		memcpy(at, mesh->uvs + 6 * f, sizeof at);
		engine_texture_mean(&scene.textures[0], &scene.materials[0].rho_texture, at, mean);
		CHECK3(mean, .5f, .5f, .5f);
	}
	engine_scene_free(&scene);
	scene =
	    load_square("newmtl m\nmap_Kd four.png\n", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl m\nf 1 2 3\n");
	CHECK3(scene.materials[0].rho, .5f, .5f, .5f);
	engine_scene_free(&scene);
}

static void emission_is_read(void **state)
{
	(void)state;
	engine_scene scene = load_square("newmtl m\nKd .5 .5 .5\nKe 4 8 12\nmap_Ke four.png\n", MAPPED);
	const engine_scene_material *m = &scene.materials[0];
	assert_string_equal(scene.warning, "");
	CHECK3(m->radiance, 2, 4, 6);
	CHECK3(m->radiance_factor, 4, 8, 12);
	check_quarters(&scene, &m->radiance_texture, (const float *[]){BLUE, WHITE, RED, GREEN});
	assert_int_equal(m->rho_texture.number, 0);
	engine_scene_free(&scene);
	scene = load_square("newmtl m\nmap_Ke four.png\n", MAPPED);
	CHECK3(scene.materials[0].radiance, .5f, .5f, .5f);
	engine_scene_free(&scene);
	/* One picture, however often it is named, is one texture. */
	scene = load_square("newmtl m\nKe 1 1 1\nmap_Ke four.png\nmap_Kd four.png\n", MAPPED);
	assert_int_equal(scene.texture_count, 1);
	engine_scene_free(&scene);
}

/* The left half is a hole: a face is left out where more than half of it is open. */
static void alpha_is_coverage(void **state)
{
	(void)state;
	static const uint8_t holes[2 * 3] = {0, 0, 0, 255, 255, 255}, red[2 * 3] = {0, 255, 255, 255, 0, 0};
	static const char quarters[] =
	    "mtllib m.mtl\nvt 0 0\nvt .4 0\nvt .4 1\nvt .6 0\nvt 1 0\nvt 1 1\nvt .1 0\nvt .8 0\nvt .8 1\n"
	    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 2 0\nv 1 2 0\nusemtl m\n"
	    "f 1/1 2/2 3/3\nf 1/4 3/5 4/6\nf 3/7 5/8 6/9\n";
	static const struct {
		const char *line;
		uint32_t faces;
	} kinds[] = {{"map_d holes.png", 2},
		     {"map_d -imfchan l holes.png", 2},
		     {"map_d -imfchan m holes.png", 3}, /* its own alpha: none */
		     {"map_d -imfchan r red.png", 2},
		     {"map_d -imfchan g red.png", 1},
		     {"map_Kd holes.png", 3}};
	write_picture("holes.png", 2, 1, holes);
	write_picture("red.png", 2, 1, red);
	for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
		char library[128];
		snprintf(library, sizeof library, "newmtl m\nKd .5 .5 .5\n%s\n", kinds[k].line);
		engine_scene scene = load_square(library, quarters);
		if (scene.objects[0].mesh.face_count != kinds[k].faces)
			fail_msg("%s: %u faces, not %u", kinds[k].line, scene.objects[0].mesh.face_count,
				 kinds[k].faces);
		assert_true((kinds[k].faces < 3) == (strstr(scene.warning, "let light through") != NULL));
		engine_scene_free(&scene);
	}
}

/* A mask is the alpha of the picture, or of a white one, where both lie alike: so it cuts what is drawn. */
static void masks_cut_pictures(void **state)
{
	(void)state;
	static const uint8_t holes[4 * 3] = {0, 0, 0, 255, 255, 255, 255, 255, 255, 255, 255, 255};
	static const struct {
		const char *lines;
		bool joined;
		uint32_t textures;
		const float *first;
	} kinds[] = {{"map_d holes.png\n", true, 2, WHITE},
		     {"map_Kd four.png\nmap_d holes.png\n", true, 3, RED},
		     {"map_d -s 2 2 holes.png\nmap_Kd -s 2 2 1 four.png\n", true, 3, RED},
		     {"map_Kd four.png\nmap_d -s 2 2 holes.png\n", false, 2, RED},
		     {"map_Kd -clamp on four.png\nmap_d holes.png\n", false, 2, RED}};
	write_picture("holes.png", 4, 1, holes);
	for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
		char library[128];
		snprintf(library, sizeof library, "newmtl m\nKd .3 .4 .5\n%s", kinds[k].lines);
		engine_scene scene = load_square(library, MAPPED);
		const engine_scene_material *m = &scene.materials[0];
		const engine_texture *t = &scene.textures[m->rho_texture.number - 1];
		assert_string_equal(scene.warning, "");
		assert_int_equal(scene.texture_count, kinds[k].textures);
		assert_int_equal(m->rho_texture.number == m->alpha_texture.number, kinds[k].joined);
		CHECK3(m->rho_factor, .3f, .4f, .5f);
		check_floats(&(float){t->mean[3]}, &(float){kinds[k].joined ? .75f : 1}, 1, 1e-6f);
		for (int c = 0; c < 3; c++)
			assert_int_equal(t->pixels.rgba[c], (int)(255 * kinds[k].first[c]));
		assert_int_equal(t->pixels.rgba[3], kinds[k].joined ? 0 : 255);
		assert_int_equal(t->pixels.width, kinds[k].joined ? 4 : 2);
		engine_scene_free(&scene);
	}
}

/* The factor holds then, and a line says why. */
static void pictures_that_cannot_be_read(void **state)
{
	(void)state;
	static const struct {
		const char *line, *words;
	} kinds[] = {
	    {"map_Kd none.png", "textures of Kd are left out: cannot be opened (No such file or directory) (\"m\")"},
	    {"map_Ke none.png", "textures of Ke are left out: cannot be opened"},
	    {"map_d none.png", "textures of d are left out: cannot be opened"},
	    {"map_Kd /etc/passwd", "textures of Kd are left out: is an absolute"},
	    {"map_Kd ../../../../etc/passwd", "textures of Kd are left out: lies outside"},
	    {"map_Kd broken.png", "textures of Kd are left out: its PNG is broken or cut off"},
	    {"map_Kd text.png", "textures of Kd are left out: it is neither PNG nor JPEG"},
	    {"map_Kd pipe.png", "textures of Kd are left out: "},
	    {"map_Kd", "broken lines of material libraries are not read (\"a texture, line 4"},
	    {"map_Kd -s 2 2", "(\"a texture, line 4"},
	};
	static const uint8_t broken[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n', 0, 0, 0, 13, 'I', 'H', 'D', 'R'};
	write_file("broken.png", broken, sizeof broken);
	write_text("text.png", "no picture");
	assert_int_equal(mkfifo(path_of("pipe.png"), 0600), 0);
	for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
		char library[128];
		snprintf(library, sizeof library, "newmtl m\nKd .3 .4 .5\nKe 1 2 3\n%s\n", kinds[k].line);
		engine_scene scene = load_square(library, MAPPED);
		if (!strstr(scene.warning, kinds[k].words))
			fail_msg("\"%s\" is not \"%s\"", scene.warning, kinds[k].words);
		CHECK3(scene.materials[0].rho, .3f, .4f, .5f);
		CHECK3(scene.materials[0].radiance, 1, 2, 3);
		assert_int_equal(scene.objects[0].mesh.face_count, 1);
		engine_scene_free(&scene);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(pictures_lie_where_vt_says),
	    cmocka_unit_test(options_place_pictures),
	    cmocka_unit_test(faces_without_vt_have_the_mean),
	    cmocka_unit_test(emission_is_read),
	    cmocka_unit_test(alpha_is_coverage),
	    cmocka_unit_test(masks_cut_pictures),
	    cmocka_unit_test(pictures_that_cannot_be_read),
	};
	return cmocka_run_group_tests_name("obj textures", tests, make_folder, remove_folder);
}
