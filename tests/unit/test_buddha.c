/* The Buddha cage must be what Catmull-Clark refinement and the radiosity hierarchy rely on: a closed, consistently
 * oriented quad surface without holes or handles, of known size, the same at every call. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh.h"
#include "scenes/buddha.h"

static int setup(void **state)
{
	engine_mesh *mesh = calloc(1, sizeof *mesh);

	if (!mesh || !buddha_cage(mesh)) {
		free(mesh);
		return -1;
	}
	*state = mesh;
	return 0;
}

static int teardown(void **state)
{
	engine_mesh_free(*state);
	free(*state);
	return 0;
}

static const float *position(const engine_mesh *mesh, uint32_t face, uint32_t corner)
{
	return &mesh->positions[3 * mesh->indices[4 * face + corner % 4]];
}

/* How often the directed edge a -> b occurs in the mesh's quads, looked up in a vertex_count^2 table. */
static uint8_t *count_directed_edges(const engine_mesh *mesh)
{
	uint8_t *count = calloc((size_t)mesh->vertex_count * mesh->vertex_count, 1);
	uint32_t f, k;

	assert_non_null(count);
	for (f = 0; f < mesh->face_count; f++) {
		for (k = 0; k < 4; k++) {
			uint32_t a = mesh->indices[4 * f + k], b = mesh->indices[4 * f + (k + 1) % 4];

			count[(size_t)a * mesh->vertex_count + b]++;
		}
	}
	return count;
}

static void all_faces_are_quads_in_the_agreed_number(void **state)
{
	const engine_mesh *mesh = *state;
	uint32_t i;

	assert_in_range(mesh->face_count, 700, 1000);
	assert_int_equal(mesh->index_count, 4 * mesh->face_count);
	for (i = 0; i < mesh->face_count; i++)
		assert_int_equal(mesh->face_counts[i], 4);
	for (i = 0; i < mesh->index_count; i++)
		assert_true(mesh->indices[i] < mesh->vertex_count);
	assert_int_equal(mesh->crease_count, 0);
}

static void surface_is_a_closed_manifold_and_a_topological_sphere(void **state)
{
	const engine_mesh *mesh = *state;
	uint8_t *count = count_directed_edges(mesh);
	uint32_t n = mesh->vertex_count, a, b, edges = 0;

	for (a = 0; a < n; a++) {
		assert_int_equal(count[(size_t)a * n + a], 0);
		for (b = a + 1; b < n; b++) {
			assert_true(count[(size_t)a * n + b] <= 1);
			assert_int_equal(count[(size_t)a * n + b], count[(size_t)b * n + a]);
			edges += count[(size_t)a * n + b];
		}
	}
	free(count);
	assert_int_equal((int)n - (int)edges + (int)mesh->face_count, 2);
}

/* Euler characteristic 2 could also be two pieces, one of them with a handle. */
static void surface_is_one_piece_and_uses_every_vertex(void **state)
{
	const engine_mesh *mesh = *state;
	uint32_t *label = malloc(mesh->vertex_count * sizeof *label);
	uint32_t v, f, k;
	int changed = 1;

	assert_non_null(label);
	for (v = 0; v < mesh->vertex_count; v++)
		label[v] = v;
	while (changed) {
		changed = 0;
		for (f = 0; f < mesh->face_count; f++) {
			for (k = 0; k < 8; k++) {
				uint32_t a = mesh->indices[4 * f + k % 4], b = mesh->indices[4 * f + (k + 1) % 4];

				if (label[b] > label[a]) {
					label[b] = label[a];
					changed = 1;
				}
			}
		}
	}
	for (v = 0; v < mesh->vertex_count; v++)
		assert_int_equal(label[v], 0);
	free(label);
}

static void faces_look_outward_and_have_area(void **state)
{
	const engine_mesh *mesh = *state;
	double volume = 0.0;
	uint32_t f, k;

	for (f = 0; f < mesh->face_count; f++) {
		const float *a = position(mesh, f, 0), *c = position(mesh, f, 2);
		double area[3] = {0.0, 0.0, 0.0};

		for (k = 1; k < 3; k++) {
			const float *p = position(mesh, f, k), *q = position(mesh, f, k + 1);
			double u[3] = {p[0] - a[0], p[1] - a[1], p[2] - a[2]};
			double w[3] = {q[0] - a[0], q[1] - a[1], q[2] - a[2]};
			double n[3] = {u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]};
			int i;

			for (i = 0; i < 3; i++)
				area[i] += 0.5 * n[i];
			volume += (a[0] * n[0] + a[1] * n[1] + a[2] * n[2]) / 6.0;
		}
		assert_true(sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]) > 1e-6);
		assert_true(memcmp(a, c, 3 * sizeof *a) != 0);
	}
	/* The bounding box holds about 0.5; a figure that fills less than a fifth of it has been turned inside out. */
	assert_true(volume > 0.1 && volume < 0.4);
}

static void left_mirrors_right(void **state)
{
	const engine_mesh *mesh = *state;
	uint32_t a, b, on_plane = 0;

	for (a = 0; a < mesh->vertex_count; a++) {
		const float *p = &mesh->positions[3 * a];
		int found = 0;

		for (b = 0; b < mesh->vertex_count && !found; b++) {
			const float *q = &mesh->positions[3 * b];

			found = q[0] == -p[0] && q[1] == p[1] && q[2] == p[2];
		}
		assert_true(found);
		on_plane += p[0] == 0.0f;
	}
	assert_true(on_plane > 20); /* an edge loop runs along the plane of symmetry */
}

