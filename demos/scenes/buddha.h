/* The Buddha of the demo, modelled as code: a Catmull-Clark control cage, made anew at each call.
 *
 * A seated figure with both hands in the lap, on a lotus of two tiers of petals. Both legs and both hands are laid
 * out as mirror images, and the robe opens in a V, so that the whole figure is left-right symmetric.
 */
#ifndef SCENES_BUDDHA_H
#define SCENES_BUDDHA_H

#include <stdbool.h>

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Fills `out` (whatever it held is overwritten, not freed) with a cage of 992 quads and 994 vertices: one closed
 * surface, counter-clockwise seen from outside. The unit is the height of the figure: the limit surface stands on
 * y = 0 and its crown is at y = 1; scale it to metres as the scene needs. y is up, the face looks to +z, x = 0 is the
 * plane of symmetry. The cage itself reaches a little beyond its limit surface. Each call gives the same bits.
 * Free with engine_mesh_free. Returns false, with `out` zeroed, only when out of memory. */
bool buddha_cage(engine_mesh *out);

#ifdef __cplusplus
}
#endif

#endif
