/* Mirrors and glass of the committed scene: what their rays ask for. Nothing of it is there in a scene without any. */
#ifndef GI_SPECULAR_H
#define GI_SPECULAR_H

#include "gi/gi.h"

typedef struct gi_smooth gi_smooth;

/* Makes what is not there for the committed scene; frees all where nothing wants it. */
gi_result specular_update(gi_context *gi);
void specular_invalidate(gi_context *gi); /* after a commit */
/* Is it of the committed scene? Not between a commit and the update after it: nor are the trees of rays. */
bool specular_is_ready(const gi_context *gi);
void specular_bind(const gi_context *gi); /* at numbers that others use too (gi_shared.h): after bind_rows() */
void specular_free(gi_context *gi);

#endif
