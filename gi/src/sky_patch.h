/* Where the patches of the sky are: the faces of a cube seen from its middle, each cut four by four at equal angles.
 * Edges are planes through the middle, so that four patches are exactly the one that they were cut from. */
#ifndef GI_SKY_PATCH_H
#define GI_SKY_PATCH_H

#include "vec3d.h"

enum {
	SKY_FACES = 6,
	SKY_LEVELS = 3,        /* of every sky */
	SKY_FINEST_LEVELS = 9, /* round what is small and bright (sky_image.h): 0.18 degrees wide */
	SKY_GRID = 1 << SKY_FINEST_LEVELS,
};

/* Of a face, from (i, j) on, size wide, in cells of the finest grid. Seen from the middle, i then j run
 * counter-clockwise. */
typedef struct sky_patch {
	int face;
	int i, j, size;
} sky_patch;

/* The k-th of the four patches that p is cut into. */
static inline sky_patch sky_patch_child(sky_patch p, int k)
{
	const int half = p.size / 2;
	return (sky_patch){p.face, p.i + (k & 1) * half, p.j + (k >> 1) * half, half};
}

/* Unit vector to place (i, j) of a face, cells of the finest grid. */
gi_vec3d sky_direction(int face, double i, double j);
/* The other way round, of a vector of any length. */
void sky_place_of(gi_vec3d direction, int *face, double *i, double *j);
void sky_patch_corners(sky_patch p, gi_vec3d corners[4]);
double sky_patch_angle(sky_patch p); /* solid, sr */

#endif
