/* One function for many numbers, on several threads. */
#ifndef TESTS_BENCH_PARALLEL_H
#define TESTS_BENCH_PARALLEL_H

#include <stdint.h>

typedef void parallel_fn(void *user, uint32_t number);

/* Calls `work` once with each number below count, in any order; threads 0: one a processor. Threads that cannot be
 * started are done without. */
void parallel_for(uint32_t threads, uint32_t count, parallel_fn *work, void *user);

#endif
