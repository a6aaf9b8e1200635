/* What all scene files share: which paths are read at all, polygons of any shape, coordinates of maps. The formats have
 * tests of their own.
 */
#define _XOPEN_SOURCE 700 /* mkdtemp, mkfifo */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "scene_files.h"

#include <sys/stat.h>
#include <time.h>

static void missing_and_foreign_files(void **state)
{
	(void)state;
	check_refused("/nowhere/at/all.gltf", "cannot be opened");
	check_refused("/nowhere/at/all.obj", "cannot be opened");
	check_refused(write_text("a.txt", "hello"), ".gltf, .glb, .obj or .ply");
	check_refused(write_text("a.ply", ""), "empty");
	check_refused(folder, "is a folder");
	assert_int_equal(mkfifo(path_of("pipe.obj"), 0600), 0);
	check_refused(path_of("pipe.obj"), "not a file");
}

/* ---- polygons ---------------------------------------------------------------------------------------------------- */

static char polygon_text[1 << 21];

/* An OBJ of one polygon: corners in a plane that leans in all three axes, and the vertex numbers of its rim. */
static const char *write_polygon(const double (*corners)[2], int count, const char *rim)
{
	char *text = polygon_text;
	const size_t size = sizeof polygon_text;
	size_t used = 0;
	for (int k = 0; k < count; k++) {
		double x = corners[k][0], y = corners[k][1]; /* axes (2 2 1)/3 and (-2 1 2)/3 */
		used += (size_t)snprintf(text + used, size - used, "v %.9g %.9g %.9g\n", (2 * x - 2 * y) / 3,
					 (2 * x + y) / 3, (x + 2 * y) / 3);
	}
	used += (size_t)snprintf(text + used, size - used, "f");
	for (int k = 0; !rim && k < count; k++)
		used += (size_t)snprintf(text + used, size - used, " %d", k + 1);
	snprintf(text + used, size - used, "%s\n", rim ? rim : "");
	return write_text("polygon.obj", text);
}

/* Its area as faces that programs cut into fans, which a convex face allows. */
static double fan_area(const engine_mesh *mesh)
{
	const uint32_t *corners = mesh->indices;
	double area = 0;
	for (uint32_t f = 0; f < mesh->face_count; corners += mesh->face_counts[f++]) {
		for (uint32_t k = 2; k < mesh->face_counts[f]; k++) {
			const uint32_t triangle[3] = {corners[0], corners[k - 1], corners[k]};
			double n[3];
			engine_mesh_face_normal(mesh, triangle, 3, n);
			area += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
		}
	}
	return area;
}

static void check_area(const double (*corners)[2], int count, const char *rim, double expected, const char *what)
{
	engine_scene scene = load(write_polygon(corners, count, rim));
	double area = fan_area(&scene.objects[0].mesh), normals = area_of(&scene.objects[0]);
	printf("%s: %u faces of %.7f m2, %.7f by their normals, of %.7f\n", what, scene.objects[0].mesh.face_count,
	       area, normals, expected);
	assert_true(fabs(area - expected) <= 1e-5 * expected && fabs(normals - expected) <= 1e-5 * expected);
	engine_scene_free(&scene);
}

