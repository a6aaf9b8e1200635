/* A detailed mesh as the library takes it: triangles to draw, and a simplified cage that lights them. */
#ifndef DEMOS_FIGURE_H
#define DEMOS_FIGURE_H

#include "mesh.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Writes all triangles of `in` to *drawn and a cage of about cage_faces triangles to *cage (the mesh itself where it
 * has no more), which keeps the materials of its faces. The caller frees both with engine_mesh_free(). False with both
 * zeroed and one line in message.
 */
bool figure_make(const engine_mesh *in, uint32_t cage_faces, engine_mesh *drawn, engine_mesh *cage, char *message,
		 size_t message_size);

#endif
