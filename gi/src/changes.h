/* What changed of the objects since the last update goes to the GPU: materials, poses, trees. */
#ifndef GI_CHANGES_H
#define GI_CHANGES_H

#include "gi/gi.h"

/* Materials that changed; what emits is weighed again, which may relight others. */
gi_result changes_upload_materials(gi_context *gi);
/* Likewise, poses and trees. */
gi_result changes_upload(gi_context *gi);

#endif
