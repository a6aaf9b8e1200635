/* glTF 2.0: .gltf and .glb. */
#ifndef ENGINE_IMPORT_GLTF_H
#define ENGINE_IMPORT_GLTF_H

#include "import_build.h"

/* Reads loader->path into the scene, whose objects have yet to be settled. False: reported. */
bool import_read_gltf(import_loader *loader);

#endif
