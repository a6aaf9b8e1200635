#include "texture.h"

#include <math.h>
#include <string.h>

/* Texels of the box about a triangle that are each looked at, a square of so many a side; of more, one a block. */
static const double MOST_SIDE = 256;

/* A triangle so many times as wide and as tall as the picture, which repeats, has the mean of all. */
static const double MANY_TIMES = 4;

/* A triangle cut by up to four lines. */
typedef struct polygon {
	double at[8][2];
	int count;
} polygon;

typedef struct sums {
	double color[4], area;
} sums;

engine_texture_use engine_texture_use_of(uint32_t number)
{
	return (engine_texture_use){.number = number, .transform = {{1, 0, 0}, {0, 1, 0}}};
}

static uint8_t alpha_of(const uint8_t texel[4], engine_alpha alpha)
{
	if (alpha != ENGINE_ALPHA_LUMINANCE)
		return texel[alpha - ENGINE_ALPHA_RED];
	return (uint8_t)lrint(0.2126 * texel[0] + 0.7152 * texel[1] + 0.0722 * texel[2]);
}

void engine_texture_set_alpha(engine_texture *texture, engine_alpha alpha)
{
	const size_t count = (size_t)texture->pixels.width * texture->pixels.height;
	double sum = 0;
	if (alpha == ENGINE_ALPHA_MASK)
		alpha = texture->mean[3] < 1 ? ENGINE_ALPHA_OWN : ENGINE_ALPHA_LUMINANCE;
	if (alpha == ENGINE_ALPHA_OWN)
		return;
	for (size_t k = 0; k < count; k++) {
		uint8_t *texel = texture->pixels.rgba + 4 * k;
		texel[3] = alpha_of(texel, alpha);
		sum += texel[3] / 255.0;
	}
	texture->mean[3] = (float)(sum / (double)count);
}

/* What of p has coordinate `axis` above the bound (sign 1) or below it (sign -1): Sutherland and Hodgman, 1974. */
static polygon clip(const polygon *p, int axis, double bound, double sign)
{
	polygon out = {.count = 0};
	for (int k = 0; k < p->count; k++) {
		const double *a = p->at[k], *b = p->at[(k + 1) % p->count];
		const double from = sign * (a[axis] - bound), to = sign * (b[axis] - bound);
		if (from >= 0 && out.count < 8)
			memcpy(out.at[out.count++], a, sizeof out.at[0]);
		if ((from >= 0) != (to >= 0) && out.count < 8) {
			const double t = from / (from - to);
			out.at[out.count][axis] = bound;
			out.at[out.count][1 - axis] = a[1 - axis] + t * (b[1 - axis] - a[1 - axis]);
			out.count++;
		}
	}
	return out;
}

static polygon clip_band(const polygon *p, int axis, double from)
{
	const polygon above = clip(p, axis, from, 1);
	return clip(&above, axis, from + 1, -1);
}

static double area_of(const polygon *p)
{
	double sum = 0;
	for (int k = 1; k + 1 < p->count; k++)
		sum += (p->at[k][0] - p->at[0][0]) * (p->at[k + 1][1] - p->at[0][1]) -
		       (p->at[k + 1][0] - p->at[0][0]) * (p->at[k][1] - p->at[0][1]);
	return 0.5 * fabs(sum);
}

static void range_of(const polygon *p, int axis, double *low, double *high)
{
	*low = HUGE_VAL;
	*high = -HUGE_VAL;
	for (int k = 0; k < p->count; k++) {
		*low = fmin(*low, p->at[k][axis]);
		*high = fmax(*high, p->at[k][axis]);
	}
}

/* Number of a texel from one that may lie beside the picture. */
static uint32_t wrapped(double number, uint32_t size, engine_wrap wrap)
{
	const double span = wrap == ENGINE_WRAP_MIRROR ? 2.0 * size : size;
	if (wrap == ENGINE_WRAP_CLAMP)
		return (uint32_t)fmax(0, fmin(number, size - 1.0));
	double place = number - span * floor(number / span);
	if (place >= size && wrap == ENGINE_WRAP_MIRROR)
		place = span - 1 - place;
	return (uint32_t)fmax(0, fmin(place, size - 1.0));
}

static void add_texel(const engine_texture *t, const engine_texture_use *use, double x, double y, double area, sums *s)
{
	static double linear[256];
	if (linear[255] == 0)
		for (int v = 0; v < 256; v++)
			linear[v] = engine_linear_of_srgb(v / 255.0);
	const uint32_t column = wrapped(x, t->pixels.width, use->wrap[0]),
		       row = wrapped(y, t->pixels.height, use->wrap[1]);
	const uint8_t *texel = t->pixels.rgba + 4 * ((size_t)row * t->pixels.width + column);
	for (int c = 0; c < 3; c++)
		s->color[c] += area * linear[texel[c]];
	s->color[3] += area * texel[3] / 255.0;
	s->area += area;
}

/* step: texels of a block, each way. */
static void add_row(const engine_texture *t, const engine_texture_use *use, const polygon *p, double y,
		    const double step[2], sums *s)
{
	const polygon row = clip_band(p, 1, y);
	double low, high;
	range_of(&row, 0, &low, &high);
	for (double x = floor(low); x < high; x++) {
		const polygon cell = clip_band(&row, 0, x);
		add_texel(t, use, floor((x + 0.5) * step[0]), floor((y + 0.5) * step[1]), area_of(&cell), s);
	}
}

void engine_texture_mean(const engine_texture *t, const engine_texture_use *use, const float uvs[3][2], float mean[4])
{
	polygon p = {.count = 3};
	double low[2], high[2];
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 2; i++) {
			const float *row = use->transform[i];
			const double size = i ? t->pixels.height : t->pixels.width;
			p.at[k][i] = size * ((double)row[0] * uvs[k][0] + (double)row[1] * uvs[k][1] + (double)row[2]);
		}
	for (int i = 0; i < 2; i++)
		range_of(&p, i, &low[i], &high[i]);
	memcpy(mean, t->mean, 4 * sizeof *mean);
	const bool repeats = use->wrap[0] != ENGINE_WRAP_CLAMP && use->wrap[1] != ENGINE_WRAP_CLAMP;
	const double wide = high[0] - low[0], tall = high[1] - low[1];
	if (!(fabs(low[0]) + fabs(low[1]) + wide + tall < 1e9) ||
	    (repeats && wide > MANY_TIMES * t->pixels.width && tall > MANY_TIMES * t->pixels.height))
		return;
	const double most = MOST_SIDE * MOST_SIDE;
	const double step[2] = {ceil((wide + 1) / fmax(MOST_SIDE, most / (tall + 1))),
				ceil((tall + 1) / fmax(MOST_SIDE, most / (wide + 1)))};
	for (int k = 0; k < 6; k++)
		p.at[k / 2][k % 2] /= step[k % 2];
	sums s = {0};
	for (double y = floor(low[1] / step[1]); y < high[1] / step[1]; y++)
		add_row(t, use, &p, y, step, &s);
	/* A line or a point: what its middle lies on. */
	if (!(s.area > 1e-9)) {
		s = (sums){0};
		add_texel(t, use, floor(0.5 * (low[0] + high[0])), floor(0.5 * (low[1] + high[1])), 1, &s);
	}
	for (int c = 0; c < 4; c++)
		mean[c] = (float)(s.color[c] / s.area);
}
