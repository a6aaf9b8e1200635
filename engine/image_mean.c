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

/* ---- PNG ---- */

/* libpng's errors leave by a jump. */
typedef struct png_state {
	png_structp reader;
	png_infop info;
	const uint8_t *next;
	size_t left;
	uint8_t *rgba, **rows;
	bool whole; /* all of it was read */
} png_state;

static void take_bytes(png_structp reader, png_bytep to, size_t count)
{
	png_state *s = png_get_io_ptr(reader);
	if (count > s->left)
		png_error(reader, "cut off");
	memcpy(to, s->next, count);
	s->next += count;
	s->left -= count;
}

static void leave_png(png_structp reader, png_const_charp message)
{
	(void)message;
	png_longjmp(reader, 1);
}

static void ignore_warning(png_structp reader, png_const_charp message)
{
	(void)reader;
	(void)message;
}

/* Any PNG to four bytes a pixel as they are stored: what it says of its gamma is not asked (glTF 2.0, 3.8.3). */
static void choose_rgba(const png_state *s)
{
	png_set_expand(s->reader);
	png_set_scale_16(s->reader);
	png_set_gray_to_rgb(s->reader);
	png_set_add_alpha(s->reader, 255, PNG_FILLER_AFTER);
	png_set_interlace_handling(s->reader);
	png_read_update_info(s->reader, s->info);
}

static void read_png_rows(png_state *s, uint64_t *pixels, const char **fault)
{
	png_read_info(s->reader, s->info);
	const size_t width = png_get_image_width(s->reader, s->info), height = png_get_image_height(s->reader, s->info);
	if (too_large(width, height, pixels, fault))
		return;
	choose_rgba(s);
	if (png_get_rowbytes(s->reader, s->info) != 4 * width)
		return;
	s->rgba = malloc(4 * width * height);
	s->rows = malloc(sizeof *s->rows * height);
	if (!s->rgba || !s->rows)
		return;
	for (size_t y = 0; y < height; y++)
		s->rows[y] = s->rgba + 4 * width * y;
	png_read_image(s->reader, s->rows);
	png_read_end(s->reader, NULL);
	s->whole = true;
}

/* What it leaves is in the state, whichever way it comes back. */
static void decode_png(png_state *s, uint64_t *pixels, const char **fault)
{
	if (setjmp(png_jmpbuf(s->reader)))
		return;
	s->info = png_create_info_struct(s->reader);
	png_set_read_fn(s->reader, s, take_bytes);
	if (s->info)
		read_png_rows(s, pixels, fault);
}

static bool read_png(const uint8_t *bytes, size_t size, histogram *h, uint64_t *pixels, const char **fault)
{
	png_state s = {.next = bytes, .left = size};
	*fault = "its PNG is broken or cut off";
	s.reader = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, leave_png, ignore_warning);
	if (s.reader)
		decode_png(&s, pixels, fault);
	if (s.whole)
		s.whole = keep_size(h, png_get_image_width(s.reader, s.info), png_get_image_height(s.reader, s.info));
	if (s.whole)
		count_pixels(h, s.rgba, *pixels, 4);
	png_destroy_read_struct(&s.reader, &s.info, NULL);
	free(s.rgba);
	free(s.rows);
	return s.whole;
}

/* ---- JPEG ---- */

/* libjpeg's errors leave by a jump. */
typedef struct jpeg_state {
	struct jpeg_decompress_struct reader;
	struct jpeg_error_mgr errors;
	struct jpeg_progress_mgr progress;
	jmp_buf failed;
	uint8_t *row;  /* as it is decoded: three bytes a pixel, or four of inks */
	bool inverted; /* inks are counted from full to none, as Adobe's programs write them */
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

/* Cyan, magenta, yellow and black to red, green and blue, in place: what each ink leaves times what black leaves. */
static void mix_inks(uint8_t *row, size_t count, bool inverted)
{
	for (size_t i = 0; i < count; i++) {
		uint8_t ink[4];
		memcpy(ink, row + 4 * i, 4);
		for (int c = 0; c < 4; c++)
			ink[c] = inverted ? ink[c] : (uint8_t)(255 - ink[c]);
		for (size_t c = 0; c < 3; c++)
			row[3 * i + c] = (uint8_t)((ink[c] * ink[3] + 127) / 255);
	}
}

static void read_jpeg_rows(jpeg_state *s, histogram *h, uint64_t *pixels, const char **fault)
{
	jpeg_read_header(&s->reader, TRUE);
	if (too_large(s->reader.image_width, s->reader.image_height, pixels, fault))
		leave((j_common_ptr)&s->reader);
	const bool inks = s->reader.jpeg_color_space == JCS_CMYK || s->reader.jpeg_color_space == JCS_YCCK;
	s->reader.out_color_space = inks ? JCS_CMYK : JCS_RGB;
	s->inverted = s->reader.saw_Adobe_marker;
	jpeg_start_decompress(&s->reader);
	if (!keep_size(h, s->reader.output_width, s->reader.output_height))
		leave((j_common_ptr)&s->reader);
	s->row = malloc((size_t)s->reader.output_width * 4);
	while (s->row && s->reader.output_scanline < s->reader.output_height) {
		jpeg_read_scanlines(&s->reader, &s->row, 1);
		if (inks)
			mix_inks(s->row, s->reader.output_width, s->inverted);
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
