/* OBJ, with its .mtl. */
#ifndef ENGINE_SCENE_OBJ_H
#define ENGINE_SCENE_OBJ_H

#include "scene_build.h"

/* Reads loader->path into the scene, whose objects have yet to be settled. False: reported. */
bool scene_read_obj(scene_loader *loader);

#endif
