/* How a light without a surface sees the scene: its frame and the windows of its depth maps (shade_shared.h). Plain
 * mathematics.
 */
#ifndef GI_PUNCTUAL_VIEW_H
#define GI_PUNCTUAL_VIEW_H

#include "shade_shared.h"
#include "vec3d.h"

#include <stdbool.h>

/* How many maps a light has. */
uint32_t punctual_view_layers(const gi_punctual_light *light);

/* What has casters in it, as corners of their boxes, each 8 in the world; a map is `size` texels a side. layers.x is
 * the caller's. */
typedef struct punctual_box {
	gi_vec3d corner[8];
} punctual_box;
void punctual_view_fit(gi_punctual_view *view, const gi_punctual_light *light, const punctual_box *boxes,
		       uint32_t count, uint32_t size);

/* To clip coordinates of one of its maps, column-major. */
void punctual_view_matrix(const gi_punctual_view *view, uint32_t layer, float clip[16]);

#endif
