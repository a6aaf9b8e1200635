/* The mean colour of a picture: what a texture is to light that does not know where on a face it is. */
#ifndef ENGINE_IMAGE_MEAN_H
#define ENGINE_IMAGE_MEAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The largest picture that is decoded, pixels. */
enum { ENGINE_IMAGE_MAX_PIXELS = 1 << 26 };

/* A value as pictures store it (sRGB, IEC 61966-2-1), 0..1, in linear light. */
double engine_linear_of_srgb(double value);

/* Decodes a PNG or JPEG of sRGB colours. mean: r g b in linear light, alpha, each 0..1. *pixels is how many there were,
 * also where decoding failed after its head. False with the reason in *fault: "it is neither PNG nor JPEG".
 */
bool engine_image_mean(const uint8_t *bytes, size_t size, float mean[4], uint64_t *pixels, const char **fault);

/* The same, and its pixels: 4 bytes each, sRGB and alpha, rows from the top, the caller's to free(); NULL where it
 * could not be read. */
typedef struct engine_image_pixels {
	uint32_t width, height;
	uint8_t *rgba;
} engine_image_pixels;
bool engine_image_decode(const uint8_t *bytes, size_t size, engine_image_pixels *out, float mean[4], uint64_t *pixels,
			 const char **fault);

#ifdef __cplusplus
}
#endif

#endif
