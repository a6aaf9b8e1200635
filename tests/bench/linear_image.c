#include "linear_image.h"

#include "gl.h"
#include "tonemap.h"

#include <stdlib.h>

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
