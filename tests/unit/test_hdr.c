/* Radiance pictures: what was written is read, and nothing else is. */
#include "hdr.h"
#include "pfm.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char PATH[] = "test_hdr.hdr";

typedef struct file {
	uint8_t bytes[1 << 16];
	size_t size;
} file;

static void put(file *f, const void *bytes, size_t size)
{
	assert_true(f->size + size <= sizeof f->bytes);
	memcpy(f->bytes + f->size, bytes, size);
	f->size += size;
}

static void put_text(file *f, const char *text)
{
	put(f, text, strlen(text));
}

static void write_file(const file *f, size_t size)
{
	FILE *out = fopen(PATH, "wb");
	assert_non_null(out);
	assert_int_equal(fwrite(f->bytes, 1, size, out), size);
	assert_int_equal(fclose(out), 0);
}

/* A pixel of the test picture, as the file has it. */
static void pixel_of(int x, int y, uint8_t out[4])
{
	const int step = x / 5; /* runs of five */
	out[0] = (uint8_t)(128 + (step * 7 + y) % 128);
	out[1] = (uint8_t)(step * 3 + y);
	out[2] = (uint8_t)(x + y);
	out[3] = (uint8_t)(x == 3 ? 0 : 120 + (x + y) % 20);
}

enum { WIDTH = 37, HEIGHT = 11 };

/* Runs where three or more are alike. */
static void put_channel(file *f, int y, int channel)
{
	uint8_t row[WIDTH];
	for (int x = 0; x < WIDTH; x++) {
		uint8_t p[4];
		pixel_of(x, y, p);
		row[x] = p[channel];
	}
	for (int x = 0; x < WIDTH;) {
		int alike = 1, plain = 0;
		while (x + alike < WIDTH && row[x + alike] == row[x])
			alike++;
		if (alike >= 3) {
			put(f, (uint8_t[]){(uint8_t)(128 + alike), row[x]}, 2);
			x += alike;
			continue;
		}
		while (x + plain < WIDTH && !(x + plain + 2 < WIDTH && row[x + plain] == row[x + plain + 1] &&
					      row[x + plain] == row[x + plain + 2]))
			plain++;
		put(f, (uint8_t[]){(uint8_t)plain}, 1);
		put(f, row + x, (size_t)plain);
		x += plain;
	}
}

static void put_picture(file *f, bool encoded, const char *header)
{
	put_text(f, header);
	for (int y = 0; y < HEIGHT; y++) {
		if (encoded)
			put(f, (uint8_t[]){2, 2, 0, WIDTH}, 4);
		for (int channel = 0; channel < 4 && encoded; channel++)
			put_channel(f, y, channel);
		for (int x = 0; x < WIDTH && !encoded; x++) {
			uint8_t p[4];
			pixel_of(x, y, p);
			put(f, p, 4);
		}
	}
}

static void expect_picture(double exposure)
{
	int width, height;
	float *rgb;
	char message[256];
	if (!engine_hdr_read(PATH, &width, &height, &rgb, message, sizeof message))
		fail_msg("%s", message);
	assert_true(width == WIDTH && height == HEIGHT);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			uint8_t p[4];
			pixel_of(x, y, p);
			for (int c = 0; c < 3; c++) {
				const double wanted = p[3] ? p[c] / 256.0 * pow(2, p[3] - 128) / exposure : 0;
				const double value = (double)rgb[3 * (y * WIDTH + x) + c];
				assert_true(fabs(value - wanted) <= 1e-6 * wanted);
			}
		}
	free(rgb);
}

static void is_read(void **state)
{
	(void)state;
	static file f;
	for (int encoded = 0; encoded < 2; encoded++) {
		f.size = 0;
		put_picture(&f, encoded, "#?RADIANCE\n# a comment\nFORMAT=32-bit_rle_rgbe\n\n-Y 11 +X 37\n");
		write_file(&f, f.size);
		expect_picture(1);
		f.size = 0;
		put_picture(&f, encoded, "#?RGBE\nEXPOSURE=2\nEXPOSURE= 4\nFORMAT=32-bit_rle_rgbe\n\n-Y 11 +X 37\n");
		write_file(&f, f.size);
		expect_picture(8);
	}
}

