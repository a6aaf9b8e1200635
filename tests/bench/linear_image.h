/* Pictures of linear radiance, W/m2/sr, and how they become files. */
#ifndef TESTS_BENCH_LINEAR_IMAGE_H
#define TESTS_BENCH_LINEAR_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct linear_image {
	int width, height;
	float *rgb; /* width * height * 3, top row first */
} linear_image;

/* Black. False when out of memory. */
bool linear_image_create(int width, int height, linear_image *out);
void linear_image_free(linear_image *image);

/* What engine_target_tonemap makes of it, width * height * 3 bytes; an OpenGL context is current. False with one
 * line in message. */
bool linear_image_tonemap(const linear_image *image, float exposure, uint8_t *rgb, char *message, size_t message_size);

#endif
