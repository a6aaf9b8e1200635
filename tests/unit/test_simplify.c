/* Mesh cleaning and cages: welding, degenerate faces, pairs of triangles, and simplified surfaces that stay closed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "engine/mesh_clean.h"
#include "engine/import_file.h"
#include "engine/simplify.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Where the shared meshes may be; a build may say better. */
#ifndef RELUME_SOURCE_DIR
#define RELUME_SOURCE_DIR "."
#endif

static char message[256];

enum { RINGS = 40, SECTORS = 80 };

static void sphere_point(uint32_t ring, uint32_t sector, float *p)
{
	double theta = 3.14159265358979 * ring / RINGS, phi = 2 * 3.14159265358979 * (sector % SECTORS) / SECTORS;
	p[0] = (float)(sin(theta) * cos(phi));
	p[1] = (float)cos(theta);
	p[2] = (float)(-sin(theta) * sin(phi));
}

/* A sphere of quads whose corners are all vertices of their own, as files deliver them; the quads at the poles are
 * triangles after welding. The upper half has material 1, the lower 2.
 */
static engine_mesh make_sphere(void)
{
	static const uint32_t steps[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
	enum { FACES = RINGS * SECTORS };
	engine_mesh mesh = {.positions = calloc(FACES * 4, 3 * sizeof(float)),
			    .vertex_count = FACES * 4,
			    .face_counts = calloc(FACES, sizeof(uint32_t)),
			    .indices = calloc(FACES * 4, sizeof(uint32_t)),
			    .face_materials = calloc(FACES, sizeof(uint32_t)),
			    .face_count = FACES,
			    .index_count = FACES * 4};
	for (uint32_t f = 0; f < FACES; f++) {
		mesh.face_counts[f] = 4;
		mesh.face_materials[f] = f < FACES / 2 ? 1 : 2;
		for (uint32_t k = 0; k < 4; k++) {
			mesh.indices[4 * f + k] = 4 * f + k;
			sphere_point(f / SECTORS + steps[k][0], f % SECTORS + steps[k][1],
				     mesh.positions + 3 * (4 * f + k));
		}
	}
	/* sin(pi) is not quite 0: the lower pole must be one point, like the upper. */
	for (uint32_t v = 0; v < mesh.vertex_count; v++) {
		if (fabsf(mesh.positions[3 * v]) < 1e-6f && fabsf(mesh.positions[3 * v + 2]) < 1e-6f)
			mesh.positions[3 * v] = mesh.positions[3 * v + 2] = 0;
	}
	return mesh;
}

static int compare_edges(const void *a, const void *b)
{
	const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return (x > y) - (x < y);
}

static uint64_t directed_edge(uint32_t from, uint32_t to)
{
	return (uint64_t)from << 32 | to;
}

/* Edges as faces run along them, sorted. The caller frees them. */
static uint64_t *sorted_edges(const engine_mesh *mesh)
{
	uint64_t *edges = malloc((mesh->index_count + 1) * sizeof *edges);
	uint32_t count = 0, first = 0;
	assert_non_null(edges);
	for (uint32_t f = 0; f < mesh->face_count; first += mesh->face_counts[f++]) {
		for (uint32_t k = 0; k < mesh->face_counts[f]; k++)
			edges[count++] = directed_edge(mesh->indices[first + k],
						       mesh->indices[first + (k + 1) % mesh->face_counts[f]]);
	}
	qsort(edges, count, sizeof *edges, compare_edges);
	return edges;
}

/* Directed edges that no face runs the other way: 0 for a closed surface. */
static uint32_t count_open_edges(const engine_mesh *mesh)
{
	uint64_t *edges = sorted_edges(mesh);
	uint32_t open = 0;
	for (uint32_t i = 0; i < mesh->index_count; i++) {
		uint64_t back = edges[i] << 32 | edges[i] >> 32;
		open += bsearch(&back, edges, mesh->index_count, sizeof *edges, compare_edges) == NULL;
	}
	free(edges);
	return open;
}

/* Directed edges that a second face runs too: where a surface touches itself along an edge. */
static uint32_t count_doubled_edges(const engine_mesh *mesh)
{
	uint64_t *edges = sorted_edges(mesh);
	uint32_t doubled = 0;
	for (uint32_t i = 1; i < mesh->index_count; i++)
		doubled += edges[i] == edges[i - 1];
	free(edges);
	return doubled;
}

static double area_of(const engine_mesh *mesh)
{
	double area = 0;
	for (uint32_t f = 0, first = 0; f < mesh->face_count; first += mesh->face_counts[f++]) {
		double n[3];
		engine_mesh_face_normal(mesh, mesh->indices + first, mesh->face_counts[f], n);
		area += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	}
	return area;
}

static void cleaning_connects_and_keeps_order(void **state)
{
	(void)state;
	engine_mesh mesh = make_sphere();
	engine_clean_report report;
	assert_true(engine_mesh_clean(&mesh, &report, message, sizeof message));
	assert_int_equal(mesh.vertex_count, (RINGS - 1) * SECTORS + 2);
	assert_int_equal(mesh.face_count, RINGS * SECTORS); /* nothing was degenerate ... */
	assert_int_equal(report.degenerate_faces, 0);
	assert_int_equal(mesh.face_counts[0], 3); /* ... but quads at the poles had a corner too many */
	assert_int_equal(mesh.face_counts[SECTORS], 4);
	assert_int_equal(count_open_edges(&mesh), 0);
	engine_mesh_free(&mesh);
}

static void cleaning_drops_what_has_no_area(void **state)
{
	(void)state;
	float positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0, -0.0f, 0, 0};
	uint32_t counts[] = {3, 3, 3, 3, 4}, indices[] = {0, 1, 2, 0, 1, 3, 0, 4, 2, 1, 1, 2, 0, 1, 2, 1};
	engine_mesh part = {.positions = positions,
			    .vertex_count = 5,
			    .face_counts = counts,
			    .indices = indices,
			    .face_count = 5,
			    .index_count = 16};
	engine_mesh mesh = {0};
	engine_clean_report report;
	assert_true(engine_mesh_append(&mesh, &part, 7));
	assert_true(engine_mesh_clean(&mesh, &report, message, sizeof message));
	assert_int_equal(mesh.face_count,
			 1); /* gone: a line, one with both zeros, one with a repeat, one twice at a vertex */
	assert_int_equal(mesh.face_materials[0], 7);
	assert_int_equal(mesh.vertex_count, 3);
	assert_int_equal(report.degenerate_faces, 4);
	assert_int_equal(report.welded_vertices, 1);
	engine_mesh_free(&mesh);
}

