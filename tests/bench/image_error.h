/* How far a picture is from another. */
#ifndef TESTS_BENCH_IMAGE_ERROR_H
#define TESTS_BENCH_IMAGE_ERROR_H

#include "linear_image.h"

/* Relative mean squared error of radiance: the mean over pixels and channels of (x - r)^2 / (r^2 + 0.01), r in
 * W/m2/sr (Rousselle, Knaus and Zwicker, "Adaptive sampling and reconstruction using greedy error minimization",
 * 2011). The truth comes in two halves of independent noise, which drops out of (x - r0)(x - r1); where the picture
 * is nearly as good as the truth the result may be below 0. Sizes are the same. */
double image_relative_mse(const linear_image *picture, const linear_image truth[2]);

/* Structural similarity of the luma (ITU-R BT.601) of two pictures of 3 bytes a pixel as they are shown, 1: the
 * same; the mean over all windows that lie within (Wang, Bovik, Sheikh and Simoncelli, "Image quality assessment:
 * from error visibility to structural similarity", 2004: Gaussian of 11 x 11 pixels, deviation 1.5, K1 0.01, K2
 * 0.03). At least 11 x 11 pixels. Negative when out of memory. */
double image_ssim(const uint8_t *a, const uint8_t *b, int width, int height);

#endif
