/* From what files hold to what a control cage must be: connected, finite, without degenerate faces. */
#ifndef ENGINE_MESH_CLEAN_H
#define ENGINE_MESH_CLEAN_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Metres; squares of what lies further out leave the range of floats. */
#define ENGINE_MESH_FARTHEST 1e15f

typedef struct engine_clean_report {
	uint32_t welded_vertices;  /* vertices that shared a position with another */
	uint32_t degenerate_faces; /* dropped: no area */
	uint32_t duplicate_faces;  /* dropped: the corners of another one, in the same order round */
	uint32_t cut_faces;        /* not convex, or with a hole: now triangles */
	uint32_t too_large;        /* dropped: not convex and of too many corners to be cut (mesh_polygon.h) */
} engine_clean_report;

/* Adds a copy of part to the end of mesh (zeroed: empty). Faces get part's materials, or `material` where part has
 * none. Creases are not carried. False and mesh as it was when memory or 32-bit numbers do not suffice.
 */
bool engine_mesh_append(engine_mesh *mesh, const engine_mesh *part, uint32_t material);

/* Welds vertices of bitwise equal position (files split them by normal and texture coordinate, and a cage needs its
 * connections), drops degenerate faces, faces that are there twice and unused vertices, cuts faces that are not convex
 * into triangles (see mesh_polygon.h); the order of all stays. Creases are dropped: no file format read here has any.
 * False with one line in message for a corner out of range, a face of fewer than three corners, a position that is not
 * finite or beyond ENGINE_MESH_FARTHEST, or lack of memory; mesh is then still good for engine_mesh_free(). A mesh with
 * no face left is no failure.
 */
bool engine_mesh_clean(engine_mesh *mesh, engine_clean_report *report, char *message, size_t message_size);

/* Drops the vertices that no face has. False, with nothing changed: out of memory. */
bool engine_mesh_drop_unused_vertices(engine_mesh *mesh);

/* Turns a face of the mesh over: its corners run the other way. */
void engine_mesh_turn_face(engine_mesh *mesh, uint32_t *corners, uint32_t count);

/* glTF has triangles only, and exporters write a quad as two triangles that follow each other. Puts such pairs back
 * together: faces f and f+1 that share an edge, have one material, are within 45 degrees of coplanar and form a convex
 * quad, with the same texture coordinates and colours at either end of that edge. The shared edge becomes the quad's
 * diagonal a-c, so that a cage without refinement keeps its shape exactly. Needs welded vertices.
 */
void engine_mesh_pair_triangles(engine_mesh *mesh);

#ifdef __cplusplus
}
#endif

#endif
