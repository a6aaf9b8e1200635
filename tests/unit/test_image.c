/* PNG there and back, and frame names that cannot be turned into format string attacks. */
#define _POSIX_C_SOURCE 200809L /* mkdtemp */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "engine/image.h"
#include "engine/pfm.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void pixels_come_back(void **state)
{
	(void)state;
	enum { WIDTH = 37, HEIGHT = 23 };
	uint8_t rgb[WIDTH * HEIGHT * 3], *back = NULL;
	char folder[] = "/tmp/relume-image-XXXXXX", path[64], message[256] = "";
	int width = 0, height = 0;
	for (size_t i = 0; i < sizeof rgb; i++)
		rgb[i] = (uint8_t)(i * 7 + i / 111);
	assert_non_null(mkdtemp(folder));
	snprintf(path, sizeof path, "%s/a.png", folder);
	assert_true(engine_image_write_png(path, WIDTH, HEIGHT, rgb, message, sizeof message));
	assert_true(engine_image_read_png(path, &width, &height, &back, message, sizeof message));
	assert_int_equal(width, WIDTH);
	assert_int_equal(height, HEIGHT);
	assert_memory_equal(rgb, back, sizeof rgb);
	free(back);
	unlink(path);
	rmdir(folder);
}

static void failures_are_one_line(void **state)
{
	(void)state;
	uint8_t rgb[3] = {1, 2, 3}, *back = NULL;
	char message[256] = "";
	int width, height;
	assert_false(engine_image_write_png("/nowhere/at/all.png", 1, 1, rgb, message, sizeof message));
	assert_string_equal(message, "cannot write /nowhere/at/all.png: No such file or directory");
	assert_false(engine_image_read_png("/nowhere/at/all.png", &width, &height, &back, message, sizeof message));
	assert_non_null(strstr(message, "cannot read /nowhere/at/all.png"));
	assert_null(back);
	if (access("/dev/full", W_OK) == 0)
		assert_false(engine_image_write_png("/dev/full", 1, 1, rgb, message, sizeof message));
}

static void write_text(const char *path, const char *text, size_t size)
{
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	assert_int_equal(fwrite(text, 1, size, file), size);
	assert_int_equal(fclose(file), 0);
}

static void check_bad_pfm(const char *path, const char *text, size_t size, const char *says)
{
	char message[256] = "";
	int width, height;
	float *rgb = NULL;
	write_text(path, text, size);
	assert_false(engine_pfm_read(path, &width, &height, &rgb, message, sizeof message));
	assert_null(rgb);
	assert_non_null(strstr(message, says));
}

/* Every bit, what is not finite too; the first row of the file is the lowest; both orders of bytes. */
static void linear_pixels_come_back(void **state)
{
	(void)state;
	enum { WIDTH = 5, HEIGHT = 3, VALUES = WIDTH * HEIGHT * 3 };
	char folder[] = "/tmp/relume-image-XXXXXX", path[64], message[256] = "";
	float rgb[VALUES], *back = NULL;
	int width = 0, height = 0;
	for (int i = 0; i < VALUES; i++)
		rgb[i] = i == 7 ? HUGE_VALF : i == 8 ? -0.0f : (float)i * 1.7f - 3;
	assert_non_null(mkdtemp(folder));
	snprintf(path, sizeof path, "%s/a.pfm", folder);
	assert_true(engine_pfm_write(path, WIDTH, HEIGHT, rgb, message, sizeof message));
	assert_true(engine_pfm_read(path, &width, &height, &back, message, sizeof message));
	assert_int_equal(width, WIDTH);
	assert_int_equal(height, HEIGHT);
	assert_memory_equal(rgb, back, sizeof rgb);
	free(back);

	static const char both_rows[2][33] = {"PF\n1 2\n-1.0\n", "PF\n1 2\n1.0\n"};
	for (int big = 0; big < 2; big++) {
		char text[64];
		size_t size = strlen(both_rows[big]);
		memcpy(text, both_rows[big], size);
		for (int k = 0; k < 6; k++, size += 4) /* 0x40000000 is 2, 0x3f800000 is 1 */
			memcpy(text + size,
			       big ? (k < 3 ? "\x40\0\0\0" : "\x3f\x80\0\0") : (k < 3 ? "\0\0\0\x40" : "\0\0\x80\x3f"),
			       4);
		write_text(path, text, size);
		assert_true(engine_pfm_read(path, &width, &height, &back, message, sizeof message));
		assert_true(back[0] == 1 && back[3] == 2);
		free(back);
		check_bad_pfm(path, text, size - 1, "too early");
	}
	check_bad_pfm(path, "Pf\n1 1\n-1.0\n0000", 17, "not a colour PFM");
	check_bad_pfm(path, "PF\n0 1\n-1.0\n", 13, "not a colour PFM");
	check_bad_pfm(path, "PF\n99999 1\n-1.0\n", 17, "not a colour PFM");
	check_bad_pfm(path, "", 0, "not a colour PFM");
	unlink(path);
	assert_false(engine_pfm_read(path, &width, &height, &back, message, sizeof message));
	assert_false(engine_pfm_write("/nowhere/at/all.pfm", 1, 1, rgb, message, sizeof message));
	rmdir(folder);
}

static void check_name(const char *pattern, int frame, const char *expected)
{
	char name[64], message[256];
	assert_true(engine_frame_pattern_check(pattern, strchr(pattern, '%') == NULL, message, sizeof message));
	assert_true(engine_frame_pattern_name(pattern, frame, name, sizeof name));
	assert_string_equal(name, expected);
}

static void frames_are_numbered(void **state)
{
	(void)state;
	check_name("frame_%04d.png", 7, "frame_0007.png");
	check_name("frame_%04d.png", 123456, "frame_123456.png");
	check_name("%d", 0, "0");
	check_name("a%3d.ply", 5, "a  5.ply");
	check_name("a%0d.ply", 5, "a5.ply");
	check_name("alone.png", 0, "alone.png");
}

static void other_patterns_are_refused(void **state)
{
	(void)state;
	static const char *const bad[] = {"%s.png",  "%n",       "%d%d.png", "%04d%%.png", "%",         "%0",
					  "%*d.png", "%-4d.png", "%04x.png", "%ld.png",    "%123d.png", ""};
	char name[64], message[256];
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		message[0] = '\0';
		assert_false(engine_frame_pattern_check(bad[i], i % 2, message, sizeof message));
		assert_non_null(strstr(message, "%04d"));
		assert_false(engine_frame_pattern_name(bad[i], 1, name, sizeof name));
		assert_string_equal(name, "");
	}
	assert_false(engine_frame_pattern_check("frame.png", false, message, sizeof message));
	assert_false(engine_frame_pattern_name("frame_%04d.png", 1, name, 8));
	assert_string_equal(name, "");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(pixels_come_back),           cmocka_unit_test(linear_pixels_come_back),
	    cmocka_unit_test(failures_are_one_line),      cmocka_unit_test(frames_are_numbered),
	    cmocka_unit_test(other_patterns_are_refused),
	};
	return cmocka_run_group_tests_name("image", tests, NULL, NULL);
}
