/* Pictures of radiance on disk, as Radiance writes them (Ward, "Real pixels", Graphics Gems II, 1991): four bytes a
 * pixel, three mantissas and a common exponent, mostly run-length encoded.
 *
 *     #?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 512 +X 1024\n   rows from the top, pixels from the left
 */
#ifndef ENGINE_HDR_H
#define ENGINE_HDR_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reads a picture of 1..32768 pixels a side, top row first, three floats a pixel; what EXPOSURE= says was multiplied in
 * is taken out again. *rgb is the caller's to free(); NULL on failure. False with one line in message. Memory grows
 * with what was read, not with what the header says. */
bool engine_hdr_read(const char *path, int *width, int *height, float **rgb, char *message, size_t message_size);

/* The same of a Radiance picture or a PFM, by its first bytes. Values that are no radiance are brought to the nearest
 * of 0..3e11, NaN to 0; *mended is how many pixels had such ones. */
bool engine_panorama_read(const char *path, int *width, int *height, float **rgb, size_t *mended, char *message,
			  size_t message_size);

#ifdef __cplusplus
}
#endif

#endif
