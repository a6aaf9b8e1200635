#include "sky_image.h"

#include "host_memory.h"

#include <string.h>

static const double PI = 3.14159265358979323846;

/* Of the sky's light: a patch with more is cut finer; one with more gets the rays of an emitter. */
static const double SPLIT_ABOVE = 1.0 / 16, FINE_ABOVE = 1.0 / 64;

/* Light is added up from points at least so close that a patch of SKY_LEVELS has a thousand of them. */
enum { SCATTER_WIDTH = 1024, SCATTER_HEIGHT = 512 };
/* Points a side of finer patches: two a texel. */
enum { GATHER_LEAST = 16, GATHER_MOST = 64 };

enum { COARSE_GRID = 1 << SKY_LEVELS, CELL = SKY_GRID / COARSE_GRID };

/* Of a patch of SKY_LEVELS: light (pi radiance times solid angle) and solid angle of its points. */
typedef struct cell {
	double light[3], angle;
} cell;

typedef struct building {
	sky_image *image;
	cell cells[SKY_FACES][COARSE_GRID][COARSE_GRID];
	double total; /* light of all, channels together */
} building;

static gi_vec3d to_world(const sky_image *s, gi_vec3d d)
{
	const double(*m)[3] = s->world_from_image;
	return (gi_vec3d){m[0][0] * d.x + m[0][1] * d.y + m[0][2] * d.z, m[1][0] * d.x + m[1][1] * d.y + m[1][2] * d.z,
			  m[2][0] * d.x + m[2][1] * d.y + m[2][2] * d.z};
}

static gi_vec3d to_image(const sky_image *s, gi_vec3d d)
{
	const double(*m)[3] = s->world_from_image;
	return (gi_vec3d){m[0][0] * d.x + m[1][0] * d.y + m[2][0] * d.z, m[0][1] * d.x + m[1][1] * d.y + m[2][1] * d.z,
			  m[0][2] * d.x + m[1][2] * d.y + m[2][2] * d.z};
}

gi_vec3d sky_image_direction(const sky_image *s, double column, double row)
{
	const double around = 2 * PI * (column / s->width - 0.5), down = PI * row / s->height;
	return (gi_vec3d){sin(around) * sin(down), cos(down), -cos(around) * sin(down)};
}

double sky_image_texel_angle(const sky_image *s, uint32_t row)
{
	return 2 * PI / s->width * (cos(PI * row / s->height) - cos(PI * (row + 1.0) / s->height));
}

static uint32_t index_below(double at, uint32_t count)
{
	return at > 0 ? (at < count ? (uint32_t)at : count - 1) : 0;
}

static const float *texel_at(const sky_image *s, gi_vec3d world)
{
	const gi_vec3d d = to_image(s, world);
	const double column = s->width * (atan2(d.x, -d.z) / (2 * PI) + 0.5);
	const double row = s->height * acos(fmax(-1, fmin(1, d.y))) / PI;
	return s->texels + 3 * ((size_t)index_below(row, s->height) * s->width + index_below(column, s->width));
}

/* ---- patches of SKY_LEVELS ---- */

static uint32_t points_in(uint32_t texels, uint32_t wanted)
{
	return (wanted + texels - 1) / texels;
}

static cell *cell_towards(building *b, gi_vec3d image_direction)
{
	int face;
	double i, j;
	sky_place_of(to_world(b->image, image_direction), &face, &i, &j);
	return &b->cells[face][index_below(j / CELL, COARSE_GRID)][index_below(i / CELL, COARSE_GRID)];
}

/* One row of points: a part of a row of texels. */
static void scatter_row(building *b, uint32_t row, double from, double to, uint32_t columns)
{
	const sky_image *s = b->image;
	const double angle = 2 * PI / ((double)s->width * columns) *
			     (cos(PI * (row + from) / s->height) - cos(PI * (row + to) / s->height));
	for (uint32_t x = 0; x < s->width * columns; x++) {
		const float *light = s->texels + 3 * ((size_t)row * s->width + x / columns);
		const gi_vec3d d = sky_image_direction(s, (x + 0.5) / columns, row + 0.5 * (from + to));
		cell *c = cell_towards(b, d);
		for (int k = 0; k < 3; k++)
			c->light[k] += light[k] * angle;
		c->angle += angle;
	}
}

