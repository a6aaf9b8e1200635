/* What tests of whole scenes are put together from: boxes, balls and quads, a solve to the end, rows that must be sane.
 */
#ifndef TESTS_PIECES_H
#define TESTS_PIECES_H

#include "snapshot.h"

typedef struct box {
	float lower[3], upper[3];
} box;

gi_object add_room(gi_context *gi, const harness_object *like, box b);
gi_object add_block(gi_context *gi, const harness_object *like, box b);
gi_object add_ball(gi_context *gi, const harness_object *like, float radius);
gi_object add_quad(gi_context *gi, const harness_object *like, const float corner[3], const float u[3],
		   const float v[3]);

/* Solves to 1e-6 of the largest B, however many sweeps it takes. */
gi_context *open_context(float row_tolerance);

/* Updates until the bound is met: near rho = 1 more sweeps are needed than one frame may have. */
gi_report solve(gi_context *gi);

double area_of(const snapshot *s, gi_object object);

/* Rows of a closed room close: 2.5e-7 below 1 on purpose, and the rounding of a sum of some hundred weights in single
 * precision. */
static const double CLOSED_TOLERANCE = 1e-6;

/* Entries name what exists, cuts do not overlap, weights and row sums lie in [0,1] and agree. */
void expect_sane_rows(const snapshot *s);

void leaf_centre_and_normal(const gi_leaf *l, float centre[3], float normal[3]);

#endif
