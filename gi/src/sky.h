/* The sky: patches at infinity. */
#ifndef GI_SKY_H
#define GI_SKY_H

#include "gi/gi.h"
#include "hierarchy.h"

/* As a hierarchy of directions. False: out of memory. */
bool sky_build(gi_hierarchy *out);
bool sky_is_lit(const gi_context_def *def);
/* Where the scene has a sky: its light is that of the definition. */
void sky_relight(gi_context *gi);

#endif
