#include "punctual_view.h"

#include <math.h>
#include <string.h>

/* Share of a map at each side that is rim. */
static const double RIM = 1.0 / 16;

/* Wider spots, slope of their outer angle, look into six maps. */
static const double WIDEST = 1.8;

/* Maps begin at this share of their depth (lamp_view.c). */
static const double NEAREST_SHARE = 1e-3;

enum { SUN_LAYERS = GI_SUN_TILES * GI_SUN_TILES };

static bool is_sun(const gi_punctual_light *l)
{
	return l->kind.x & GI_PUNCTUAL_DIRECTIONAL;
}

/* Slope of a spot's outer angle; below 0: of a point, or too wide for one map. */
static double slope_of(const gi_punctual_light *l)
{
	if (l->cone.x == 0)
		return -1;
	const double cosine = fmax(-(double)l->cone.y / (double)l->cone.x, 0), slope = sqrt(1 / (cosine * cosine) - 1);
	return slope < WIDEST ? slope : -1;
}

uint32_t punctual_view_layers(const gi_punctual_light *l)
{
	return is_sun(l) ? SUN_LAYERS : slope_of(l) < 0 ? 6 : 1;
}

static gi_vec4 row_of(gi_vec3d axis, gi_vec3d origin)
{
	return (gi_vec4){(float)axis.x, (float)axis.y, (float)axis.z, (float)-gi_vec3d_dot(axis, origin)};
}

/* A point keeps the world's axes; else z is where it shines. */
static void set_frame(gi_punctual_view *v, const gi_punctual_light *l)
{
	const gi_vec3d origin = is_sun(l) ? (gi_vec3d){0, 0, 0} : gi_vec3d_from(l->place), z = gi_vec3d_from(l->axis);
	if (!is_sun(l) && slope_of(l) < 0) {
		v->frame_x = row_of((gi_vec3d){1, 0, 0}, origin);
		v->frame_y = row_of((gi_vec3d){0, 1, 0}, origin);
		v->frame_z = row_of((gi_vec3d){0, 0, 1}, origin);
		return;
	}
	const gi_vec3d aside = fabs(z.y) < 0.9 ? (gi_vec3d){0, 1, 0} : (gi_vec3d){1, 0, 0};
	gi_vec3d x = gi_vec3d_cross(aside, z);
	x = gi_vec3d_scale(x, 1 / gi_vec3d_length(x));
	v->frame_x = row_of(x, origin);
	v->frame_y = row_of(gi_vec3d_cross(z, x), origin);
	v->frame_z = row_of(z, origin);
}

static double along(gi_vec4 row, gi_vec3d p)
{
	return gi_vec3d_dot(gi_vec3d_from(row), p) + (double)row.w;
}

/* Bounds of the boxes in the light's frame. */
static void bound(const gi_punctual_view *v, const punctual_box *boxes, uint32_t count, double lower[3],
		  double upper[3])
{
	const gi_vec4 rows[3] = {v->frame_x, v->frame_y, v->frame_z};
	for (int axis = 0; axis < 3; axis++) {
		lower[axis] = INFINITY;
		upper[axis] = -INFINITY;
		for (uint32_t k = 0; k < 8 * count; k++) {
			const double q = along(rows[axis], boxes[k / 8].corner[k % 8]);
			lower[axis] = fmin(lower[axis], q);
			upper[axis] = fmax(upper[axis], q);
		}
		if (!count)
			lower[axis] = upper[axis] = 0;
	}
}

