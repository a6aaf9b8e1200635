/* Objects of a file whose shape changes: with joints, with morph targets, by a scale that does. */
#ifndef DEMOS_FILE_SHAPE_H
#define DEMOS_FILE_SHAPE_H

#include "gi/gi.h"
#include "import_file.h"
#include "import_shape.h"

typedef struct file_shape {
	bool bends;                   /* by joints or targets */
	bool scales;                  /* by its pose */
	engine_followers cage, drawn; /* of one that bends; drawn: of a mesh that is drawn in the cage's place */
	float *points;                /* room for either */
} file_shape;

/* Says what changes of an object; `cage` and `drawn` (empty: none) are what the library gets of it. False: out of
 * memory. file_shape_free() takes a zeroed one too.
 */
bool file_shape_make(const engine_scene *scene, uint32_t object, const engine_mesh *cage, const engine_mesh *drawn,
		     file_shape *out);
void file_shape_free(file_shape *shape);

/* The shape at a time, where the object has a pose then: `pose`. What the library refuses leaves the one before. */
gi_result file_shape_set(const engine_scene *scene, uint32_t object, file_shape *shape, gi_context *gi,
			 gi_object handle, double time_s, const engine_pose *pose);

#endif
