/* A scene from a file as the player plays it. */
#ifndef DEMOS_FILE_SCENE_H
#define DEMOS_FILE_SCENE_H

#include "camera.h"
#include "file_lights.h"
#include "file_shape.h"
#include "file_shown.h"
#include "gi/gi.h"
#include "options.h"
#include "import_file.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct file_scene {
	engine_scene scene;
	const char *program; /* for warnings */
	bool lit;            /* by a sky, whatever the file holds */
	bool sky_given;      /* one of the file does not count */
	options_sides two_sided;
	float leaf_size;     /* 0: the levels that the file gives, and what is chosen for objects without */
	uint32_t leaves;     /* about so many are chosen; 0: what suits the renderer */
	uint32_t cage_faces; /* of the cages of detailed meshes; 0: chosen */
	gi_object *handles;  /* scene.object_count */
	file_shape *shapes;  /* likewise */
	const char **names;
	file_lights lights;
	file_uploads uploads;     /* textures that are drawn */
	float lower[3], upper[3]; /* of everything at rest, world */
	camera framing;           /* where the file has no camera */
} file_scene;

/* Loads the file; what it dropped is told on stderr. False with one line in message, and nothing to free. */
bool file_scene_load(file_scene *f, const char *path, char *message, size_t message_size);
void file_scene_free(file_scene *f);

/* Creates the objects in the order of the file, as fine as suits the scene; one line on stderr says how fine. A mesh of
 * more faces than its share of the leaves is drawn in full and lit through a simplified one. False with one line in
 * message.
 */
bool file_scene_create(file_scene *f, gi_context *gi, char *message, size_t message_size);

/* Poses what is animated, lights too. */
gi_result file_scene_animate(file_scene *f, gi_context *gi, double time_s);

/* The file's camera, or one that sees everything. */
void file_scene_view(const file_scene *f, double time_s, camera *out);

#endif
