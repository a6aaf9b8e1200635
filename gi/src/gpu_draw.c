#include "gpu_draw.h"

#include <glad/gl.h>

#include <stdint.h>
#include <stdlib.h>

/* ---- capabilities ---- */

static bool is_set(GLenum what)
{
	GLboolean value = GL_FALSE;
	glGetBooleanv(what, &value);
	return value == GL_TRUE;
}

static void set(GLenum capability, bool on)
{
	if (on)
		glEnable(capability);
	else
		glDisable(capability);
}

/* ---- meshes ---- */

static void describe_vertices(const gpu_mesh *mesh, const gpu_attribute *attributes, uint32_t vertex_bytes)
{
	glVertexArrayVertexBuffer(mesh->array, 0, mesh->vertices.name, 0, (GLsizei)vertex_bytes);
	glVertexArrayElementBuffer(mesh->array, mesh->indices.name);
	for (GLuint k = 0; attributes[k].components; k++) {
		const GLint components = (GLint)attributes[k].components;
		if (attributes[k].integer)
			glVertexArrayAttribIFormat(mesh->array, k, components, GL_UNSIGNED_INT, attributes[k].offset);
		else
			glVertexArrayAttribFormat(mesh->array, k, components, GL_FLOAT, GL_FALSE, attributes[k].offset);
		glVertexArrayAttribBinding(mesh->array, k, 0);
		glEnableVertexArrayAttrib(mesh->array, k);
	}
}

gi_result gpu_mesh_create(gpu *g, gpu_mesh *mesh, const gpu_attribute *attributes, uint32_t vertex_bytes,
			  uint64_t vertex_count, const void *vertices, uint64_t index_count, const uint32_t *indices)
{
	gpu_mesh_free(g, mesh);
	gi_result result = gpu_buffer_allocate(g, &mesh->vertices, vertex_bytes * vertex_count, vertices);
	if (!result)
		result = gpu_buffer_allocate(g, &mesh->indices, sizeof *indices * index_count, indices);
	if (result) {
		gpu_mesh_free(g, mesh);
		return result;
	}
	glCreateVertexArrays(1, &mesh->array);
	describe_vertices(mesh, attributes, vertex_bytes);
	mesh->index_count = index_count;
	return GI_OK;
}

void gpu_mesh_free(gpu *g, gpu_mesh *mesh)
{
	if (mesh->array && !g->lost)
		glDeleteVertexArrays(1, &mesh->array);
	gpu_buffer_free(g, &mesh->vertices);
	gpu_buffer_free(g, &mesh->indices);
	*mesh = (gpu_mesh){0};
}

static void draw(const gpu_mesh *mesh, uint32_t program, GLenum primitive, gpu_range range)
{
	if (!range.count)
		return;
	glUseProgram(program);
	glBindVertexArray(mesh->array);
	const uintptr_t offset = sizeof(uint32_t) * (uintptr_t)range.first;
	glDrawElements(primitive, (GLsizei)range.count, GL_UNSIGNED_INT, (const void *)offset);
}

void gpu_mesh_draw(const gpu_mesh *mesh, uint32_t program)
{
	draw(mesh, program, GL_TRIANGLES, (gpu_range){0, (uint32_t)mesh->index_count});
}

void gpu_mesh_draw_lines(const gpu_mesh *mesh, uint32_t program)
{
	draw(mesh, program, GL_LINES, (gpu_range){0, (uint32_t)mesh->index_count});
}

void gpu_mesh_draw_ranges(const gpu_mesh *mesh, uint32_t program, const gpu_range *ranges, uint32_t count)
{
	for (uint32_t k = 0; k < count; k++)
		draw(mesh, program, GL_TRIANGLES, ranges[k]);
}

/* ---- depth maps ---- */

