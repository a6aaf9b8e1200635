/* Buffers to where shaders look for them: the one place that knows all of a context's. */
#ifndef GI_BINDING_H
#define GI_BINDING_H

#include "gi/gi.h"

void bind_scene(const gi_context *gi);
void bind_rows(const gi_context *gi); /* the budget's too, and the report's */
void bind_solver(const gi_context *gi);
void bind_all(const gi_context *gi);

#endif
