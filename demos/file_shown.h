/* Textures of a scene file in the picture: materials that have some get numbers of their own, and the library the
 * textures. What has no place in its texture, or colours that are times it, is drawn in the mean of its leaves.
 */
#ifndef DEMOS_FILE_SHOWN_H
#define DEMOS_FILE_SHOWN_H

#include "gi/gi.h"
#include "import_file.h"

#include <stdbool.h>

/* Of one object. */
typedef struct file_shown {
	uint32_t *numbers; /* by face of the mesh, or by triangle of its fans: the material in the definition */
	float *uvs;        /* of triangles alone: two of each corner */
	/* Of materials of the definition from `first` on, which are those with textures: the scene's. */
	uint32_t *sources;
	uint32_t first, count;
} file_shown;

/* Has some face of the mesh a texture that is drawn? */
bool file_shown_is_used(const engine_scene *scene, const engine_mesh *mesh);

/* Of a mesh that is drawn. face_materials: the scene's numbers. plain: what a face's number is where it has no texture;
 * NULL: 0, and faces become triangles as figure_make() makes them. first: how many materials the definition has without
 * these. False: out of memory. */
bool file_shown_make(const engine_scene *scene, const engine_mesh *mesh, const uint32_t *face_materials,
		     const uint32_t *plain, uint32_t first, file_shown *out);
void file_shown_free(file_shown *shown);

/* All textures of the scene in OpenGL, once they are wanted. */
typedef struct file_uploads {
	uint32_t *textures; /* scene.texture_count; 0: not yet, or it could not be */
	uint32_t samplers[3][3];
} file_uploads;

/* Hands over the textures of an object that was made with these. */
gi_result file_shown_set(const engine_scene *scene, const file_shown *shown, file_uploads *uploads, gi_context *gi,
			 gi_object object);
void file_uploads_free(file_uploads *uploads); /* what is in OpenGL goes with its context */

#endif
