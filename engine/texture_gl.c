#include "texture_gl.h"

#include "gl.h"

static GLsizei level_count(uint32_t width, uint32_t height)
{
	GLsizei count = 1;
	for (uint32_t size = width > height ? width : height; size > 1; size /= 2)
		count++;
	return count;
}

static bool has_storage(GLuint texture)
{
	GLint width = 0;
	glGetTextureLevelParameteriv(texture, 0, GL_TEXTURE_WIDTH, &width);
	return width > 0;
}

uint32_t engine_texture_upload(const engine_texture *t)
{
	const GLsizei width = (GLsizei)t->pixels.width, height = (GLsizei)t->pixels.height;
	GLint most = 0;
	GLuint texture = 0;
	glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
	if (!t->pixels.rgba || width < 1 || height < 1 || width > most || height > most)
		return 0;
	glCreateTextures(GL_TEXTURE_2D, 1, &texture);
	glTextureStorage2D(texture, level_count(t->pixels.width, t->pixels.height), GL_SRGB8_ALPHA8, width, height);
	if (!has_storage(texture)) {
		while (glGetError() != GL_NO_ERROR)
			;
		glDeleteTextures(1, &texture);
		return 0;
	}
	glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	glTextureSubImage2D(texture, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, t->pixels.rgba);
	glGenerateTextureMipmap(texture);
	return texture;
}

uint32_t engine_texture_sampler(const engine_wrap wrap[2])
{
	static const GLint modes[] = {[ENGINE_WRAP_REPEAT] = GL_REPEAT,
				      [ENGINE_WRAP_CLAMP] = GL_CLAMP_TO_EDGE,
				      [ENGINE_WRAP_MIRROR] = GL_MIRRORED_REPEAT};
	GLuint sampler = 0;
	glCreateSamplers(1, &sampler);
	glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
	glSamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glSamplerParameteri(sampler, GL_TEXTURE_WRAP_S, modes[wrap[0]]);
	glSamplerParameteri(sampler, GL_TEXTURE_WRAP_T, modes[wrap[1]]);
	return sampler;
}
