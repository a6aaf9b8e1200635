/* The sky: patches at infinity. */
#ifndef GI_SKY_H
#define GI_SKY_H

#include "gi/gi.h"
#include "hierarchy.h"

/* As a hierarchy of directions. False: out of memory. */
bool sky_build(gi_hierarchy *out);
bool sky_is_lit(const gi_context_def *def);
/* Sets the sky's light to that of the definition, where the scene has a sky. */
void sky_relight(gi_context *gi);

#endif
