#include "occluder_mask.h"

#include <math.h>
#include <string.h>

static const double SIZE[3] = {GI_MASK_SIDE, GI_MASK_SIDE, GI_MASK_HEIGHT};

void occluder_mask_clear(occluder_mask *mask, const occluder_box *scene)
{
	memset(mask->rows, 0, OCCLUDER_MASK_BYTES);
	for (int axis = 0; axis < 3; axis++) {
		mask->lower[axis] = axis == 2 ? 0 : scene->lower[axis];
		mask->scale[axis] = SIZE[axis] / fmax(1.001 * (scene->upper[axis] - mask->lower[axis]), 1e-6);
	}
}

/* What is hidden at heights from..to on one axis. A point q sees the sample s past the blocker b where
 * q = s + (b - s) t, t = q.z / b.z >= 1: linear in t, so the ends are at the ends of t. */
static void shadow_of(const occluder_mask *mask, const occluder_box *box, int axis, double least, double most,
		      double out[2])
{
	out[0] = INFINITY;
	out[1] = -INFINITY;
	for (int end = 0; end < 2; end++) {
		const double t = end ? most : least;
		out[0] = fmin(out[0], mask->lamp_upper[axis] * (1 - t) + box->lower[axis] * t);
		out[1] = fmax(out[1], mask->lamp_lower[axis] * (1 - t) + box->upper[axis] * t);
	}
}

static int cell_of(const occluder_mask *mask, int axis, double at)
{
	return (int)fmin(fmax(floor((at - mask->lower[axis]) * mask->scale[axis]), 0), SIZE[axis] - 1);
}

/* Depth maps' texels at a height, where x and y are as wide as that. */
static double margin_of(const occluder_mask *mask, const double x[2], const double y[2], double height)
{
	const double wide = fmax(fmax(fabs(x[0]), fabs(x[1])), fmax(fabs(y[0]), fabs(y[1])));
	return mask->texel * (height + mask->bend * wide);
}

static uint64_t row_of(const occluder_mask *mask, double lower, double upper)
{
	return (~UINT64_C(0) >> (63 - cell_of(mask, 0, upper))) & (~UINT64_C(0) << cell_of(mask, 0, lower));
}

static void add_slice(occluder_mask *mask, const occluder_box *box, int slice)
{
	const double from = slice / mask->scale[2], to = (slice + 1) / mask->scale[2];
	const double lowest = fmax(box->lower[2], mask->lowest);
	const double least = fmax(1, from / box->upper[2]), most = fmax(1, to / lowest);
	double x[2], y[2];
	shadow_of(mask, box, 0, least, most, x);
	shadow_of(mask, box, 1, least, most, y);
	const double margin = margin_of(mask, x, y, to);
	const int first_y = cell_of(mask, 1, y[0] - margin), last_y = cell_of(mask, 1, y[1] + margin);
	const uint64_t row = row_of(mask, x[0] - margin, x[1] + margin);
	for (int j = first_y; j <= last_y; j++)
		mask->rows[slice * (int)GI_MASK_SIDE + j] |= row;
}

void occluder_mask_add(occluder_mask *mask, const occluder_box *box)
{
	if (box->upper[2] <= mask->lowest)
		return;
	for (int slice = cell_of(mask, 2, box->lower[2] * (1 - mask->texel)); slice < (int)GI_MASK_HEIGHT; slice++)
		add_slice(mask, box, slice);
}

bool occluder_mask_any(const occluder_mask *mask, const occluder_box *box)
{
	const double x[2] = {box->lower[0], box->upper[0]}, y[2] = {box->lower[1], box->upper[1]};
	const double margin = margin_of(mask, x, y, box->upper[2]);
	const uint64_t row = row_of(mask, x[0] - margin, x[1] + margin);
	const int first_y = cell_of(mask, 1, y[0] - margin), last_y = cell_of(mask, 1, y[1] + margin);
	const int last_z = cell_of(mask, 2, box->upper[2] + margin);
	for (int k = cell_of(mask, 2, box->lower[2] - margin); k <= last_z; k++)
		for (int j = first_y; j <= last_y; j++)
			if (mask->rows[k * (int)GI_MASK_SIDE + j] & row)
				return true;
	return false;
}
