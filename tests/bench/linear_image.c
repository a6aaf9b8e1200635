#include "linear_image.h"

#include "gl.h"
#include "output.h"
#include "tonemap.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_SIDE = 16384 };

bool linear_image_create(int width, int height, linear_image *out)
{
	*out = (linear_image){.width = width, .height = height};
	out->rgb = calloc(3 * (size_t)width * (size_t)height, sizeof *out->rgb);
	return out->rgb != NULL;
}

void linear_image_free(linear_image *image)
{
	free(image->rgb);
	*image = (linear_image){0};
}

bool linear_image_write_pfm(const linear_image *image, const char *path, char *message, size_t message_size)
{
	engine_output file;
	if (!engine_output_open(&file, path, message, message_size))
		return false;
	const size_t row = 3 * (size_t)image->width;
	bool written = fprintf(file.file, "PF\n%d %d\n-1.0\n", image->width, image->height) > 0;
	for (int y = image->height - 1; written && y >= 0; y--)
		written = fwrite(image->rgb + row * (size_t)y, sizeof *image->rgb, row, file.file) == row;
	return engine_output_close(&file, written, message, message_size);
}

static bool read_rows(FILE *file, linear_image *out)
{
	double scale;
	if (fscanf(file, "PF %d %d %lf", &out->width, &out->height, &scale) != 3 || fgetc(file) == EOF || scale >= 0)
		return false;
	if (out->width < 1 || out->width > MOST_SIDE || out->height < 1 || out->height > MOST_SIDE ||
	    !linear_image_create(out->width, out->height, out))
		return false;
	const size_t row = 3 * (size_t)out->width;
	for (int y = out->height - 1; y >= 0; y--)
		if (fread(out->rgb + row * (size_t)y, sizeof *out->rgb, row, file) != row)
			return false;
	return true;
}

bool linear_image_read_pfm(const char *path, linear_image *out, char *message, size_t message_size)
{
	*out = (linear_image){0};
	FILE *file = fopen(path, "rb");
	const bool read = file && read_rows(file, out);
	if (file)
		fclose(file);
	if (!read) {
		linear_image_free(out);
		snprintf(message, message_size, "%s is no little-endian colour PFM that can be read", path);
	}
	return read;
}

/* Textures have their first row at the bottom. */
static void upload(const linear_image *image, engine_target *target)
{
	GLint texture = 0;
	glGetNamedFramebufferAttachmentParameteriv(engine_target_hdr_framebuffer(target), GL_COLOR_ATTACHMENT0,
						   GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME, &texture);
	glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	for (int y = 0; y < image->height; y++)
		glTextureSubImage2D((GLuint)texture, 0, 0, image->height - 1 - y, image->width, 1, GL_RGB, GL_FLOAT,
				    image->rgb + 3 * (size_t)image->width * (size_t)y);
}

bool linear_image_tonemap(const linear_image *image, float exposure, uint8_t *rgb, char *message, size_t message_size)
{
	engine_target *target = engine_target_create(image->width, image->height, message, message_size);
	if (!target)
		return false;
	engine_target_begin(target);
	upload(image, target);
	engine_target_tonemap(target, exposure);
	engine_target_read(target, rgb);
	engine_target_destroy(target);
	return true;
}