/* 1 1 1 n: n more of the pixel before. */
static void old_runs(void **state)
{
	(void)state;
	static file f;
	int width, height;
	float *rgb;
	char message[256];
	f.size = 0;
	put_text(&f, "#?RADIANCE\n\n-Y 1 +X 300\n");
	put(&f, (uint8_t[]){128, 64, 32, 129, 1, 1, 1, 42, 1, 1, 1, 1, 200, 0, 0, 129}, 16);
	write_file(&f, f.size);
	assert_true(engine_hdr_read(PATH, &width, &height, &rgb, message, sizeof message));
	for (int x = 0; x < 299; x++)
		assert_true(rgb[3 * x] == 1 && rgb[3 * x + 1] == .5f && rgb[3 * x + 2] == .25f);
	assert_true(rgb[3 * 299] == 200 / 128.0f && rgb[3 * 299 + 1] == 0);
	free(rgb);
}

static void expect_refused(const char *text, const void *pixels, size_t size)
{
	static file f;
	int width, height;
	float *rgb;
	char message[256] = "";
	f.size = 0;
	put_text(&f, text);
	put(&f, pixels, size);
	write_file(&f, f.size);
	assert_false(engine_hdr_read(PATH, &width, &height, &rgb, message, sizeof message));
	assert_true(!rgb && message[0]);
}

static void is_refused(void **state)
{
	(void)state;
	static const uint8_t none[1], run[] = {1, 1, 1, 3}, beyond[] = {2, 2, 0, 8, 128 + 9, 5},
				      zero[] = {2, 2, 0, 8, 0, 5};
	static const uint8_t twice[] = {9, 9, 9, 130, 1, 1, 1, 255, 1, 1, 1, 255, 1, 1, 1, 255, 1, 1, 1, 255};
	expect_refused("", none, 0);
	expect_refused("P6\n", none, 0);
	expect_refused("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", run, 4);
	expect_refused("#?RADIANCE\n\n+Y 1 +X 1\n", run, 4);
	expect_refused("#?RADIANCE\n\n-Y 0 +X 1\n", run, 4);
	expect_refused("#?RADIANCE\n\n-Y 40000 +X 1\n", run, 4);
	expect_refused("#?RADIANCE\n\n-Y 32768 +X 32768\n", none, 0);
	expect_refused("#?RADIANCE\n\n-Y 1 +X 8\n", run, sizeof run);
	expect_refused("#?RADIANCE\n\n-Y 1 +X 8\n", beyond, sizeof beyond);
	expect_refused("#?RADIANCE\n\n-Y 1 +X 8\n", zero, sizeof zero);
	expect_refused("#?RADIANCE\n\n-Y 1 +X 300\n", twice, sizeof twice);
}

/* Cut off anywhere. */
static void cut_off(void **state)
{
	(void)state;
	static file f;
	f.size = 0;
	put_picture(&f, true, "#?RADIANCE\n\n-Y 11 +X 37\n");
	for (size_t size = 0; size < f.size; size += 7) {
		int width, height;
		float *rgb;
		char message[256];
		write_file(&f, size);
		assert_false(engine_hdr_read(PATH, &width, &height, &rgb, message, sizeof message));
		assert_null(rgb);
	}
}

/* By its first bytes; what is no radiance is mended and counted. */
static void either(void **state)
{
	(void)state;
	int width, height;
	size_t mended;
	float *rgb;
	char message[256];
	const float pixels[] = {1, 2, 3, -1, 5, 6, NAN, 8, INFINITY, 10, 11, 12};
	assert_true(engine_pfm_write(PATH, 2, 2, pixels, message, sizeof message));
	assert_true(engine_panorama_read(PATH, &width, &height, &rgb, &mended, message, sizeof message));
	const float wanted[] = {1, 2, 3, 0, 5, 6, 0, 8, 3e11f, 10, 11, 12};
	assert_true(width == 2 && height == 2 && mended == 2);
	assert_memory_equal(rgb, wanted, sizeof wanted);
	free(rgb);
	static file f;
	f.size = 0;
	put_picture(&f, true, "#?RADIANCE\n\n-Y 11 +X 37\n");
	write_file(&f, f.size);
	assert_true(engine_panorama_read(PATH, &width, &height, &rgb, &mended, message, sizeof message));
	assert_true(width == WIDTH && mended == 0);
	free(rgb);
	remove(PATH);
	assert_false(engine_panorama_read(PATH, &width, &height, &rgb, &mended, message, sizeof message));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(is_read), cmocka_unit_test(old_runs), cmocka_unit_test(is_refused),
	    cmocka_unit_test(cut_off), cmocka_unit_test(either),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
