/* Objects of a scene file that are of one shape: nodes with one mesh, instances of one node. The library refines such a
 * shape once. */
#ifndef DEMOS_FILE_TWINS_H
#define DEMOS_FILE_TWINS_H

#include "gi/gi.h"
#include "import_file.h"

#include <stdbool.h>

/* Fills first[k] with the first object of the same mesh, materials, scale and refinement as object k, k where there is
 * none before it. What moves its vertices has none. False: out of memory. */
bool file_twins_find(const engine_scene *scene, uint32_t *first);

/* Of two such: are their leaves chosen alike? */
bool file_twins_have_same_leaves(const gi_object_def *a, const gi_object_def *b);

#endif
