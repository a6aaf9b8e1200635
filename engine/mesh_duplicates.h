/* Faces that are there twice: files are joined from pieces, and pieces are pasted twice. */
#ifndef ENGINE_MESH_DUPLICATES_H
#define ENGINE_MESH_DUPLICATES_H

#include "mesh.h"

/* Drops the faces that have the vertices of an earlier one in the same order round, wherever the list begins; the order
 * of the others stays. Those that go round the other way stay too: they are the other sides of sheets. (Faces that pass
 * through their least vertex twice are compared from the first time on.) Time: corners times the logarithm of faces.
 * False when out of memory. */
bool engine_mesh_drop_duplicates(engine_mesh *mesh, uint32_t *dropped);

#endif
