/* A picture of the sky, and the light of its patches.
 *
 * Each patch has the mean of the picture over its solid angle. A patch that has more than a sixteenth of the light of
 * the whole sky is cut in four, again and again down to SKY_FINEST_LEVELS: so a sun is some ten patches, and shadows
 * have its edge. Which patches are cut is a function of the picture alone.
 */
#ifndef GI_SKY_IMAGE_H
#define GI_SKY_IMAGE_H

#include "sky_patch.h"

#include <stdbool.h>
#include <stdint.h>

/* What gi_set_sky_image takes. */
enum { SKY_IMAGE_MOST_SIDE = 32768 };
static const float SKY_IMAGE_MOST_RADIANCE = 3e11f; /* W/m2/sr: exitance below 1e12 */

/* Larger pictures are averaged down to this many texels: as fine as the finest patches. */
enum { SKY_IMAGE_MOST_WIDTH = 2048, SKY_IMAGE_MOST_HEIGHT = 1024 };

/* Nodes of all patches and those that they are cut into: fewer than 16 of a level have more than a sixteenth. */
enum { SKY_MOST_NODES = SKY_FACES * (1 + 4 + 16 + 64) + (SKY_FINEST_LEVELS - SKY_LEVELS) * 15 * 4 };

typedef struct sky_image {
	uint32_t width, height;
	float *texels; /* 3 each: pi times radiance, W/m2; rows from the top */
	double world_from_image[3][3];
	uint32_t node_count; /* depth first, face after face */
	bool split[SKY_MOST_NODES];
	bool fine[SKY_MOST_NODES]; /* a patch of much light, or something below it is */
	float mean[SKY_MOST_NODES][3];
} sky_image;

/* radiance: 3 * width * height, each at least 0; rotation: unit quaternion x y z w, world from image. NULL: out of
 * memory. */
sky_image *sky_image_make(const float *radiance, uint32_t width, uint32_t height, const double rotation[4]);
void sky_image_free(sky_image *image); /* NULL is fine */
bool sky_image_is_black(const sky_image *image);

/* Unit vector, in the frame of the picture, to a place in it: texels from the left and from the top. */
gi_vec3d sky_image_direction(const sky_image *image, double column, double row);
double sky_image_texel_angle(const sky_image *image, uint32_t row); /* solid, sr */

#endif
