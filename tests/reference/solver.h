/* Double-precision solution of given rows: separates the error of the solve from that of the rows.
 *
 *     B_i = E_i + rho_i * sum over entries e of row i of  weight_e * mean of B over column_e
 */
#ifndef TESTS_REFERENCE_SOLVER_H
#define TESTS_REFERENCE_SOLVER_H

#include <stdbool.h>
#include <stdint.h>

/* The leaves [first_leaf, first_leaf + count): a leaf itself has count 1. */
typedef struct reference_node {
	uint32_t first_leaf;
	uint32_t count;
} reference_node;

/* Rows in CSR. The caller owns the arrays; they are read during the call only. A sky or any other source with a known B
 * is a leaf with rho 0 and an empty row. */
typedef struct reference_rows {
	const uint32_t *row_offsets; /* leaf_count + 1, entries of row i are [row_offsets[i], row_offsets[i+1]) */
	const uint32_t *columns;     /* one per entry: a node number, or a leaf number when nodes is NULL */
	const double *weights;       /* one per entry, F or F V, >= 0 */
	const reference_node *nodes; /* node_count, any order, may overlap; NULL: columns are leaves */
	const double *areas;         /* leaf_count, m2, > 0; the weights of a node's mean. NULL only without nodes */
	const float *rho;            /* leaf_count * 3, [0,1) */
	const float *exitance;       /* leaf_count * 3, W/m2, >= 0 */
	uint32_t leaf_count;
	uint32_t node_count;
} reference_rows;

typedef struct reference_solution {
	double *radiosity;  /* leaf_count * 3, W/m2; reference_solution_free() */
	double bound;       /* certified |B - B*|_inf / |B|_inf, from the residual r: |r|_inf / (1 - q) */
	double contraction; /* q = max over leaves and channels of rho_i * sum of row i; the bound needs q < 1 */
	uint32_t sweeps;    /* 0 for the direct solve */
	bool converged;     /* bound <= 1e-13, or the residual is down to the rounding of double */
} reference_solution;

/* Gauss-Seidel (nodes: their means from the sweep before) until the step's bound is 1e-13 of the largest B or stops
 * falling at rounding level. False, with *out zeroed, on rows that are malformed, have q >= 1, or when out of memory.
 */
bool reference_solve(const reference_rows *rows, uint32_t max_sweeps, reference_solution *out);

/* Dense LU with partial pivoting and refinement, for q next to 1: n^3 multiplications (a third per channel), leaf_count
 * <= 4096. Same failures, but for q >= 1, where the bound is infinite and the matrix only has to be regular. */
#define REFERENCE_DENSE_MAX 4096
bool reference_solve_dense(const reference_rows *rows, reference_solution *out);

/* H = sum of weight * mean B, leaf_count * 3: what error.h compares. False when out of memory. */
bool reference_irradiance(const reference_rows *rows, const double *radiosity, double *irradiance);

void reference_solution_free(reference_solution *solution);

#endif
