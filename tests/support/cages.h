/* Small cages that the tests of refinement, hierarchy, rays and drawn surfaces share. A cage points into its own
 * storage: fill it where it stays. */
#ifndef TESTS_CAGES_H
#define TESTS_CAGES_H

#include "hierarchy.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct test_cage {
	gi_refine_cage cage;
	float positions[3 * 512];
	uint32_t counts[512];
	uint32_t indices[4 * 512];
	uint32_t materials[512];
} test_cage;

static inline void cage_begin(test_cage *t, gi_refine_scheme scheme)
{
	memset(t, 0, sizeof *t);
	t->cage = (gi_refine_cage){.positions = t->positions,
				   .face_counts = t->counts,
				   .indices = t->indices,
				   .face_materials = t->materials,
				   .scheme = scheme,
				   .scale = {1.0f, 1.0f, 1.0f}};
}

static inline uint32_t cage_vertex(test_cage *t, float x, float y, float z)
{
	float *p = t->positions + 3 * t->cage.vertex_count;
	p[0] = x;
	p[1] = y;
	p[2] = z;
	return t->cage.vertex_count++;
}

/* Adds a face; its material is its number. */
static inline void cage_face(test_cage *t, uint32_t count, const uint32_t *corners)
{
	memcpy(t->indices + t->cage.index_count, corners, count * sizeof *corners);
	t->cage.index_count += count;
	t->materials[t->cage.face_count] = t->cage.face_count;
	t->counts[t->cage.face_count++] = count;
}

/* The cube [-1, 1]^3, outward. */
static inline void cage_cube(test_cage *t, gi_refine_scheme scheme)
{
	static const uint32_t faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
					     {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
	cage_begin(t, scheme);
	for (int i = 0; i < 8; i++)
		cage_vertex(t, i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f);
	for (int i = 0; i < 6; i++)
		cage_face(t, 4, faces[i]);
}

static inline void cage_octahedron(test_cage *t, gi_refine_scheme scheme)
{
	static const uint32_t faces[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
					     {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
	cage_begin(t, scheme);
	for (int i = 0; i < 6; i++)
		cage_vertex(t,
			    i == 0   ? 1.0f
			    : i == 1 ? -1.0f
				     : 0.0f,
			    i == 2   ? 1.0f
			    : i == 3 ? -1.0f
				     : 0.0f,
			    i == 4   ? 1.0f
			    : i == 5 ? -1.0f
				     : 0.0f);
	for (int i = 0; i < 8; i++)
		cage_face(t, 3, faces[i]);
}

static inline void cage_tetrahedron(test_cage *t, gi_refine_scheme scheme)
{
	static const uint32_t faces[4][3] = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
	cage_begin(t, scheme);
	cage_vertex(t, 1.0f, 1.0f, 1.0f);
	cage_vertex(t, -1.0f, 1.0f, -1.0f);
	cage_vertex(t, 1.0f, -1.0f, -1.0f);
	cage_vertex(t, -1.0f, -1.0f, 1.0f);
	for (int i = 0; i < 4; i++)
		cage_face(t, 3, faces[i]);
	/* Vertex order above makes faces inward; mirror them outward. */
	for (uint32_t i = 0; i < 4; i++) {
		const uint32_t b = t->indices[3 * i + 1];
		t->indices[3 * i + 1] = t->indices[3 * i + 2];
		t->indices[3 * i + 2] = b;
	}
}

/* The square [0, n]^2 in the plane z = 0, facing up, of n * n unit squares. */
static inline void cage_grid(test_cage *t, gi_refine_scheme scheme, uint32_t n)
{
	cage_begin(t, scheme);
	for (uint32_t y = 0; y <= n; y++)
		for (uint32_t x = 0; x <= n; x++)
			cage_vertex(t, (float)x, (float)y, 0.0f);
	for (uint32_t y = 0; y < n; y++)
		for (uint32_t x = 0; x < n; x++) {
			const uint32_t a = y * (n + 1) + x;
			cage_face(t, 4, (uint32_t[]){a, a + 1, a + n + 2, a + n + 1});
		}
	memset(t->materials, 0, sizeof t->materials);
}

/* A prism over a pentagon: two faces of five corners, sides of four, one of them cut into two triangles. */
static inline void cage_prism(test_cage *t, gi_refine_scheme scheme)
{
	cage_begin(t, scheme);
	for (int i = 0; i < 10; i++)
		cage_vertex(t, cosf(1.2566371f * (float)(i % 5)), sinf(1.2566371f * (float)(i % 5)),
			    i < 5 ? -1.0f : 1.0f);
	cage_face(t, 5, (uint32_t[]){4, 3, 2, 1, 0});
	cage_face(t, 5, (uint32_t[]){5, 6, 7, 8, 9});
	for (uint32_t i = 0; i < 4; i++)
		cage_face(t, 4, (uint32_t[]){i, i + 1, i + 6, i + 5});
	cage_face(t, 3, (uint32_t[]){4, 0, 5});
	cage_face(t, 3, (uint32_t[]){4, 5, 9});
}

static inline void refine_cage(const test_cage *t, uint32_t levels, gi_refined *out)
{
	char message[256] = "";
	if (!gi_refine(&t->cage, levels, out, message, sizeof message))
		fail_msg("gi_refine: %s", message);
}

static inline void build_cage(const test_cage *t, uint32_t levels, gi_hierarchy *out)
{
	char message[256] = "";
	gi_refined refined;
	refine_cage(t, levels, &refined);
	if (!gi_hierarchy_build(&refined, out, message, sizeof message))
		fail_msg("gi_hierarchy_build: %s", message);
	gi_refined_free(&refined);
}

/* A tolerance needs its reason beside it where this is used. */
static inline void check_near(double found, double expected, double tolerance, const char *file, int line)
{
	if (!(fabs(found - expected) <= tolerance)) {
		print_error("%s:%d: found %.9g, expected %.9g, tolerance %g\n", file, line, found, expected, tolerance);
		_fail(file, line);
	}
}
#define CHECK_NEAR(found, expected, tolerance) check_near(found, expected, tolerance, __FILE__, __LINE__)

#endif
