/* Leaves of a context, and how far two lists of them are apart. */
#ifndef TESTS_BENCH_BENCH_LEAVES_H
#define TESTS_BENCH_BENCH_LEAVES_H

#include "gi/gi.h"

/* How far B is from that of an exact update of the same poses. */
typedef struct bench_distance {
	double most;    /* W/m2, of any leaf and channel */
	double percent; /* area-weighted RMS, of the RMS of B - E */
} bench_distance;

/* Leaves of two contexts with the same scene, or of one at two times. The caller frees what bench_leaves returns. */
gi_leaf *bench_leaves(gi_context *gi, uint32_t *count);
bench_distance bench_leaves_distance(const gi_leaf *leaves, const gi_leaf *exact, uint32_t count);

#endif