/* A triangle, the same from another corner, on vertices of its own and turned round, and a quad four times. */
static void cleaning_drops_faces_that_are_there_twice(void **state)
{
	(void)state;
	float positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0};
	uint32_t counts[] = {3, 3, 3, 3, 4, 4, 4, 4},
		 indices[] = {0, 1, 2, 1, 2, 0, 6, 4, 5, 2, 1, 0, 0, 1, 2, 3, 3, 0, 1, 2, 2, 3, 0, 1, 5, 6, 3, 4};
	uint32_t materials[] = {4, 1, 2, 5, 6, 3, 7, 8};
	engine_mesh part = {.positions = positions,
			    .vertex_count = 7,
			    .face_counts = counts,
			    .indices = indices,
			    .face_materials = materials,
			    .face_count = 8,
			    .index_count = 28};
	engine_mesh mesh = {0};
	engine_clean_report report;
	assert_true(engine_mesh_append(&mesh, &part, 0));
	assert_true(engine_mesh_clean(&mesh, &report, message, sizeof message));
	assert_int_equal(report.duplicate_faces, 5);
	assert_int_equal(mesh.face_count, 3);
	assert_int_equal(mesh.index_count, 10);
	for (int f = 0; f < 3; f++)
		assert_int_equal(mesh.face_materials[f], 4 + f);
	engine_mesh_free(&mesh);
}

