/* Trees over the objects of the scene, as rays walk them. */
#ifndef GI_TLAS_H
#define GI_TLAS_H

#include "gi/gi.h"

/* Where the objects are now. */
gi_result tlas_upload(gi_context *gi);

#endif