/* A window that is a power of two wide, its corner on a grid of its 32nds: texels stay while something moves. */
static void fit_sun(gi_punctual_view *v, const double lower[3], const double upper[3], uint32_t size)
{
	const double wide = fmax(fmax(upper[0] - lower[0], upper[1] - lower[1]), 1e-6),
		     step = exp2(floor(log2(wide)) - 5);
	const double side = (ceil(wide / step) + 1) * step / GI_SUN_TILES;
	const double deep = fmax(upper[2] - lower[2], 1e-6), near = lower[2] - 0.01 * deep;
	v->tiles =
	    (gi_vec4){(float)(floor(lower[0] / step) * step), (float)(floor(lower[1] / step) * step), (float)side, 0};
	v->map = (gi_vec4){(float)(1 - 2 * RIM), (float)(side / (size * (1 - 2 * RIM))), (float)RIM, (float)size};
	v->depth.x = (float)(-near / (1.02 * deep));
	v->depth.y = (float)(1 / (1.02 * deep));
}

static void fit_point(gi_punctual_view *v, const double lower[3], const double upper[3], double slope, uint32_t size)
{
	double far = 1e-6;
	for (int axis = 0; axis < 3; axis++)
		far = fmax(far, 1.01 * fmax(-lower[axis], upper[axis]));
	const double near = NEAREST_SHARE * far, scale = (0.5 - RIM) / slope;
	v->map = (gi_vec4){(float)scale, (float)(1 / (scale * size)), (float)RIM, (float)size};
	v->depth.x = (float)(far / (far - near));
	v->depth.y = (float)(-far * near / (far - near));
}

void punctual_view_fit(gi_punctual_view *v, const gi_punctual_light *l, const punctual_box *boxes, uint32_t count,
		       uint32_t size)
{
	double lower[3], upper[3];
	memset(v, 0, sizeof *v);
	v->light = *l;
	set_frame(v, l);
	bound(v, boxes, count, lower, upper);
	if (is_sun(l))
		fit_sun(v, lower, upper, size);
	else
		fit_point(v, lower, upper, slope_of(l) < 0 ? 1 : slope_of(l), size);
	v->depth.z = l->place.w;
	v->layers.y = punctual_view_layers(l);
}

/* Row of the frame times a factor, added to a row of the matrix. */
static void add_row(float clip[16], int row, gi_vec4 from, double factor)
{
	const float *f = &from.x;
	for (int k = 0; k < 4; k++)
		clip[4 * k + row] += (float)(factor * (double)f[k]);
}

/* uv = 0.5 + x (t - tile - 0.5) with t = (q - corner) / side, as x, y from -1 to 1. */
static void sun_matrix(const gi_punctual_view *v, uint32_t layer, float clip[16])
{
	const uint32_t tile[2] = {layer % GI_SUN_TILES, layer / GI_SUN_TILES};
	const gi_vec4 rows[2] = {v->frame_x, v->frame_y};
	const double side = (double)v->tiles.z, x = (double)v->map.x;
	for (int axis = 0; axis < 2; axis++) {
		const double corner = (double)(&v->tiles.x)[axis];
		add_row(clip, axis, rows[axis], 2 * x / side);
		clip[12 + axis] += (float)(-2 * x * (corner / side + tile[axis] + 0.5));
	}
	add_row(clip, 2, v->frame_z, 2 * (double)v->depth.y);
	clip[14] += 2 * v->depth.x - 1;
	clip[15] = 1;
}

void punctual_view_matrix(const gi_punctual_view *v, uint32_t layer, float clip[16])
{
	memset(clip, 0, 16 * sizeof *clip);
	if (is_sun(&v->light)) {
		sun_matrix(v, layer, clip);
		return;
	}
	/* Maps along +x, -x, +y, -y, +z, -z; of a narrow spot +z alone. */
	const uint32_t face = v->layers.y == 1 ? 4 : layer, axis = face / 2;
	const gi_vec4 rows[3] = {v->frame_x, v->frame_y, v->frame_z};
	const double sign = face & 1 ? -1 : 1;
	add_row(clip, 0, rows[(axis + 1) % 3], 2 * (double)v->map.x);
	add_row(clip, 1, rows[(axis + 2) % 3], 2 * (double)v->map.x);
	add_row(clip, 2, rows[axis], sign * (2 * (double)v->depth.x - 1));
	clip[14] += 2 * v->depth.y;
	add_row(clip, 3, rows[axis], sign);
}
