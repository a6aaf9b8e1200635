#include "image_error.h"

#include <math.h>
#include <stdlib.h>

static const double DARK = 0.01; /* (W/m2/sr)^2 */

double image_relative_mse(const linear_image *picture, const linear_image truth[2])
{
	const size_t values = 3 * (size_t)picture->width * (size_t)picture->height;
	double sum = 0;
	for (size_t k = 0; k < values; k++) {
		const double x = (double)picture->rgb[k], a = (double)truth[0].rgb[k], b = (double)truth[1].rgb[k];
		const double r = 0.5 * (a + b);
		sum += (x - a) * (x - b) / (r * r + DARK);
	}
	return sum / (double)values;
}

enum { WINDOW = 11 };

static void gaussian(double weights[WINDOW])
{
	double sum = 0;
	for (int k = 0; k < WINDOW; k++) {
		const double x = (k - WINDOW / 2) / 1.5;
		weights[k] = exp(-0.5 * x * x);
		sum += weights[k];
	}
	for (int k = 0; k < WINDOW; k++)
		weights[k] /= sum;
}

static double luma(const uint8_t *p)
{
	return 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
}

/* The weighted moments of two pictures in a window: means of a, b, a^2, b^2, a b. */
enum { A, B, AA, BB, AB, MOMENTS };

static void add_moments(double *sum, double weight, const double *of)
{
	for (int m = 0; m < MOMENTS; m++)
		sum[m] += weight * of[m];
}

/* Along rows, for all rows: MOMENTS a window. */
static void sum_rows(const uint8_t *a, const uint8_t *b, int width, int height, const double *weights, double *out)
{
	for (int y = 0; y < height; y++)
		for (int x = 0; x + WINDOW <= width; x++, out += MOMENTS) {
			for (int m = 0; m < MOMENTS; m++)
				out[m] = 0;
			for (int k = 0; k < WINDOW; k++) {
				const size_t at = 3 * ((size_t)y * (size_t)width + (size_t)(x + k));
				const double p = luma(a + at), q = luma(b + at);
				add_moments(out, weights[k], (const double[MOMENTS]){p, q, p * p, q * q, p * q});
			}
		}
}

static double similarity(const double *m)
{
	const double c1 = 0.01 * 255 * 0.01 * 255, c2 = 0.03 * 255 * 0.03 * 255;
	const double aa = m[AA] - m[A] * m[A], bb = m[BB] - m[B] * m[B], ab = m[AB] - m[A] * m[B];
	return (2 * m[A] * m[B] + c1) * (2 * ab + c2) / ((m[A] * m[A] + m[B] * m[B] + c1) * (aa + bb + c2));
}

double image_ssim(const uint8_t *a, const uint8_t *b, int width, int height)
{
	const int across = width - WINDOW + 1, down = height - WINDOW + 1;
	double *rows = malloc(MOMENTS * sizeof *rows * (size_t)across * (size_t)height);
	if (!rows)
		return -1;
	double weights[WINDOW], sum = 0;
	gaussian(weights);
	sum_rows(a, b, width, height, weights, rows);
	for (int y = 0; y < down; y++)
		for (int x = 0; x < across; x++) {
			double moments[MOMENTS] = {0};
			for (int k = 0; k < WINDOW; k++)
				add_moments(moments, weights[k],
					    rows + MOMENTS * ((size_t)(y + k) * (size_t)across + (size_t)x));
			sum += similarity(moments);
		}
	free(rows);
	return sum / ((double)across * down);
}
