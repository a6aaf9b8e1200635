/* Cages at other positions, by the sums that refining them once left: the same surface as refining them anew. */
#include "cages.h"

#include "bits.h"
#include "bvh.h"
#include "split.h"
#include "vec3d.h"

#include <stdlib.h>

/* Positions are floats of size 1 to 3, and weights that sum to 1 in double. */
#define ROUNDING 5e-7

static void bend_cage(test_cage *t)
{
	for (uint32_t v = 0; v < t->cage.vertex_count; v++) {
		float *p = t->positions + 3 * v;
		const float x = p[0], y = p[1], z = p[2];
		p[0] = x + .2f * sinf(2 * y + z) + .3f;
		p[1] = 1.2f * y - .1f * cosf(3 * x);
		p[2] = .8f * z + .2f * x * y;
	}
}

/* In double, as deform.c has it. */
static void copy_cage(const test_cage *t, double (*out)[3])
{
	for (uint32_t v = 0; v < t->cage.vertex_count; v++)
		for (int k = 0; k < 3; k++)
			out[v][k] = (double)t->positions[3 * v + k] * t->cage.scale[k];
}

static void expect_same_points(const gi_refined *sums, const gi_refined *anew, const double (*cage)[3])
{
	assert_int_equal(sums->points.count, anew->vertex_count);
	for (uint32_t k = 0; k < anew->vertex_count; k++) {
		double at[3];
		gi_stencils_evaluate(&sums->points, k, cage, at);
		for (int c = 0; c < 3; c++)
			CHECK_NEAR(at[c], anew->positions[k][c], ROUNDING);
	}
}

static void expect_same_normals(const gi_refined *sums, const gi_refined *anew, const double (*cage)[3])
{
	uint32_t normals = 0;
	for (uint32_t k = 0; k < anew->vertex_count && sums->tangents[0].count; k++) {
		double a[3], b[3];
		gi_stencils_evaluate(&sums->tangents[0], k, cage, a);
		gi_stencils_evaluate(&sums->tangents[1], k, cage, b);
		const gi_vec3d n =
		    gi_vec3d_unit(gi_vec3d_cross((gi_vec3d){a[0], a[1], a[2]}, (gi_vec3d){b[0], b[1], b[2]}));
		CHECK_NEAR(n.x, anew->normals[k][0], ROUNDING);
		CHECK_NEAR(n.y, anew->normals[k][1], ROUNDING);
		CHECK_NEAR(n.z, anew->normals[k][2], ROUNDING);
		normals += gi_vec3d_length(n) > 0;
	}
	assert_true(anew->vertex_count > 0 && (normals > 0) == (sums->tangents[0].count > 0));
}

typedef void make_cage(test_cage *t, gi_refine_scheme scheme);

static void make_grid(test_cage *t, gi_refine_scheme scheme)
{
	cage_grid(t, scheme, 3);
}

static const struct {
	make_cage *make;
	gi_refine_scheme scheme;
} CAGES[] = {{cage_cube, GI_REFINE_BILINEAR},       {cage_prism, GI_REFINE_BILINEAR},
	     {cage_octahedron, GI_REFINE_BILINEAR}, {cage_cube, GI_REFINE_CATMULL_CLARK},
	     {cage_prism, GI_REFINE_CATMULL_CLARK}, {cage_octahedron, GI_REFINE_LOOP},
	     {cage_tetrahedron, GI_REFINE_LOOP},    {make_grid, GI_REFINE_CATMULL_CLARK}};

