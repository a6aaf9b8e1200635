#include "target.h"

#include <glad/gl.h>

#include <stdlib.h>
#include <string.h>

target target_make(uint32_t size)
{
	const GLsizei side = (GLsizei)size;
	target t = {.size = size};
	glCreateTextures(GL_TEXTURE_2D, 1, &t.colour);
	glTextureStorage2D(t.colour, 1, GL_RGBA32F, side, side);
	glCreateRenderbuffers(1, &t.depth);
	glNamedRenderbufferStorage(t.depth, GL_DEPTH_COMPONENT32F, side, side);
	glCreateFramebuffers(1, &t.framebuffer);
	glNamedFramebufferTexture(t.framebuffer, GL_COLOR_ATTACHMENT0, t.colour, 0);
	glNamedFramebufferRenderbuffer(t.framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, t.depth);
	t.pixels = calloc((size_t)size * size, 4 * sizeof *t.pixels);
	assert_non_null(t.pixels);
	return t;
}

void target_free(target *t)
{
	glDeleteFramebuffers(1, &t->framebuffer);
	glDeleteTextures(1, &t->colour);
	glDeleteRenderbuffers(1, &t->depth);
	free(t->pixels);
}

gi_result target_try(target *t, gi_context *gi, gi_view view)
{
	static const float black[4] = {0}, far = 1;
	view.width = view.height = t->size;
	glBindFramebuffer(GL_FRAMEBUFFER, t->framebuffer);
	glViewport(0, 0, (GLsizei)t->size, (GLsizei)t->size);
	glDepthMask(GL_TRUE);
	glClearBufferfv(GL_COLOR, 0, black);
	glClearBufferfv(GL_DEPTH, 0, &far);
	const gi_result result = gi_draw(gi, &view);
	const GLsizei bytes = (GLsizei)(4 * sizeof(float) * t->size * t->size);
	if (!result)
		glGetTextureImage(t->colour, 0, GL_RGBA, GL_FLOAT, bytes, t->pixels);
	return result;
}

void target_draw(target *t, gi_context *gi, gi_view view)
{
	GLint bound = 0;
	if (target_try(t, gi, view))
		fail_msg("gi_draw: %s", harness_last_message());
	glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
	assert_int_equal(bound, t->framebuffer);
	assert_int_equal(glGetError(), GL_NO_ERROR);
}

gi_view target_look_down(uint32_t size)
{
	gi_view view = gi_view_default();
	const float world[16] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1};
	const float clip[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -.1f, 0, 0, 0, 0, 1};
	memcpy(view.view_from_world, world, sizeof world);
	memcpy(view.clip_from_view, clip, sizeof clip);
	view.width = view.height = size;
	return view;
}
