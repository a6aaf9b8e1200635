/* PLY: headers and bodies in every form, what they become, what is told or refused, and that no file takes long. */
#define _XOPEN_SOURCE 700 /* mkdtemp */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "scene_files.h"

#define VERTEX "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
#define FACE(count) "element face " #count "\nproperty list uchar int vertex_indices\n"
#define ASCII "ply\nformat ascii 1.0\n"
#define SQUARE "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"

static const char ply_text[] = ASCII VERTEX FACE(1) "end_header\n" SQUARE "4 0 1 2 3\n";

static engine_scene load_ply(const char *text)
{
	return load(write_text("a.ply", text));
}

static void check_ply_refused(const char *text, const char *words)
{
	check_refused(write_text("a.ply", text), words);
}

/* Bytes of a file that is made piece by piece. */
typedef struct body {
	uint8_t bytes[4096];
	size_t size;
	bool big_endian;
} body;

static void add_text(body *b, const char *text)
{
	memcpy(b->bytes + b->size, text, strlen(text));
	b->size += strlen(text);
}

static void add_value(body *b, uint64_t bits, size_t size)
{
	for (size_t i = 0; i < size; i++)
		b->bytes[b->size++] = (uint8_t)(bits >> 8 * (b->big_endian ? size - 1 - i : i));
}

static void add_float(body *b, float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	add_value(b, bits, sizeof bits);
}

