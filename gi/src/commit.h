/* What gi_commit does. */
#ifndef GI_COMMIT_H
#define GI_COMMIT_H

#include "gi/gi.h"

/* Takes what was created, destroyed and changed into the scene. Where it fails all is as it was. */
gi_result commit_objects(gi_context *gi);

#endif
