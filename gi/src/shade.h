/* The picture. */
#ifndef GI_SHADE_H
#define GI_SHADE_H

#include "gi/gi.h"

typedef struct gi_shade gi_shade; /* all that pictures take */

/* Drops what was made of the committed scene. */
void shade_invalidate(gi_context *gi);
/* Other objects or materials than before have textures. */
void shade_invalidate_textures(gi_context *gi);
void shade_free(gi_context *gi);

#endif