static void scatter(building *b)
{
	const sky_image *s = b->image;
	const uint32_t columns = points_in(s->width, SCATTER_WIDTH), rows = points_in(s->height, SCATTER_HEIGHT);
	for (uint32_t row = 0; row < s->height; row++)
		for (uint32_t part = 0; part < rows; part++)
			scatter_row(b, row, (double)part / rows, (part + 1.0) / rows, columns);
	for (int face = 0; face < SKY_FACES; face++)
		for (int j = 0; j < COARSE_GRID; j++)
			for (int i = 0; i < COARSE_GRID; i++) {
				const double *light = b->cells[face][j][i].light;
				b->total += light[0] + light[1] + light[2];
			}
}

/* ---- finer ones ---- */

/* Solid angle of a cell of the finest grid there, but for a factor. */
static double density_at(double i, double j)
{
	const double u = tan(PI / 4 * (2 * i / SKY_GRID - 1)), v = tan(PI / 4 * (2 * j / SKY_GRID - 1));
	return (1 + u * u) * (1 + v * v) / pow(1 + u * u + v * v, 1.5);
}

static void gather(const sky_image *s, sky_patch p, double mean[3])
{
	const double patch = 0.5 * PI * p.size / SKY_GRID, texel = fmin(2 * PI / s->width, PI / s->height);
	const int side = (int)fmax(GATHER_LEAST, fmin(GATHER_MOST, ceil(2 * patch / texel)));
	double sum[3] = {0}, weight = 0;
	for (int y = 0; y < side; y++)
		for (int x = 0; x < side; x++) {
			const double i = p.i + p.size * (x + 0.5) / side, j = p.j + p.size * (y + 0.5) / side;
			const float *light = texel_at(s, sky_direction(p.face, i, j));
			const double w = density_at(i, j);
			for (int k = 0; k < 3; k++)
				sum[k] += w * light[k];
			weight += w;
		}
	for (int k = 0; k < 3; k++)
		mean[k] = sum[k] / weight;
}

/* Of the four parts of a patch; together they have its light. */
static void gather_parts(const sky_image *s, sky_patch p, const double mean[3], double parts[4][3])
{
	double light[3] = {0};
	const double angle = sky_patch_angle(p);
	for (int k = 0; k < 4; k++) {
		gather(s, sky_patch_child(p, k), parts[k]);
		for (int c = 0; c < 3; c++)
			light[c] += parts[k][c] * sky_patch_angle(sky_patch_child(p, k));
	}
	for (int k = 0; k < 4; k++)
		for (int c = 0; c < 3; c++)
			parts[k][c] = light[c] > 0 ? parts[k][c] * mean[c] * angle / light[c] : mean[c];
}

static void set_mean(sky_image *s, uint32_t node, const double mean[3])
{
	for (int c = 0; c < 3; c++)
		s->mean[node][c] = (float)mean[c];
}

/* Patch p of SKY_LEVELS, or below one, as node n; returns the node behind it. */
static uint32_t add_fine(building *b, uint32_t n, sky_patch p, const double mean[3])
{
	sky_image *s = b->image;
	const double share = (mean[0] + mean[1] + mean[2]) * sky_patch_angle(p) / b->total;
	set_mean(s, n, mean);
	s->fine[n] = share > FINE_ABOVE;
	s->split[n] = share > SPLIT_ABOVE && p.size > 1;
	if (!s->split[n])
		return n + 1;
	double parts[4][3];
	gather_parts(s, p, mean, parts);
	uint32_t next = n + 1;
	for (int k = 0; k < 4; k++)
		next = add_fine(b, next, sky_patch_child(p, k), parts[k]);
	return next;
}

static uint32_t add_node(building *b, uint32_t n, sky_patch p)
{
	sky_image *s = b->image;
	double mean[3] = {0}, angle = 0;
	if (p.size == CELL) {
		const cell *c = &b->cells[p.face][p.j / CELL][p.i / CELL];
		for (int k = 0; k < 3; k++)
			mean[k] = c->light[k] / c->angle;
		return add_fine(b, n, p, mean);
	}
	uint32_t next = n + 1;
	s->split[n] = true;
	s->fine[n] = false;
	for (int k = 0; k < 4; k++) {
		const uint32_t child = next;
		const double part = sky_patch_angle(sky_patch_child(p, k));
		next = add_node(b, child, sky_patch_child(p, k));
		s->fine[n] = s->fine[n] || s->fine[child];
		for (int c = 0; c < 3; c++)
			mean[c] += part * s->mean[child][c];
		angle += part;
	}
	for (int c = 0; c < 3; c++)
		mean[c] /= angle;
	set_mean(s, n, mean);
	return next;
}

