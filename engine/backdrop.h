/* A picture of the sky behind what was drawn: equirectangular, linear radiance, as gi_set_sky_image takes it. */
#ifndef ENGINE_BACKDROP_H
#define ENGINE_BACKDROP_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct engine_backdrop engine_backdrop;

/* rgb: 3 * width * height, copied; larger pictures than the driver's textures are refused. NULL with one line in
 * message. Needs the context current, as all of these. */
engine_backdrop *engine_backdrop_create(const float *rgb, int width, int height, char *message, size_t message_size);
void engine_backdrop_destroy(engine_backdrop *backdrop); /* NULL is fine */

/* Draws it into the bound framebuffer where depth is 1, as cleared. Column-major matrices of the camera; what it
 * changes of OpenGL's state is what engine_target_tonemap does. */
void engine_backdrop_draw(const engine_backdrop *backdrop, const float view_from_world[16],
			  const float clip_from_view[16]);

#ifdef __cplusplus
}
#endif

#endif
