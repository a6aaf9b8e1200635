/* PLY. */
#ifndef ENGINE_SCENE_PLY_H
#define ENGINE_SCENE_PLY_H

#include "scene_build.h"

/* Reads loader->path into the scene, whose objects have yet to be settled. False: reported. */
bool scene_read_ply(scene_loader *loader);

#endif
