#include "lamp_view.h"

#include "frames.h"

#include <math.h>

/* Where casters lie within these slopes to each side of a lamp's normal (63 degrees) maps are plain perspectives of
 * them alone; else maps of the whole hemisphere. */
static const double WIDEST = 2;

/* A frustum's borders are multiples of its width over this, so that maps keep their texels while something moves. */
static const double BORDER_STEPS = 16;

/* Texels between a border and the nearest shadow, for filters. */
static const double BORDER_TEXELS = 4;

/* A sample looks this share of the way to its neighbours aside, to both sides: shadows of neighbours then meet. */
static const double LOOK_ASIDE = 0.25;

/* Maps begin at this share of their depth: floats then tell depths in the far half apart to about 1e-4 of it. */
static const double NEAREST_SHARE = 1e-3;

/* ---- samples ---- */

/* Samples of the unit square whose shadows of a straight edge, summed, come nearest to the true ramp over all
 * directions of the edge (annealed; a grid leaves steps of a quarter where the edge runs along it). The first four lie
 * near the corners, the others follow from the outside in. */
static const float PATTERN_1[1][2] = {{0.5f, 0.5f}};
static const float PATTERN_2[2][2] = {{0.702f, 0.270f}, {0.298f, 0.730f}};
static const float PATTERN_4[4][2] = {{0.140f, 0.369f}, {0.860f, 0.631f}, {0.630f, 0.139f}, {0.370f, 0.862f}};
static const float PATTERN_8[8][2] = {{0.273f, 0.079f}, {0.727f, 0.923f}, {0.889f, 0.180f}, {0.110f, 0.820f},
				      {0.185f, 0.438f}, {0.815f, 0.562f}, {0.544f, 0.307f}, {0.455f, 0.692f}};
static const float PATTERN_16[16][2] = {{0.207f, 0.170f}, {0.872f, 0.771f}, {0.889f, 0.092f}, {0.156f, 0.912f},
					{0.047f, 0.340f}, {0.939f, 0.382f}, {0.737f, 0.937f}, {0.422f, 0.063f},
					{0.096f, 0.634f}, {0.520f, 0.868f}, {0.665f, 0.200f}, {0.766f, 0.497f},
					{0.331f, 0.739f}, {0.294f, 0.467f}, {0.466f, 0.307f}, {0.573f, 0.598f}};
static const float PATTERN_32[32][2] = {
    {0.077f, 0.129f}, {0.901f, 0.936f}, {0.915f, 0.118f}, {0.097f, 0.835f}, {0.218f, 0.980f}, {0.023f, 0.661f},
    {0.618f, 0.024f}, {0.731f, 0.965f}, {0.959f, 0.385f}, {0.294f, 0.051f}, {0.765f, 0.073f}, {0.924f, 0.566f},
    {0.093f, 0.283f}, {0.430f, 0.895f}, {0.121f, 0.442f}, {0.873f, 0.776f}, {0.584f, 0.848f}, {0.841f, 0.299f},
    {0.479f, 0.161f}, {0.185f, 0.725f}, {0.242f, 0.193f}, {0.359f, 0.784f}, {0.781f, 0.589f}, {0.236f, 0.537f},
    {0.554f, 0.237f}, {0.700f, 0.699f}, {0.314f, 0.352f}, {0.677f, 0.325f}, {0.651f, 0.486f}, {0.519f, 0.640f},
    {0.369f, 0.592f}, {0.458f, 0.416f}};

/* Where samples look aside, one after the other. */
static const float ASIDE[4][2] = {{1.0f, 0.0f}, {0.0f, 1.0f}, {0.7f, 0.7f}, {-0.7f, 0.7f}};

static const float (*pattern_of(uint32_t samples))[2]
{
	switch (samples) {
	case 1:
		return PATTERN_1;
	case 2:
		return PATTERN_2;
	case 4:
		return PATTERN_4;
	case 8:
		return PATTERN_8;
	case 16:
		return PATTERN_16;
	default:
		return PATTERN_32;
	}
}

void lamp_share_samples(const gi_lamps *lamps, uint32_t samples[GI_LAMP_MAX])
{
	const bool few = lamps->count <= 2;
	uint32_t total = lamps->count;
	for (uint32_t k = 0; k < lamps->count; k++)
		samples[k] = few ? GI_LAMP_FEW_SAMPLES : 1;
	while (!few) {
		uint32_t best = GI_NONE;
		double most = 0;
		for (uint32_t k = 0; k < lamps->count; k++) {
			const double share = lamps->polygon[k].power / samples[k];
			if (share > most && total + samples[k] <= GI_LAMP_SAMPLE_MAX) {
				most = share;
				best = k;
			}
		}
		if (best == GI_NONE)
			return;
		total += samples[best];
		samples[best] *= 2;
	}
}

