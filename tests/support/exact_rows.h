/* The rows a context solves, in double precision: the truth that a solve is measured against.
 *
 * The very links and areas of the library, so that what is tested is the solve alone, not the rows. Of an open scene
 * all patches of the sky are one more leaf behind the others, black, with the sky's exitance.
 */
#ifndef TESTS_EXACT_ROWS_H
#define TESTS_EXACT_ROWS_H

#include "snapshot.h"

#include "tests/reference/solver.h"

typedef struct exact_rows {
	reference_rows rows; /* points into the arrays below */
	uint32_t *offsets, *columns;
	double *weights, *areas;
	reference_node *nodes;
	float *rho, *exitance;
	uint32_t leaf_count; /* the scene's */
} exact_rows;

/* node_count as reported; sky_exitance: the context definition's. Fails the test when out of memory. */
exact_rows exact_rows_of(const snapshot *s, uint32_t node_count, const float sky_exitance[3]);
void exact_rows_free(exact_rows *e);

/* B* of the snapshot's rows; reference_solution_free(). */
void exact_solution(const snapshot *s, const gi_report *r, const float sky_exitance[3], reference_solution *out);

/* Largest |B - B*| of the snapshot: B* by sweeps, or where they would be many (q above 0.98) by LU.
 * Fails the test when B* is not good to a thousandth of `needed`, W/m2. */
double exact_distance(const snapshot *s, const gi_report *r, const float sky_exitance[3], double needed);

#endif
