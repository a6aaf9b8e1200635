/* Linear pictures on disk: Portable Float Map (Debevec, 1998), three 32-bit floats a pixel, for what an 8-bit picture
 * cannot hold: radiance before exposure and tone mapping, to be measured or mapped otherwise.
 *
 *     PF\n512 384\n-1.0\n   width, height; the sign of the scale says which byte comes first: little-endian below 0
 *     float r, g, b ...     rows from the bottom up
 */
#ifndef ENGINE_PFM_H
#define ENGINE_PFM_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Writes width x height pixels of three floats, top row first. False with one line in message when the file cannot be
 * written; then what was there before stays (output.h). */
bool engine_pfm_write(const char *path, int width, int height, const float *rgb, char *message, size_t message_size);

/* Reads a colour picture of 1..16384 pixels a side, top row first. *rgb is the caller's to free(); NULL on failure.
 * False with one line in message. */
bool engine_pfm_read(const char *path, int *width, int *height, float **rgb, char *message, size_t message_size);

#ifdef __cplusplus
}
#endif

#endif
