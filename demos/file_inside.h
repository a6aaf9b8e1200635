/* A camera inside, for rooms that are closed from all sides. */
#ifndef DEMOS_FILE_INSIDE_H
#define DEMOS_FILE_INSIDE_H

#include "camera.h"
#include "scene_file.h"

#include <stdbool.h>

/* Where the picture would show nothing that a lamp lights, moves the camera to where light goes, as far back as it can
 * stand. True when it was moved. Scenes without lamps are left alone.
 */
bool file_inside_look(const engine_scene *scene, camera *view);

/* Whether a picture shows nothing that a lamp lights, and most of it is backs of faces with one side. */
bool file_inside_sees_backs(const engine_scene *scene, const camera *view);

#endif
