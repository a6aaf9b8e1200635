/* Cages from scans. */
#ifndef ENGINE_SIMPLIFY_H
#define ENGINE_SIMPLIFY_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Writes a triangle cage of about target_faces (>= 4) triangles of `in` to *out, which the caller owns and frees with
 * engine_mesh_free(). Polygons are split into fans first; zero-area faces are dropped before and after. The simplifier
 * (Garland and Heckbert's quadrics, meshoptimizer) keeps topology: closed stays closed, handles stay, so a shape of
 * many handles may keep more triangles than asked for; a handle thinner than a triangle may leave an edge of four faces
 * (which OpenSubdiv takes as sharp). A triangle takes the material that most of its corners had.
 * False with *out zeroed and one line in message when `in` is not valid, has no area, or memory does not suffice.
 */
bool engine_simplify(const engine_mesh *in, uint32_t target_faces, engine_mesh *out, char *message,
		     size_t message_size);

#ifdef __cplusplus
}
#endif

#endif