static void cleaning_refuses_broken_meshes(void **state)
{
	(void)state;
	float positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0};
	uint32_t counts[] = {3}, indices[] = {0, 1, 3};
	engine_mesh part = {.positions = positions,
			    .vertex_count = 3,
			    .face_counts = counts,
			    .indices = indices,
			    .face_count = 1,
			    .index_count = 3};
	engine_mesh out;
	assert_false(engine_simplify(&part, 10, &out, message, sizeof message));
	assert_non_null(strstr(message, "vertex number 3"));
	indices[2] = 2;
	counts[0] = 4;
	assert_false(engine_simplify(&part, 10, &out, message, sizeof message));
	counts[0] = 3;
	positions[4] = INFINITY;
	assert_false(engine_simplify(&part, 10, &out, message, sizeof message));
	assert_non_null(strstr(message, "vertex 1 is not finite"));
	positions[4] = 0;
	positions[7] = 0;
	assert_false(engine_simplify(&part, 10, &out, message, sizeof message));
	assert_non_null(strstr(message, "area"));
	assert_null(out.positions);
}

static engine_mesh make_pair(float *positions, uint32_t *indices)
{
	static uint32_t counts[] = {3, 3};
	engine_mesh part = {.positions = positions,
			    .vertex_count = 4,
			    .face_counts = counts,
			    .indices = indices,
			    .face_count = 2,
			    .index_count = 6};
	engine_mesh mesh = {0};
	assert_true(engine_mesh_append(&mesh, &part, 0));
	return mesh;
}

/* Faces left of two triangles on four points. */
static uint32_t paired(float *positions, uint32_t *indices, uint32_t second_material)
{
	engine_mesh mesh = make_pair(positions, indices);
	mesh.face_materials[1] = second_material;
	double before = area_of(&mesh);
	engine_mesh_pair_triangles(&mesh);
	assert_true(fabs(area_of(&mesh) - before) < 1e-6 || mesh.face_count == 1);
	uint32_t faces = mesh.face_count;
	engine_mesh_free(&mesh);
	return faces;
}

