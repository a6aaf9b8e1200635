/* glTF 2.0: .gltf and .glb. */
#ifndef ENGINE_SCENE_GLTF_H
#define ENGINE_SCENE_GLTF_H

#include "scene_build.h"

/* Reads loader->path into the scene, whose objects have yet to be settled. False: reported. */
bool scene_read_gltf(scene_loader *loader);

#endif
