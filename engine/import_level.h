/* Planes that a file's rounding bent or parted. */
#ifndef ENGINE_IMPORT_LEVEL_H
#define ENGINE_IMPORT_LEVEL_H

#include "import_build.h"

/* Brings the corners of faces that lie in one plane, but for the rounding of the file, into one plane; faces of all
 * objects that stand still, in the world at rest. No corner moves by more than some units of that rounding. Nothing is
 * done where the rounding is no more than that of the floats that positions are kept in, or where memory is short.
 */
void import_level_planes(import_loader *loader);

#endif