/* The limit points of all vertices. Among quads that of a vertex v of valence n is
 * (n^2 v + 4 * sum of edge neighbours + sum of face opposites) / (n (n + 5)). Free the result. */
static double *limit_points(const engine_mesh *mesh)
{
	double *limit = calloc(3 * mesh->vertex_count, sizeof *limit);
	uint32_t *valence = calloc(mesh->vertex_count, sizeof *valence);
	uint32_t f, k, v, i;

	assert_non_null(limit);
	assert_non_null(valence);
	for (f = 0; f < mesh->face_count; f++) {
		for (k = 0; k < 4; k++) {
			const float *before = position(mesh, f, k + 3), *after = position(mesh, f, k + 1);
			const float *opposite = position(mesh, f, k + 2);

			v = mesh->indices[4 * f + k];
			valence[v]++;
			for (i = 0; i < 3; i++) /* each edge is met from two faces */
				limit[3 * v + i] += 2.0 * ((double)before[i] + after[i]) + opposite[i];
		}
	}
	for (v = 0; v < mesh->vertex_count; v++) {
		double n = valence[v];

		for (i = 0; i < 3; i++)
			limit[3 * v + i] = (limit[3 * v + i] + n * n * mesh->positions[3 * v + i]) / (n * (n + 5.0));
	}
	free(valence);
	return limit;
}

static void cross(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

/* At refinement level 0 the patches are the cage's faces with their corners on the limit surface: none of them may be
 * folded over or concave. */
static void patches_on_the_limit_are_convex(void **state)
{
	const engine_mesh *mesh = *state;
	double *limit = limit_points(mesh);
	uint32_t f, k, i;

	for (f = 0; f < mesh->face_count; f++) {
		const double *p[4];
		double edge[4][3], diagonal[2][3], normal[3], corner[3];

		for (k = 0; k < 4; k++)
			p[k] = &limit[3 * mesh->indices[4 * f + k]];
		for (i = 0; i < 3; i++) {
			for (k = 0; k < 4; k++)
				edge[k][i] = p[(k + 1) % 4][i] - p[k][i];
			diagonal[0][i] = p[2][i] - p[0][i];
			diagonal[1][i] = p[3][i] - p[1][i];
		}
		cross(diagonal[0], diagonal[1], normal);
		for (k = 0; k < 4; k++) {
			cross(edge[k], edge[(k + 1) % 4], corner);
			assert_true(corner[0] * normal[0] + corner[1] * normal[1] + corner[2] * normal[2] > 0.0);
		}
	}
	free(limit);
}

static void stands_on_the_floor_and_is_one_high(void **state)
{
	const engine_mesh *mesh = *state;
	double *limit = limit_points(mesh), low = 1e9, high = -1e9, widest = 0.0, deepest = 0.0;
	uint32_t v;

	for (v = 0; v < mesh->vertex_count; v++) {
		low = fmin(low, limit[3 * v + 1]);
		high = fmax(high, limit[3 * v + 1]);
		widest = fmax(widest, limit[3 * v]);
		deepest = fmax(deepest, fabs(limit[3 * v + 2]));
		assert_true(mesh->positions[3 * v + 1] >= 0.0f); /* so that no refinement can dip below the floor */
	}
	free(limit);
	assert_true(fabs(low) < 1e-6);
	assert_true(fabs(high - 1.0) < 1e-5);
	assert_true(widest > 0.3 && widest < 0.5);
	assert_true(deepest > 0.25 && deepest < 0.5);
}

/* The face looks to +z: the lap and the hands reach further forward than anything at their height reaches back. */
static void looks_forward(void **state)
{
	const engine_mesh *mesh = *state;
	float front = -1.0f, back = 1.0f;
	uint32_t v;

	for (v = 0; v < mesh->vertex_count; v++) {
		const float *p = &mesh->positions[3 * v];

		if (p[1] > 0.3f && p[1] < 0.5f) {
			front = fmaxf(front, p[2]);
			back = fminf(back, p[2]);
		}
	}
	assert_true(front > -back);
}

static void two_calls_give_the_same_bits(void **state)
{
	const engine_mesh *mesh = *state;
	engine_mesh again;

	assert_true(buddha_cage(&again));
	assert_int_equal(again.vertex_count, mesh->vertex_count);
	assert_int_equal(again.face_count, mesh->face_count);
	assert_int_equal(again.index_count, mesh->index_count);
	assert_memory_equal(again.positions, mesh->positions, 3 * mesh->vertex_count * sizeof *mesh->positions);
	assert_memory_equal(again.indices, mesh->indices, mesh->index_count * sizeof *mesh->indices);
	assert_memory_equal(again.face_counts, mesh->face_counts, mesh->face_count * sizeof *mesh->face_counts);
	engine_mesh_free(&again);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(all_faces_are_quads_in_the_agreed_number),
	    cmocka_unit_test(surface_is_a_closed_manifold_and_a_topological_sphere),
	    cmocka_unit_test(surface_is_one_piece_and_uses_every_vertex),
	    cmocka_unit_test(faces_look_outward_and_have_area),
	    cmocka_unit_test(left_mirrors_right),
	    cmocka_unit_test(stands_on_the_floor_and_is_one_high),
	    cmocka_unit_test(looks_forward),
	    cmocka_unit_test(patches_on_the_limit_are_convex),
	    cmocka_unit_test(two_calls_give_the_same_bits),
	};

	return cmocka_run_group_tests(tests, setup, teardown);
}
