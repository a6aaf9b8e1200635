/* Pictures on disk: 8-bit sRGB PNG, rows from the top left, and the names of numbered frames. */
#ifndef ENGINE_IMAGE_H
#define ENGINE_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Writes width x height pixels of 3 bytes (sRGB, top row first, no padding). False with one line in message when the
 * file cannot be written; then what was there before stays (output.h).
 */
bool engine_image_write_png(const char *path, int width, int height, const uint8_t *rgb, char *message,
			    size_t message_size);

/* Reads a PNG as 3 bytes a pixel, top row first. *rgb is the caller's to free(). False with one line in message. */
bool engine_image_read_png(const char *path, int *width, int *height, uint8_t **rgb, char *message,
			   size_t message_size);

/* A frame pattern is a file name with exactly one %d, %5d or %04d (width 1 to 9) and no other per cent sign, so that a
 * name from the command line can never do more than count. One without any, which every frame would write, is a pattern
 * of a `single` frame. False with one line in message when it is none.
 */
bool engine_frame_pattern_check(const char *pattern, bool single, char *message, size_t message_size);

/* Writes the name of one frame, e.g. frame_%04d.png and 7 give frame_0007.png. False and an empty name when the pattern
 * is not one, of a single frame or of many, or the name needs more than name_size bytes.
 */
bool engine_frame_pattern_name(const char *pattern, int frame, char *name, size_t name_size);

#ifdef __cplusplus
}
#endif

#endif
