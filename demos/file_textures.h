/* Textures of a scene file as what leaves reflect and emit: the mean of what of the picture lies on each. */
#ifndef DEMOS_FILE_TEXTURES_H
#define DEMOS_FILE_TEXTURES_H

#include "gi/gi.h"
#include "import_file.h"

#include <stdbool.h>

/* Has the mesh texture coordinates and some face a texture? Then the object is to be made with the mesh's uvs and with
 * leaf_materials. */
bool file_textures_are_used(const engine_scene *scene, const engine_mesh *mesh);

/* Sets the materials of the leaves of such an object; face_materials: the scene's numbers, by face of its definition.
 */
gi_result file_textures_set(const engine_scene *scene, const uint32_t *face_materials, gi_context *gi,
			    gi_object object);

#endif
