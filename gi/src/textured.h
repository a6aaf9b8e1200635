/* Pictures of what has textures: their parameters, part by part of the mesh. */
#ifndef GI_TEXTURED_H
#define GI_TEXTURED_H

#include "surfaces.h"

struct gi_context;

/* Are the host's textures and samplers still there? */
gi_result textured_check(const struct gi_context *gi, const gi_surfaces *surfaces);

/* Draws the parts without textures by `plain`, the others by `textured`. */
void textured_draw(const struct gi_context *gi, const gi_surfaces *surfaces, uint32_t plain, uint32_t textured);

#endif
