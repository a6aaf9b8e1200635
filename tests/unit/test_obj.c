/* OBJ and MTL: what the lines mean, however they are written, what is told or refused, and that no file takes long. */
#define _XOPEN_SOURCE 700 /* mkdtemp, mkfifo */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "scene_files.h"

#include <sys/stat.h>

/* A unit square in z = 0 and what stands behind it. */
#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
#define TRIANGLE "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n"

static const char obj_text[] = "mtllib a.mtl\n" SQUARE "v 2 0 0\nv 2 1 0\n"
			       "vt 0 0\nvt 1 1\nvn 0 0 1\nvn 0 1 0\n"
			       "o left\nusemtl lamp\nf 1/1/1 2/2/2 3/1/1 4/1/2\nusemtl wall\nf 2/1/2 5/2/1 3/2/2\n"
			       "o right\nf 5 6 3\n";
static const char mtl_text[] = "newmtl lamp\nKd 0.25 0.5 0.75\nKe 3 2 1\nnewmtl wall\nKd 0.1 0.1 0.1\n";

static engine_scene load_obj(const char *text)
{
	return load(write_text("a.obj", text));
}

static void check_obj_refused(const char *text, const char *words)
{
	check_refused(write_text("a.obj", text), words);
}

/* A triangle of the material "m" that `library` describes. */
static engine_scene load_material(const char *library)
{
	write_text("m.mtl", library);
	return load_obj("mtllib m.mtl\nusemtl m\n" TRIANGLE);
}

static void check_material(const char *library, float rho, float radiance, const char *words)
{
	engine_scene scene = load_material(library);
	assert_int_equal(scene.material_count, 1);
	CHECK3(scene.materials[0].rho, rho, rho, rho);
	CHECK3(scene.materials[0].radiance, radiance, radiance, radiance);
	if (!strstr(scene.warning, words) || (!words[0] && scene.warning[0]))
		fail_msg("\"%s\" is not \"%s\"", scene.warning, words);
	engine_scene_free(&scene);
}

/* ---- lines ------------------------------------------------------------------------------------------------------- */

static void objects_polygons_and_materials(void **state)
{
	(void)state;
	write_text("a.mtl", mtl_text);
	engine_scene scene = load_obj(obj_text);
	assert_int_equal(scene.object_count, 2);
	const engine_mesh *mesh = &scene.objects[0].mesh;
	assert_string_equal(scene.objects[0].name, "left");
	assert_string_equal(scene.objects[1].name, "right");
	assert_int_equal(mesh->face_count, 2);
	assert_int_equal(mesh->face_counts[0], 4); /* polygons stay */
	assert_int_equal(mesh->vertex_count, 5);   /* connected across normals and materials */
	const engine_scene_material *lamp = &scene.materials[mesh->face_materials[0]];
	assert_string_equal(lamp->name, "lamp");
	CHECK3(lamp->rho, 0.25f, 0.5f, 0.75f);
	CHECK3(lamp->radiance, 3, 2, 1);
	assert_string_equal(scene.materials[mesh->face_materials[1]].name, "wall");
	assert_string_equal(scene.warning, "");
	engine_mesh merged;
	assert_true(engine_scene_merge(&scene, &merged, message, sizeof message));
	assert_int_equal(merged.vertex_count, 6);
	assert_int_equal(merged.face_count, 3);
	engine_mesh_free(&merged);
	engine_scene_free(&scene);
}

static void numbers_in_every_form(void **state)
{
	(void)state;
	engine_scene scene = load_obj("v -.5 +.5 5e-1\nv 1. 1E+1 -0\nv\t2.5e0  -0.25\t0 # why not\nf 1 2 3");
	const float expected[9] = {-0.5f, 0.5f, 0.5f, 1, 10, 0, 2.5f, -0.25f, 0};
	check_floats(scene.objects[0].mesh.positions, expected, 9, 0);
	engine_scene_free(&scene);
}

