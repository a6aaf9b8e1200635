/* How much finer than others what emits is cut. */
#ifndef GI_EMITTERS_H
#define GI_EMITTERS_H

#include "gi/gi.h"

/* Of all objects of the scene; those whose part in it changed are relit. */
gi_result emitters_weigh(gi_context *gi);

#endif
