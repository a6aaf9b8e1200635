/* Leaves of a simplified cage: the mean of what of the full mesh lies next to each. */
#ifndef DEMOS_FILE_CAGE_H
#define DEMOS_FILE_CAGE_H

#include "gi/gi.h"
#include "import_file.h"

#include <stdbool.h>

/* Sets the materials of the leaves of an object made of `cage`, with the uvs that file_textures_prepare(all) left, in
 * place of `full`; both in the same space. Pieces of the full mesh about as large as leaves, each the mean of its part
 * of textures and colours, count for the leaf that is next to them and faces as they do. A leaf that has none is as
 * what is next to it. both_sides: the object has two.
 */
gi_result file_cage_set(const engine_scene *scene, const engine_mesh *full, const engine_mesh *cage, bool both_sides,
			gi_context *gi, gi_object object);

#endif