static gi_vec3d unit(gi_vec3d v)
{
	const double length = gi_vec3d_length(v);
	return length > 0 ? gi_vec3d_scale(v, 1 / length) : (gi_vec3d){1, 0, 0};
}

static void place_frame(const gi_object_data *d, const lamp_polygon *p, lamp_view *l)
{
	const gi_vec3d offset = {d->row0.w, d->row1.w, d->row2.w};
	l->origin = (gi_vec3d){0, 0, 0};
	for (int k = 0; k < 4; k++) {
		l->corner[k] = gi_vec3d_add(gi_direction_to_world(d, gi_vec3d_load(p->corner[k])), offset);
		l->origin = gi_vec3d_add(l->origin, gi_vec3d_scale(l->corner[k], 0.25));
	}
	l->z = unit(gi_direction_to_world(d, gi_vec3d_load(p->normal)));
	const gi_vec3d edge = gi_vec3d_sub(l->corner[1], l->corner[0]);
	l->x = unit(gi_vec3d_sub(edge, gi_vec3d_scale(l->z, gi_vec3d_dot(edge, l->z))));
	l->y = gi_vec3d_cross(l->z, l->x);
}

gi_vec3d lamp_view_point(const lamp_view *l, gi_vec3d p)
{
	const gi_vec3d q = gi_vec3d_sub(p, l->origin);
	return (gi_vec3d){gi_vec3d_dot(l->x, q), gi_vec3d_dot(l->y, q), gi_vec3d_dot(l->z, q)};
}

