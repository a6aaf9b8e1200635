/* Which emitters give direct light per pixel, as polygons. The light of all others reaches the picture through the
 * leaves.
 *
 * An object is a lamp as a whole or not at all: its emitting surface is cut into the coarsest flat polygons that tile
 * it (neighbours that make one quad are joined), or, where it is curved, into nodes that come near it. Objects that
 * need more polygons than there is room for are no lamps; the strongest come first. Nodes of a lamp carry GI_NODE_LAMP.
 */
#ifndef GI_LAMP_H
#define GI_LAMP_H

#include "shade_shared.h"

#include <stdbool.h>

typedef struct lamp_polygon {
	uint32_t slot;
	float corner[4][3]; /* rest frame, counter-clockwise; a triangle repeats its third */
	float normal[3];    /* unit */
	float bulge;        /* how far the surface it stands for rises above its plane */
	float exitance[3];
	float power; /* area times the mean of E */
} lamp_polygon;

typedef struct gi_lamps {
	uint32_t count;
	uint32_t generation; /* another one when the polygons changed */
	lamp_polygon polygon[GI_LAMP_MAX];
} gi_lamps;

struct gi_context;

/* Chooses the lamps from the exitance of the nodes; to be called when that changed. Uploads the topology of objects
 * that became lamps or ceased to be, where `upload` says that the buffer is the current one. */
void lamps_select(struct gi_context *gi, bool upload);

#endif
