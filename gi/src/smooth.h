/* Normals of the smooth surface that an object's leaves stand for, at the corners of what rays meet: mirrors and
 * glass are round where they are meant to be. */
#ifndef GI_SMOOTH_H
#define GI_SMOOTH_H

#include "gi_shared.h"

#include <stdbool.h>

/* Of each corner of each primitive the mean of the normals that meet there within 40 degrees of its own, as
 * octahedron.glsl packs it; rest frame. out: 4 * count. False: out of memory. */
bool gi_smooth_normals(const gi_primitive *primitives, uint32_t count, uint32_t *out);

#endif
