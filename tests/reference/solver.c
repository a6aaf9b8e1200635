#include "solver.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double TOLERANCE = 1e-13;

static reference_node column_node(const reference_rows *rows, uint32_t column)
{
	return rows->nodes ? rows->nodes[column] : (reference_node){column, 1};
}

static bool rows_valid(const reference_rows *rows)
{
	uint32_t columns = rows->nodes ? rows->node_count : rows->leaf_count;
	if (rows->leaf_count == 0 || (rows->nodes && !rows->areas) || rows->row_offsets[0] != 0)
		return false;
	for (uint32_t n = 0; rows->nodes && n < rows->node_count; n++) {
		reference_node node = rows->nodes[n];
		if (node.count == 0 || node.first_leaf >= rows->leaf_count ||
		    node.count > rows->leaf_count - node.first_leaf)
			return false;
	}
	for (uint32_t i = 0; i < rows->leaf_count; i++) {
		if (rows->row_offsets[i] > rows->row_offsets[i + 1] || (rows->areas && !(rows->areas[i] > 0)))
			return false;
		for (int k = 0; k < 3; k++) {
			float rho = rows->rho[3 * (size_t)i + k], e = rows->exitance[3 * (size_t)i + k];
			if (!(rho >= 0 && rho < 1) || !(e >= 0) || !isfinite(e))
				return false;
		}
	}
	for (uint32_t e = 0; e < rows->row_offsets[rows->leaf_count]; e++)
		if (rows->columns[e] >= columns || !(rows->weights[e] >= 0) || !isfinite(rows->weights[e]))
			return false;
	return true;
}

static double contraction(const reference_rows *rows)
{
	double q = 0;
	for (uint32_t i = 0; i < rows->leaf_count; i++) {
		double sum = 0;
		const float *rho = rows->rho + 3 * (size_t)i;
		for (uint32_t e = rows->row_offsets[i]; e < rows->row_offsets[i + 1]; e++)
			sum += rows->weights[e];
		q = fmax(q, sum * fmax(rho[0], fmax(rho[1], rho[2])));
	}
	return q;
}

/* ---- means and gathers ---- */

static void node_mean(const reference_rows *rows, reference_node node, const double *b, double mean[3])
{
	double area = 0;
	mean[0] = mean[1] = mean[2] = 0;
	for (size_t i = node.first_leaf; i < (size_t)node.first_leaf + node.count; i++) {
		area += rows->areas[i];
		for (int k = 0; k < 3; k++)
			mean[k] += rows->areas[i] * b[3 * i + k];
	}
	for (int k = 0; k < 3; k++)
		mean[k] /= area;
}

static void update_means(const reference_rows *rows, const double *b, double *means)
{
	for (uint32_t n = 0; rows->nodes && n < rows->node_count; n++)
		if (rows->nodes[n].count > 1)
			node_mean(rows, rows->nodes[n], b, means + 3 * (size_t)n);
}

/* Single leaves are read live from b, inner nodes from means. */
static void gather(const reference_rows *rows, uint32_t i, const double *b, const double *means, double h[3])
{
	h[0] = h[1] = h[2] = 0;
	for (uint32_t e = rows->row_offsets[i]; e < rows->row_offsets[i + 1]; e++) {
		reference_node node = column_node(rows, rows->columns[e]);
		const double *source =
		    node.count == 1 ? b + 3 * (size_t)node.first_leaf : means + 3 * (size_t)rows->columns[e];
		for (int k = 0; k < 3; k++)
			h[k] += rows->weights[e] * source[k];
	}
}

static double *new_means(const reference_rows *rows)
{
	return calloc(3 * ((size_t)rows->node_count + 1), sizeof(double));
}

bool reference_irradiance(const reference_rows *rows, const double *radiosity, double *irradiance)
{
	double *means = new_means(rows);
	if (!means)
		return false;
	update_means(rows, radiosity, means);
	for (uint32_t i = 0; i < rows->leaf_count; i++)
		gather(rows, i, radiosity, means, irradiance + 3 * (size_t)i);
	free(means);
	return true;
}

