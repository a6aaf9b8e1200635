/* Textures of a scene: pictures whose texels are reflectance or radiance, and their means over parts of a surface. */
#ifndef ENGINE_TEXTURE_H
#define ENGINE_TEXTURE_H

#include "image_mean.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What lies beside the picture: coordinates are at texels by 0..1 from its top left corner. */
typedef enum engine_wrap { ENGINE_WRAP_REPEAT, ENGINE_WRAP_CLAMP, ENGINE_WRAP_MIRROR } engine_wrap;

typedef struct engine_texture {
	engine_image_pixels pixels; /* its own */
	float mean[4];              /* of all, linear r g b, alpha */
} engine_texture;

/* A texture as a material looks it up. */
typedef struct engine_texture_use {
	uint32_t number;       /* of the scene's textures, and one; 0: none */
	engine_wrap wrap[2];   /* of u and of v */
	float transform[2][3]; /* u and v of the texture = rows times (u, v, 1) of the mesh */
} engine_texture_use;

engine_texture_use engine_texture_use_of(uint32_t number);

/* What of a picture is alpha. */
typedef enum engine_alpha {
	ENGINE_ALPHA_OWN, /* its own channel, 1 without */
	ENGINE_ALPHA_RED, /* a channel as it is stored, not in linear light */
	ENGINE_ALPHA_GREEN,
	ENGINE_ALPHA_BLUE,
	ENGINE_ALPHA_LUMINANCE, /* 0.2126 r + 0.7152 g + 0.0722 b of these */
	ENGINE_ALPHA_MASK,      /* its own where some pixel's is not 1, else luminance */
} engine_alpha;

/* Makes alpha of what is told, and its mean. */
void engine_texture_set_alpha(engine_texture *texture, engine_alpha alpha);

/* Mean over a triangle of the surface, whose corners have these coordinates of the mesh: linear r g b, and alpha.
 * Texels are squares of one value, what the triangle covers of each counts. Of very many one in so many is looked
 * at; a triangle that covers a repeating picture several times has the mean of all. */
void engine_texture_mean(const engine_texture *texture, const engine_texture_use *use, const float uvs[3][2],
			 float mean[4]);

#ifdef __cplusplus
}
#endif

#endif
