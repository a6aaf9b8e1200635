/* What benchmarks do with times: a clock, medians. */
#ifndef TESTS_BENCH_SAMPLES_H
#define TESTS_BENCH_SAMPLES_H

#include <stdint.h>

enum { MAX_SAMPLES = 2000 };

typedef struct samples {
	double values[MAX_SAMPLES]; /* those beyond are dropped */
	uint32_t count;
} samples;

/* Wall clock, milliseconds. */
double now_ms(void);

/* Processor time of the process, all threads, milliseconds: other programs on the machine hardly disturb it. */
double processor_ms(void);

void samples_add(samples *s, double value);

/* The smallest value that `share` (0..1) of the others do not exceed; 0 without samples. */
double samples_quantile(const samples *s, double share);
double samples_median(const samples *s);

#endif
