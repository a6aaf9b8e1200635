/* What is measured in linear pictures of the demos: light on the floor, edges of shadows, distances of two pictures. */
#ifndef TESTS_BENCH_PICTURE_MEASURES_H
#define TESTS_BENCH_PICTURE_MEASURES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Radiance, W/(m2 sr), top row first. */
typedef struct picture {
	int width, height;
	float *rgb;
} picture;

/* A PFM. False with one line in message; the caller frees with picture_free. */
bool picture_read(const char *path, picture *out, char *message, size_t message_size);
void picture_free(picture *p);

/* Luminance of linear sRGB (IEC 61966-2-1). */
double picture_luminance(const double rgb[3]);

/* A part of a picture in shares of its width and height, [0, 1], from the top left corner. */
typedef struct picture_part {
	double left, top, right, bottom;
} picture_part;

/* Its mean; parts have one pixel at least. */
void picture_mean(const picture *p, picture_part part, double rgb[3]);

/* A rectangle of the floor y = 0 of the Cornell box, metres. */
typedef struct floor_part {
	double x0, z0, x1, z1;
} floor_part;

/* Radiance of a point of the floor as the demo's camera sees it: interpolated between the four nearest pixels. What
 * stands between camera and floor is seen instead: parts are to be chosen where nothing does. */
void picture_floor(const picture *p, double x, double z, double rgb[3]);
void picture_floor_mean(const picture *p, floor_part part, double rgb[3]);

/* The radiance that the lamp alone gives a white floor with nothing in between, W/(m2 sr), green: closed form. */
double floor_unshadowed(double x, double z);

/* How much of the lamp a line of the floor sees, from a picture of direct light: radiance over floor_unshadowed. */
enum { SHADOW_SAMPLES = 401 };
typedef struct floor_line {
	double from[2], to[2]; /* x, z: from the shadow to the lit floor */
} floor_line;
void picture_shadow(const picture *p, const floor_line *line, double share[SHADOW_SAMPLES]);

/* Length of the line on which the lamp's visible share rises from a tenth to nine tenths: from the last sample at most
 * 0.1 to the first after it of at least 0.9, between samples linearly, metres. NAN where it does not. */
double penumbra_width(const floor_line *line, const double share[SHADOW_SAMPLES]);

/* Two pictures of one size. Pixels of which a channel of either exceeds `bright` are left out: lamps, and their edges.
 */
typedef struct picture_distance {
	double relative_mse; /* mean over pixels and channels of (a - b)^2 / (b^2 + (a tenth of the mean of b)^2) */
	double rms_of_mean;  /* root of the mean of (a - b)^2 over the mean of b */
} picture_distance;

picture_distance picture_compare(const picture *a, const picture *b, double bright);

/* The same on the floor, by cells x cells means: and root mean square of their differences over that of b. */
typedef struct floor_distance {
	double a, b;         /* mean radiance, green channel */
	double relative_rms; /* of the cells */
} floor_distance;
floor_distance picture_compare_floor(const picture *a, const picture *b, floor_part part, int cells);

#endif
