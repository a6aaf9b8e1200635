/* Spherical harmonics as gi.h has them. */
#ifndef TESTS_HARMONICS_H
#define TESTS_HARMONICS_H

#include <string.h>

/* Y_lm along a unit vector, in the order of gi_receiver_buffer. */
static inline void harmonics_of(const float n[3], double out[9])
{
	const double x = (double)n[0], y = (double)n[1], z = (double)n[2];
	const double basis[9] = {.282095,
				 .488603 * y,
				 .488603 * z,
				 .488603 * x,
				 1.092548 * x * y,
				 1.092548 * y * z,
				 .315392 * (3 * z * z - 1),
				 1.092548 * x * z,
				 .546274 * (x * x - y * y)};
	memcpy(out, basis, sizeof basis);
}

/* E along a unit vector: a channel of 4 or 9 coefficients, vec4 each. */
static inline double harmonics_along(const float *c, unsigned count, const float n[3], int channel)
{
	double basis[9], sum = 0;
	harmonics_of(n, basis);
	for (unsigned k = 0; k < count; k++)
		sum += basis[k] * (double)c[4 * k + (unsigned)channel];
	return sum;
}

#endif
