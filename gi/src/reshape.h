/* Shapes that changed go to the GPU: each object to the place that it has in the scene. */
#ifndef GI_RESHAPE_H
#define GI_RESHAPE_H

#include "gi/gi.h"

/* Brings objects to the shapes that were set since the last update, and uploads them. Poses, trees over objects and
 * rows are not its concern: the object moved, too. */
void reshape_objects(gi_context *gi);

#endif
