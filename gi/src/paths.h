/* Path tracing on the same trees, for comparison. */
#ifndef GI_PATHS_H
#define GI_PATHS_H

#include "gi/gi.h"

typedef struct gi_paths gi_paths;

void paths_free(gi_context *gi);

#endif