static void light_patches(building *b)
{
	scatter(b);
	for (int face = 0; face < SKY_FACES; face++)
		b->image->node_count = add_node(b, b->image->node_count, (sky_patch){face, 0, 0, SKY_GRID});
}

/* ---- the picture ---- */

/* Mean of the part of a picture that a texel of the smaller one covers, rows by their solid angle. */
static void average(const float *radiance, uint32_t width, uint32_t height, const sky_image *s, uint32_t row,
		    uint32_t column, float out[3])
{
	const double left = (double)column * width / s->width, right = (column + 1.0) * width / s->width;
	const double top = (double)row * height / s->height, bottom = (row + 1.0) * height / s->height;
	double sum[3] = {0}, weight = 0;
	for (uint32_t y = (uint32_t)top; y < height && y < bottom; y++) {
		const double tall = cos(PI * fmax(y, top) / height) - cos(PI * fmin(y + 1.0, bottom) / height);
		for (uint32_t x = (uint32_t)left; x < width && x < right; x++) {
			const double w = tall * (fmin(x + 1.0, right) - fmax(x, left));
			for (int c = 0; c < 3; c++)
				sum[c] += w * radiance[3 * ((size_t)y * width + x) + c];
			weight += w;
		}
	}
	for (int c = 0; c < 3; c++)
		out[c] = (float)(PI * sum[c] / weight);
}

/* Towards the poles texels are ever narrower: neighbours become one until it is about as wide as those of the horizon,
 * so that points that are close enough there miss none. As many are left as a power of two: a picture that is turned is
 * treated alike. */
static void widen_row(sky_image *s, uint32_t row)
{
	const double wanted = s->width * sin(PI * (row + 0.5) / s->height);
	uint32_t parts = 4;
	while (parts < wanted)
		parts *= 2;
	for (uint32_t part = 0; part < parts && parts < s->width; part++) {
		const uint32_t first = (uint32_t)((uint64_t)part * s->width / parts),
			       count = (uint32_t)((part + (uint64_t)1) * s->width / parts) - first;
		float *texels = s->texels + 3 * ((size_t)row * s->width + first);
		double sum[3] = {0};
		for (uint32_t k = 0; k < 3 * count; k++)
			sum[k % 3] += texels[k];
		for (uint32_t k = 0; k < 3 * count; k++)
			texels[k] = (float)(sum[k % 3] / count);
	}
}

static void set_rotation(sky_image *s, const double q[4])
{
	const double x = q[0], y = q[1], z = q[2], w = q[3];
	const double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
				   {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
				   {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
	memcpy(s->world_from_image, rows, sizeof rows);
}

sky_image *sky_image_make(const float *radiance, uint32_t width, uint32_t height, const double rotation[4])
{
	sky_image *s = gi_calloc(1, sizeof *s);
	building *b = gi_calloc(1, sizeof *b);
	const bool ready = s && b;
	if (ready) {
		s->width = width < SKY_IMAGE_MOST_WIDTH ? width : SKY_IMAGE_MOST_WIDTH;
		s->height = height < SKY_IMAGE_MOST_HEIGHT ? height : SKY_IMAGE_MOST_HEIGHT;
		s->texels = gi_calloc(3 * (size_t)s->width * s->height, sizeof *s->texels);
		b->image = s;
	}
	if (ready && s->texels) {
		set_rotation(s, rotation);
		for (uint32_t row = 0; row < s->height; row++)
			for (uint32_t column = 0; column < s->width; column++)
				average(radiance, width, height, s, row, column,
					s->texels + 3 * ((size_t)row * s->width + column));
		for (uint32_t row = 0; row < s->height; row++)
			widen_row(s, row);
		light_patches(b);
	}
	gi_free(b);
	if (ready && s->texels)
		return s;
	sky_image_free(s);
	return NULL;
}

bool sky_image_is_black(const sky_image *s)
{
	bool black = true;
	for (uint32_t n = 0; n < s->node_count; n++)
		black = black && s->mean[n][0] + s->mean[n][1] + s->mean[n][2] <= 0;
	return black;
}

void sky_image_free(sky_image *s)
{
	if (!s)
		return;
	gi_free(s->texels);
	gi_free(s);
}
