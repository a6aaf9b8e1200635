/* The emitting triangles of a scene in the world, for what draws points on emitters by their power. */
#ifndef GI_LIGHTS_H
#define GI_LIGHTS_H

#include "arena.h"
#include "scene.h"

typedef struct gi_lights {
	gi_uvec4 *triangles; /* 3 each, as shaders have them (GI_BIND_PATH_LIGHTS); slices are set last */
	double *powers;      /* count: area times what was measured of the exitance */
	uint32_t *first;     /* slot_count + 1: those of a slot's object are [first[slot], first[slot + 1]) */
	uint32_t count;
	double power; /* of all */
} gi_lights;

/* How strong an exitance counts: one of the two below. */
typedef double gi_light_measure(gi_vec4 exitance);
double lights_luminance(gi_vec4 exitance);
double lights_largest(gi_vec4 exitance);

/* Lists the triangles as they were at the last gi_update, which is what the GPU has of the scene. The list lies in the
 * arena. False: out of memory. */
bool lights_find(const gi_scene *scene, gi_light_measure *measure, gi_arena *arena, gi_lights *out);

/* Cuts the 32-bit line into slices for [first, end), as wide as triangles are powerful. Returns their power. */
double lights_set_slices(gi_lights *lights, uint32_t first, uint32_t end);

#endif