static double largest(const double *values, size_t count)
{
	double max = 0;
	for (size_t i = 0; i < count; i++)
		max = fmax(max, fabs(values[i]));
	return max;
}

/* r = E + rho H - B of the whole system, into residual when not NULL; returns |r|_inf. means is scratch. */
static double residual_norm(const reference_rows *rows, const double *b, double *means, double *residual)
{
	double norm = 0;
	update_means(rows, b, means);
	for (size_t i = 0; i < rows->leaf_count; i++) {
		double h[3];
		gather(rows, (uint32_t)i, b, means, h);
		for (size_t k = 3 * i; k < 3 * i + 3; k++) {
			double r = rows->exitance[k] + rows->rho[k] * h[k - 3 * i] - b[k];
			norm = fmax(norm, fabs(r));
			if (residual)
				residual[k] = r;
		}
	}
	return norm;
}

/* |B - B*| <= |M^-1| |r| <= |r| / (1 - q) in the maximum norm. 16 eps: the rounding of one row's sum of a few terms of
 * size |B|; a residual that small cannot be told from none. */
static void certify(const reference_rows *rows, double *means, reference_solution *out)
{
	double r = residual_norm(rows, out->radiosity, means, NULL);
	double size = largest(out->radiosity, 3 * (size_t)rows->leaf_count);
	if (!(size > 0))
		size = 1;
	out->bound = out->contraction < 1 ? r / (1 - out->contraction) / size : INFINITY;
	out->converged = out->bound <= TOLERANCE || r <= 16 * 2.3e-16 * size;
}

/* ---- Gauss-Seidel ---- */

/* Returns the largest change; *size is the largest B. */
static double sweep(const reference_rows *rows, double *b, double *means, double *size)
{
	double step = 0;
	*size = 0;
	update_means(rows, b, means);
	for (size_t i = 0; i < rows->leaf_count; i++) {
		double h[3];
		gather(rows, (uint32_t)i, b, means, h);
		for (size_t k = 3 * i; k < 3 * i + 3; k++) {
			double next = rows->exitance[k] + rows->rho[k] * h[k - 3 * i];
			step = fmax(step, fabs(next - b[k]));
			*size = fmax(*size, next);
			b[k] = next;
		}
	}
	return step;
}

static bool solution_init(const reference_rows *rows, reference_solution *out)
{
	memset(out, 0, sizeof *out);
	if (!rows_valid(rows))
		return false;
	size_t count = 3 * (size_t)rows->leaf_count;
	out->radiosity = malloc(count * sizeof(double));
	for (size_t k = 0; out->radiosity && k < count; k++)
		out->radiosity[k] = rows->exitance[k];
	out->contraction = contraction(rows);
	return out->radiosity != NULL;
}

void reference_solution_free(reference_solution *solution)
{
	free(solution->radiosity);
	memset(solution, 0, sizeof *solution);
}

bool reference_solve(const reference_rows *rows, uint32_t max_sweeps, reference_solution *out)
{
	double *means = NULL;
	if (!solution_init(rows, out) || !(out->contraction < 1) || !(means = new_means(rows))) {
		reference_solution_free(out);
		return false;
	}
	double q = out->contraction, size;
	while (out->sweeps < max_sweeps) {
		double step = sweep(rows, out->radiosity, means, &size);
		out->sweeps++;
		/* The bound of the step is q / (1 - q) times it. At 2 eps of the largest B the steps are rounding, and
		 * more of them help nobody. */
		if (step * q <= 0.1 * TOLERANCE * (1 - q) * size || step <= 2 * 2.3e-16 * size)
			break;
	}
	certify(rows, means, out);
	free(means);
	return true;
}

/* ---- dense LU ---- */

