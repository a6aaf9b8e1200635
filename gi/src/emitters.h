/* How much finer than others what emits is cut. */
#ifndef GI_EMITTERS_H
#define GI_EMITTERS_H

#include "gi/gi.h"

/* Decides it for all materials of the scene. Objects for which it changed are marked relit, so that they are cut
 * anew. */
gi_result emitters_weigh(gi_context *gi);

#endif
