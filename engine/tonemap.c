#include "tonemap.h"
#include "gl.h"

#include <stdio.h>
#include <stdlib.h>

/* Shader files, made string literals by the build. */
static const char vertex_source[] =
#include "shaders/tonemap.vert.inc"
    ;
static const char fragment_source[] =
#include "shaders/tonemap.frag.inc"
    ;

/* Everything that depends on the size. */
typedef struct surfaces {
	GLuint radiance, depth, picture; /* textures: RGBA16F, DEPTH32F, RGBA8 */
	GLuint hdr_framebuffer, picture_framebuffer;
	int width, height;
} surfaces;

struct engine_target {
	surfaces surfaces;
	GLuint program;
	GLuint vertex_array; /* empty; core profiles draw nothing without one */
};

static GLuint create_texture(GLenum format, int width, int height)
{
	GLuint texture = 0;
	glCreateTextures(GL_TEXTURE_2D, 1, &texture);
	glTextureStorage2D(texture, 1, format, width, height);
	glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	return texture;
}

static void destroy_surfaces(surfaces *s)
{
	const GLuint textures[3] = {s->radiance, s->depth, s->picture};
	const GLuint framebuffers[2] = {s->hdr_framebuffer, s->picture_framebuffer};
	glDeleteTextures(3, textures); /* 0 is ignored */
	glDeleteFramebuffers(2, framebuffers);
	*s = (surfaces){0};
}

static bool is_complete(GLuint framebuffer)
{
	return glCheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

static bool create_surfaces(surfaces *s, int width, int height, char *message, size_t message_size)
{
	*s = (surfaces){.width = width, .height = height};
	s->radiance = create_texture(GL_RGBA16F, width, height);
	s->depth = create_texture(GL_DEPTH_COMPONENT32F, width, height);
	s->picture = create_texture(GL_RGBA8, width, height);
	glCreateFramebuffers(1, &s->hdr_framebuffer);
	glNamedFramebufferTexture(s->hdr_framebuffer, GL_COLOR_ATTACHMENT0, s->radiance, 0);
	glNamedFramebufferTexture(s->hdr_framebuffer, GL_DEPTH_ATTACHMENT, s->depth, 0);
	glCreateFramebuffers(1, &s->picture_framebuffer);
	glNamedFramebufferTexture(s->picture_framebuffer, GL_COLOR_ATTACHMENT0, s->picture, 0);
	if (is_complete(s->hdr_framebuffer) && is_complete(s->picture_framebuffer))
		return true;
	snprintf(message, message_size, "the driver has no framebuffer of %d x %d; use a smaller picture", width,
		 height);
	destroy_surfaces(s);
	return false;
}

engine_target *engine_target_create(int width, int height, char *message, size_t message_size)
{
	engine_target *target = calloc(1, sizeof *target);
	if (!target) {
		snprintf(message, message_size, "out of memory for a render target");
		return NULL;
	}
	glCreateVertexArrays(1, &target->vertex_array);
	target->program = engine_gl_program("tonemap", vertex_source, fragment_source, message, message_size);
	if (target->program && create_surfaces(&target->surfaces, width, height, message, message_size))
		return target;
	engine_target_destroy(target);
	return NULL;
}

void engine_target_destroy(engine_target *target)
{
	if (!target)
		return;
	destroy_surfaces(&target->surfaces);
	glDeleteProgram(target->program);
	glDeleteVertexArrays(1, &target->vertex_array);
	free(target);
}

bool engine_target_resize(engine_target *target, int width, int height, char *message, size_t message_size)
{
	if (target->surfaces.width == width && target->surfaces.height == height)
		return true;
	surfaces fresh;
	if (!create_surfaces(&fresh, width, height, message, message_size))
		return false;
	destroy_surfaces(&target->surfaces);
	target->surfaces = fresh;
	return true;
}

int engine_target_width(const engine_target *target)
{
	return target->surfaces.width;
}

int engine_target_height(const engine_target *target)
{
	return target->surfaces.height;
}

void engine_target_begin(engine_target *target)
{
	static const GLfloat black[4] = {0, 0, 0, 1}, far_depth = 1;
	const surfaces *s = &target->surfaces;
	glBindFramebuffer(GL_FRAMEBUFFER, s->hdr_framebuffer);
	glViewport(0, 0, s->width, s->height);
	glDepthMask(GL_TRUE); /* clears obey the masks */
	glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
	glDisable(GL_SCISSOR_TEST);
	glClearNamedFramebufferfv(s->hdr_framebuffer, GL_COLOR, 0, black);
	glClearNamedFramebufferfv(s->hdr_framebuffer, GL_DEPTH, 0, &far_depth);
}

void engine_target_tonemap(engine_target *target, float exposure)
{
	const surfaces *s = &target->surfaces;
	glBindFramebuffer(GL_FRAMEBUFFER, s->picture_framebuffer);
	glViewport(0, 0, s->width, s->height);
	glDisable(GL_DEPTH_TEST);
	glDisable(GL_BLEND);
	glDisable(GL_CULL_FACE);
	glDisable(GL_FRAMEBUFFER_SRGB); /* the shader encodes */
	glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
	glUseProgram(target->program);
	glProgramUniform1f(target->program, 0, exposure);
	glBindTextureUnit(0, s->radiance);
	glBindVertexArray(target->vertex_array);
	glDrawArrays(GL_TRIANGLES, 0, 3);
}

/* GL's first row is the bottom one. */
static void flip_rows(void *pixels, size_t row_bytes, int height)
{
	uint8_t *rgb = pixels;
	for (int top = 0, bottom = height - 1; top < bottom; top++, bottom--) {
		uint8_t *a = rgb + (size_t)top * row_bytes, *b = rgb + (size_t)bottom * row_bytes;
		for (size_t i = 0; i < row_bytes; i++) {
			uint8_t kept = a[i];
			a[i] = b[i];
			b[i] = kept;
		}
	}
}

static void read_texture(GLuint texture, GLenum type, size_t row_bytes, int height, void *pixels)
{
	glPixelStorei(GL_PACK_ALIGNMENT, 1);
	glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
	glGetTextureImage(texture, 0, GL_RGB, type, (GLsizei)(row_bytes * (size_t)height), pixels);
	glPixelStorei(GL_PACK_ALIGNMENT, 4);
	flip_rows(pixels, row_bytes, height);
}

void engine_target_read(engine_target *target, uint8_t *rgb)
{
	const surfaces *s = &target->surfaces;
	read_texture(s->picture, GL_UNSIGNED_BYTE, 3 * (size_t)s->width, s->height, rgb);
}

void engine_target_read_radiance(engine_target *target, float *rgb)
{
	const surfaces *s = &target->surfaces;
	read_texture(s->radiance, GL_FLOAT, 3 * sizeof *rgb * (size_t)s->width, s->height, rgb);
}

void engine_target_present(engine_target *target, int window_width, int window_height)
{
	const surfaces *s = &target->surfaces;
	if (window_width <= 0 || window_height <= 0)
		return;
	bool same = window_width == s->width && window_height == s->height;
	glBindFramebuffer(GL_FRAMEBUFFER, 0);
	glBlitNamedFramebuffer(s->picture_framebuffer, 0, 0, 0, s->width, s->height, 0, 0, window_width, window_height,
			       GL_COLOR_BUFFER_BIT, same ? GL_NEAREST : GL_LINEAR);
}

unsigned engine_target_hdr_framebuffer(const engine_target *target)
{
	return target->surfaces.hdr_framebuffer;
}
