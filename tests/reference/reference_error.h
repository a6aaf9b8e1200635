/* Error of an irradiance against the path-traced reference, with the reference's own noise removed.
 *
 * With R1 and R2 independent and unbiased, (H - R1).(H - R2) has the expectation |H - R|^2 exactly: their noises
 * multiply to zero on average, where |H - mean|^2 would add the noise of the mean.
 */
#ifndef TESTS_REFERENCE_ERROR_H
#define TESTS_REFERENCE_ERROR_H

#include <stdbool.h>
#include <stdint.h>

/* All relative to the area-weighted RMS of the reference; dot products over rgb. 0.02 is 2 %. */
typedef struct reference_error {
	double rms;     /* sqrt(max(0, squared)) */
	double squared; /* sum A (H-R1).(H-R2) / sum A R1.R2; slightly negative when the error drowns in the noise */
	double plain;   /* sqrt(sum A |H-R|^2 / sum A |R|^2) against the mean R of the halves: holds the noise too */
	double noise;   /* estimated RMS noise of that mean: plain^2 is about squared + noise^2 */
	double bias;    /* sum A H / sum A R - 1, channels added: too bright (+) or too dark (-) as a whole */
} reference_error;

/* h, r1, r2: leaf_count * 3, W/m2; areas: leaf_count, m2. False, with *out zeroed, when the reference is dark (there is
 * nothing to be relative to) or a value is not finite. */
bool reference_error_measure(const double *h, const double *r1, const double *r2, const double *areas,
			     uint32_t leaf_count, reference_error *out);

/* Copies rgb of `count` float records of `stride` >= 3 floats (4: vec4 as GPU buffers have them) to packed doubles. */
void reference_widen(const float *records, uint32_t stride, uint32_t count, double *rgb);

#endif
