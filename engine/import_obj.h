/* OBJ, with its .mtl. */
#ifndef ENGINE_IMPORT_OBJ_H
#define ENGINE_IMPORT_OBJ_H

#include "import_build.h"

/* Reads loader->path into the scene, whose objects have yet to be settled. False: reported. */
bool import_read_obj(import_loader *loader);

#endif