static void add_square(body *b)
{
	static const float square[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
	for (int i = 0; i < 12; i++)
		add_float(b, square[i]);
}

static engine_scene load_body(const body *b)
{
	return load(write_file("a.ply", b->bytes, b->size));
}

/* One face of the four corners, of area 1; frees the scene. */
static void check_square(engine_scene scene)
{
	const float expected[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
	assert_int_equal(scene.object_count, 1);
	assert_int_equal(scene.objects[0].mesh.face_count, 1);
	assert_int_equal(scene.objects[0].mesh.vertex_count, 4);
	check_floats(scene.objects[0].mesh.positions, expected, 12, 0);
	assert_string_equal(scene.warning, "");
	engine_scene_free(&scene);
}

/* ---- headers ----------------------------------------------------------------------------------------------------- */

static void headers_in_every_form(void **state)
{
	(void)state;
	char text[1024];
	check_square(load_ply(ply_text));
	engine_scene scene = load_ply(ply_text);
	CHECK3(scene.materials[0].rho, 0.5f, 0.5f, 0.5f);
	assert_false(scene.objects[0].double_sided);
	engine_scene_free(&scene);
	check_square(load_ply(ASCII VERTEX FACE(1) "end_header \t\n" SQUARE "4 0 1 2 3\n"));
	check_square(load_ply(
	    "ply \nformat ascii 1.0\ncomment a\rb\nobj_info c\n\n" VERTEX FACE(1) "end_header\n" SQUARE "4 0 1 2 3"));
	for (int style = 0; style < 2; style++) { /* CR LF and CR */
		size_t length = 0;
		for (const char *c = ply_text; *c; c++) {
			if (*c == '\n')
				text[length++] = '\r';
			if (*c != '\n' || style == 0)
				text[length++] = *c;
		}
		check_square(load(write_file("a.ply", text, length)));
	}
}

static void lines_of_any_length(void **state)
{
	(void)state;
	enum { LENGTH = 1000000 };
	char *text = malloc(LENGTH + sizeof ply_text + 64);
	assert_non_null(text);
	size_t start = sizeof ASCII "comment " - 1;
	memcpy(text, ASCII "comment ", start);
	memset(text + start, 'x', LENGTH);
	strcpy(text + start + LENGTH, ply_text + sizeof ASCII - 2);
	check_square(load_ply(text));
	memset(text + start, 'x', LENGTH);
	text[LENGTH] = '\0';
	check_ply_refused(text, "cut off in its header");
	free(text);
}

static void broken_headers_are_refused(void **state)
{
	(void)state;
	check_ply_refused("hello\n", "is no PLY file");
	check_ply_refused("ply", "is no PLY file");
	check_ply_refused("plywood\n", "is no PLY file");
	check_ply_refused("ply\nformat ascii 1.0\nelement vertex 4\n", "cut off in its header");
	check_ply_refused("ply\nend_header\n", "no format");
	check_ply_refused("ply\nformat ebcdic 1.0\nend_header\n", "line 2: the format \"ebcdic\"");
	check_ply_refused(ASCII "hello\n", "line 3: \"hello\" has no meaning");
	check_ply_refused(ASCII "property float x\nend_header\n", "line 3: a property stands before any element");
	check_ply_refused(ASCII "element vertex -1\n", "line 3: element \"vertex\" needs a count, and \"-1\" is none");
	check_ply_refused(ASCII "element vertex list\n", "needs a count, and \"list\" is none");
	check_ply_refused(ASCII "element vertex 1e9\n", "needs a count");
	check_ply_refused(ASCII "element vertex\n", "needs a count");
	check_ply_refused(ASCII "element\n", "needs a count");
	check_ply_refused(ASCII VERTEX "property quad w\n", "line 7: is no \"property TYPE NAME\"");
	check_ply_refused(ASCII VERTEX "property list uchar\n", "line 7");
	check_ply_refused(ASCII VERTEX "property list float int vertex_indices\n", "line 7");
	check_ply_refused(ASCII "element face 1\nproperty list uchar float vertex_indices\n",
			  "vertex numbers must be integers");
	check_ply_refused(ASCII VERTEX "property float x\n", "line 7: element \"vertex\" has \"x\" twice");
	check_ply_refused(ASCII VERTEX FACE(1) VERTEX, "line 9: element \"vertex\" comes twice");
	check_ply_refused(ASCII VERTEX FACE(1) FACE(20000) "end_header\n" SQUARE, "element \"face\" comes twice");
	check_ply_refused(ASCII "element vertex 3\nproperty float x\nproperty float y\nend_header\n0 0\n1 0\n0 1\n",
			  "element \"vertex\" has no x, y and z");
	check_ply_refused(ASCII VERTEX "element face 1\nproperty list uchar int nonsense\n"
				       "property list uchar float texcoord\nend_header\n" SQUARE "3 0 1 2 2 0 0\n",
			  "element \"face\" has no vertex_indices");
}

/* ---- bodies ------------------------------------------------------------------------------------------------------ */

static void binary_files(void **state)
{
	(void)state;
	for (int big = 0; big < 2; big++) {
		body b = {.big_endian = big};
		add_text(&b, big ? "ply\nformat binary_big_endian 1.0\n" : "ply\nformat binary_little_endian 1.0\n");
		add_text(&b, VERTEX FACE(1) "end_header\n");
		add_square(&b);
		add_value(&b, 4, 1);
		for (uint32_t i = 0; i < 4; i++)
			add_value(&b, i, 4);
		check_square(load_body(&b));
	}
}

/* -0.5 as a float in big-endian order begins with 0xbf; 8 as a little-endian one has 0 first. Bytes that are ends of
 * lines are part of the body all the same.
 */
static void bodies_may_begin_with_an_end_of_line(void **state)
{
	(void)state;
	static const char bytes[] = {'\n', '\r', ' '};
	for (int i = 0; i < 3; i++) {
		body b = {0};
		add_text(&b, "ply\nformat binary_little_endian 1.0\n" VERTEX FACE(1) "end_header\n");
		size_t start = b.size;
		add_square(&b);
		b.bytes[start] = (uint8_t)bytes[i]; /* 1e-44 m: as good as 0 */
		add_value(&b, 4, 1);
		for (uint32_t k = 0; k < 4; k++)
			add_value(&b, k, 4);
		engine_scene scene = load_body(&b);
		assert_int_equal(scene.objects[0].mesh.face_count, 1);
		assert_true(fabs(area_of(&scene.objects[0]) - 1) < 1e-6);
		engine_scene_free(&scene);
	}
}

/* Every type in a list, elements in another order, and what is between. */
static void all_types_in_any_order(void **state)
{
	(void)state;
	static const char *const names[] = {"char", "uint8", "short", "ushort", "int", "uint32", "float32", "double"};
	static const size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
	for (int t = 0; t < 6; t++) {
		char header[1024];
		body b = {.big_endian = t % 2};
		snprintf(header, sizeof header,
			 "ply\nformat binary_%s_endian 1.0\nelement edge 2\nproperty %s a\nproperty list %s double b\n"
			 "element face 1\nproperty list uchar %s other\nproperty list %s %s vertex_index\n"
			 "property %s flags\n"
			 "element vertex 4\nproperty double w\nproperty float z\nproperty float x\nproperty float y\n"
			 "end_header\n",
			 t % 2 ? "big" : "little", names[t + 2], names[t], names[t + 2], names[t], names[t], names[t]);
		add_text(&b, header);
		for (uint32_t e = 0; e < 2; e++) {
			add_value(&b, 7, sizes[t + 2]);
			add_value(&b, e, sizes[t]);
			add_value(&b, 0, e * 8);
		}
		add_value(&b, 3, 1);
		for (int i = 0; i < 3; i++)
			add_value(&b, 9, sizes[t + 2]);
		add_value(&b, 4, sizes[t]);
		for (uint32_t i = 0; i < 4; i++)
			add_value(&b, i, sizes[t]);
		add_value(&b, 1, sizes[t]);
		for (uint32_t v = 0; v < 4; v++) {
			add_value(&b, 0, 8);
			add_float(&b, 0);
			add_float(&b, v == 1 || v == 2);
			add_float(&b, v >= 2);
		}
		engine_scene scene = load_body(&b);
		assert_non_null(strstr(scene.warning, "elements of other kinds are not read (\"edge\")"));
		scene.warning[0] = '\0';
		check_square(scene);
	}
}

static void positions_in_double_precision(void **state)
{
	(void)state;
	engine_scene scene =
	    load_ply(ASCII "element vertex 3\nproperty double x\nproperty double y\nproperty double z\n" FACE(
		1) "end_header\n500000.125 4649776.5 10\n500001.375 4649776.5 10\n"
		   "500001.375 4649777.25 10\n3 0 1 2\n");
	printf("area of half of 1.25 m x 0.75 m at 4,650 km: %.9g\n", area_of(&scene.objects[0]));
	assert_true(fabs(area_of(&scene.objects[0]) - 0.5 * 1.25 * 0.75) < 1e-6);
	engine_scene_free(&scene);
}

/* Normals that a writer could not make. */
static void what_is_skipped_need_be_no_number(void **state)
{
	(void)state;
	check_square(load_ply(ASCII VERTEX "property float nx\nproperty list uchar float weights\n" FACE(
	    1) "property float q\nend_header\n0 0 0 nan 0\n1 0 0 -1.#IND 1 1.#QNAN\n1 1 0 inf 0\n"
	       "0 1 0 -nan(ind) 2 a b\n4 0 1 2 3 x"));
}

static void strips_of_triangles(void **state)
{
	(void)state;
	engine_scene scene = load_ply(ASCII VERTEX "element tristrips 2\nproperty list int int vertex_indices\n"
						   "end_header\n" SQUARE "4 0 1 3 2\n9 0 1 2 -1 -1 0 2 3 3\n");
	const engine_mesh *mesh = &scene.objects[0].mesh;
	assert_int_equal(mesh->face_count, 4);
	assert_true(fabs(area_of(&scene.objects[0]) - 2) < 1e-6);
	const uint32_t *corners = mesh->indices;
	for (uint32_t f = 0; f < 4; f++, corners += 3) {
		double normal[3];
		engine_mesh_face_normal(mesh, corners, 3, normal);
		assert_true(normal[2] > 0.4); /* all face the same way */
	}
	assert_string_equal(scene.warning, "");
	engine_scene_free(&scene);
}

/* sRGB 200 30 30 reflects 0.5776 0.0130 0.0130. */
static void check_colors_by_letters(void)
{
	engine_scene scene = load_ply(ASCII VERTEX "property uchar r\nproperty uchar g\nproperty uchar b\n" FACE(
	    1) "end_header\n0 0 0 200 30 30\n1 0 0 200 30 30\n1 1 0 200 30 30\n0 1 0 200 30 30\n4 0 1 2 3\n");
	CHECK_FACE(&scene, 0, 0.5775805f, 0.0129830f, 0.0129830f);
	engine_scene_free(&scene);
}

static void colours_are_read(void **state)
{
	(void)state;
	static const char *const types[] = {"uchar", "ushort", "float"};
	static const char *const red[] = {"200 30 30", "51400 7710 7710", "0.78431373 0.11764706 0.11764706"};
	for (int t = 0; t < 3; t++) {
		char text[1024];
		snprintf(text, sizeof text,
			 ASCII VERTEX
			 "property %s red\nproperty %s green\nproperty %s blue\nproperty uchar alpha\n" FACE(
			     2) "end_header\n0 0 0 %s 255\n1 0 0 %s 255\n1 1 0 %s 255\n0 1 0 0 0 0 255\n"
				"3 0 1 2\n3 0 2 3\n",
			 types[t], types[t], types[t], red[t], red[t], red[t]);
		engine_scene scene = load_ply(text);
		CHECK_FACE(&scene, 0, 0.5775805f, 0.0129830f, 0.0129830f);
		CHECK_FACE(&scene, 1, 0.3850537f, 0.0086553f, 0.0086553f);
		engine_scene_free(&scene);
	}
	check_colors_by_letters();
	engine_scene scene = load_ply(ASCII VERTEX "element face 2\nproperty list uchar int vertex_index\n"
						   "property uchar red\nproperty uchar green\nproperty uchar blue\n"
						   "end_header\n" SQUARE "3 0 1 2 255 255 255\n3 0 2 3 0 0 0\n");
	CHECK_FACE(&scene, 0, 1, 1, 1);
	CHECK_FACE(&scene, 1, 0, 0, 0);
	assert_non_null(strstr(scene.warning, "get 0.98"));
	engine_scene_free(&scene);
}

static void what_is_not_read_is_told(void **state)
{
	(void)state;
	check_told(
	    write_text("a.ply", ASCII "comment TextureFile a.png\n" VERTEX FACE(1) "end_header\n" SQUARE "4 0 1 2 3\n"),
	    "texture is not read");
	check_told(write_text("a.ply", ASCII VERTEX FACE(1) "end_header\n" SQUARE "4 0 1 2 3\n3 0 1 2\n"),
		   "what follows its last element is not read");
	check_told(write_text("a.ply", ASCII VERTEX FACE(3) "end_header\n" SQUARE "4 0 1 2 3\n2 0 1\n0\n"),
		   "faces of fewer than three corners are left out (2)");
}

static void broken_bodies_are_refused(void **state)
{
	(void)state;
	check_ply_refused(ASCII VERTEX FACE(40) "end_header\n" SQUARE "3 0 1 2\n3 0 2 3\n",
			  "cut off: 2 of 40 elements \"face\" are there");
	check_ply_refused(ASCII VERTEX FACE(1) "end_header\n0 0 0\n1 0 0\n1 1\n",
			  "cut off: 2 of 4 elements \"vertex\" are there");
	check_ply_refused(ASCII VERTEX FACE(1) "end_header\n" SQUARE "-3 0 1 2\n", "length of a list");
	check_ply_refused(ASCII VERTEX FACE(1) "end_header\n" SQUARE "4294967295 0 1 2\n", "cut off");
	check_ply_refused(ASCII VERTEX FACE(1) "end_header\n0 0 0\n1 x 0\n", "line 11: a number was expected");
	check_ply_refused(ASCII VERTEX "end_header\n" SQUARE, "holds no faces");
	check_ply_refused(ASCII VERTEX FACE(0) "end_header\n" SQUARE, "holds no faces");
	check_ply_refused(ASCII "end_header\n", "holds no faces");
}

/* A corner or a vertex that is none costs its faces, as in the other formats. */
static void bad_corners_cost_their_faces(void **state)
{
	(void)state;
	static const char *const corners[] = {"4", "-1", "1.5", "1e30", "nan", "4294967295"};
	static const char *const positions[] = {"nan 0 0", "0 inf 0", "0 0 -1e16"};
	char text[400], told[160];
	for (size_t k = 0; k < sizeof corners / sizeof *corners; k++) {
		snprintf(text, sizeof text, ASCII VERTEX FACE(2) "end_header\n" SQUARE "3 0 1 2\n3 0 1 %s\n",
			 corners[k]);
		check_told(write_text("a.ply", text), "beyond 1e15 m are left out (\"line 15\")");
		snprintf(text, sizeof text, ASCII VERTEX FACE(1) "end_header\n" SQUARE "3 0 1 %s\n", corners[k]);
		check_ply_refused(text, "1 of its 1 faces cannot be used, it may be cut off: faces with a corner");
	}
	for (size_t k = 0; k < sizeof positions / sizeof *positions; k++) {
		snprintf(text, sizeof text,
			 ASCII VERTEX FACE(2) "end_header\n0 0 0\n1 0 0\n1 1 0\n%s\n3 0 1 2\n4 0 1 2 3\n",
			 positions[k]);
		snprintf(told, sizeof told, "left out (\"line 13: %.4s", positions[k]);
		check_told(write_text("a.ply", text), told);
		check_told(write_text("a.ply", text), "beyond 1e15 m are left out (\"line 15\")");
	}
	engine_scene scene = load_ply(ASCII VERTEX "element tristrips 1\nproperty list int int vertex_indices\n"
						   "end_header\n" SQUARE "8 0 1 3 -1 9 1 2 3\n");
	assert_int_equal(scene.objects[0].mesh.face_count, 2);
	assert_non_null(strstr(scene.warning, "beyond 1e15 m are left out (\"line 14\")"));
	engine_scene_free(&scene);
	body b = {0};
	add_text(&b, "ply\nformat binary_little_endian 1.0\n" VERTEX FACE(2) "end_header\n");
	add_square(&b);
	for (uint32_t f = 0; f < 2; f++) {
		add_value(&b, 3, 1);
		for (uint32_t i = 0; i < 3; i++)
			add_value(&b, i + 2 * f, 4);
	}
	check_told(write_file("a.ply", b.bytes, b.size), "beyond 1e15 m are left out (\"face 1\")");
}

/* No count and no length of a list takes memory or time of its own. */
static void promises_cost_nothing(void **state)
{
	(void)state;
	static const char *const counts[] = {"4000000000", "99999999999999999999", "18446744073709551615", "500"};
	char text[512];
	for (int i = 0; i < 4; i++) {
		snprintf(text, sizeof text,
			 ASCII "element vertex %s\nproperty float x\nproperty float y\nproperty float z\n" FACE(
			     1) "end_header\n" SQUARE,
			 counts[i]);
		check_ply_refused(text, "cut off: 4 of ");
		snprintf(text, sizeof text,
			 ASCII "element nothing %s\n" VERTEX FACE(1) "end_header\n" SQUARE "4 0 1 2 3\n", counts[i]);
		check_told(write_text("a.ply", text), "elements of other kinds");
	}
	for (uint32_t length = 0x7fffffff; length; length = length == 0x7fffffff ? 0xffffffff : 0) {
		body b = {0};
		add_text(&b, "ply\nformat binary_little_endian 1.0\n" VERTEX "element face 1\n"
			     "property list uint uint vertex_indices\nproperty list uint double other\nend_header\n");
		add_square(&b);
		add_value(&b, 3, 4);
		for (uint32_t i = 0; i < 3; i++)
			add_value(&b, i, 4);
		add_value(&b, length, 4);
		check_refused(write_file("a.ply", b.bytes, b.size), "cut off: 0 of 1 elements \"face\"");
		b.size -= 20;
		add_value(&b, length, 4);
		check_refused(write_file("a.ply", b.bytes, b.size), "cut off: 0 of 1 elements \"face\"");
	}
}

static void damaged_files_never_crash(void **state)
{
	(void)state;
	static const char colored[] =
	    ASCII VERTEX "property uchar red\nproperty uchar green\nproperty uchar blue\n" FACE(
		1) "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
		   "0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n4 0 1 2 3\n5 0 1 2 -1 3\n";
	body b = {0};
	add_text(&b, "ply\nformat binary_little_endian 1.0\n" VERTEX FACE(1) "end_header\n");
	add_square(&b);
	add_value(&b, 4, 1);
	for (uint32_t i = 0; i < 4; i++)
		add_value(&b, i, 4);
	damage("a.ply", (const uint8_t *)ply_text, sizeof ply_text - 1, 1000);
	damage("a.ply", (const uint8_t *)colored, sizeof colored - 1, 1000);
	damage("a.ply", b.bytes, b.size, 1000);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(headers_in_every_form),
	    cmocka_unit_test(lines_of_any_length),
	    cmocka_unit_test(broken_headers_are_refused),
	    cmocka_unit_test(binary_files),
	    cmocka_unit_test(bodies_may_begin_with_an_end_of_line),
	    cmocka_unit_test(all_types_in_any_order),
	    cmocka_unit_test(positions_in_double_precision),
	    cmocka_unit_test(what_is_skipped_need_be_no_number),
	    cmocka_unit_test(strips_of_triangles),
	    cmocka_unit_test(colours_are_read),
	    cmocka_unit_test(what_is_not_read_is_told),
	    cmocka_unit_test(broken_bodies_are_refused),
	    cmocka_unit_test(bad_corners_cost_their_faces),
	    cmocka_unit_test(promises_cost_nothing),
	    cmocka_unit_test(damaged_files_never_crash),
	};
	return cmocka_run_group_tests_name("ply", tests, make_folder, remove_folder);
}
