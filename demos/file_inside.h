/* A camera inside, for rooms that are closed from all sides. */
#ifndef DEMOS_FILE_INSIDE_H
#define DEMOS_FILE_INSIDE_H

#include "camera.h"
#include "import_file.h"

#include <stdbool.h>

/* Where the picture would show nothing that a lamp lights, or the sky where there is one, moves the camera to where
 * light goes, as far back as it can stand. True when it was moved. Scenes without lamps are left alone.
 */
bool file_inside_look(const engine_scene *scene, bool sky, camera *view);

/* Whether a picture shows nothing that is lit, and most of it is backs of faces with one side. */
bool file_inside_sees_backs(const engine_scene *scene, bool sky, const camera *view);

#endif
