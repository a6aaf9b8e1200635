/* What pictures show of all objects: one mesh, small objects first, so that what they hide of the walls behind them is
 * not shaded.
 *
 *   position 3 | normal 3, sink 1 | leaf | light vertices 4 | weights 4        64 bytes a vertex
 *   u v                                                                        8 more in scenes with textures
 *
 * A scene without textures is drawn as a whole. In one with textures the mesh is drawn part by part: an object that has
 * some lies in it material by material.
 */
#ifndef GI_SURFACES_H
#define GI_SURFACES_H

#include "gpu_draw.h"

struct gi_context;

typedef struct surfaces_part {
	gpu_range range;
	uint32_t slot, material; /* whose textures it has; material GI_NONE: none, it may be of several objects */
} surfaces_part;

typedef struct gi_surfaces {
	bool built; /* for the scene as committed */
	gpu_mesh mesh;
	gpu_buffer uvs;
	surfaces_part *parts; /* all of the mesh, in its order; none in a scene without textures */
	uint32_t part_count;
	uint32_t *first_vertex;      /* by slot; GI_NONE: it is not drawn */
	struct draw_vertex *staging; /* of a shape that changed */
	uint32_t staging_room;
} gi_surfaces;

gi_result surfaces_build(struct gi_context *gi, gi_surfaces *surfaces);
/* What is drawn of an object has another shape: so has it in the mesh. False: out of memory. */
bool surfaces_redraw(struct gi_context *gi, gi_surfaces *surfaces, uint32_t slot);
/* Drops what was made of the committed scene. */
void surfaces_invalidate(struct gi_context *gi, gi_surfaces *surfaces);
void surfaces_free(struct gi_context *gi, gi_surfaces *surfaces);

#endif