static void sums_are_what_refining_gives(void **state)
{
	(void)state;
	static test_cage t;
	static double at_rest[512][3], bent[512][3];
	for (size_t c = 0; c < sizeof CAGES / sizeof *CAGES; c++)
		for (uint32_t levels = 0; levels <= 2; levels++) {
			gi_refined rest, anew;
			CAGES[c].make(&t, CAGES[c].scheme);
			t.cage.scale[1] = 1.5f;
			t.cage.stencils = true;
			refine_cage(&t, levels, &rest);
			copy_cage(&t, at_rest);
			bend_cage(&t);
			copy_cage(&t, bent);
			t.cage.stencils = false;
			refine_cage(&t, levels, &anew);
			assert_int_equal(anew.points.count, 0);
			assert_null(anew.faces);
			expect_same_points(&rest, &rest, (const double(*)[3])at_rest);
			expect_same_points(&rest, &anew, (const double(*)[3])bent);
			expect_same_normals(&rest, &anew, (const double(*)[3])bent);
			/* Materials are the faces' numbers. */
			const gi_refine_level *finest = &rest.levels[rest.level_count - 1];
			for (uint32_t f = 0; f < finest->face_count && CAGES[c].make != make_grid; f++)
				assert_int_equal(rest.faces[f], finest->material[f]);
			gi_refined_free(&rest);
			gi_refined_free(&anew);
		}
}

/* Faces that are split: where the cage is turned and stretched as a whole, all points are. */
static void faces_that_are_split(void **state)
{
	(void)state;
	static test_cage t;
	static double cage[512][3];
	const gi_leaf_cut cut = {.face = 1, .from = {1, -.3f, -1}, .to = {1, .2f, 1}};
	const gi_split_def def = {.leaf_size = .3f, .cuts = &cut, .cut_count = 1};
	for (int kind = 0; kind < 3; kind++) {
		gi_refined r;
		char message[256];
		CAGES[kind].make(&t, GI_REFINE_BILINEAR);
		t.cage.stencils = true;
		assert_true(gi_split(&t.cage, &def, &r, message, sizeof message));
		copy_cage(&t, cage);
		expect_same_points(&r, &r, (const double(*)[3])cage);
		static const double turn[3][3] = {{.5, -.2, .1}, {.4, 1.1, 0}, {-.3, .2, .9}};
		for (uint32_t v = 0; v < t.cage.vertex_count; v++)
			for (int row = 0; row < 3; row++)
				cage[v][row] = turn[row][0] * (double)t.positions[3 * v] +
					       turn[row][1] * (double)t.positions[3 * v + 1] +
					       turn[row][2] * (double)t.positions[3 * v + 2];
		for (uint32_t k = 0; k < r.vertex_count; k++) {
			double at[3];
			gi_stencils_evaluate(&r.points, k, (const double(*)[3])cage, at);
			for (int row = 0; row < 3; row++)
				CHECK_NEAR(at[row],
					   turn[row][0] * r.positions[k][0] + turn[row][1] * r.positions[k][1] +
					       turn[row][2] * r.positions[k][2],
					   ROUNDING);
		}
		gi_refined_free(&r);
	}
}

/* Two faces of one sheet that lie on one another share no points but those of the edge between them. */
static void what_lies_together_may_part(void **state)
{
	(void)state;
	static test_cage t;
	cage_begin(&t, GI_REFINE_BILINEAR);
	const float corners[6][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 0}};
	for (int k = 0; k < 6; k++)
		cage_vertex(&t, corners[k][0], corners[k][1], corners[k][2]);
	cage_face(&t, 4, (uint32_t[]){0, 1, 2, 3});
	cage_face(&t, 4, (uint32_t[]){3, 2, 4, 5});
	const gi_split_def def = {.leaf_size = .5f};
	uint32_t counts[2];
	for (int deforms = 0; deforms < 2; deforms++) {
		gi_refined r;
		char message[256];
		t.cage.stencils = deforms;
		assert_true(gi_split(&t.cage, &def, &r, message, sizeof message));
		counts[deforms] = r.vertex_count;
		gi_refined_free(&r);
	}
	/* Nine points a face, three of them shared; at rest all but four corners of the cage are one. */
	assert_int_equal(counts[1], 15);
	assert_true(counts[0] < counts[1]);
}