static void place_samples(lamp_view *l, gi_vec4 *out)
{
	const gi_vec3d p = gi_vec3d_sub(l->corner[2], l->corner[0]), q = gi_vec3d_sub(l->corner[3], l->corner[1]);
	l->spacing = sqrt(0.5 * gi_vec3d_length(gi_vec3d_cross(p, q)) / l->sample_count);
	const float(*pattern)[2] = pattern_of(l->sample_count);
	for (int axis = 0; axis < 2; axis++) {
		l->sample_lower[axis] = INFINITY;
		l->sample_upper[axis] = -INFINITY;
	}
	gi_vec3d c[4];
	for (int k = 0; k < 4; k++)
		c[k] = lamp_view_point(l, l->corner[k]);
	for (uint32_t k = 0; k < l->sample_count; k++) {
		const double u = pattern[k][0], v = pattern[k][1];
		const double w[4] = {(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v};
		double at[2] = {0, 0};
		for (int i = 0; i < 4; i++) {
			at[0] += w[i] * c[i].x;
			at[1] += w[i] * c[i].y;
		}
		out[k] = (gi_vec4){(float)at[0], (float)at[1], ASIDE[k & 3][0], ASIDE[k & 3][1]};
		for (int axis = 0; axis < 2; axis++) {
			l->sample_lower[axis] = fmin(l->sample_lower[axis], at[axis]);
			l->sample_upper[axis] = fmax(l->sample_upper[axis], at[axis]);
		}
	}
}

void lamp_view_place(lamp_view *l, const lamp_polygon *polygon, const gi_object_data *object, uint32_t samples,
		     gi_vec4 *out)
{
	l->sample_count = samples;
	place_frame(object, polygon, l);
	place_samples(l, out);
}

/* ---- the window ---- */

static void reach_point(lamp_view *l, gi_vec3d q)
{
	const double at[2] = {q.x, q.y};
	for (int axis = 0; axis < 2; axis++) {
		l->lower[axis] = fmin(l->lower[axis], (at[axis] - l->sample_upper[axis]) / q.z);
		l->upper[axis] = fmax(l->upper[axis], (at[axis] - l->sample_lower[axis]) / q.z);
	}
	l->farthest = fmax(l->farthest, q.z);
}

/* The part of a box in front of z = nearest: its corners there and where its edges cross. */
static void reach_box(lamp_view *l, const gi_vec3d box[8])
{
	gi_vec3d q[8];
	for (int k = 0; k < 8; k++) {
		q[k] = lamp_view_point(l, box[k]);
		if (q[k].z >= l->nearest)
			reach_point(l, q[k]);
	}
	for (int k = 0; k < 8; k++)
		for (int bit = 1; bit < 8; bit *= 2) {
			const gi_vec3d a = q[k], b = q[k ^ bit];
			if ((a.z < l->nearest) == (b.z < l->nearest) || (k & bit))
				continue;
			const double t = (l->nearest - a.z) / (b.z - a.z);
			gi_vec3d cut = gi_vec3d_add(a, gi_vec3d_scale(gi_vec3d_sub(b, a), t));
			cut.z = l->nearest;
			reach_point(l, cut);
		}
}

static double closest_z(const lamp_view *l, const gi_vec3d box[8], double *farthest)
{
	double closest = INFINITY;
	*farthest = -INFINITY;
	for (int k = 0; k < 8; k++) {
		const double z = lamp_view_point(l, box[k]).z;
		closest = fmin(closest, z);
		*farthest = fmax(*farthest, z);
	}
	return closest;
}

double lamp_view_lowest(const lamp_polygon *p, const lamp_view *l)
{
	return 1.05 * p->bulge + 1e-4 * l->spacing;
}

/* Depths of the whole hemisphere: to the casters' farthest corner. */
static void take_hemisphere(lamp_view *l, const lamp_box *boxes, uint32_t count)
{
	double aside = 0, farthest = 0;
	for (int axis = 0; axis < 2; axis++)
		aside = fmax(aside, fmax(-l->sample_lower[axis], l->sample_upper[axis]));
	for (uint32_t k = 0; k < count; k++)
		for (int b = 0; b < 8; b++) {
			const gi_vec3d q = lamp_view_point(l, boxes[k].corner[b]);
			farthest = fmax(farthest, fmax(q.z, 0) + fmax(fabs(q.x), fabs(q.y)) + aside);
		}
	l->hemisphere = true;
	l->farthest = 1.01 * farthest;
	l->nearest = NEAREST_SHARE * farthest;
}

bool lamp_view_fit(lamp_view *l, const lamp_polygon *p, const lamp_box *boxes, uint32_t count)
{
	double closest = INFINITY, farthest = 0, z;
	for (uint32_t k = 0; k < count; k++) {
		const double from = closest_z(l, boxes[k].corner, &z);
		if (z <= lamp_view_lowest(p, l))
			continue;
		closest = fmin(closest, from);
		farthest = fmax(farthest, z);
	}
	if (!(farthest > 0))
		return false;
	l->nearest = fmax(fmax(0.99 * closest, 1.05 * p->bulge), NEAREST_SHARE * farthest);
	l->farthest = l->nearest;
	for (int axis = 0; axis < 2; axis++) {
		l->lower[axis] = INFINITY;
		l->upper[axis] = -INFINITY;
	}
	for (uint32_t k = 0; k < count; k++)
		reach_box(l, boxes[k].corner);
	l->farthest *= 1.01;
	for (int axis = 0; axis < 2; axis++)
		if (l->lower[axis] < -WIDEST || l->upper[axis] > WIDEST) {
			take_hemisphere(l, boxes, count);
			return true;
		}
	return l->upper[0] > l->lower[0];
}

/* One square window of slopes: borders on a grid, a margin of some texels. */
static void square_window(const lamp_view *l, double lower[2], double *width)
{
	double from[2], to[2];
	const double span = fmax(l->upper[0] - l->lower[0], l->upper[1] - l->lower[1]);
	const double step = exp2(ceil(log2(fmax(span, 1e-6)))) / BORDER_STEPS;
	*width = 0;
	for (int axis = 0; axis < 2; axis++) {
		from[axis] = floor(l->lower[axis] / step) * step;
		to[axis] = ceil(l->upper[axis] / step) * step;
		*width = fmax(*width, to[axis] - from[axis]);
	}
	for (int axis = 0; axis < 2; axis++)
		lower[axis] = 0.5 * (from[axis] + to[axis] - *width) - *width * BORDER_TEXELS / l->map_size;
	*width *= 1 + 2 * BORDER_TEXELS / l->map_size;
}

static gi_vec4 frame_row(gi_vec3d axis, gi_vec3d origin)
{
	return (gi_vec4){(float)axis.x, (float)axis.y, (float)axis.z, (float)-gi_vec3d_dot(axis, origin)};
}

void lamp_view_fill(const lamp_view *l, const lamp_polygon *p, bool casts, gi_lamp *out)
{
	for (int k = 0; k < 4; k++)
		out->corner[k] = (gi_vec4){(float)l->corner[k].x, (float)l->corner[k].y, (float)l->corner[k].z, 0};
	out->exitance = (gi_vec4){p->exitance[0], p->exitance[1], p->exitance[2], (float)lamp_view_lowest(p, l)};
	out->frame_x = frame_row(l->x, l->origin);
	out->frame_y = frame_row(l->y, l->origin);
	out->frame_z = frame_row(l->z, l->origin);
	if (!casts) {
		out->range.y = 0;
		return;
	}
	double lower[2] = {-1, -1}, width = 2;
	if (!l->hemisphere)
		square_window(l, lower, &width);
	const double n = l->nearest, f = l->farthest;
	out->map = (gi_vec4){(float)(1 / width), l->hemisphere ? 1.0f : 0.0f, (float)(-lower[0] / width),
			     (float)(-lower[1] / width)};
	out->depth = (gi_vec4){(float)(f / (f - n)), (float)(-f * n / (f - n)), (float)(width / l->map_size),
			       (float)(LOOK_ASIDE * l->spacing)};
}
