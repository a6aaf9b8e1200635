/* What the host draws into, and how it becomes a picture.
 *
 *   engine_target_begin      RGBA16F colour (linear radiance, W/(m2 sr)) + 32-bit float depth, cleared
 *   ... the host draws ...
 *   engine_target_tonemap    exposure, tone map, sRGB          -> RGBA8
 *   ... text and plots are drawn into the RGBA8 picture ...
 *   engine_target_read       bytes for a file, and / or
 *   engine_target_present    blit to a window
 *
 * All functions need the context current that was current at creation. They leave framebuffer and viewport bindings as
 * their descriptions say and may change the bound program, vertex array, texture unit 0 and the depth, blend, cull and
 * sRGB enables.
 */
#ifndef ENGINE_TONEMAP_H
#define ENGINE_TONEMAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct engine_target engine_target;

/* Makes a target of width x height pixels (1..16384). The caller owns it. NULL with one line in message. */
engine_target *engine_target_create(int width, int height, char *message, size_t message_size);

/* Needs the context current. NULL is fine. */
void engine_target_destroy(engine_target *target);

/* New size, contents undefined. False with one line in message when the driver refuses; the old size stays then.
 * The same size costs nothing.
 */
bool engine_target_resize(engine_target *target, int width, int height, char *message, size_t message_size);

int engine_target_width(const engine_target *target);
int engine_target_height(const engine_target *target);

/* Binds the HDR framebuffer, sets the viewport to all of it and clears: radiance 0, depth 1. */
void engine_target_begin(engine_target *target);

/* Turns radiance into the RGBA8 picture: exposure (display value 1 per W/(m2 sr), > 0) times radiance, shown unchanged
 * up to 0.76, compressed with its hue above, encoded as sRGB; NaN becomes black. Leaves the picture's framebuffer bound
 * with the viewport over all of it, ready for text.
 */
void engine_target_tonemap(engine_target *target, float exposure);

/* Reads the picture: 3 * width * height bytes, top row first. Waits until drawing is done. */
void engine_target_read(engine_target *target, uint8_t *rgb);

/* Reads the radiance that was drawn, before exposure and tone mapping: 3 * width * height floats, W/(m2 sr), top row
 * first, to the 11 bits that a half float has. Waits until drawing is done. */
void engine_target_read_radiance(engine_target *target, float *rgb);

/* Stretches the picture over framebuffer 0 of the given size; binds framebuffer 0. Nothing for sizes of 0. */
void engine_target_present(engine_target *target, int window_width, int window_height);

/* GL name of the HDR framebuffer, for hosts that blit or read it themselves. */
unsigned engine_target_hdr_framebuffer(const engine_target *target);

#ifdef __cplusplus
}
#endif

#endif
