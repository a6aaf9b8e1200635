#include "hdr.h"

#include "pfm.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PIXELS = 32768 }; /* a side */
enum { MOST_HEADER_LINES = 1000, LINE = 512 };
enum { SHORTEST_RLE = 8, LONGEST_RLE = 0x7fff }; /* rows of other lengths are not encoded channel by channel */

static const float MOST_RADIANCE = 3e11f;

typedef struct hdr_reader {
	FILE *file;
	int width, height;
	double exposure; /* what values were multiplied with */
	const char *fault;
} hdr_reader;

static bool fail(hdr_reader *r, const char *fault)
{
	r->fault = fault;
	return false;
}

/* ---- header ---- */

/* Takes in one line of the header; blank: it was the last. */
static bool read_line(hdr_reader *r, bool *blank)
{
	char line[LINE], format[32];
	double value;
	if (!fgets(line, sizeof line, r->file))
		return fail(r, "its header is cut off");
	*blank = line[0] == '\n' || line[0] == '\r';
	if (sscanf(line, "FORMAT=%31s", format) == 1 && strcmp(format, "32-bit_rle_rgbe") != 0)
		return fail(r, "its pixels are not of FORMAT=32-bit_rle_rgbe");
	if (sscanf(line, "EXPOSURE=%lf", &value) == 1 && value > 0 && isfinite(value))
		r->exposure *= value;
	return true;
}

static bool read_header(hdr_reader *r)
{
	char line[LINE], start[2] = {0};
	bool blank = false;
	if (fread(start, 1, 2, r->file) != 2 || memcmp(start, "#?", 2) != 0)
		return fail(r, "it is no Radiance picture");
	for (int k = 0; k < MOST_HEADER_LINES && !blank; k++)
		if (!read_line(r, &blank))
			return false;
	if (!blank || !fgets(line, sizeof line, r->file) || sscanf(line, "-Y %6d +X %6d", &r->height, &r->width) != 2)
		return fail(r, "its size is not given as -Y rows +X columns");
	if (r->width < 1 || r->height < 1 || r->width > MOST_PIXELS || r->height > MOST_PIXELS)
		return fail(r, "its sides are not 1 to 32768 pixels");
	return true;
}

/* ---- rows ---- */

static bool read_bytes(hdr_reader *r, uint8_t *out, size_t count)
{
	return fread(out, 1, count, r->file) == count || fail(r, "it ends too early");
}

/* One channel of a row: runs of one byte, and bytes as they are. */
static bool read_channel(hdr_reader *r, uint8_t *row, int channel)
{
	for (int x = 0; x < r->width;) {
		uint8_t head[2];
		if (!read_bytes(r, head, 2))
			return false;
		const bool run = head[0] > 128;
		const int count = run ? head[0] - 128 : head[0];
		if (count == 0 || count > r->width - x)
			return fail(r, "a run of pixels is longer than its row");
		for (int k = 0; k < count; k++) {
			row[4 * (x + k) + channel] = head[1];
			if (!run && k + 1 < count && !read_bytes(r, head + 1, 1))
				return false;
		}
		x += count;
	}
	return true;
}

/* Pixels one by one; 1 1 1 n stands for n more of the one before, 1 1 1 n 1 1 1 m for n + 256 m. */
static bool read_plain(hdr_reader *r, uint8_t *row, const uint8_t first[4])
{
	int shift = 0;
	for (int x = 0; x < r->width;) {
		uint8_t p[4];
		if (x == 0 && shift == 0)
			memcpy(p, first, 4);
		else if (!read_bytes(r, p, 4))
			return false;
		if (p[0] != 1 || p[1] != 1 || p[2] != 1) {
			memcpy(row + 4 * x++, p, 4);
			shift = 0;
			continue;
		}
		const int count = shift < 24 ? p[3] << shift : MOST_PIXELS;
		if (x == 0 || count > r->width - x)
			return fail(r, "a run of pixels is longer than its row");
		for (int k = 0; k < count; k++)
			memcpy(row + 4 * (x + k), row + 4 * (x - 1), 4);
		x += count;
		shift += 8;
	}
	return true;
}

static bool read_row(hdr_reader *r, uint8_t *row)
{
	uint8_t first[4];
	if (!read_bytes(r, first, 4))
		return false;
	const bool encoded = r->width >= SHORTEST_RLE && r->width <= LONGEST_RLE && first[0] == 2 && first[1] == 2 &&
			     (first[2] << 8 | first[3]) == r->width;
	if (!encoded)
		return read_plain(r, row, first);
	bool read = true;
	for (int channel = 0; channel < 4 && read; channel++)
		read = read_channel(r, row, channel);
	return read;
}

static void decode_row(const hdr_reader *r, const uint8_t *row, float *out)
{
	for (int x = 0; x < r->width; x++)
		for (int c = 0; c < 3; c++) {
			const double value = row[4 * x + 3] ? ldexp(row[4 * x + c], row[4 * x + 3] - 136) : 0;
			out[3 * x + c] = (float)(value / r->exposure);
		}
}

static float *read_pixels(hdr_reader *r)
{
	const size_t width = (size_t)r->width;
	uint8_t *row = malloc(4 * width);
	float *rgb = NULL;
	bool read = row || fail(r, "there is no memory for it");
	for (int y = 0, room = 0; y < r->height && read; y++) {
		if (y == room) {
			room = room ? (room < r->height / 2 ? 2 * room : r->height) : 1;
			float *grown = realloc(rgb, 3 * sizeof *rgb * width * (size_t)room);
			read = grown || fail(r, "there is no memory for it");
			rgb = grown ? grown : rgb;
		}
		read = read && read_row(r, row);
		if (read)
			decode_row(r, row, rgb + 3 * width * (size_t)y);
	}
	free(row);
	if (read)
		return rgb;
	free(rgb);
	return NULL;
}

bool engine_hdr_read(const char *path, int *width, int *height, float **rgb, char *message, size_t message_size)
{
	hdr_reader r = {.file = fopen(path, "rb"), .exposure = 1};
	*rgb = NULL;
	if (!r.file) {
		snprintf(message, message_size, "cannot read %s: %s", path, strerror(errno));
		return false;
	}
	if (read_header(&r))
		*rgb = read_pixels(&r);
	if (!*rgb)
		snprintf(message, message_size, "cannot read %s: %s", path, r.fault);
	*width = r.width;
	*height = r.height;
	fclose(r.file);
	return *rgb != NULL;
}

/* ---- either format ---- */

static bool is_pfm(const char *path)
{
	FILE *file = fopen(path, "rb");
	const bool pfm = file && fgetc(file) == 'P' && fgetc(file) == 'F';
	if (file)
		fclose(file);
	return pfm;
}

static bool mend(float pixel[3])
{
	bool mended = false;
	for (int c = 0; c < 3; c++) {
		const float value = pixel[c] > 0 ? fminf(pixel[c], MOST_RADIANCE) : 0;
		mended = mended || !(value == pixel[c]);
		pixel[c] = value;
	}
	return mended;
}

bool engine_panorama_read(const char *path, int *width, int *height, float **rgb, size_t *mended, char *message,
			  size_t message_size)
{
	const bool read = is_pfm(path) ? engine_pfm_read(path, width, height, rgb, message, message_size)
				       : engine_hdr_read(path, width, height, rgb, message, message_size);
	*mended = 0;
	for (size_t k = 0; read && k < (size_t)*width * (size_t)*height; k++)
		*mended += mend(*rgb + 3 * k);
	return read;
}
