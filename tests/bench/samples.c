#define _POSIX_C_SOURCE 200809L /* clock_gettime */
#include "samples.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

double now_ms(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

double processor_ms(void)
{
	struct timespec t;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

void samples_add(samples *s, double value)
{
	if (s->count < MAX_SAMPLES)
		s->values[s->count++] = value;
}

static int by_value(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

double samples_quantile(const samples *s, double share)
{
	static double sorted[MAX_SAMPLES];
	memcpy(sorted, s->values, sizeof *sorted * s->count);
	qsort(sorted, s->count, sizeof *sorted, by_value);
	return s->count ? sorted[(uint32_t)(share * (s->count - 1))] : 0;
}

double samples_median(const samples *s)
{
	return samples_quantile(s, 0.5);
}
