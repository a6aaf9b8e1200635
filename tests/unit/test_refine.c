/* Refinement against the limit masks of the literature, and every way a cage can be wrong.
 *
 * Catmull-Clark: an interior vertex of n quads has the limit (n^2 v + 4 sum e + sum f) / (n (n + 5)), e its edge
 * neighbours, f the corners opposite (Halstead, Kass, DeRose 1993). Loop: v + (sum of (e - v)) / (n + 3 / (8 beta))
 * with Loop's beta.
 */
#include "cages.h"

#include <stdlib.h>

static float length3(const float v[3])
{
	return sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static void cube_corners_reach_the_catmull_clark_limit(void **state)
{
	(void)state;
	test_cage t;
	cage_cube(&t, GI_REFINE_CATMULL_CLARK);
	/* (9 * 1 + 4 * (1 + 1 - 1) + (1 - 1 - 1)) / 24 a coordinate, whatever the level. */
	for (uint32_t levels = 0; levels <= 4; levels++) {
		gi_refined r;
		refine_cage(&t, levels, &r);
		assert_int_equal(r.level_count, levels + 1);
		for (uint32_t face = 0; face < 6; face++)
			for (uint32_t k = 0; k < 4; k++) {
				const float *cage = t.positions + 3 * t.indices[4 * face + k];
				const float *limit = r.positions[r.levels[0].corners[face][k]];
				for (int axis = 0; axis < 3; axis++)
					CHECK_NEAR(limit[axis], 0.5f * cage[axis], 1e-7); /* float rounding */
			}
		assert_true(r.closed);
		gi_refined_free(&r);
	}
}

static void cube_normals_point_outward_and_are_unit(void **state)
{
	(void)state;
	test_cage t;
	gi_refined r;
	cage_cube(&t, GI_REFINE_CATMULL_CLARK);
	refine_cage(&t, 3, &r);
	for (uint32_t i = 0; i < r.vertex_count; i++) {
		const float *p = r.positions[i], *n = r.normals[i];
		CHECK_NEAR(length3(n), 1.0, 1e-6);
		assert_true(p[0] * n[0] + p[1] * n[1] + p[2] * n[2] > 0.9f * length3(p));
	}
	/* By symmetry the normal at a corner is the diagonal. */
	const uint32_t corner = r.levels[0].corners[0][0];
	for (int axis = 0; axis < 3; axis++)
		CHECK_NEAR(r.normals[corner][axis] * copysignf(1.0f, r.positions[corner][axis]), sqrt(1.0 / 3.0), 1e-6);
	gi_refined_free(&r);
}

/* Loop's mask for valence n: beta from the refinement rule, the limit from its eigenvector. */
static double loop_limit_weight(int n)
{
	const double c = 0.375 + 0.25 * cos(2.0 * 3.14159265358979 / n);
	const double beta = (0.625 - c * c) / n;
	return 1.0 / (0.375 / beta + n);
}

static void check_loop_limit(const test_cage *t, int valence, double neighbour_sum)
{
	/* By symmetry the neighbours' sum lies along the vertex: limit = (1 - n w) v + w sum. */
	const double w = loop_limit_weight(valence), factor = 1.0 - valence * w + w * neighbour_sum;
	for (uint32_t levels = 0; levels <= 3; levels++) {
		gi_refined r;
		refine_cage(t, levels, &r);
		for (uint32_t i = 0; i < t->cage.index_count; i++) {
			const uint32_t vertex = r.levels[0].corners[i / 3][i % 3];
			for (int axis = 0; axis < 3; axis++)
				CHECK_NEAR(r.positions[vertex][axis], factor * t->positions[3 * t->indices[i] + axis],
					   2e-7);
		}
		const uint32_t finest = r.levels[levels].face_count;
		assert_int_equal(finest, t->cage.face_count << 2 * levels);
		assert_int_equal(r.levels[levels].corners[finest - 1][2], r.levels[levels].corners[finest - 1][3]);
		gi_refined_free(&r);
	}
}

static void octahedron_and_tetrahedron_reach_the_loop_limit(void **state)
{
	(void)state;
	test_cage t;
	cage_octahedron(&t, GI_REFINE_LOOP);
	check_loop_limit(&t, 4, 0.0);
	cage_tetrahedron(&t, GI_REFINE_LOOP);
	check_loop_limit(&t, 3, -1.0);
}

static void bilinear_grid_is_exact(void **state)
{
	(void)state;
	test_cage t;
	gi_refined r;
	cage_grid(&t, GI_REFINE_BILINEAR, 3);
	refine_cage(&t, 2, &r);
	assert_int_equal(r.vertex_count, 13 * 13);
	assert_int_equal(r.levels[2].face_count, 144);
	assert_false(r.closed);
	for (uint32_t i = 0; i < r.vertex_count; i++) {
		/* Quarters of a unit are exact in binary. */
		assert_true(r.positions[i][0] * 4.0f == floorf(r.positions[i][0] * 4.0f));
		assert_true(r.positions[i][1] * 4.0f == floorf(r.positions[i][1] * 4.0f));
		assert_true(r.positions[i][2] == 0.0f);
		assert_true(length3(r.normals[i]) == 0.0f);
	}
	gi_refined_free(&r);
}

static void children_lie_in_their_parents(void **state)
{
	(void)state;
	test_cage t;
	gi_refined r;
	cage_grid(&t, GI_REFINE_BILINEAR, 3);
	for (uint32_t i = 0; i < t.cage.face_count; i++)
		t.materials[i] = i;
	refine_cage(&t, 2, &r);
	for (uint32_t level = 1; level < r.level_count; level++)
		for (uint32_t face = 0; face < r.levels[level].face_count; face++) {
			const uint32_t parent = r.levels[level].parent[face];
			const float *low = r.positions[r.levels[level - 1].corners[parent][0]];
			const float size = ldexpf(1.0f, 1 - (int)level);
			assert_int_equal(r.levels[level].material[face], r.levels[level - 1].material[parent]);
			for (int k = 0; k < 4; k++) {
				const float *p = r.positions[r.levels[level].corners[face][k]];
				assert_true(p[0] >= low[0] && p[0] <= low[0] + size);
				assert_true(p[1] >= low[1] && p[1] <= low[1] + size);
			}
		}
	assert_null(r.levels[0].parent);
	gi_refined_free(&r);
}

static void sharp_creases_keep_their_edges(void **state)
{
	(void)state;
	test_cage t;
	gi_refined r;
	cage_cube(&t, GI_REFINE_CATMULL_CLARK);
	const uint32_t loop[8] = {4, 5, 5, 7, 7, 6, 6, 4};
	const float sharpness[4] = {10.0f, 10.0f, 10.0f, 10.0f};
	t.cage.crease_vertices = loop;
	t.cage.crease_sharpness = sharpness;
	t.cage.crease_count = 4;
	refine_cage(&t, 3, &r);
	uint32_t on_top = 0;
	for (uint32_t i = 0; i < r.vertex_count; i++) {
		if (r.positions[i][2] < 1.0f - 1e-6f)
			continue;
		on_top++;
		const float out = fmaxf(fabsf(r.positions[i][0]), fabsf(r.positions[i][1]));
		/* The crease is a cubic B-spline: its middle is 5/6 out, and it has no normal; inside the top is flat.
		 */
		if (length3(r.normals[i]) > 0.0f)
			CHECK_NEAR(r.normals[i][2], 1.0, 1e-6);
		else
			assert_true(out > 0.5f);
	}
	/* The whole top face and its rim lie in z = 1. */
	assert_int_equal(on_top, 9 * 9);
	gi_refined_free(&r);
}

static void creased_vertices_have_no_normal(void **state)
{
	(void)state;
	test_cage t;
	gi_refined r;
	cage_cube(&t, GI_REFINE_CATMULL_CLARK);
	const uint32_t edge[2] = {4, 5};
	const float sharpness[1] = {1.5f};
	t.cage.crease_vertices = edge;
	t.cage.crease_sharpness = sharpness;
	t.cage.crease_count = 1;
	refine_cage(&t, 1, &r); /* half a step of sharpness is left on two edges of three vertices */
	uint32_t without = 0;
	for (uint32_t i = 0; i < r.vertex_count; i++)
		without += length3(r.normals[i]) == 0.0f;
	assert_int_equal(without, 3);
	gi_refined_free(&r);
	refine_cage(&t, 3, &r); /* the sharpness is used up: smooth everywhere */
	for (uint32_t i = 0; i < r.vertex_count; i++)
		CHECK_NEAR(length3(r.normals[i]), 1.0, 1e-6);
	gi_refined_free(&r);
}

static void boundary_rules(void **state)
{
	(void)state;
	test_cage t;
	gi_refined r;
	cage_grid(&t, GI_REFINE_CATMULL_CLARK, 2);
	refine_cage(&t, 2, &r);
	const float *corner = r.positions[r.levels[0].corners[0][0]];
	assert_true(corner[0] == 0.0f && corner[1] == 0.0f);
	for (uint32_t i = 0; i < r.vertex_count; i++)
		CHECK_NEAR(r.normals[i][2], 1.0, 1e-6);
	gi_refined_free(&r);

	/* Rounded, the corner is a point of the boundary's cubic B-spline: (a + 4 v + b) / 6. */
	t.cage.boundary = GI_REFINE_BOUNDARY_EDGE_ONLY;
	refine_cage(&t, 2, &r);
	corner = r.positions[r.levels[0].corners[0][0]];
	CHECK_NEAR(corner[0], 1.0 / 6.0, 1e-7);
	CHECK_NEAR(corner[1], 1.0 / 6.0, 1e-7);
	gi_refined_free(&r);
}

static void n_gons_are_refined_once_at_least(void **state)
{
	(void)state;
	test_cage t;
	gi_refined r;
	cage_prism(&t, GI_REFINE_BILINEAR);
	refine_cage(&t, 0, &r);
	assert_int_equal(r.level_count, 2);
	assert_int_equal(r.levels[0].corners[0][0], UINT32_MAX);
	assert_int_equal(r.levels[0].corners[0][3], UINT32_MAX);
	assert_int_equal(r.levels[1].face_count, t.cage.index_count);
	assert_true(r.closed);
	gi_refined_free(&r);
}

static void quads_that_repeat_a_corner_are_triangles(void **state)
{
	(void)state;
	test_cage t;
	gi_refined r;
	cage_begin(&t, GI_REFINE_LOOP);
	for (int i = 0; i < 5; i++)
		cage_vertex(&t, (float)(i & 1), (float)(i / 2), 0.0f);
	cage_face(&t, 4, (uint32_t[]){0, 1, 3, 3});
	cage_face(&t, 4, (uint32_t[]){0, 3, 2, 2});
	cage_face(&t, 4, (uint32_t[]){0, 0, 1, 1}); /* a line: no face at all */
	t.cage.face_counts = NULL;
	refine_cage(&t, 1, &r);
	assert_int_equal(r.levels[0].face_count, 2);
	assert_int_equal(r.levels[1].face_count, 8);
	assert_int_equal(r.vertex_count, 9); /* vertex 4, in no face, is gone */
	gi_refined_free(&r);
}

static void a_mirroring_scale_keeps_outside_out(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy h;
	cage_cube(&t, GI_REFINE_BILINEAR);
	t.cage.scale[0] = -2.0f;
	t.cage.scale[1] = 3.0f;
	build_cage(&t, 1, &h);
	CHECK_NEAR(h.volume, 48.0, 1e-5);
	gi_hierarchy_free(&h);
}

static void edges_of_four_faces_are_a_surface_too(void **state)
{
	(void)state;
	test_cage t;
	gi_refined r;
	/* Two tetrahedra that share an edge: closed, though not a manifold. */
	cage_begin(&t, GI_REFINE_LOOP);
	cage_vertex(&t, 0.0f, 0.0f, 0.0f);
	cage_vertex(&t, 0.0f, 0.0f, 1.0f);
	for (int side = 1; side >= -1; side -= 2) {
		const uint32_t a = cage_vertex(&t, (float)side, 0.5f * (float)side, 0.5f);
		const uint32_t b = cage_vertex(&t, (float)side, -0.5f * (float)side, 0.5f);
		cage_face(&t, 3, (uint32_t[]){0, 1, a});
		cage_face(&t, 3, (uint32_t[]){1, 0, b});
		cage_face(&t, 3, (uint32_t[]){0, a, b});
		cage_face(&t, 3, (uint32_t[]){1, b, a});
	}
	refine_cage(&t, 2, &r);
	assert_true(r.closed);
	assert_true(length3(r.normals[r.levels[0].corners[0][0]]) == 0.0f);
	gi_refined_free(&r);
	t.cage.face_count--;
	t.cage.index_count -= 3;
	refine_cage(&t, 1, &r);
	assert_false(r.closed);
	gi_refined_free(&r);
}

/* ---- what is wrong with a cage ---- */

static void expect_refusal(const test_cage *t, uint32_t levels, const char *part)
{
	gi_refined r;
	char message[256] = "";
	memset(&r, 0xAB, sizeof r);
	assert_false(gi_refine(&t->cage, levels, &r, message, sizeof message));
	if (!strstr(message, part))
		fail_msg("message \"%s\" lacks \"%s\"", message, part);
	assert_null(strchr(message, '\n'));
	assert_null(r.levels);
	assert_null(r.positions);
	assert_int_equal(r.level_count, 0);
	assert_int_equal(r.vertex_count, 0);
	assert_false(gi_refine(&t->cage, levels, &r, NULL, 0));
}

static void refuses_broken_arrays(void **state)
{
	(void)state;
	test_cage t;
	cage_cube(&t, GI_REFINE_CATMULL_CLARK);
	expect_refusal(&t, 9, "levels");
	t.cage.face_count = 0;
	expect_refusal(&t, 1, "no faces");
	cage_cube(&t, GI_REFINE_CATMULL_CLARK);
	t.cage.positions = NULL;
	expect_refusal(&t, 1, "no faces");
	cage_cube(&t, GI_REFINE_CATMULL_CLARK);
	t.counts[2] = 2;
	expect_refusal(&t, 1, "face 2 has 2 corners");
	t.counts[2] = 5;
	expect_refusal(&t, 1, "there are 24 indices");
	t.counts[2] = 70000;
	expect_refusal(&t, 1, "at most");
	cage_cube(&t, GI_REFINE_CATMULL_CLARK);
	t.indices[7] = 8;
	expect_refusal(&t, 1, "index 7 is vertex 8");
	cage_cube(&t, (gi_refine_scheme)7);
	expect_refusal(&t, 1, "scheme 7");
	cage_cube(&t, GI_REFINE_BILINEAR);
	t.cage.boundary = (gi_refine_boundary)-1;
	expect_refusal(&t, 1, "boundary rule -1");
}

static void refuses_broken_numbers(void **state)
{
	(void)state;
	test_cage t;
	const float bad[3] = {NAN, INFINITY, 1e30f};
	for (int i = 0; i < 3; i++) {
		cage_cube(&t, GI_REFINE_CATMULL_CLARK);
		t.positions[10] = bad[i];
		expect_refusal(&t, 1, "vertex 3");
	}
	cage_cube(&t, GI_REFINE_CATMULL_CLARK);
	t.cage.scale[1] = 0.0f;
	expect_refusal(&t, 1, "scale");
	t.cage.scale[1] = NAN;
	expect_refusal(&t, 1, "scale");
}

static void refuses_broken_faces(void **state)
{
	(void)state;
	test_cage t;
	cage_cube(&t, GI_REFINE_LOOP);
	expect_refusal(&t, 1, "Loop");
	cage_begin(&t, GI_REFINE_CATMULL_CLARK);
	for (int i = 0; i < 3; i++)
		cage_vertex(&t, (float)i, (float)(i * i), 0.0f);
	cage_face(&t, 4, (uint32_t[]){0, 1, 0, 2});
	expect_refusal(&t, 1, "face 0 passes through vertex 0 twice");
	cage_begin(&t, GI_REFINE_CATMULL_CLARK);
	cage_vertex(&t, 0.0f, 0.0f, 0.0f);
	cage_face(&t, 3, (uint32_t[]){0, 0, 0});
	expect_refusal(&t, 1, "three different corners");
	cage_grid(&t, GI_REFINE_BILINEAR, 20);
	expect_refusal(&t, 8, "too many faces");
}

static void refuses_broken_creases(void **state)
{
	(void)state;
	test_cage t;
	uint32_t ends[2] = {0, 7};
	float sharpness = 3.0f;
	cage_cube(&t, GI_REFINE_CATMULL_CLARK);
	t.cage.crease_count = 1;
	expect_refusal(&t, 1, "no arrays");
	t.cage.crease_vertices = ends;
	t.cage.crease_sharpness = &sharpness;
	expect_refusal(&t, 1, "no face joins");
	ends[1] = 8;
	expect_refusal(&t, 1, "crease 0 joins vertices 0 and 8");
	ends[1] = 1;
	sharpness = -1.0f;
	expect_refusal(&t, 1, "sharpness");
	sharpness = NAN;
	expect_refusal(&t, 1, "sharpness");
}

static void freeing_twice_is_harmless(void **state)
{
	(void)state;
	test_cage t;
	gi_refined r;
	cage_cube(&t, GI_REFINE_BILINEAR);
	refine_cage(&t, 1, &r);
	gi_refined_free(&r);
	gi_refined_free(&r);
	gi_refined_free(NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(cube_corners_reach_the_catmull_clark_limit),
	    cmocka_unit_test(cube_normals_point_outward_and_are_unit),
	    cmocka_unit_test(octahedron_and_tetrahedron_reach_the_loop_limit),
	    cmocka_unit_test(bilinear_grid_is_exact),
	    cmocka_unit_test(children_lie_in_their_parents),
	    cmocka_unit_test(sharp_creases_keep_their_edges),
	    cmocka_unit_test(creased_vertices_have_no_normal),
	    cmocka_unit_test(boundary_rules),
	    cmocka_unit_test(n_gons_are_refined_once_at_least),
	    cmocka_unit_test(quads_that_repeat_a_corner_are_triangles),
	    cmocka_unit_test(a_mirroring_scale_keeps_outside_out),
	    cmocka_unit_test(edges_of_four_faces_are_a_surface_too),
	    cmocka_unit_test(refuses_broken_arrays),
	    cmocka_unit_test(refuses_broken_numbers),
	    cmocka_unit_test(refuses_broken_faces),
	    cmocka_unit_test(refuses_broken_creases),
	    cmocka_unit_test(freeing_twice_is_harmless),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
