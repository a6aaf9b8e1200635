/* Where a lamp may be hidden: a grid over the scene in the lamp's frame (z along its normal), one bit a cell. Where the
 * bit is 0 every sample of the lamp sees every point of the cell, and nobody has to look into depth maps.
 *
 *   rows[z * SIDE + y]    bit x
 */
#ifndef GI_OCCLUDER_MASK_H
#define GI_OCCLUDER_MASK_H

#include "shade_shared.h"

#include <stdbool.h>

enum { OCCLUDER_MASK_ROWS = GI_MASK_HEIGHT * GI_MASK_SIDE, OCCLUDER_MASK_BYTES = 8 * OCCLUDER_MASK_ROWS };

typedef struct occluder_box {
	double lower[3], upper[3]; /* in the lamp's frame */
} occluder_box;

typedef struct occluder_mask {
	uint64_t *rows;                      /* OCCLUDER_MASK_ROWS, the caller's */
	double lamp_lower[2], lamp_upper[2]; /* x and y of the samples, whose z is 0 */
	double lowest;                       /* what lies under this height hides nothing */
	double texel, bend;        /* shadows are wider by texel * (z + bend * max(|x|, |y|)): a depth map's texels */
	double lower[3], scale[3]; /* cell = (q - lower) * scale; clear() sets them */
} occluder_mask;

/* Clears all bits and lays the grid over the box of the scene. */
void occluder_mask_clear(occluder_mask *mask, const occluder_box *scene);

/* Sets the bits of all points for which something inside the box may hide a sample of the lamp. */
void occluder_mask_add(occluder_mask *mask, const occluder_box *box);

/* Is a bit set for any point in the box, or next to it by up to a depth map's texel? */
bool occluder_mask_any(const occluder_mask *mask, const occluder_box *box);

#endif
