#include "image_mean.h"

#include <math.h>
#include <setjmp.h>
#include <stdio.h> /* before jpeglib.h, which uses FILE */
#include <stdlib.h>
#include <string.h>

#include <jpeglib.h>
#include <png.h>

/* How often each byte occurs in each channel: a mean in linear light needs no more. */
typedef struct histogram {
	uint64_t counts[4][256];
	engine_image_pixels *kept; /* NULL: nobody wants the pixels */
	size_t written;            /* of them */
} histogram;

static bool keep_size(histogram *h, uint32_t width, uint32_t height)
{
	if (!h->kept)
		return true;
	*h->kept = (engine_image_pixels){width, height, malloc(4 * (size_t)width * height + 1)};
	return h->kept->rgba != NULL;
}

static void keep_pixels(histogram *h, const uint8_t *pixels, size_t count, int channels)
{
	uint8_t *to = h->kept->rgba + 4 * h->written;
	for (size_t i = 0; i < count; i++) {
		to[4 * i + 3] = 255;
		memcpy(to + 4 * i, pixels + i * (size_t)channels, (size_t)channels);
	}
	h->written += count;
}

static void count_pixels(histogram *h, const uint8_t *pixels, size_t count, int channels)
{
	for (size_t i = 0; i < count; i++) {
		for (int c = 0; c < channels; c++)
			h->counts[c][pixels[i * (size_t)channels + (size_t)c]]++;
	}
	if (h->kept)
		keep_pixels(h, pixels, count, channels);
}

double engine_linear_of_srgb(double value)
{
	return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4);
}

static float mean_of(const uint64_t counts[256], bool srgb)
{
	double sum = 0, count = 0;
	for (int v = 0; v < 256; v++) {
		double value = v / 255.0;
		sum += (double)counts[v] * (srgb ? engine_linear_of_srgb(value) : value);
		count += (double)counts[v];
	}
	return count > 0 ? (float)(sum / count) : 1;
}

static bool too_large(uint64_t width, uint64_t height, uint64_t *pixels, const char **fault)
{
	*pixels = width * height;
	if (*pixels <= ENGINE_IMAGE_MAX_PIXELS)
		return false;
	*fault = "it has more than 67 million pixels";
	return true;
}

static bool read_png(const uint8_t *bytes, size_t size, histogram *h, uint64_t *pixels, const char **fault)
{
	png_image image = {.version = PNG_IMAGE_VERSION};
	*fault = "its PNG is broken or cut off";
	if (!png_image_begin_read_from_memory(&image, bytes, size))
		return false;
	image.format = PNG_FORMAT_RGBA;
	uint8_t *rgba = too_large(image.width, image.height, pixels, fault) ? NULL : malloc(PNG_IMAGE_SIZE(image));
	bool read =
	    rgba && png_image_finish_read(&image, NULL, rgba, 0, NULL) && keep_size(h, image.width, image.height);
	if (read)
		count_pixels(h, rgba, *pixels, 4);
	png_image_free(&image);
	free(rgba);
	return read;
}

/* libjpeg's errors leave by a jump. */
typedef struct jpeg_state {
	struct jpeg_decompress_struct reader;
	struct jpeg_error_mgr errors;
	struct jpeg_progress_mgr progress;
	jmp_buf failed;
	uint8_t *row;
} jpeg_state;

static void leave(j_common_ptr reader)
{
	longjmp(((jpeg_state *)reader)->failed, 1);
}

static void ignore_message(j_common_ptr reader)
{
	(void)reader;
}

/* A small file can hold any number of scans of a large picture; pictures have ten or so. */
static void limit_scans(j_common_ptr reader)
{
	if (((jpeg_state *)reader)->reader.input_scan_number > 100)
		leave(reader);
}

static void read_jpeg_rows(jpeg_state *s, histogram *h, uint64_t *pixels, const char **fault)
{
	jpeg_read_header(&s->reader, TRUE);
	if (too_large(s->reader.image_width, s->reader.image_height, pixels, fault))
		leave((j_common_ptr)&s->reader);
	s->reader.out_color_space = JCS_RGB;
	jpeg_start_decompress(&s->reader);
	if (!keep_size(h, s->reader.output_width, s->reader.output_height))
		leave((j_common_ptr)&s->reader);
	s->row = malloc((size_t)s->reader.output_width * 3);
	while (s->row && s->reader.output_scanline < s->reader.output_height) {
		jpeg_read_scanlines(&s->reader, &s->row, 1);
		count_pixels(h, s->row, s->reader.output_width, 3);
	}
	jpeg_finish_decompress(&s->reader);
}

static bool read_jpeg(const uint8_t *bytes, size_t size, histogram *h, uint64_t *pixels, const char **fault)
{
	jpeg_state *s = calloc(1, sizeof *s);
	if (!s)
		return false;
	*fault = "its JPEG is broken or cut off";
	s->reader.err = jpeg_std_error(&s->errors);
	s->errors.error_exit = leave;
	s->errors.output_message = ignore_message;
	s->progress.progress_monitor = limit_scans;
	bool read = false;
	if (setjmp(s->failed) == 0) {
		jpeg_create_decompress(&s->reader);
		s->reader.progress = &s->progress;
		jpeg_mem_src(&s->reader, bytes, (unsigned long)size);
		read_jpeg_rows(s, h, pixels, fault);
		read = s->row && s->errors.num_warnings == 0;
	}
	jpeg_destroy_decompress(&s->reader);
	free(s->row);
	free(s);
	return read;
}

bool engine_image_mean(const uint8_t *bytes, size_t size, float mean[4], uint64_t *pixels, const char **fault)
{
	return engine_image_decode(bytes, size, NULL, mean, pixels, fault);
}

bool engine_image_decode(const uint8_t *bytes, size_t size, engine_image_pixels *out, float mean[4], uint64_t *pixels,
			 const char **fault)
{
	static const uint8_t png_start[4] = {0x89, 'P', 'N', 'G'}, jpeg_start[2] = {0xff, 0xd8};
	histogram *h = calloc(1, sizeof *h);
	bool read = false;
	if (out)
		*out = (engine_image_pixels){0};
	if (h)
		h->kept = out;
	*pixels = 0;
	*fault = h ? "it is neither PNG nor JPEG" : "there is no memory for it";
	if (h && size > sizeof png_start && memcmp(bytes, png_start, sizeof png_start) == 0)
		read = read_png(bytes, size, h, pixels, fault);
	else if (h && size > sizeof jpeg_start && memcmp(bytes, jpeg_start, sizeof jpeg_start) == 0)
		read = read_jpeg(bytes, size, h, pixels, fault);
	for (int c = 0; read && c < 4; c++)
		mean[c] = mean_of(h->counts[c], c < 3);
	if (out && !read) {
		free(out->rgba);
		*out = (engine_image_pixels){0};
	}
	free(h);
	return read;
}
