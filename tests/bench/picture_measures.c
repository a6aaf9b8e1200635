#include "picture_measures.h"

#include "pfm.h"
#include "scenes/cornell.h"

#include "../reference/exact.h"

#include <cglm/cglm.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool picture_read(const char *path, picture *out, char *message, size_t message_size)
{
	return engine_pfm_read(path, &out->width, &out->height, &out->rgb, message, message_size);
}

void picture_free(picture *p)
{
	free(p->rgb);
	*p = (picture){0};
}

double picture_luminance(const double rgb[3])
{
	return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

static const float *pixel(const picture *p, int x, int y)
{
	x = x < 0 ? 0 : x >= p->width ? p->width - 1 : x;
	y = y < 0 ? 0 : y >= p->height ? p->height - 1 : y;
	return p->rgb + 3 * ((size_t)y * (size_t)p->width + (size_t)x);
}

void picture_mean(const picture *p, picture_part part, double rgb[3])
{
	const int left = (int)(part.left * p->width), top = (int)(part.top * p->height);
	const int right = (int)(part.right * p->width), bottom = (int)(part.bottom * p->height);
	double count = 0;
	memset(rgb, 0, 3 * sizeof *rgb);
	for (int y = top; y < bottom || y == top; y++)
		for (int x = left; x < right || x == left; x++, count++)
			for (int c = 0; c < 3; c++)
				rgb[c] += (double)pixel(p, x, y)[c];
	for (int c = 0; c < 3; c++)
		rgb[c] /= count;
}

/* ---- the floor ---- */

/* Where the demo's camera sees a point of the floor, pixels from the top left corner. */
static void place_of(const picture *p, double x, double z, double place[2])
{
	float view_from_world[16], clip_from_view[16];
	cornell_camera((float)p->width / (float)p->height, view_from_world, clip_from_view);
	mat4 view, clip;
	memcpy(view, view_from_world, sizeof view);
	memcpy(clip, clip_from_view, sizeof clip);
	vec4 at = {(float)x, 0, (float)z, 1};
	glm_mat4_mulv(view, at, at);
	glm_mat4_mulv(clip, at, at);
	place[0] = 0.5 * p->width * (1 + (double)(at[0] / at[3]));
	place[1] = 0.5 * p->height * (1 - (double)(at[1] / at[3]));
}

void picture_floor(const picture *p, double x, double z, double rgb[3])
{
	double place[2];
	place_of(p, x, z, place);
	const double u = place[0] - 0.5, v = place[1] - 0.5; /* from the middle of the first pixel */
	const int left = (int)floor(u), top = (int)floor(v);
	const double s = u - left, t = v - top;
	for (int c = 0; c < 3; c++) {
		const double above = (1 - s) * (double)pixel(p, left, top)[c] + s * (double)pixel(p, left + 1, top)[c];
		const double below =
		    (1 - s) * (double)pixel(p, left, top + 1)[c] + s * (double)pixel(p, left + 1, top + 1)[c];
		rgb[c] = (1 - t) * above + t * below;
	}
}

enum { POINTS = 32 }; /* of a part, a side: nearer than pixels are */

void picture_floor_mean(const picture *p, floor_part part, double rgb[3])
{
	memset(rgb, 0, 3 * sizeof *rgb);
	for (int k = 0; k < POINTS * POINTS; k++) {
		const double s = (k % POINTS + 0.5) / POINTS, t = ((double)(k / POINTS) + 0.5) / POINTS;
		double one[3];
		picture_floor(p, part.x0 + s * (part.x1 - part.x0), part.z0 + t * (part.z1 - part.z0), one);
		for (int c = 0; c < 3; c++)
			rgb[c] += one[c] / (POINTS * POINTS);
	}
}

/* ---- shadows ---- */

/* The lamp of demos/scenes/cornell.c above a white floor. */
static const double LAMP_X = 0.65, LAMP_Z = 0.525, LAMP_Y = 5.5, LAMP_GREEN = 38.8, WHITE = 0.73;
static const double PI = 3.14159265358979323846;

double floor_unshadowed(double x, double z)
{
	const double corners[12] = {-LAMP_X, LAMP_Y, -LAMP_Z, LAMP_X,  LAMP_Y, -LAMP_Z,
				    LAMP_X,  LAMP_Y, LAMP_Z,  -LAMP_X, LAMP_Y, LAMP_Z};
	const double point[3] = {x, 0, z}, up[3] = {0, 1, 0};
	return WHITE / PI * LAMP_GREEN * fabs(exact_element_polygon(point, up, corners, 4));
}

void picture_shadow(const picture *p, const floor_line *line, double share[SHADOW_SAMPLES])
{
	for (int k = 0; k < SHADOW_SAMPLES; k++) {
		const double s = (double)k / (SHADOW_SAMPLES - 1);
		const double x = line->from[0] + s * (line->to[0] - line->from[0]);
		const double z = line->from[1] + s * (line->to[1] - line->from[1]);
		double rgb[3];
		picture_floor(p, x, z, rgb);
		share[k] = rgb[1] / floor_unshadowed(x, z);
	}
}

/* Where between samples k - 1 and k the share is `level`. */
static double crossing(const double *share, int k, double level)
{
	return k - 1 + (level - share[k - 1]) / (share[k] - share[k - 1]);
}

double penumbra_width(const floor_line *line, const double share[SHADOW_SAMPLES])
{
	int dark = SHADOW_SAMPLES - 1;
	while (dark >= 0 && share[dark] > 0.1)
		dark--;
	int lit = dark + 1;
	while (lit < SHADOW_SAMPLES && share[lit] < 0.9)
		lit++;
	if (dark < 0 || lit >= SHADOW_SAMPLES)
		return NAN;
	const double length = hypot(line->to[0] - line->from[0], line->to[1] - line->from[1]);
	return length / (SHADOW_SAMPLES - 1) * (crossing(share, lit, 0.9) - crossing(share, dark + 1, 0.1));
}

/* ---- two pictures ---- */

static bool is_bright(const float rgb[3], double bright)
{
	return (double)rgb[0] > bright || (double)rgb[1] > bright || (double)rgb[2] > bright;
}

/* Of what is not too bright in both. */
static double mean_value(const picture *a, const picture *b, double bright, size_t *kept)
{
	double sum = 0;
	*kept = 0;
	for (size_t k = 0; k < (size_t)b->width * (size_t)b->height; k++) {
		const float *rgb = b->rgb + 3 * k;
		if (is_bright(rgb, bright) || is_bright(a->rgb + 3 * k, bright))
			continue;
		sum += (double)rgb[0] + (double)rgb[1] + (double)rgb[2];
		*kept += 3;
	}
	return *kept ? sum / (double)*kept : 0;
}

picture_distance picture_compare(const picture *a, const picture *b, double bright)
{
	size_t kept;
	const double mean = mean_value(a, b, bright, &kept), least = 0.1 * mean;
	picture_distance d = {0};
	for (size_t k = 0; k < 3 * (size_t)b->width * (size_t)b->height; k++) {
		const size_t first = k - k % 3;
		if (is_bright(b->rgb + first, bright) || is_bright(a->rgb + first, bright))
			continue;
		const double right = (double)b->rgb[k], off = (double)a->rgb[k] - right;
		d.relative_mse += off * off / (right * right + least * least) / (double)kept;
		d.rms_of_mean += off * off / (double)kept;
	}
	d.rms_of_mean = sqrt(d.rms_of_mean) / mean;
	return d;
}

floor_distance picture_compare_floor(const picture *a, const picture *b, floor_part part, int cells)
{
	const double wide = (part.x1 - part.x0) / cells, deep = (part.z1 - part.z0) / cells;
	floor_distance d = {0};
	double off = 0, square = 0;
	for (int k = 0; k < cells * cells; k++) {
		const double x = part.x0 + wide * (k % cells), z = part.z0 + deep * (double)(k / cells);
		const floor_part cell = {x, z, x + wide, z + deep};
		double of_a[3], of_b[3];
		picture_floor_mean(a, cell, of_a);
		picture_floor_mean(b, cell, of_b);
		d.a += of_a[1] / (cells * cells);
		d.b += of_b[1] / (cells * cells);
		off += (of_a[1] - of_b[1]) * (of_a[1] - of_b[1]);
		square += of_b[1] * of_b[1];
	}
	d.relative_rms = sqrt(off / square);
	return d;
}