static void polygons_keep_their_area(void **state)
{
	(void)state;
	static const double u[8][2] = {{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
	static const double square[4][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
	static const double arrow[4][2] = {{0, 0}, {2, 1}, {0, 2}, {0.5, 1}};
	static const double frame[8][2] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 1}, {3, 1}, {3, 3}, {1, 3}};
	static const double two_holes[12][2] = {{0, 0}, {9, 0}, {9, 4}, {0, 4}, {1, 1}, {3, 1},
						{3, 3}, {1, 3}, {6, 1}, {8, 1}, {8, 3}, {6, 3}};
	double star[10][2];
	for (int k = 0; k < 10; k++) {
		star[k][0] = (k % 2 ? 1 : 3) * cos(0.62831853 * k);
		star[k][1] = (k % 2 ? 1 : 3) * sin(0.62831853 * k);
	}
	check_area(u, 8, NULL, 7, "U");
	check_area(u, 8, " 8 7 6 5 4 3 2 1", 7, "U from behind");
	check_area(square, 4, NULL, 4, "square");
	for (int first = 0; first < 4; first++) {
		char rim[32];
		snprintf(rim, sizeof rim, " %d %d %d %d", first + 1, (first + 1) % 4 + 1, (first + 2) % 4 + 1,
			 (first + 3) % 4 + 1);
		check_area(arrow, 4, rim, 1.5, "arrowhead");
	}
	check_area(star, 10, NULL, 10 * 0.5 * 3 * sin(0.62831853), "star");
	check_area(frame, 8, " 1 2 3 4 1 5 8 7 6 5", 12, "square with a hole, by a bridge");
	check_area(two_holes, 12, " 1 2 3 4 1 5 8 7 6 9 12 11 10 9 6 5", 28, "two holes");
	check_area(u, 8, " 1 2 3 3 4 5 6 7 8 1", 7, "U with corners twice");
}

/* Random polygons about a middle, which never cross themselves: the area by their corners is the right one. */
static void random_polygons_keep_their_area(void **state)
{
	(void)state;
	double worst = 0;
	for (int round = 0; round < 300; round++) {
		double corners[40][2], expected = 0;
		int count = 4 + (int)(next_random() % 37);
		for (int k = 0; k < count; k++) {
			double angle = 6.28318531 * (k + 0.8 * (next_random() % 1000) / 1000) / count;
			double distance = 0.1 + 3.0 * (next_random() % 1000) / 1000;
			corners[k][0] = distance * cos(angle);
			corners[k][1] = distance * sin(angle);
		}
		for (int k = 0; k < count; k++) {
			const double *a = corners[k], *b = corners[(k + 1) % count];
			expected += 0.5 * (a[0] * b[1] - a[1] * b[0]);
		}
		engine_scene scene = load(write_polygon((const double(*)[2])corners, count, NULL));
		worst = fmax(worst, fabs(fan_area(&scene.objects[0].mesh) / expected - 1));
		engine_scene_free(&scene);
	}
	printf("300 random polygons of 4 to 40 corners: area within %.2g\n", worst);
	assert_true(worst < 1e-5);
}

/* What takes a clipper of ears, which tries all pairs, minutes. */
static void combs_of_thousands_of_corners(void **state)
{
	(void)state;
	enum { TEETH = 2000 };
	static double corners[4 * TEETH + 2][2];
	int count = 0;
	corners[count][0] = 0;
	corners[count++][1] = 0;
	corners[count][0] = TEETH;
	corners[count++][1] = 0;
	for (int k = TEETH - 1; k >= 0; k--) {
		const double x[4] = {k + 1, k + 0.5, k + 0.5, k}, y[4] = {5, 5, 1, 1};
		for (int i = 0; i < 4; i++, count++) {
			corners[count][0] = x[i];
			corners[count][1] = y[i];
		}
	}
	clock_t began = clock();
	engine_scene scene = load(write_polygon((const double(*)[2])corners, count, NULL));
	double seconds = (double)(clock() - began) / CLOCKS_PER_SEC, area = fan_area(&scene.objects[0].mesh);
	printf("comb of 8,002 corners: %.4f m2 of %d in %.2f s\n", area, 3 * TEETH, seconds);
	assert_true(fabs(area - 3 * TEETH) < 1e-4 * 3 * TEETH); /* floats at a kilometre */
	engine_scene_free(&scene);
	/* more of them than are cut */
	char *face = strdup(strstr(polygon_text, "f "));
	assert_non_null(face);
	const char *rest = face + 1;
	for (int k = 0; k < 20; k++) { /* each without the corners that the ones before left out: no two are one face */
		rest = strchr(rest + 1, ' ');
		strcat(strcat(polygon_text, "f"), rest);
	}
	free(face);
	check_told(write_text("polygon.obj", polygon_text), "thousands of corners are left out");
}

/* ---- coordinates of maps ----------------------------------------------------------------------------------------- */

/* A square of 1 m with corners at odd fractions, 500 km east and 5,800 km north. */
static void map_coordinates_keep_their_digits(void **state)
{
	(void)state;
	engine_scene scene = load(write_text("map.obj", "v 500000.125 5800000.25 31.5\nv 500001.125 5800000.25 31.5\n"
							"v 500001.125 5800001.25 31.5\nv 500000.125 5800001.25 31.5\n"
							"f 1 2 3 4\n"));
	double area = area_of(&scene.objects[0]);
	printf("a square of 1 m2 in map coordinates: %.9f m2, moved by %.0f %.0f %.0f\n", area, scene.origin[0],
	       scene.origin[1], scene.origin[2]);
	assert_true(fabs(area - 1) < 1e-6);
	const engine_pose *rest = &scene.objects[0].rest;
	const float *corner = scene.objects[0].mesh.positions;
	assert_true(fabs(scene.origin[0] + (double)(rest->translation[0] + corner[0]) - 500000.125) < 1e-6);
	assert_true(fabs(scene.origin[1] + (double)(rest->translation[1] + corner[1]) - 5800000.25) < 1e-6);
	engine_scene_free(&scene);
	check_told(path_of("map.obj"), "the scene lies far from the origin");
}

static void damaged_polygons_never_crash(void **state)
{
	(void)state;
	static const char text[] =
	    "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 2 3 0\nv 2 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nf 1 2 3 4 5 6 7 8\n"
	    "f 1 2 3 4 1 5 8 7 6 5\n";
	engine_scene scene = load(write_text("polygon.obj", text));
	CHECK3(scene.objects[0].rest.scale, 1, 1, 1);
	engine_scene_free(&scene);
	damage("polygon.obj", (const uint8_t *)text, sizeof text - 1, 1000);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(missing_and_foreign_files),         cmocka_unit_test(polygons_keep_their_area),
	    cmocka_unit_test(random_polygons_keep_their_area),   cmocka_unit_test(combs_of_thousands_of_corners),
	    cmocka_unit_test(map_coordinates_keep_their_digits), cmocka_unit_test(damaged_polygons_never_crash),
	};
	return cmocka_run_group_tests_name("import_file", tests, make_folder, remove_folder);
}