static void place(gi_hierarchy *h, const gi_refined *r, const double (*cage)[3])
{
	for (uint32_t k = 0; k < h->vertex_count; k++) {
		double at[3];
		gi_stencils_evaluate(&r->points, k, cage, at);
		h->vertices[k] = (gi_vec4){(float)at[0], (float)at[1], (float)at[2], 0};
	}
	static gi_node_sums sums[8192];
	assert_true(h->node_count <= 8192);
	gi_hierarchy_refit(h, sums);
}

static void expect_boxes_hold(const gi_bvh *bvh)
{
	for (uint32_t n = 0; n < bvh->node_count; n++) {
		const uint32_t primitive = gi_bits_from_float(bvh->nodes[n].upper.w);
		const float *l = &bvh->nodes[n].lower.x, *u = &bvh->nodes[n].upper.x;
		for (int axis = 0; axis < 3 && primitive != GI_NONE; axis++)
			for (int c = 0; c < 4; c++) {
				const float at = (&(&bvh->primitives[primitive].a)[c].x)[axis];
				assert_true(l[axis] < at && at < u[axis]);
			}
		const uint32_t end = gi_bits_from_float(bvh->nodes[n].lower.w);
		for (uint32_t child = n + 1; child < end; child = gi_bits_from_float(bvh->nodes[child].lower.w))
			for (int axis = 0; axis < 3; axis++)
				assert_true(l[axis] <= (&bvh->nodes[child].lower.x)[axis] &&
					    u[axis] >= (&bvh->nodes[child].upper.x)[axis]);
	}
}

/* There and back again is where it began, bit for bit, and no less right on the way. */
static void refitting_forgets(void **state)
{
	(void)state;
	static test_cage t;
	static double at_rest[512][3], bent[512][3];
	for (size_t c = 0; c < sizeof CAGES / sizeof *CAGES; c++) {
		gi_refined r;
		gi_hierarchy h;
		gi_bvh bvh;
		CAGES[c].make(&t, CAGES[c].scheme);
		t.cage.stencils = true;
		refine_cage(&t, 2, &r);
		copy_cage(&t, at_rest);
		bend_cage(&t);
		copy_cage(&t, bent);
		assert_true(gi_hierarchy_build(&r, &h, NULL, 0));
		place(&h, &r, (const double(*)[3])at_rest);
		assert_true(gi_bvh_build(&h, &bvh));
		assert_int_equal(bvh.primitive_count, h.leaf_count);
		const size_t bytes[4] = {sizeof *h.geometry * h.node_count, sizeof *h.topology * h.node_count,
					 sizeof *bvh.nodes * bvh.node_count,
					 sizeof *bvh.primitives * bvh.primitive_count};
		const void *now[4] = {h.geometry, h.topology, bvh.nodes, bvh.primitives};
		void *before[4];
		for (int k = 0; k < 4; k++) {
			before[k] = malloc(bytes[k]);
			assert_non_null(before[k]);
			memcpy(before[k], now[k], bytes[k]);
		}
		static gi_box boxes[4096];
		static uint32_t order[4096];
		assert_true(h.leaf_count <= 4096);
		place(&h, &r, (const double(*)[3])bent);
		gi_bvh_rebuild(&h, &bvh, boxes, order);
		assert_null(gi_validate_hierarchy(&h));
		expect_boxes_hold(&bvh);
		assert_memory_not_equal(h.geometry, before[0], bytes[0]);
		place(&h, &r, (const double(*)[3])at_rest);
		gi_bvh_rebuild(&h, &bvh, boxes, order);
		for (int k = 0; k < 4; k++) {
			assert_memory_equal(now[k], before[k], bytes[k]);
			free(before[k]);
		}
		gi_bvh_free(&bvh);
		gi_hierarchy_free(&h);
		gi_refined_free(&r);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(sums_are_what_refining_gives),
	    cmocka_unit_test(faces_that_are_split),
	    cmocka_unit_test(what_lies_together_may_part),
	    cmocka_unit_test(refitting_forgets),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
