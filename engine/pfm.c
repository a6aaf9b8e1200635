#include "pfm.h"

#include "output.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PIXELS = 16384 }; /* a side */

static bool is_little_endian(void)
{
	const uint16_t one = 1;
	return *(const uint8_t *)&one == 1;
}

bool engine_pfm_write(const char *path, int width, int height, const float *rgb, char *message, size_t message_size)
{
	engine_output output;
	if (!engine_output_open(&output, path, message, message_size))
		return false;
	fprintf(output.file, "PF\n%d %d\n%s\n", width, height, is_little_endian() ? "-1.0" : "1.0");
	const size_t row = 3 * (size_t)width;
	for (int y = height - 1; y >= 0; y--)
		fwrite(rgb + (size_t)y * row, sizeof *rgb, row, output.file);
	return engine_output_close(&output, true, message, message_size);
}

static void swap_bytes(float *values, size_t count)
{
	for (size_t k = 0; k < count; k++) {
		uint32_t bits;
		memcpy(&bits, values + k, sizeof bits);
		bits = bits >> 24 | (bits >> 8 & 0xff00) | (bits << 8 & 0xff0000) | bits << 24;
		memcpy(values + k, &bits, sizeof bits);
	}
}

/* One white space ends the header; the first byte of the pixels may look like more of it. */
static bool read_header(FILE *file, int *width, int *height, double *scale)
{
	return fscanf(file, "PF %6d %6d %31lf", width, height, scale) == 3 && fgetc(file) != EOF && *width >= 1 &&
	       *height >= 1 && *width <= MOST_PIXELS && *height <= MOST_PIXELS && *scale != 0;
}

static void turn_over(float *rgb, size_t row, int height)
{
	for (int y = 0; y < height / 2; y++) {
		float *a = rgb + (size_t)y * row, *b = rgb + (size_t)(height - 1 - y) * row;
		for (size_t k = 0; k < row; k++) {
			const float kept = a[k];
			a[k] = b[k];
			b[k] = kept;
		}
	}
}

/* NULL where the file ends too early, or memory is short: it grows with what was read, not with what the header says.
 */
static float *read_pixels(FILE *file, int width, int height, bool swapped)
{
	const size_t row = 3 * (size_t)width;
	float *rgb = NULL;
	bool read = true;
	for (int y = 0, room = 0; y < height && read; y++) {
		if (y == room) {
			room = room ? (room < height / 2 ? 2 * room : height) : 1;
			float *grown = realloc(rgb, sizeof *rgb * row * (size_t)room);
			read = grown != NULL;
			rgb = grown ? grown : rgb;
		}
		read = read && fread(rgb + (size_t)y * row, sizeof *rgb, row, file) == row;
	}
	if (!read) {
		free(rgb);
		return NULL;
	}
	turn_over(rgb, row, height);
	if (swapped)
		swap_bytes(rgb, row * (size_t)height);
	return rgb;
}

bool engine_pfm_read(const char *path, int *width, int *height, float **rgb, char *message, size_t message_size)
{
	*rgb = NULL;
	FILE *file = fopen(path, "rb");
	if (!file) {
		snprintf(message, message_size, "cannot read %s: %s", path, strerror(errno));
		return false;
	}
	double scale;
	if (!read_header(file, width, height, &scale))
		snprintf(message, message_size, "cannot read %s: not a colour PFM", path);
	else if (!(*rgb = read_pixels(file, *width, *height, (scale < 0) != is_little_endian())))
		snprintf(message, message_size, "cannot read %s: it ends too early, or memory is short", path);
	fclose(file);
	return *rgb != NULL;
}
