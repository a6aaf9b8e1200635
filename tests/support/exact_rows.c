#include "exact_rows.h"

#include <math.h>
#include <stdlib.h>

static void *allocate(uint64_t count, size_t size)
{
	void *data = calloc(count + 1, size);
	assert_non_null(data);
	return data;
}

static void copy_leaves(const snapshot *s, const float sky_exitance[3], exact_rows *e)
{
	for (uint32_t k = 0; k < s->leaf_count; k++) {
		e->areas[k] = (double)s->leaves[k].area;
		for (uint32_t c = 0; c < 3; c++) {
			e->rho[3 * k + c] = s->leaves[k].rho[c];
			e->exitance[3 * k + c] = s->leaves[k].exitance[c];
		}
	}
	e->areas[s->leaf_count] = 1;
	for (uint32_t c = 0; c < 3; c++)
		e->exitance[3 * s->leaf_count + c] = sky_exitance[c];
}

/* Links come sorted by leaf. */
static void copy_links(const snapshot *s, exact_rows *e)
{
	uint32_t at = 0, leaf = 0;
	for (uint64_t k = 0; k < s->link_count; k++) {
		const gi_link *l = &s->links[k];
		for (; leaf < l->leaf; leaf++)
			e->offsets[leaf + 1] = at;
		const reference_node sky = {s->leaf_count, 1}, own = {l->first_leaf, l->leaf_count};
		e->columns[at] = l->node;
		e->weights[at] = (double)l->weight;
		e->nodes[l->node] = l->leaf_count ? own : sky;
		at++;
	}
	for (; leaf <= s->leaf_count; leaf++)
		e->offsets[leaf + 1] = at;
}

exact_rows exact_rows_of(const snapshot *s, uint32_t node_count, const float sky_exitance[3])
{
	const uint32_t leaves = s->leaf_count + 1;
	exact_rows e = {
	    .offsets = allocate(leaves, sizeof *e.offsets),
	    .columns = allocate(s->link_count, sizeof *e.columns),
	    .weights = allocate(s->link_count, sizeof *e.weights),
	    .areas = allocate(leaves, sizeof *e.areas),
	    .nodes = allocate(node_count, sizeof *e.nodes),
	    .rho = allocate(3 * (uint64_t)leaves, sizeof *e.rho),
	    .exitance = allocate(3 * (uint64_t)leaves, sizeof *e.exitance),
	    .leaf_count = s->leaf_count,
	};
	for (uint32_t k = 0; k < node_count; k++)
		e.nodes[k].count = 1;
	copy_leaves(s, sky_exitance, &e);
	copy_links(s, &e);
	e.rows = (reference_rows){.row_offsets = e.offsets,
				  .columns = e.columns,
				  .weights = e.weights,
				  .nodes = e.nodes,
				  .areas = e.areas,
				  .rho = e.rho,
				  .exitance = e.exitance,
				  .leaf_count = leaves,
				  .node_count = node_count};
	return e;
}

void exact_rows_free(exact_rows *e)
{
	free(e->offsets);
	free(e->columns);
	free(e->weights);
	free(e->areas);
	free(e->nodes);
	free(e->rho);
	free(e->exitance);
	*e = (exact_rows){0};
}

/* Above this contraction sweeps of small scenes cost more than LU. */
static const double SWEEPS_DO = 0.98;

static void solve(const exact_rows *e, double contraction, reference_solution *out)
{
	const bool dense = contraction > SWEEPS_DO && e->rows.leaf_count <= REFERENCE_DENSE_MAX;
	assert_true(dense ? reference_solve_dense(&e->rows, out) : reference_solve(&e->rows, 100000, out));
}

void exact_solution(const snapshot *s, const gi_report *r, const float sky_exitance[3], reference_solution *out)
{
	exact_rows e = exact_rows_of(s, r->nodes, sky_exitance);
	solve(&e, (double)r->contraction, out);
	exact_rows_free(&e);
}

double exact_distance(const snapshot *s, const gi_report *r, const float sky_exitance[3], double needed)
{
	reference_solution solution;
	exact_solution(s, r, sky_exitance, &solution);
	double distance = 0, largest = 0;
	for (uint32_t k = 0; k < 3 * s->leaf_count; k++) {
		distance = fmax(distance, fabs((double)s->leaves[k / 3].radiosity[k % 3] - solution.radiosity[k]));
		largest = fmax(largest, solution.radiosity[k]);
	}
	if (!(solution.bound * largest <= 1e-3 * needed || largest == 0))
		fail_msg("the double-precision solution is only known to %.3g, and %.3g is asked for",
			 solution.bound * largest, 1e-3 * needed);
	reference_solution_free(&solution);
	return distance;
}
