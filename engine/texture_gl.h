/* Textures of a scene as OpenGL's, for the library to draw with. Names go with the OpenGL context. */
#ifndef ENGINE_TEXTURE_GL_H
#define ENGINE_TEXTURE_GL_H

#include "texture.h"

#ifdef __cplusplus
extern "C" {
#endif

/* sRGB and alpha, with all its mipmaps. 0: it is larger than the driver's, or there is no memory. May change the buffer
 * bound for unpacking and the alignment of rows. */
uint32_t engine_texture_upload(const engine_texture *texture);

/* A sampler that filters between texels and mipmaps. */
uint32_t engine_texture_sampler(const engine_wrap wrap[2]);

#ifdef __cplusplus
}
#endif

#endif
