/* Text and line plots over a finished picture. Pixels from the top left corner; colours are sRGB r g b a in 0..1.
 *
 * Text and plots are collected on the CPU and drawn together by engine_hud_draw() into the bound framebuffer.
 */
#ifndef ENGINE_HUD_H
#define ENGINE_HUD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct engine_hud engine_hud;

/* Needs a current context. The caller owns it. NULL with one line in message. */
engine_hud *engine_hud_create(char *message, size_t message_size);

/* Needs the context current. NULL is fine. */
void engine_hud_destroy(engine_hud *hud);

/* printf-style text, ASCII, at most 1023 characters; '\n' starts a new line 12 * scale pixels lower. x, y: the upper
 * left corner. What does not fit into the collection any more is left out.
 */
#if defined(__GNUC__)
__attribute__((format(printf, 6, 7)))
#endif
void engine_hud_text(engine_hud *hud, float x, float y, float scale, const float color[4], const char *format, ...);

/* A filled rectangle, e.g. behind text. box: x, y, width, height. */
void engine_hud_box(engine_hud *hud, const float box[4], const float color[4]);

/* A line through count values, evenly spaced over box (x, y, width, height); low is the bottom edge, high the top, what
 * lies outside is clamped, what is not finite is left out. Fewer than two values or low >= high draw nothing.
 */
void engine_hud_plot(engine_hud *hud, const float box[4], const float color[4], const float *values, uint32_t count,
		     float low, float high);

/* Draws everything collected since the last call into the bound framebuffer of that size (its viewport is set by the
 * caller) and forgets it. Leaves depth test and culling off and blending off.
 */
void engine_hud_draw(engine_hud *hud, int width, int height);

#ifdef __cplusplus
}
#endif

#endif
