/* The rows of a frame in double precision: their solution, and Jacobi over them. Apart from what uses it, for cmocka.h,
 * which exact_rows.h brings, has a fail of its own. */
#ifndef TESTS_BENCH_FRAME_ROWS_H
#define TESTS_BENCH_FRAME_ROWS_H

#include "gi/gi.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct frame_rows frame_rows;

/* Of a scene without sky, as the context's last update left it; frame_rows_free(). NULL when out of memory or without a
 * solution. */
frame_rows *frame_rows_read(gi_context *gi);
void frame_rows_free(frame_rows *rows);

/* How many numbers its B has: three a leaf, and what exact_rows.h adds. */
uint32_t frame_rows_values(const frame_rows *rows);

/* B = E */
void frame_rows_start(const frame_rows *rows, double *b);

/* B = E + rho W B, so many times; false when out of memory. */
bool frame_rows_sweep(const frame_rows *rows, uint32_t sweeps, double *b);

/* Largest R = B - E of the solution, and largest |B - B*|. */
double frame_rows_reflected(const frame_rows *rows);
double frame_rows_distance(const frame_rows *rows, const double *b);

/* The context's own B; its rows are these. False when it cannot be read. */
bool frame_rows_context_distance(const frame_rows *rows, gi_context *gi, double *distance);

#endif
