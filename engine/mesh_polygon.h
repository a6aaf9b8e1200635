/* Polygons that are not convex, cut into triangles. */
#ifndef ENGINE_MESH_POLYGON_H
#define ENGINE_MESH_POLYGON_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct engine_polygon_report {
	uint32_t cut;       /* polygons that became triangles */
	uint32_t dropped;   /* polygons that left none */
	uint32_t too_large; /* polygons left out: of more than 10,000 corners, or after too many of thousands */
} engine_polygon_report;

/* Replaces the faces that are not convex, or pass a vertex twice (a hole joined to the rim by a bridge), by triangles
 * of the area they enclose: what an odd number of turns of the rim surrounds. Fans and midpoints, which do for convex
 * faces, would cover the notch too. Others stay as they are, in their place. Vertices are added where edges cross.
 * Needs welded vertices without repeats along a face. False: out of memory, with the mesh still whole.
 */
bool engine_mesh_cut_polygons(engine_mesh *mesh, engine_polygon_report *report);

#ifdef __cplusplus
}
#endif

#endif
