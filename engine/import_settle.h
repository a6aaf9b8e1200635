#ifndef ENGINE_IMPORT_SETTLE_H
#define ENGINE_IMPORT_SETTLE_H

#include "import_build.h"

/* Places all objects once they and the animations are there: moves a scene that is far from the origin, finds the
 * poses at rest and what animation does to them, drops objects that have none. False: out of memory (reported).
 */
bool import_settle_objects(import_loader *loader);

#endif
