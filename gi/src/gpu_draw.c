#include "gpu_draw.h"

#include <gi_gl.h>

#include <stdint.h>
#include <stdlib.h>

/* ---- capabilities ---- */

static bool is_set(const gpu *g, GLenum what)
{
	GLboolean value = GL_FALSE;
	g->gl->GetBooleanv(what, &value);
	return value == GL_TRUE;
}

static void set(const gpu *g, GLenum capability, bool on)
{
	if (on)
		g->gl->Enable(capability);
	else
		g->gl->Disable(capability);
}

/* ---- meshes ---- */

static void describe_vertices(const gpu *g, const gpu_mesh *mesh, const gpu_attribute *attributes,
			      uint32_t vertex_bytes)
{
	g->gl->VertexArrayVertexBuffer(mesh->array, 0, mesh->vertices.name, 0, (GLsizei)vertex_bytes);
	g->gl->VertexArrayElementBuffer(mesh->array, mesh->indices.name);
	for (GLuint k = 0; attributes[k].components; k++) {
		const GLint components = (GLint)attributes[k].components;
		if (attributes[k].integer)
			g->gl->VertexArrayAttribIFormat(mesh->array, k, components, GL_UNSIGNED_INT,
							attributes[k].offset);
		else
			g->gl->VertexArrayAttribFormat(mesh->array, k, components, GL_FLOAT, GL_FALSE,
						       attributes[k].offset);
		g->gl->VertexArrayAttribBinding(mesh->array, k, 0);
		g->gl->EnableVertexArrayAttrib(mesh->array, k);
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
	g->gl->CreateVertexArrays(1, &mesh->array);
	describe_vertices(g, mesh, attributes, vertex_bytes);
	mesh->index_count = index_count;
	return GI_OK;
}

void gpu_mesh_free(gpu *g, gpu_mesh *mesh)
{
	if (mesh->array && !g->lost)
		g->gl->DeleteVertexArrays(1, &mesh->array);
	gpu_buffer_free(g, &mesh->vertices);
	gpu_buffer_free(g, &mesh->indices);
	*mesh = (gpu_mesh){0};
}

static void draw(const gpu *g, const gpu_mesh *mesh, uint32_t program, GLenum primitive, gpu_range range)
{
	if (!range.count)
		return;
	g->gl->UseProgram(program);
	g->gl->BindVertexArray(mesh->array);
	const uintptr_t offset = sizeof(uint32_t) * (uintptr_t)range.first;
	g->gl->DrawElements(primitive, (GLsizei)range.count, GL_UNSIGNED_INT, (const void *)offset);
}

void gpu_mesh_draw(const gpu *g, const gpu_mesh *mesh, uint32_t program)
{
	draw(g, mesh, program, GL_TRIANGLES, (gpu_range){0, (uint32_t)mesh->index_count});
}

void gpu_mesh_draw_lines(const gpu *g, const gpu_mesh *mesh, uint32_t program)
{
	draw(g, mesh, program, GL_LINES, (gpu_range){0, (uint32_t)mesh->index_count});
}

void gpu_mesh_draw_ranges(const gpu *g, const gpu_mesh *mesh, uint32_t program, const gpu_range *ranges, uint32_t count)
{
	for (uint32_t k = 0; k < count; k++)
		draw(g, mesh, program, GL_TRIANGLES, ranges[k]);
}

/* ---- depth maps ---- */

gi_result gpu_depth_maps_create(gpu *g, gpu_depth_maps *maps, uint32_t size, uint32_t layers)
{
	if (maps->texture && maps->size == size && maps->layers == layers)
		return GI_OK;
	gpu_depth_maps_free(g, maps);
	if (!layers)
		return GI_OK;
	while (g->gl->GetError() != GL_NO_ERROR)
		;
	g->gl->CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &maps->texture);
	g->gl->TextureStorage3D(maps->texture, 1, GL_DEPTH_COMPONENT32F, (GLsizei)size, (GLsizei)size, (GLsizei)layers);
	if (g->gl->GetError() != GL_NO_ERROR) {
		gpu_depth_maps_free(g, maps);
		return gi_fail(&g->log, GI_ERROR_OUT_OF_MEMORY, "no GPU memory for %u shadow maps", layers);
	}
	g->gl->TextureParameteri(maps->texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	g->gl->TextureParameteri(maps->texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	g->gl->TextureParameteri(maps->texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	g->gl->TextureParameteri(maps->texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	g->gl->TextureParameteri(maps->texture, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
	g->gl->TextureParameteri(maps->texture, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
	g->gl->CreateSamplers(1, &maps->plain_sampler);
	g->gl->SamplerParameteri(maps->plain_sampler, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	g->gl->SamplerParameteri(maps->plain_sampler, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	g->gl->SamplerParameteri(maps->plain_sampler, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	g->gl->SamplerParameteri(maps->plain_sampler, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	g->gl->CreateFramebuffers(1, &maps->framebuffer);
	g->gl->NamedFramebufferDrawBuffer(maps->framebuffer, GL_NONE);
	g->gl->NamedFramebufferReadBuffer(maps->framebuffer, GL_NONE);
	maps->size = size;
	maps->layers = layers;
	maps->bytes = sizeof(float) * (uint64_t)size * size * layers;
	g->buffer_bytes += maps->bytes;
	return GI_OK;
}

void gpu_depth_maps_free(gpu *g, gpu_depth_maps *maps)
{
	if (maps->texture && !g->lost)
		g->gl->DeleteTextures(1, &maps->texture);
	if (maps->plain_sampler && !g->lost)
		g->gl->DeleteSamplers(1, &maps->plain_sampler);
	if (maps->framebuffer && !g->lost)
		g->gl->DeleteFramebuffers(1, &maps->framebuffer);
	g->buffer_bytes -= maps->bytes;
	*maps = (gpu_depth_maps){0};
}

void gpu_depth_maps_begin_layer(const gpu *g, const gpu_depth_maps *maps, uint32_t layer, bool border)
{
	const GLfloat farthest = 1.0f;
	const GLsizei inside = (GLsizei)maps->size - 2;
	g->gl->NamedFramebufferTextureLayer(maps->framebuffer, GL_DEPTH_ATTACHMENT, maps->texture, 0, (GLint)layer);
	g->gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, maps->framebuffer);
	g->gl->Disable(GL_SCISSOR_TEST);
	g->gl->ClearBufferfv(GL_DEPTH, 0, &farthest);
	g->gl->Viewport(0, 0, (GLsizei)maps->size, (GLsizei)maps->size);
	g->gl->Scissor(1, 1, inside, inside);
	set(g, GL_SCISSOR_TEST, border);
}

void gpu_depth_maps_bind(const gpu *g, const gpu_depth_maps *maps, uint32_t unit)
{
	g->gl->BindTextureUnit(unit, maps->texture);
	g->gl->BindSampler(unit, 0);
	g->gl->BindTextureUnit(unit + 1, maps->texture);
	g->gl->BindSampler(unit + 1, maps->plain_sampler);
}

/* ---- targets ---- */

static GLuint make_texture(const gpu *g, GLenum format, const gpu_target *t)
{
	GLuint texture = 0;
	g->gl->CreateTextures(GL_TEXTURE_2D, 1, &texture);
	g->gl->TextureStorage2D(texture, 1, format, (GLsizei)t->width, (GLsizei)t->height);
	g->gl->TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	g->gl->TextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	return texture;
}

static void attach_textures(const gpu *g, gpu_target *t, const gpu_format formats[2], bool depth)
{
	static const GLenum internal[] = {GL_NONE, GL_RGBA32F, GL_RGBA32UI};
	const GLenum attached[2] = {GL_COLOR_ATTACHMENT0, formats[1] ? GL_COLOR_ATTACHMENT1 : GL_NONE};
	const uint64_t pixels = (uint64_t)t->width * t->height;
	g->gl->CreateFramebuffers(1, &t->framebuffer);
	for (GLuint k = 0; k < 2 && formats[k]; k++) {
		t->color[k] = make_texture(g, internal[formats[k]], t);
		g->gl->NamedFramebufferTexture(t->framebuffer, attached[k], t->color[k], 0);
		t->bytes += 4 * sizeof(float) * pixels;
	}
	g->gl->NamedFramebufferDrawBuffers(t->framebuffer, 2, attached);
	if (!depth)
		return;
	t->depth = make_texture(g, GL_DEPTH_COMPONENT32F, t);
	g->gl->NamedFramebufferTexture(t->framebuffer, GL_DEPTH_ATTACHMENT, t->depth, 0);
	t->bytes += sizeof(float) * pixels;
}

gi_result gpu_target_create(gpu *g, gpu_target *t, const gpu_format formats[2], bool depth, uint32_t width,
			    uint32_t height)
{
	if (t->framebuffer && t->width == width && t->height == height)
		return GI_OK;
	gpu_target_free(g, t);
	while (g->gl->GetError() != GL_NO_ERROR)
		;
	t->width = width;
	t->height = height;
	attach_textures(g, t, formats, depth);
	g->buffer_bytes += t->bytes;
	if (g->gl->GetError() == GL_NO_ERROR &&
	    g->gl->CheckNamedFramebufferStatus(t->framebuffer, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE)
		return GI_OK;
	gpu_target_free(g, t);
	return gi_fail(&g->log, GI_ERROR_OUT_OF_MEMORY, "no GPU memory for a picture of %u x %u", width, height);
}

void gpu_target_free(gpu *g, gpu_target *t)
{
	const GLuint textures[3] = {t->color[0], t->color[1], t->depth};
	if (!g->lost) {
		g->gl->DeleteTextures(3, textures); /* 0 is ignored */
		g->gl->DeleteFramebuffers(1, &t->framebuffer);
	}
	g->buffer_bytes -= t->bytes;
	*t = (gpu_target){0};
}

void gpu_target_begin(const gpu *g, const gpu_target *t)
{
	static const GLfloat farthest = 1;
	g->gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, t->framebuffer);
	g->gl->Viewport(0, 0, (GLsizei)t->width, (GLsizei)t->height);
	if (t->depth)
		g->gl->ClearBufferfv(GL_DEPTH, 0, &farthest);
}

void gpu_bind_texture(const gpu *g, uint32_t unit, uint32_t texture)
{
	g->gl->BindTextureUnit(unit, texture);
	g->gl->BindSampler(unit, 0);
}

/* ---- state ---- */

void gpu_draw_begin(const gpu *g, gpu_draw_state *s)
{
	GLboolean mask[4];
	g->gl->GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &s->draw_framebuffer);
	g->gl->GetIntegerv(GL_SCISSOR_BOX, s->scissor_box);
	g->gl->GetIntegerv(GL_VIEWPORT, s->viewport);
	g->gl->GetIntegerv(GL_DEPTH_FUNC, &s->depth_function);
	static const GLenum blend[4] = {GL_BLEND_SRC_RGB, GL_BLEND_DST_RGB, GL_BLEND_SRC_ALPHA, GL_BLEND_DST_ALPHA};
	for (int k = 0; k < 4; k++)
		g->gl->GetIntegerv(blend[k], &s->blend_function[k]);
	g->gl->GetBooleanv(GL_COLOR_WRITEMASK, mask);
	for (int k = 0; k < 4; k++)
		s->color_mask[k] = mask[k] == GL_TRUE;
	s->scissor = is_set(g, GL_SCISSOR_TEST);
	s->blend = is_set(g, GL_BLEND);
	s->depth_mask = is_set(g, GL_DEPTH_WRITEMASK);
	s->polygon_offset_fill = is_set(g, GL_POLYGON_OFFSET_FILL);
	s->clamp = is_set(g, GL_DEPTH_CLAMP);
	for (GLenum k = 0; k < GPU_CLIP_DISTANCES; k++)
		s->clip[k] = is_set(g, GL_CLIP_DISTANCE0 + k);
	gpu_draw_clip(g, false);
	g->gl->Disable(GL_BLEND);
	g->gl->Disable(GL_SCISSOR_TEST);
	g->gl->Disable(GL_POLYGON_OFFSET_FILL);
	g->gl->Disable(GL_DEPTH_CLAMP);
	g->gl->Enable(GL_DEPTH_TEST);
	g->gl->DepthFunc(GL_LESS);
	g->gl->DepthMask(GL_TRUE);
	g->gl->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
	g->gl->CullFace(GL_BACK);
	g->gl->FrontFace(GL_CCW);
	g->gl->Enable(GL_CULL_FACE);
}

void gpu_draw_end(const gpu *g, const gpu_draw_state *s)
{
	g->gl->BindSampler(1, 0);
	g->gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, (GLuint)s->draw_framebuffer);
	g->gl->Scissor(s->scissor_box[0], s->scissor_box[1], s->scissor_box[2], s->scissor_box[3]);
	set(g, GL_SCISSOR_TEST, s->scissor);
	set(g, GL_BLEND, s->blend);
	g->gl->BlendFuncSeparate((GLenum)s->blend_function[0], (GLenum)s->blend_function[1],
				 (GLenum)s->blend_function[2], (GLenum)s->blend_function[3]);
	set(g, GL_POLYGON_OFFSET_FILL, s->polygon_offset_fill);
	set(g, GL_DEPTH_CLAMP, s->clamp);
	for (GLenum k = 0; k < GPU_CLIP_DISTANCES; k++)
		set(g, GL_CLIP_DISTANCE0 + k, s->clip[k]);
	g->gl->DepthFunc((GLenum)s->depth_function);
	g->gl->DepthMask(s->depth_mask);
	g->gl->ColorMask(s->color_mask[0], s->color_mask[1], s->color_mask[2], s->color_mask[3]);
}

void gpu_draw_to_host(const gpu *g, const gpu_draw_state *s, uint32_t width, uint32_t height)
{
	g->gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, (GLuint)s->draw_framebuffer);
	g->gl->Disable(GL_SCISSOR_TEST);
	g->gl->Viewport(s->viewport[0], s->viewport[1], (GLsizei)width, (GLsizei)height);
}

void gpu_draw_cull(const gpu *g, gpu_cull cull)
{
	set(g, GL_CULL_FACE, cull != GPU_CULL_NONE);
	g->gl->FrontFace(cull == GPU_CULL_MIRRORED_BACKS ? GL_CW : GL_CCW);
}

void gpu_draw_scissor(const gpu *g, const int lower[2], const int upper[2])
{
	g->gl->Enable(GL_SCISSOR_TEST);
	g->gl->Scissor(lower[0], lower[1], upper[0] - lower[0], upper[1] - lower[1]);
}

void gpu_draw_unscissored(const gpu *g)
{
	g->gl->Disable(GL_SCISSOR_TEST);
}

void gpu_draw_clip(const gpu *g, bool clip)
{
	for (GLenum k = 0; k < GPU_CLIP_DISTANCES; k++)
		set(g, GL_CLIP_DISTANCE0 + k, clip);
}

void gpu_draw_multiplied(const gpu *g, bool on)
{
	set(g, GL_BLEND, on);
	g->gl->BlendFunc(on ? GL_ZERO : GL_ONE, on ? GL_SRC_COLOR : GL_ZERO);
	g->gl->DepthFunc(on ? GL_LEQUAL : GL_LESS);
	g->gl->DepthMask(!on);
}

void gpu_draw_added(const gpu *g, bool on)
{
	set(g, GL_BLEND, on);
	g->gl->BlendFunc(GL_ONE, on ? GL_ONE : GL_ZERO);
	set(g, GL_DEPTH_TEST, !on);
}

void gpu_bind_uniform_range(const gpu *g, uint32_t binding, const gpu_buffer *buffer, uint64_t offset, uint64_t bytes)
{
	g->gl->BindBufferRange(GL_UNIFORM_BUFFER, binding, buffer->name, (GLintptr)offset, (GLsizeiptr)bytes);
}

void gpu_set_corner(const gpu *g, uint32_t program, int location, const int corner[2])
{
	g->gl->ProgramUniform2i(program, location, corner[0], corner[1]);
}
