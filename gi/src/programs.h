/* The programs that every frame takes. Others are compiled when first wanted, by the modules that run them. */
#ifndef GI_PROGRAMS_H
#define GI_PROGRAMS_H

#include "gi/gi.h"

/* Hands all sources to the driver, which may compile them on threads of its own. */
gi_result programs_begin(gi_context *gi);
/* Waits for them; fails, every time, for those that do not compile. */
gi_result programs_end(gi_context *gi);
void programs_free(gi_context *gi);

#endif