static void only_halves_of_quads_are_paired(void **state)
{
	(void)state;
	float flat[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, bent[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0.1f, 1};
	float dart[] = {0, 0, 0, 1, 0, 0, 0.2f, 0.2f, 0, 0, 1, 0},
	      kite[] = {0, 0, 0, 0.2f, -0.1f, 0, 1, 1, 0, 0, 0.5f, 0};
	assert_int_equal(paired(flat, (uint32_t[]){0, 1, 2, 0, 2, 3}, 0), 1);
	assert_int_equal(paired(flat, (uint32_t[]){1, 2, 0, 3, 0, 2}, 0), 1); /* whatever corner comes first */
	assert_int_equal(paired(flat, (uint32_t[]){0, 1, 2, 0, 2, 3}, 1), 2); /* two materials */
	assert_int_equal(paired(flat, (uint32_t[]){0, 1, 2, 0, 3, 2}, 0), 2); /* the second one faces the other way */
	assert_int_equal(paired(flat, (uint32_t[]){0, 1, 2, 1, 2, 0}, 0), 2); /* the same triangle twice */
	assert_int_equal(paired(bent, (uint32_t[]){0, 1, 2, 0, 2, 3}, 0), 2);
	assert_int_equal(paired(dart, (uint32_t[]){0, 1, 2, 0, 2, 3}, 0), 2); /* not convex */
	assert_int_equal(paired(kite, (uint32_t[]){0, 1, 2, 0, 2, 3}, 0), 1);
}

static void a_sphere_stays_a_closed_sphere(void **state)
{
	(void)state;
	engine_mesh sphere = make_sphere(), cage;
	assert_true(engine_simplify(&sphere, 600, &cage, message, sizeof message));
	assert_in_range(cage.face_count, 500, 600);
	assert_int_equal(cage.index_count, 3 * cage.face_count);
	assert_int_equal(count_open_edges(&cage), 0);
	assert_int_equal(count_doubled_edges(&cage), 0);
	assert_int_equal(cage.vertex_count + cage.face_count, 3 * cage.face_count / 2 + 2); /* Euler: V - E + F = 2 */
	/* 600 triangles inscribed in a sphere miss about 2 pi^2 / (3 * 600) * 2 of its area; the rest is the
	 * simplifier's. */
	assert_true(fabs(area_of(&cage) / (4 * 3.14159265) - 1) < 0.04);
	uint32_t wrong = 0;
	for (uint32_t f = 0; f < cage.face_count; f++) {
		const uint32_t *c = cage.indices + 3 * f;
		float y = cage.positions[3 * c[0] + 1] + cage.positions[3 * c[1] + 1] + cage.positions[3 * c[2] + 1];
		wrong += fabsf(y) > 0.5f && cage.face_materials[f] != (y > 0 ? 1u : 2u);
	}
	assert_int_equal(wrong, 0);
	engine_mesh_free(&cage);
	engine_mesh_free(&sphere);
}

static void little_meshes_are_left_alone(void **state)
{
	(void)state;
	float positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
	uint32_t counts[] = {4}, indices[] = {0, 1, 2, 3};
	engine_mesh part = {.positions = positions,
			    .vertex_count = 4,
			    .face_counts = counts,
			    .indices = indices,
			    .face_count = 1,
			    .index_count = 4};
	engine_mesh out;
	assert_true(engine_simplify(&part, 0, &out, message, sizeof message));
	assert_int_equal(out.face_count, 2);
	assert_true(fabs(area_of(&out) - 1) < 1e-6);
	engine_mesh_free(&out);
}

/* Loads a mesh of the shared folder and makes cages of it; skips where the folder is not. */
static void simplify_shared(const char *name, uint32_t expected_faces)
{
	char path[1024];
	engine_scene scene;
	engine_mesh merged, cage;
	snprintf(path, sizeof path, "%s/../shared/meshes/%s", RELUME_SOURCE_DIR, name);
	FILE *file = fopen(path, "rb");
	if (!file) {
		print_message("skipped: no %s\n", path);
		skip();
	}
	fclose(file);
	if (!engine_scene_load(path, &scene, message, sizeof message))
		fail_msg("%s", message);
	assert_true(engine_scene_merge(&scene, &merged, message, sizeof message));
	print_message("%s: %u faces, %u vertices, %u open edges; %s\n", name, merged.face_count, merged.vertex_count,
		      count_open_edges(&merged), scene.warning);
	assert_in_range(merged.face_count, expected_faces - 10, expected_faces);
	for (uint32_t target = 600; target <= 2000; target += 700) {
		assert_true(engine_simplify(&merged, target, &cage, message, sizeof message));
		print_message("  %u asked: %u faces, %u open edges, %u doubled, %.1f %% of the area\n", target,
			      cage.face_count, count_open_edges(&cage), count_doubled_edges(&cage),
			      100 * area_of(&cage) / area_of(&merged));
		/* A handle thinner than a triangle collapses onto itself here and there. */
		assert_true(count_doubled_edges(&cage) <= cage.face_count / 50);
		assert_in_range(cage.face_count, target / 2, target);
		assert_true(area_of(&cage) > 0.6 * area_of(&merged));
		if (count_open_edges(&merged) == 0)
			assert_int_equal(count_open_edges(&cage), 0);
		engine_mesh_free(&cage);
	}
	engine_mesh_free(&merged);
	engine_scene_free(&scene);
}

static void a_scanned_statue(void **state)
{
	(void)state;
	simplify_shared("happy_buddha_100k.obj", 100000);
}

static void a_modelled_cow(void **state)
{
	(void)state;
	simplify_shared("spot.obj", 5856);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(cleaning_connects_and_keeps_order),
	    cmocka_unit_test(cleaning_drops_what_has_no_area),
	    cmocka_unit_test(cleaning_drops_faces_that_are_there_twice),
	    cmocka_unit_test(cleaning_refuses_broken_meshes),
	    cmocka_unit_test(only_halves_of_quads_are_paired),
	    cmocka_unit_test(a_sphere_stays_a_closed_sphere),
	    cmocka_unit_test(little_meshes_are_left_alone),
	    cmocka_unit_test(a_scanned_statue),
	    cmocka_unit_test(a_modelled_cow),
	};
	return cmocka_run_group_tests_name("simplify", tests, NULL, NULL);
}
