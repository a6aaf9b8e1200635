/* Binds a context's buffers at the numbers where shaders read and write them (gi_shared.h). */
#ifndef GI_BINDING_H
#define GI_BINDING_H

#include "gi/gi.h"

void bind_scene(const gi_context *gi);
void bind_rows(const gi_context *gi); /* those of rows, budgets and the report */
void bind_solver(const gi_context *gi);
void bind_all(const gi_context *gi);

#endif