gi_result gpu_depth_maps_create(gpu *g, gpu_depth_maps *maps, uint32_t size, uint32_t layers)
{
	if (maps->texture && maps->size == size && maps->layers == layers)
		return GI_OK;
	gpu_depth_maps_free(g, maps);
	if (!layers)
		return GI_OK;
	while (glGetError() != GL_NO_ERROR)
		;
	glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &maps->texture);
	glTextureStorage3D(maps->texture, 1, GL_DEPTH_COMPONENT32F, (GLsizei)size, (GLsizei)size, (GLsizei)layers);
	if (glGetError() != GL_NO_ERROR) {
		gpu_depth_maps_free(g, maps);
		return gi_fail(&g->log, GI_ERROR_OUT_OF_MEMORY, "no GPU memory for %u shadow maps", layers);
	}
	glTextureParameteri(maps->texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	glTextureParameteri(maps->texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glTextureParameteri(maps->texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glTextureParameteri(maps->texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	glTextureParameteri(maps->texture, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
	glTextureParameteri(maps->texture, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
	glCreateSamplers(1, &maps->plain_sampler);
	glSamplerParameteri(maps->plain_sampler, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glSamplerParameteri(maps->plain_sampler, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	glSamplerParameteri(maps->plain_sampler, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glSamplerParameteri(maps->plain_sampler, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	glCreateFramebuffers(1, &maps->framebuffer);
	glNamedFramebufferDrawBuffer(maps->framebuffer, GL_NONE);
	glNamedFramebufferReadBuffer(maps->framebuffer, GL_NONE);
	maps->size = size;
	maps->layers = layers;
	maps->bytes = sizeof(float) * (uint64_t)size * size * layers;
	g->buffer_bytes += maps->bytes;
	return GI_OK;
}

void gpu_depth_maps_free(gpu *g, gpu_depth_maps *maps)
{
	if (maps->texture && !g->lost)
		glDeleteTextures(1, &maps->texture);
	if (maps->plain_sampler && !g->lost)
		glDeleteSamplers(1, &maps->plain_sampler);
	if (maps->framebuffer && !g->lost)
		glDeleteFramebuffers(1, &maps->framebuffer);
	g->buffer_bytes -= maps->bytes;
	*maps = (gpu_depth_maps){0};
}

void gpu_depth_maps_begin_layer(const gpu_depth_maps *maps, uint32_t layer, bool border)
{
	const GLfloat farthest = 1.0f;
	const GLsizei inside = (GLsizei)maps->size - 2;
	glNamedFramebufferTextureLayer(maps->framebuffer, GL_DEPTH_ATTACHMENT, maps->texture, 0, (GLint)layer);
	glBindFramebuffer(GL_DRAW_FRAMEBUFFER, maps->framebuffer);
	glDisable(GL_SCISSOR_TEST);
	glClearBufferfv(GL_DEPTH, 0, &farthest);
	glViewport(0, 0, (GLsizei)maps->size, (GLsizei)maps->size);
	glScissor(1, 1, inside, inside);
	set(GL_SCISSOR_TEST, border);
}

void gpu_depth_maps_bind(const gpu_depth_maps *maps, uint32_t unit)
{
	glBindTextureUnit(unit, maps->texture);
	glBindSampler(unit, 0);
	glBindTextureUnit(unit + 1, maps->texture);
	glBindSampler(unit + 1, maps->plain_sampler);
}

/* ---- targets ---- */

static GLuint make_texture(GLenum format, const gpu_target *t)
{
	GLuint texture = 0;
	glCreateTextures(GL_TEXTURE_2D, 1, &texture);
	glTextureStorage2D(texture, 1, format, (GLsizei)t->width, (GLsizei)t->height);
	glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	return texture;
}

static void attach_textures(gpu_target *t, const gpu_format formats[2], bool depth)
{
	static const GLenum internal[] = {GL_NONE, GL_RGBA32F, GL_RGBA32UI};
	const GLenum attached[2] = {GL_COLOR_ATTACHMENT0, formats[1] ? GL_COLOR_ATTACHMENT1 : GL_NONE};
	const uint64_t pixels = (uint64_t)t->width * t->height;
	glCreateFramebuffers(1, &t->framebuffer);
	for (GLuint k = 0; k < 2 && formats[k]; k++) {
		t->color[k] = make_texture(internal[formats[k]], t);
		glNamedFramebufferTexture(t->framebuffer, attached[k], t->color[k], 0);
		t->bytes += 4 * sizeof(float) * pixels;
	}
	glNamedFramebufferDrawBuffers(t->framebuffer, 2, attached);
	if (!depth)
		return;
	t->depth = make_texture(GL_DEPTH_COMPONENT32F, t);
	glNamedFramebufferTexture(t->framebuffer, GL_DEPTH_ATTACHMENT, t->depth, 0);
	t->bytes += sizeof(float) * pixels;
}

gi_result gpu_target_create(gpu *g, gpu_target *t, const gpu_format formats[2], bool depth, uint32_t width,
			    uint32_t height)
{
	if (t->framebuffer && t->width == width && t->height == height)
		return GI_OK;
	gpu_target_free(g, t);
	while (glGetError() != GL_NO_ERROR)
		;
	t->width = width;
	t->height = height;
	attach_textures(t, formats, depth);
	g->buffer_bytes += t->bytes;
	if (glGetError() == GL_NO_ERROR &&
	    glCheckNamedFramebufferStatus(t->framebuffer, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE)
		return GI_OK;
	gpu_target_free(g, t);
	return gi_fail(&g->log, GI_ERROR_OUT_OF_MEMORY, "no GPU memory for a picture of %u x %u", width, height);
}

void gpu_target_free(gpu *g, gpu_target *t)
{
	const GLuint textures[3] = {t->color[0], t->color[1], t->depth};
	if (!g->lost) {
		glDeleteTextures(3, textures); /* 0 is ignored */
		glDeleteFramebuffers(1, &t->framebuffer);
	}
	g->buffer_bytes -= t->bytes;
	*t = (gpu_target){0};
}

void gpu_target_begin(const gpu_target *t)
{
	static const GLfloat farthest = 1;
	glBindFramebuffer(GL_DRAW_FRAMEBUFFER, t->framebuffer);
	glViewport(0, 0, (GLsizei)t->width, (GLsizei)t->height);
	if (t->depth)
		glClearBufferfv(GL_DEPTH, 0, &farthest);
}

void gpu_bind_texture(uint32_t unit, uint32_t texture)
{
	glBindTextureUnit(unit, texture);
	glBindSampler(unit, 0);
}

/* ---- state ---- */

void gpu_draw_begin(gpu_draw_state *s)
{
	GLboolean mask[4];
	glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &s->draw_framebuffer);
	glGetIntegerv(GL_SCISSOR_BOX, s->scissor_box);
	glGetIntegerv(GL_VIEWPORT, s->viewport);
	glGetIntegerv(GL_DEPTH_FUNC, &s->depth_function);
	static const GLenum blend[4] = {GL_BLEND_SRC_RGB, GL_BLEND_DST_RGB, GL_BLEND_SRC_ALPHA, GL_BLEND_DST_ALPHA};
	for (int k = 0; k < 4; k++)
		glGetIntegerv(blend[k], &s->blend_function[k]);
	glGetBooleanv(GL_COLOR_WRITEMASK, mask);
	for (int k = 0; k < 4; k++)
		s->color_mask[k] = mask[k] == GL_TRUE;
	s->scissor = is_set(GL_SCISSOR_TEST);
	s->blend = is_set(GL_BLEND);
	s->depth_mask = is_set(GL_DEPTH_WRITEMASK);
	s->polygon_offset_fill = is_set(GL_POLYGON_OFFSET_FILL);
	s->clamp = is_set(GL_DEPTH_CLAMP);
	for (GLenum k = 0; k < GPU_CLIP_DISTANCES; k++)
		s->clip[k] = is_set(GL_CLIP_DISTANCE0 + k);
	gpu_draw_clip(false);
	glDisable(GL_BLEND);
	glDisable(GL_SCISSOR_TEST);
	glDisable(GL_POLYGON_OFFSET_FILL);
	glDisable(GL_DEPTH_CLAMP);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LESS);
	glDepthMask(GL_TRUE);
	glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
	glCullFace(GL_BACK);
	glFrontFace(GL_CCW);
	glEnable(GL_CULL_FACE);
}

void gpu_draw_end(const gpu_draw_state *s)
{
	glBindSampler(1, 0);
	glBindFramebuffer(GL_DRAW_FRAMEBUFFER, (GLuint)s->draw_framebuffer);
	glScissor(s->scissor_box[0], s->scissor_box[1], s->scissor_box[2], s->scissor_box[3]);
	set(GL_SCISSOR_TEST, s->scissor);
	set(GL_BLEND, s->blend);
	glBlendFuncSeparate((GLenum)s->blend_function[0], (GLenum)s->blend_function[1], (GLenum)s->blend_function[2],
			    (GLenum)s->blend_function[3]);
	set(GL_POLYGON_OFFSET_FILL, s->polygon_offset_fill);
	set(GL_DEPTH_CLAMP, s->clamp);
	for (GLenum k = 0; k < GPU_CLIP_DISTANCES; k++)
		set(GL_CLIP_DISTANCE0 + k, s->clip[k]);
	glDepthFunc((GLenum)s->depth_function);
	glDepthMask(s->depth_mask);
	glColorMask(s->color_mask[0], s->color_mask[1], s->color_mask[2], s->color_mask[3]);
}

void gpu_draw_to_host(const gpu_draw_state *s, uint32_t width, uint32_t height)
{
	glBindFramebuffer(GL_DRAW_FRAMEBUFFER, (GLuint)s->draw_framebuffer);
	glDisable(GL_SCISSOR_TEST);
	glViewport(s->viewport[0], s->viewport[1], (GLsizei)width, (GLsizei)height);
}

void gpu_draw_cull(gpu_cull cull)
{
	set(GL_CULL_FACE, cull != GPU_CULL_NONE);
	glFrontFace(cull == GPU_CULL_MIRRORED_BACKS ? GL_CW : GL_CCW);
}

void gpu_draw_scissor(const int lower[2], const int upper[2])
{
	glEnable(GL_SCISSOR_TEST);
	glScissor(lower[0], lower[1], upper[0] - lower[0], upper[1] - lower[1]);
}

void gpu_draw_unscissored(void)
{
	glDisable(GL_SCISSOR_TEST);
}

void gpu_draw_clip(bool clip)
{
	for (GLenum k = 0; k < GPU_CLIP_DISTANCES; k++)
		set(GL_CLIP_DISTANCE0 + k, clip);
}

void gpu_draw_multiplied(bool on)
{
	set(GL_BLEND, on);
	glBlendFunc(on ? GL_ZERO : GL_ONE, on ? GL_SRC_COLOR : GL_ZERO);
	glDepthFunc(on ? GL_LEQUAL : GL_LESS);
	glDepthMask(!on);
}

void gpu_draw_added(bool on)
{
	set(GL_BLEND, on);
	glBlendFunc(GL_ONE, on ? GL_ONE : GL_ZERO);
	set(GL_DEPTH_TEST, !on);
}

void gpu_bind_uniform_range(uint32_t binding, const gpu_buffer *buffer, uint64_t offset, uint64_t bytes)
{
	glBindBufferRange(GL_UNIFORM_BUFFER, binding, buffer->name, (GLintptr)offset, (GLsizeiptr)bytes);
}

void gpu_set_corner(uint32_t program, int location, const int corner[2])
{
	glProgramUniform2i(program, location, corner[0], corner[1]);
}
