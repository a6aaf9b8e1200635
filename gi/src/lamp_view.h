/* How a lamp sees the scene: its frame, its samples, and the window of its depth maps (shade_shared.h). Plain
 * mathematics.
 */
#ifndef GI_LAMP_VIEW_H
#define GI_LAMP_VIEW_H

#include "lamp.h"
#include "vec3d.h"

/* A lamp's frame and corners in the world, and what its frustum has to hold. */
typedef struct lamp_view {
	gi_vec3d x, y, z, origin, corner[4];
	uint32_t sample_count;
	double sample_lower[2], sample_upper[2];
	double spacing;    /* of the samples */
	uint32_t map_size; /* of a depth map, texels a side */
	bool hemisphere;
	double nearest, farthest, lower[2], upper[2]; /* along z; slopes x/z, y/z. Of a hemisphere: distances e */
} lamp_view;

/* Something that may be before the lamp: the corners of its box. */
typedef struct lamp_box {
	gi_vec3d corner[8]; /* world */
} lamp_box;

/* Samples of each lamp, powers of two: GI_LAMP_FEW_SAMPLES where there are one or two, else by its share of the power.
 */
void lamp_share_samples(const gi_lamps *lamps, uint32_t samples[GI_LAMP_MAX]);

/* Frame and samples of a lamp whose object is placed so. */
void lamp_view_place(lamp_view *view, const lamp_polygon *polygon, const gi_object_data *object, uint32_t samples,
		     gi_vec4 *out);

gi_vec3d lamp_view_point(const lamp_view *view, gi_vec3d world);

/* Height over the lamp's plane from where on something casts: what lies in it does not, but for rounding. */
double lamp_view_lowest(const lamp_polygon *polygon, const lamp_view *view);

/* Fits the window to the casters before the lamp; false when there are none. */
bool lamp_view_fit(lamp_view *view, const lamp_polygon *polygon, const lamp_box *boxes, uint32_t count);

/* For the shaders; `casts`: what fit said. */
void lamp_view_fill(const lamp_view *view, const lamp_polygon *polygon, bool casts, gi_lamp *out);

#endif