/* The square as one face, whatever its lines look like. */
static void check_square(const char *text)
{
	engine_scene scene = load_obj(text);
	const float expected[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
	assert_int_equal(scene.object_count, 1);
	assert_int_equal(scene.objects[0].mesh.face_count, 1);
	assert_int_equal(scene.objects[0].mesh.vertex_count, 4);
	check_floats(scene.objects[0].mesh.positions, expected, 12, 0);
	assert_string_equal(scene.warning, "");
	engine_scene_free(&scene);
}

static void lines_in_every_form(void **state)
{
	(void)state;
	check_square(SQUARE "f 1 2 3 4");
	check_square("v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nf 1 2 3 4\r\n");
	check_square("v 0 0 0\rv 1 0 0\rv 1 1 0\rv 0 1 0\rf 1 2 3 4\r");
	check_square("\xef\xbb\xbfv 0 0 0\n\n\t v 1 0 0  \nv 1 1 0\nv 0 1 0\nf\t1 2 3 4 \n# f 1 2 3 \\\n");
	check_square(SQUARE "f 1 2 \\\n3 \\\r\n 4\n");
	check_square("# C:\\models\\\n" SQUARE "f 1 2 3 4 # one face\n");
	check_square(SQUARE "f 1 2 3 4 \\");
	check_square(SQUARE "s off\ns 1\nvt 0\nvn 1 0 0\nf 1 2 3 4\n");
	check_square("v 0 0 0 1\nv 1 0 0 1\nv 1 1 0 1\nv 0 1 0 1\nf 1 2 3 4\n"); /* with a weight */
}

static void corners_in_every_form(void **state)
{
	(void)state;
	check_square(SQUARE "f -4 -3 -2 -1\n");
	check_square(SQUARE "f 1/1 2/2 3/3 4/4\n"); /* numbers of texture coordinates are not looked at */
	check_square(SQUARE "f 1//7 2//7 3//7 4//7\n");
	check_square(SQUARE "f 1/1/1 -3/-1/-1 +3/ 04\n");
	check_square("f 1 2 3 4\n" SQUARE);
	check_square("v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1 4\nv 0 1 0\n");
}

static void bad_lines_cost_their_faces(void **state)
{
	(void)state;
	static const char *const vertices[] = {"nan 0 0", "1 -inf 0", "1e16 0 0", "1e999 0 0", "1,5 0 0",
					       "0x1 0 0", "0 0",      "",         "a b c"};
	static const char *const faces[] = {
	    "0 1 2",          "1 2 -7",    "1 2 6",   "1 2 99999999999999999999", "1 2 -99999999999999999999",
	    "1 2 4294967299", "1 2 three", "1 2 3.5", "9999 9999 9999 9999"};
	char text[400], told[200];
	/* One bad line costs its faces. */
	for (size_t k = 0; k < sizeof vertices / sizeof *vertices; k++) {
		snprintf(text, sizeof text, SQUARE "v %s\nf 1 2 3\nf 1 2 5\n", vertices[k]);
		snprintf(told, sizeof told,
			 "vertices that are not three numbers within 1e15 m are left out (\"line 5: %s\"); "
			 "faces with a corner that is not there, not finite or beyond 1e15 m are left out (\"line 7\")",
			 vertices[k]);
		check_told(write_text("a.obj", text), told);
		snprintf(text, sizeof text, "v %s\n" SQUARE "f 1 2 5\n", vertices[k]);
		check_obj_refused(text, "line 1: ");
	}
	for (size_t k = 0; k < sizeof faces / sizeof *faces; k++) {
		snprintf(text, sizeof text, SQUARE "f 1 2 3\nf %s\n", faces[k]);
		check_told(write_text("a.obj", text),
			   "faces with a corner that is not there, not finite or beyond 1e15 m "
			   "are left out (\"line 6\")");
		snprintf(text, sizeof text, SQUARE "\nf \\\n%s\n", faces[k]);
		check_obj_refused(text, "1 of its 1 faces cannot be used, it may be cut off: faces with a corner");
	}
	check_told(write_text("a.obj", SQUARE "f 1 2 9\nf 1 2 3\nf 1 3 4\nf 0 1 2\n"),
		   "are left out (2, first: \"line 5\")");
	check_obj_refused("hello\n", "holds no faces");
	check_obj_refused(SQUARE, "holds no faces");
	check_obj_refused(SQUARE "f 1 2\n", "holds no faces");
	check_obj_refused("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
			  "none of its 1 faces can be used: faces without area");
}

/* A vertex astray costs its face, not the object; nor is it left for a camera that wants to see everything. */
static void far_corners_cost_their_faces(void **state)
{
	(void)state;
	static const char *const far[] = {"1e10 1e10 0", "0 -2e12 0", "0 0.5 5e9"};
	char text[300];
	for (size_t k = 0; k < sizeof far / sizeof *far; k++) {
		snprintf(text, sizeof text, SQUARE "v %s\nv 3e9 1 1\nf 1 2 3 4\nf 1 5 6\n", far[k]);
		engine_scene scene = load_obj(text);
		assert_int_equal(scene.object_count, 1);
		assert_int_equal(scene.objects[0].mesh.face_count, 1);
		assert_int_equal(scene.objects[0].mesh.vertex_count, 4);
		assert_non_null(strstr(scene.warning, "faces beyond 1e9 m are left out (\"object0\")"));
		engine_scene_free(&scene);
	}
	check_obj_refused("v 0 0 0\nv 2e9 0 0\nv 0 2e9 0\nf 1 2 3\n", "objects beyond 1e9 m are left out");
}

static void what_is_not_read_is_told(void **state)
{
	(void)state;
	check_obj_refused(SQUARE "F 1 2 3 4\n", "holds no faces: lines of other kinds are not read (\"F, line 5\")");
	check_obj_refused("\xff\xfev\0", "is UTF-16; save it as UTF-8");
	check_square(SQUARE "fo 1 2 3 4\n");
	check_told(write_text("a.obj", TRIANGLE "l 1 2\np 1\nl 2 3\n"), "points and lines (p, l) are left out (3)");
	check_told(write_text("a.obj", TRIANGLE "cstype bezier\ncurv 0 1 2\n"),
		   "lines of other kinds are not read (2, first: \"cstype, line 5\")");
	check_told(write_text("a.obj", TRIANGLE "f 1 2\nf\n"), "faces of fewer than three corners are left out (2)");
}

static void groups_become_objects(void **state)
{
	(void)state;
	engine_scene scene = load_obj(SQUARE "f 1 2 3\ng a\nf 1 2 3\ng b c\nf 1 2 4\ng a\nf 1 3 4\no x\nf 2 3 4\n"
					     "g a\nf 1 2 3\ng empty\no x\nf 1 3 4\n");
	static const char *const names[] = {"object0", "a", "b c", "x", "a#2"};
	static const uint32_t faces[] = {1, 2, 1, 2, 1};
	assert_int_equal(scene.object_count, 5);
	for (int i = 0; i < 5; i++) {
		assert_string_equal(scene.objects[i].name, names[i]);
		assert_int_equal(scene.objects[i].mesh.face_count, faces[i]);
	}
	engine_scene_free(&scene);
}

/* ---- materials --------------------------------------------------------------------------------------------------- */

static void materials_in_every_form(void **state)
{
	(void)state;
	check_material("newmtl m\nKd 0.5\nKe 2\n", 0.5f, 2, "");
	check_material("newmtl m\nKd .5 +5e-1 0.5 # grey\n", 0.5f, 0, "");
	check_material("\tnewmtl m \r\n  Kd 0.5 0.5 0.5\r\n", 0.5f, 0, "");
	check_material("newmtl m\nKe 2 2 2\n", 0.6f, 2, ""); /* not stated */
	check_material("newmtl m\nKd 0.25 0.25 0.25\nnewmtl m\nKd 0.5 0.5 0.5\n", 0.5f, 0, "");
	check_material(
	    "newmtl m\nKd 0.5 0.5 0.5\nPr 0.5\nPm 0\nPs 0\nPc 0\nPcr 0.03\naniso 0\nanisor 0\nnorm n.png\n"
	    "Ka 1 1 1\nKs 0.5 0.5 0.5\nNs 250\nNi 1.45\nd 1\nTr 0\nillum 2\nTf 1 1 1\nmap_Bump -bm 1 b.png\n",
	    0.5f, 0, "");
}

static void materials_no_face_uses_do_not_matter(void **state)
{
	(void)state;
	check_material("newmtl m\nKd 0.5 0.5 0.5\nnewmtl white\nKd 1 1 1\nd 0.1\n", 0.5f, 0, "");
}

static void what_matt_surfaces_cannot_show_is_told(void **state)
{
	(void)state;
	check_material("newmtl m\nKd 0 0 0\nKs 0.9 0.9 0.9\n", 0, 0, "are taken as diffuse (\"m\")");
	check_material("newmtl m\nKd 0.5 0.5 0.5\nillum 5\n", 0.5f, 0, "are taken as diffuse (\"m\")");
	check_material("newmtl m\nKd 0.5 0.5 0.5\nPm 1\n", 0.5f, 0, "are taken as diffuse (\"m\")");
	check_material("newmtl m\nKd 0.5 0.5 0.5\nd 0.1\n", 0.5f, 0, "transparency (d, Tr) is taken as opaque (\"m\")");
	check_material("newmtl m\nKd 0.5 0.5 0.5\nTr 0.9\n", 0.5f, 0,
		       "transparency (d, Tr) is taken as opaque (\"m\")");
	check_material("newmtl m\nKd 0.5 0.5 0.5\nd -halo 0.9\n", 0.5f, 0,
		       "transparency (d, Tr) is taken as opaque (\"m\")");
	check_material("newmtl m\nmap_Kd -t 1 1 1 wall.png\n", 0.6f, 0, "options -t, -mm and -cc of textures");
}

static void broken_libraries_cost_no_file(void **state)
{
	(void)state;
	check_material("newmtl m\nKd 0.5 0.5\n", 0.6f, 0,
		       "broken lines of material libraries are not read (\"Kd, line 2 of m.mtl\")");
	check_material("newmtl m\nKd -1 0 0\n", 0.6f, 0, "line 2");
	check_material("newmtl m\nKd nan 0 0\n", 0.6f, 0, "line 2");
	check_material("newmtl m\n\nKe 1e999 0 0\n", 0.6f, 0, "Ke, line 3 of m.mtl");
	check_material("newmtl m\nKe 1e38\n", 0.6f, 3e11f, "emit the nearest");
	check_material("newmtl m\nKd spectral file.rfl 1\n", 0.6f, 0, "line 2");
	check_material("map_bump -bm 1 wood.png\nmap_Kd wood.png\nKd 1 1 1\nnewmtl m\nKd 0.5 0.5 0.5\n", 0.5f, 0,
		       "not read (2, first: \"before newmtl, line 2 of m.mtl\")");
	check_material("Kd", 0.6f, 0, "in no library get a reflectance of 0.6 (\"m\")");
}

static void missing_libraries_are_told(void **state)
{
	(void)state;
	unlink(path_of("a.mtl"));
	check_told(write_text("a.obj", obj_text),
		   "a material library cannot be opened (No such file or directory) (\"a.mtl\")");
	check_told(write_text("a.obj", TRIANGLE), "");
	engine_scene scene = load_obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
	CHECK3(scene.materials[scene.objects[0].mesh.face_materials[0]].rho, 0.5f, 0.5f, 0.5f);
	engine_scene_free(&scene);
}

static void libraries_lie_below_the_scene(void **state)
{
	(void)state;
	check_told(write_text("a.obj", "mtllib ../../etc/passwd\n" TRIANGLE), "lies outside of the scene's folder");
	check_told(write_text("a.obj", "mtllib /etc/passwd\n" TRIANGLE), "absolute");
	assert_int_equal(mkfifo(path_of("pipe.mtl"), 0600), 0);
	check_told(write_text("a.obj", "mtllib pipe.mtl\n" TRIANGLE), "pipe");
	unlink(path_of("pipe.mtl"));
	assert_int_equal(mkfifo(path_of("pipe.obj"), 0600), 0);
	check_refused(path_of("pipe.obj"), "pipe.obj: ");
}

static void several_libraries(void **state)
{
	(void)state;
	write_text("one.mtl", "newmtl one\nKd 0.1 0.1 0.1\n");
	write_text("the second.mtl", "newmtl two\nKd 0.2 0.2 0.2\n");
	write_text("three.mtl", "newmtl three\nKd 0.3 0.3 0.3\n");
	engine_scene scene = load_obj("mtllib one.mtl three.mtl\nmtllib the second.mtl\nmtllib one.mtl\n" SQUARE
				      "usemtl three\nf 1 2 3\nusemtl two\nf 1 2 4\nusemtl one\nf 1 3 4\nf 2 3 4\n");
	assert_int_equal(scene.material_count, 3);
	for (int i = 0; i < 3; i++)
		assert_true(fabsf(scene.materials[i].rho[0] - 0.1f * (float)(3 - i)) < 1e-6f);
	assert_string_equal(scene.warning, "");
	engine_scene_free(&scene);
}

/* sRGB 0.5 reflects 0.214. */
static void colours_of_vertices_are_read(void **state)
{
	(void)state;
	engine_scene scene =
	    load_obj("v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\nv 0 1 0 .5 .5 .5\nf 1 2 3 4\nf 1 2 3\n"
		     "usemtl m\nf 1 2 4\n");
	CHECK_FACE(&scene, 0, 0.8035103f, 0.0535103f, 0.0535103f);
	/* A material of no library says less than the colours. */
	CHECK_FACE(&scene, 2, 0.738014f, 0.071347f, 0.071347f);
	assert_null(strstr(scene.warning, "in no library"));
	engine_scene_free(&scene);
	/* One of a library is times them. */
	write_text("m.mtl", "newmtl m\nKd .3 .4 .5\nnewmtl plain\nd 1\n");
	scene = load_obj("mtllib m.mtl\nv 0 0 0 1 0 0\nv 1 0 0 1 1 0\nv 1 1 0 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n"
			 "f 1 3 4\nusemtl plain\nf 1 2 3\nf 3 2 1\n");
	const engine_mesh *mesh = &scene.objects[0].mesh;
	CHECK_FACE(&scene, 0, 0.3f, 0.4f / 3, 0);
	CHECK_FACE(&scene, 2, 1, 1.0f / 3, 0); /* without Kd */
	CHECK3(scene.materials[mesh->face_materials[1]].rho, 0.3f, 0.4f, 0.5f);
	assert_true(mesh->colors[4 * 3] < 0); /* a corner of the second face has no colour */
	assert_non_null(strstr(scene.warning, "get 0.98"));
	engine_scene_free(&scene);
}

/* ---- places ------------------------------------------------------------------------------------------------------ */

/* Map coordinates (UTM): floats are half a metre apart at 4.6e6. */
static void far_scenes_are_moved_in_double(void **state)
{
	(void)state;
	engine_scene scene =
	    load_obj("v 500000.125 4649776.5 10\nv 500001.375 4649776.5 10\nv 500001.375 4649777.25 10\n"
		     "v 500000.125 4649777.25 10\nf 1 2 3 4\n");
	const engine_mesh *mesh = &scene.objects[0].mesh;
	printf("area of 1.25 m x 0.75 m at 500 km and 4,650 km: %.9g; %s\n", area_of(&scene.objects[0]), scene.warning);
	assert_true(fabs(area_of(&scene.objects[0]) - 1.25 * 0.75) < 1e-6);
	assert_true(fabsf(mesh->positions[0]) < 2);
	assert_non_null(strstr(scene.warning, "is moved by -500001 -4649777 -10 m"));
	engine_scene_free(&scene);
	scene = load_obj("v 50 0 0\nv 51 0 0\nv 51 1 0\nf 1 2 3\n"); /* floats are 4 micrometres apart */
	assert_true(scene.objects[0].mesh.positions[0] == 50 && !scene.warning[0]);
	engine_scene_free(&scene);
}

/* ---- effort ------------------------------------------------------------------------------------------------------ */

typedef struct long_text {
	char *bytes;
	size_t size, capacity;
} long_text;

__attribute__((format(printf, 2, 3))) static void add_text(long_text *text, const char *format, ...)
{
	va_list arguments;
	if (text->capacity - text->size < 256) {
		text->capacity = 2 * text->capacity + 4096;
		text->bytes = realloc(text->bytes, text->capacity);
		assert_non_null(text->bytes);
	}
	va_start(arguments, format);
	text->size += (size_t)vsnprintf(text->bytes + text->size, 256, format, arguments);
	va_end(arguments);
}

static engine_scene load_long(long_text *text)
{
	engine_scene scene = load(write_file("a.obj", text->bytes, text->size));
	free(text->bytes);
	return scene;
}

/* Each would take minutes where a name is looked for among all, or a line read again for every piece of it. */
static void large_files_take_linear_time(void **state)
{
	(void)state;
	enum { MANY = 20000 };
	long_text groups = {0}, line = {0}, library = {0};
	for (int i = 0; i < MANY; i++) {
		add_text(&groups, "%sg part %d\nusemtl paint %d\nf 1 2 3\n", i ? "" : "mtllib m.mtl\n" TRIANGLE,
			 i % (MANY / 2), i % (MANY / 2));
		add_text(&library, "newmtl paint %d\nKd 0.5 0.5 0.5\n", i / 2);
	}
	write_file("m.mtl", library.bytes, library.size);
	free(library.bytes);
	engine_scene scene = load_long(&groups);
	assert_int_equal(scene.object_count, MANY / 2 + 1);
	assert_int_equal(scene.material_count, MANY / 2 + 1);
	engine_scene_free(&scene);
	for (int i = 0; i < MANY; i++)
		add_text(&line, "v %.9g %.9g 0\n", cos(i * 2 * M_PI / MANY), sin(i * 2 * M_PI / MANY));
	add_text(&line, "f ");
	for (int i = 0; i < MANY; i++)
		add_text(&line, "%d/ %s", i + 1, i % 2 ? "\\\n" : "");
	scene = load_long(&line);
	assert_true(fabs(area_of(&scene.objects[0]) - M_PI) < 1e-4);
	engine_scene_free(&scene);
}

static void damaged_files_never_crash(void **state)
{
	(void)state;
	write_text("a.mtl", mtl_text);
	damage("a.obj", (const uint8_t *)obj_text, sizeof obj_text - 1, 1000);
	write_text("a.obj", obj_text);
	for (int i = 0; i < 500; i++) {
		char copy[sizeof mtl_text];
		memcpy(copy, mtl_text, sizeof copy);
		copy[next_random() % (sizeof copy - 1)] ^= (char)(1u << next_random() % 7);
		write_file("a.mtl", copy, sizeof copy - 1);
		load_damaged("a.obj", (const uint8_t *)obj_text, sizeof obj_text - 1);
	}
}

/* Real meshes, where they lie beside the project. */
static void real_meshes(void **state)
{
	(void)state;
	static const struct {
		const char *path;
		uint32_t vertices, faces;
	} meshes[] = {{RELUME_SOURCE_DIR "/../shared/meshes/spot.obj", 2930, 5856},
		      {RELUME_SOURCE_DIR "/../shared/meshes/happy_buddha_100k.obj", 49990, 99997}};
	for (int i = 0; i < 2; i++) {
		if (access(meshes[i].path, R_OK) != 0) {
			printf("skipped: there is no %s\n", meshes[i].path);
			skip();
		}
		engine_scene scene = load(meshes[i].path);
		assert_int_equal(scene.object_count, 1);
		assert_int_equal(scene.objects[0].mesh.vertex_count, meshes[i].vertices);
		assert_int_equal(scene.objects[0].mesh.face_count, meshes[i].faces);
		engine_scene_free(&scene);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(objects_polygons_and_materials),
	    cmocka_unit_test(numbers_in_every_form),
	    cmocka_unit_test(lines_in_every_form),
	    cmocka_unit_test(corners_in_every_form),
	    cmocka_unit_test(bad_lines_cost_their_faces),
	    cmocka_unit_test(far_corners_cost_their_faces),
	    cmocka_unit_test(what_is_not_read_is_told),
	    cmocka_unit_test(groups_become_objects),
	    cmocka_unit_test(materials_in_every_form),
	    cmocka_unit_test(materials_no_face_uses_do_not_matter),
	    cmocka_unit_test(what_matt_surfaces_cannot_show_is_told),
	    cmocka_unit_test(broken_libraries_cost_no_file),
	    cmocka_unit_test(missing_libraries_are_told),
	    cmocka_unit_test(libraries_lie_below_the_scene),
	    cmocka_unit_test(several_libraries),
	    cmocka_unit_test(colours_of_vertices_are_read),
	    cmocka_unit_test(far_scenes_are_moved_in_double),
	    cmocka_unit_test(large_files_take_linear_time),
	    cmocka_unit_test(damaged_files_never_crash),
	    cmocka_unit_test(real_meshes),
	};
	return cmocka_run_group_tests_name("obj", tests, make_folder, remove_folder);
}
