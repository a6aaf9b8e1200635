#include "image.h"

#include "output.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Static, so that a host with an stb of its own links; what stays unused then is no fault of this file (gcc judges
 * that at its end, so no push and pop around the headers). */
#pragma GCC diagnostic ignored "-Wunused-function"
#define STBI_ONLY_PNG
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#include <stb_image.h>
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>

/* stb's own file writer does not notice a full disk; this one lets ferror() tell. */
static void write_bytes(void *file, void *data, int size)
{
	fwrite(data, 1, (size_t)size, file);
}

static bool encode(FILE *file, int width, int height, const uint8_t *rgb)
{
	return stbi_write_png_to_func(write_bytes, file, width, height, 3, rgb, 3 * width) != 0;
}

bool engine_image_write_png(const char *path, int width, int height, const uint8_t *rgb, char *message,
			    size_t message_size)
{
	engine_output output;
	if (!engine_output_open(&output, path, message, message_size))
		return false;
	const bool encoded = encode(output.file, width, height, rgb), stored = !ferror(output.file);
	if (engine_output_close(&output, encoded, message, message_size))
		return true;
	if (!encoded && stored)
		snprintf(message, message_size, "cannot write %s: the picture is too large", path);
	return false;
}

bool engine_image_read_png(const char *path, int *width, int *height, uint8_t **rgb, char *message, size_t message_size)
{
	int channels = 0;
	*rgb = stbi_load(path, width, height, &channels, 3);
	if (*rgb)
		return true;
	snprintf(message, message_size, "cannot read %s: %s", path, stbi_failure_reason());
	return false;
}

/* Where the conversion is: pattern[begin] is '%', pattern[end - 1] is 'd'. */
typedef struct conversion {
	size_t begin, end;
	int width; /* 0 when none is given */
	bool zeros;
} conversion;

static bool find_conversion(const char *pattern, conversion *found)
{
	const char *percent = strchr(pattern, '%');
	if (!percent || strchr(percent + 1, '%'))
		return false;
	const char *c = percent + 1;
	found->zeros = *c == '0';
	c += found->zeros;
	found->width = *c >= '1' && *c <= '9' ? *c++ - '0' : 0;
	found->begin = (size_t)(percent - pattern);
	found->end = (size_t)(c - pattern) + 1;
	return *c == 'd';
}

bool engine_frame_pattern_check(const char *pattern, bool single, char *message, size_t message_size)
{
	conversion ignored;
	if ((single && *pattern && !strchr(pattern, '%')) || find_conversion(pattern, &ignored))
		return true;
	snprintf(message, message_size, "\"%s\" does not number frames; write one %%04d and no other %% into it",
		 pattern);
	return false;
}

bool engine_frame_pattern_name(const char *pattern, int frame, char *name, size_t name_size)
{
	conversion at = {.begin = strlen(pattern), .end = strlen(pattern)};
	const bool numbered = strchr(pattern, '%');
	name[0] = '\0';
	if (numbered ? !find_conversion(pattern, &at) : !*pattern)
		return false;
	const char *format = !numbered ? "%.*s" : at.zeros ? "%.*s%0*d%s" : "%.*s%*d%s";
	int length = snprintf(name, name_size, format, (int)at.begin, pattern, at.width, frame, pattern + at.end);
	if (length >= 0 && (size_t)length < name_size)
		return true;
	name[0] = '\0';
	return false;
}
