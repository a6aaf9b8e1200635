#include "frame_rows.h"

#include "tests/support/exact_rows.h"

#include <math.h>
#include <stdlib.h>

struct frame_rows {
	exact_rows exact;
	reference_solution solution;
};

static const float NO_SKY[3];

static bool solve(const reference_rows *rows, reference_solution *out)
{
	return rows->leaf_count <= REFERENCE_DENSE_MAX ? reference_solve_dense(rows, out)
						       : reference_solve(rows, 1000000, out);
}

frame_rows *frame_rows_read(gi_context *gi)
{
	frame_rows *f = calloc(1, sizeof *f);
	gi_report report;
	if (!f || gi_get_report(gi, &report)) {
		free(f);
		return NULL;
	}
	snapshot s = snapshot_take(gi);
	f->exact = exact_rows_of(&s, report.nodes, NO_SKY);
	snapshot_free(&s);
	if (solve(&f->exact.rows, &f->solution))
		return f;
	frame_rows_free(f);
	return NULL;
}

void frame_rows_free(frame_rows *f)
{
	reference_solution_free(&f->solution);
	exact_rows_free(&f->exact);
	free(f);
}

uint32_t frame_rows_values(const frame_rows *f)
{
	return 3 * f->exact.rows.leaf_count;
}

void frame_rows_start(const frame_rows *f, double *b)
{
	for (uint32_t n = 0; n < frame_rows_values(f); n++)
		b[n] = (double)f->exact.exitance[n];
}

bool frame_rows_sweep(const frame_rows *f, uint32_t sweeps, double *b)
{
	double *h = malloc(frame_rows_values(f) * sizeof *h);
	bool done = h != NULL;
	for (uint32_t k = 0; done && k < sweeps; k++) {
		done = reference_irradiance(&f->exact.rows, b, h);
		for (uint32_t n = 0; done && n < frame_rows_values(f); n++)
			b[n] = (double)f->exact.exitance[n] + (double)f->exact.rho[n] * h[n];
	}
	free(h);
	return done;
}

double frame_rows_reflected(const frame_rows *f)
{
	double most = 0;
	for (uint32_t n = 0; n < frame_rows_values(f); n++)
		most = fmax(most, f->solution.radiosity[n] - (double)f->exact.exitance[n]);
	return most;
}

double frame_rows_distance(const frame_rows *f, const double *b)
{
	double most = 0;
	for (uint32_t n = 0; n < frame_rows_values(f); n++)
		most = fmax(most, fabs(b[n] - f->solution.radiosity[n]));
	return most;
}

bool frame_rows_context_distance(const frame_rows *f, gi_context *gi, double *out)
{
	uint32_t count = f->exact.leaf_count;
	gi_leaf *leaves = malloc(count * sizeof *leaves);
	const bool read = leaves && !gi_read_leaves(gi, leaves, count, &count) && count == f->exact.leaf_count;
	*out = 0;
	for (uint32_t n = 0; read && n < 3 * count; n++)
		*out = fmax(*out, fabs((double)leaves[n / 3].radiosity[n % 3] - f->solution.radiosity[n]));
	free(leaves);
	return read;
}
