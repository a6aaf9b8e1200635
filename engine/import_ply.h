/* PLY. */
#ifndef ENGINE_IMPORT_PLY_H
#define ENGINE_IMPORT_PLY_H

#include "import_build.h"

/* Reads loader->path into the scene, whose objects have yet to be settled. False: reported. */
bool import_read_ply(import_loader *loader);

#endif
