#include "reference_error.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

typedef struct sums {
	double cross_error, cross, plain_error, plain, difference, h, r;
} sums;

static void add_leaf(sums *s, const double *h, const double *r1, const double *r2, double area)
{
	for (int k = 0; k < 3; k++) {
		double mean = 0.5 * (r1[k] + r2[k]);
		s->cross_error += area * (h[k] - r1[k]) * (h[k] - r2[k]);
		s->cross += area * r1[k] * r2[k];
		s->plain_error += area * (h[k] - mean) * (h[k] - mean);
		s->plain += area * mean * mean;
		s->difference += area * (r1[k] - r2[k]) * (r1[k] - r2[k]);
		s->h += area * h[k];
		s->r += area * mean;
	}
}

bool reference_error_measure(const double *h, const double *r1, const double *r2, const double *areas,
			     uint32_t leaf_count, reference_error *out)
{
	sums s = {0};
	memset(out, 0, sizeof *out);
	for (size_t i = 0; i < leaf_count; i++)
		add_leaf(&s, h + 3 * i, r1 + 3 * i, r2 + 3 * i, areas[i]);
	if (!(s.cross > 0 && isfinite(s.cross) && isfinite(s.cross_error)))
		return false;
	out->squared = s.cross_error / s.cross;
	out->rms = sqrt(fmax(0, out->squared));
	out->plain = sqrt(s.plain_error / s.plain);
	/* the mean of two has a quarter of the variance of their difference */
	out->noise = sqrt(0.25 * s.difference / s.cross);
	out->bias = s.h / s.r - 1;
	return true;
}

void reference_widen(const float *records, uint32_t stride, uint32_t count, double *rgb)
{
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < 3; k++)
			rgb[3 * i + k] = records[i * stride + k];
}
