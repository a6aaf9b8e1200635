#include "pieces.h"

#include "scenes/shapes.h"

#include <math.h>
#include <stdlib.h>

gi_object add_room(gi_context *gi, const harness_object *like, box b)
{
	engine_mesh mesh;
	assert_true(shape_box(b.lower, b.upper, 1, true, &mesh));
	return harness_add(gi, like, &mesh);
}

gi_object add_block(gi_context *gi, const harness_object *like, box b)
{
	engine_mesh mesh;
	assert_true(shape_box(b.lower, b.upper, 1, false, &mesh));
	return harness_add(gi, like, &mesh);
}

gi_object add_ball(gi_context *gi, const harness_object *like, float radius)
{
	engine_mesh mesh;
	assert_true(shape_sphere(radius, 3, &mesh));
	return harness_add(gi, like, &mesh);
}

gi_object add_quad(gi_context *gi, const harness_object *like, const float corner[3], const float u[3],
		   const float v[3])
{
	engine_mesh mesh;
	assert_true(shape_quad(corner, u, v, 1, 1, &mesh));
	return harness_add(gi, like, &mesh);
}

gi_context *open_context(float row_tolerance)
{
	gi_context_def def = harness_def();
	def.row_tolerance = row_tolerance;
	def.solve_tolerance = 1e-4f;
	def.max_sweeps = 1000;
	def.profile = false;
	return harness_context(&def);
}

double area_of(const snapshot *s, gi_object object)
{
	double area = 0;
	for (uint32_t k = 0; k < s->leaf_count; k++)
		if (s->leaves[k].object.index1 == object.index1)
			area += (double)s->leaves[k].area;
	return area;
}

gi_report solve(gi_context *gi)
{
	gi_report r = harness_update(gi);
	for (int frame = 0; frame < 20 && r.outcome == GI_OUTCOME_SWEEPS; frame++)
		r = harness_update(gi);
	if (r.outcome != GI_OUTCOME_CONVERGED && r.outcome != GI_OUTCOME_AT_REST)
		fail_msg("outcome %d, bound %g of the largest B", r.outcome, (double)r.solve_relative);
	return r;
}

void expect_sane_rows(const snapshot *s)
{
	double *sums = calloc(s->leaf_count + 1, sizeof *sums);
	assert_non_null(sums);
	for (uint64_t k = 0; k < s->entry_count; k++) {
		const gi_entry *e = &s->entries[k];
		assert_true(e->leaf < s->leaf_count && e->first_leaf + e->leaf_count <= s->leaf_count);
		assert_true(e->form_factor >= 0 && e->form_factor <= 1);
		assert_true(e->visible <= e->samples && e->samples <= 16 && e->back <= 1);
		if (k && s->entries[k - 1].leaf == e->leaf && e->leaf_count) /* nodes of a cut do not overlap */
			assert_true(!s->entries[k - 1].leaf_count ||
				    s->entries[k - 1].first_leaf + s->entries[k - 1].leaf_count <= e->first_leaf);
	}
	for (uint64_t k = 0; k < s->link_count; k++) {
		assert_true(s->links[k].weight > 0 && s->links[k].weight <= 1);
		sums[s->links[k].leaf] += (double)s->links[k].weight;
	}
	for (uint32_t k = 0; k < s->leaf_count; k++) {
		assert_true(s->leaves[k].row_sum >= 0 && s->leaves[k].row_sum <= 1);
		assert_true(sums[k] <= 1);
		assert_true(fabs(sums[k] - (double)s->leaves[k].row_sum) <= CLOSED_TOLERANCE);
	}
	free(sums);
}

void leaf_centre_and_normal(const gi_leaf *l, float centre[3], float normal[3])
{
	float p[3], q[3];
	for (int c = 0; c < 3; c++) {
		centre[c] = .25f * (l->corners[0][c] + l->corners[1][c] + l->corners[2][c] + l->corners[3][c]);
		p[c] = l->corners[2][c] - l->corners[0][c];
		q[c] = l->corners[3][c] - l->corners[1][c];
	}
	for (int c = 0; c < 3; c++)
		normal[c] = p[(c + 1) % 3] * q[(c + 2) % 3] - p[(c + 2) % 3] * q[(c + 1) % 3];
}