/* M = I - diag(rho) F with every node spread over its leaves by area, one channel. */
static void dense_matrix(const reference_rows *rows, int channel, double *m)
{
	size_t n = rows->leaf_count;
	memset(m, 0, n * n * sizeof *m);
	for (size_t i = 0; i < n; i++) {
		double rho = rows->rho[3 * i + (size_t)channel];
		for (uint32_t e = rows->row_offsets[i]; e < rows->row_offsets[i + 1]; e++) {
			reference_node node = column_node(rows, rows->columns[e]);
			size_t first = node.first_leaf, end = first + node.count;
			double area = 0;
			for (size_t j = first; node.count > 1 && j < end; j++)
				area += rows->areas[j];
			for (size_t j = first; j < end; j++)
				m[i * n + j] -= rho * rows->weights[e] * (node.count > 1 ? rows->areas[j] / area : 1);
		}
		m[i * n + i] += 1;
	}
}

static void swap_rows(double *m, size_t n, size_t a, size_t b)
{
	for (size_t j = 0; j < n; j++) {
		double swap = m[a * n + j];
		m[a * n + j] = m[b * n + j];
		m[b * n + j] = swap;
	}
}

static bool lu_factor(double *m, size_t n, size_t *pivots)
{
	for (size_t k = 0; k < n; k++) {
		size_t best = k;
		for (size_t i = k + 1; i < n; i++)
			if (fabs(m[i * n + k]) > fabs(m[best * n + k]))
				best = i;
		pivots[k] = best;
		if (!(fabs(m[best * n + k]) > 0))
			return false;
		if (best != k)
			swap_rows(m, n, k, best);
		for (size_t i = k + 1; i < n; i++) {
			double f = m[i * n + k] /= m[k * n + k];
			for (size_t j = k + 1; f != 0 && j < n; j++)
				m[i * n + j] -= f * m[k * n + j];
		}
	}
	return true;
}

static void lu_solve(const double *m, size_t n, const size_t *pivots, double *x)
{
	for (size_t k = 0; k < n; k++) {
		double swap = x[k];
		x[k] = x[pivots[k]];
		x[pivots[k]] = swap;
	}
	for (size_t i = 0; i < n; i++)
		for (size_t j = 0; j < i; j++)
			x[i] -= m[i * n + j] * x[j];
	for (size_t i = n; i-- > 0;) {
		for (size_t j = i + 1; j < n; j++)
			x[i] -= m[i * n + j] * x[j];
		x[i] /= m[i * n + i];
	}
}

/* B = E + correction: the first pass solves for B - E, the second refines it with the residual of the rows. */
static bool solve_channel(const reference_rows *rows, int channel, double *work, size_t *pivots, double *means,
			  double *b)
{
	size_t n = rows->leaf_count;
	double *m = work, *x = m + n * n, *residual = x + n;
	dense_matrix(rows, channel, m);
	if (!lu_factor(m, n, pivots))
		return false;
	for (int pass = 0; pass < 2; pass++) {
		residual_norm(rows, b, means, residual);
		for (size_t i = 0; i < n; i++)
			x[i] = residual[3 * i + (size_t)channel];
		lu_solve(m, n, pivots, x);
		for (size_t i = 0; i < n; i++)
			b[3 * i + (size_t)channel] += x[i];
	}
	return true;
}

bool reference_solve_dense(const reference_rows *rows, reference_solution *out)
{
	bool ok = rows->leaf_count <= REFERENCE_DENSE_MAX && solution_init(rows, out);
	if (!ok) {
		memset(out, 0, sizeof *out);
		return false;
	}
	size_t n = rows->leaf_count;
	double *work = malloc((n * n + 4 * n) * sizeof *work), *means = new_means(rows);
	size_t *pivots = malloc(n * sizeof *pivots);
	ok = work && means && pivots;
	for (int channel = 0; ok && channel < 3; channel++)
		ok = solve_channel(rows, channel, work, pivots, means, out->radiosity);
	if (ok)
		certify(rows, means, out);
	else
		reference_solution_free(out);
	free(work);
	free(means);
	free(pivots);
	return ok;
}
