#include "backdrop.h"
#include "gl.h"

#include <cglm/cglm.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char vertex_source[] =
#include "shaders/backdrop.vert.inc"
    ;
static const char fragment_source[] =
#include "shaders/backdrop.frag.inc"
    ;

struct engine_backdrop {
	GLuint program, texture, vertex_array;
};

static GLuint create_texture(const float *rgb, int width, int height)
{
	GLuint texture = 0;
	glCreateTextures(GL_TEXTURE_2D, 1, &texture);
	glTextureStorage2D(texture, 1, GL_RGB32F, width, height);
	glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_REPEAT);
	glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	glTextureSubImage2D(texture, 0, 0, 0, width, height, GL_RGB, GL_FLOAT, rgb);
	return texture;
}

engine_backdrop *engine_backdrop_create(const float *rgb, int width, int height, char *message, size_t message_size)
{
	GLint most = 0;
	glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
	engine_backdrop *b = width <= most && height <= most ? calloc(1, sizeof *b) : NULL;
	if (!b) {
		snprintf(message, message_size, "no memory for a sky of %d x %d, or it is larger than the driver's %d",
			 width, height, most);
		return NULL;
	}
	b->program = engine_gl_program("backdrop", vertex_source, fragment_source, message, message_size);
	if (!b->program) {
		free(b);
		return NULL;
	}
	b->texture = create_texture(rgb, width, height);
	glCreateVertexArrays(1, &b->vertex_array);
	return b;
}

void engine_backdrop_destroy(engine_backdrop *b)
{
	if (!b)
		return;
	glDeleteProgram(b->program);
	glDeleteTextures(1, &b->texture);
	glDeleteVertexArrays(1, &b->vertex_array);
	free(b);
}

void engine_backdrop_draw(const engine_backdrop *b, const float view_from_world[16], const float clip_from_view[16])
{
	/* Directions alone: where the camera is does not matter. */
	mat4 view, clip, both;
	memcpy(view, view_from_world, sizeof view);
	memcpy(clip, clip_from_view, sizeof clip);
	for (int c = 0; c < 3; c++)
		view[3][c] = 0;
	glm_mat4_mul(clip, view, both);
	glm_mat4_inv(both, both);
	glDisable(GL_BLEND);
	glDisable(GL_CULL_FACE);
	glDisable(GL_FRAMEBUFFER_SRGB);
	glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LEQUAL);
	glDepthMask(GL_FALSE);
	glUseProgram(b->program);
	glProgramUniformMatrix4fv(b->program, 0, 1, GL_FALSE, both[0]);
	glBindTextureUnit(0, b->texture);
	glBindVertexArray(b->vertex_array);
	glDrawArrays(GL_TRIANGLES, 0, 3);
	glDepthMask(GL_TRUE);
	glDepthFunc(GL_LESS);
	glDisable(GL_DEPTH_TEST);
}
