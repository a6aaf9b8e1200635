#include "gpu_draw.h"

#include <gi_gl.h>

#include <stdint.h>

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

gi_result gpu_mesh_create(gpu *g, gpu_mesh *mesh, const char *label, const gpu_attribute *attributes,
			  uint32_t vertex_bytes, uint64_t vertex_count, const void *vertices, uint64_t index_count,
			  const uint32_t *indices)
{
	gpu_mesh_free(g, mesh);
	gi_result result = gpu_buffer_allocate(g, &mesh->vertices, label, vertex_bytes * vertex_count, vertices);
	if (!result)
		result = gpu_buffer_allocate(g, &mesh->indices, label, sizeof *indices * index_count, indices);
	if (result) {
		gpu_mesh_free(g, mesh);
		return result;
	}
	g->gl->CreateVertexArrays(1, &mesh->array);
	gpu_label(g, GL_VERTEX_ARRAY, mesh->array, label);
	describe_vertices(g, mesh, attributes, vertex_bytes);
	mesh->index_count = index_count;
	return GI_OK;
}

void gpu_mesh_add_floats(const gpu *g, const gpu_mesh *mesh, uint32_t location, uint32_t components,
			 const gpu_buffer *buffer)
{
	g->gl->VertexArrayVertexBuffer(mesh->array, 1, buffer->name, 0, (GLsizei)(sizeof(float) * components));
	g->gl->VertexArrayAttribFormat(mesh->array, location, (GLint)components, GL_FLOAT, GL_FALSE, 0);
	g->gl->VertexArrayAttribBinding(mesh->array, location, 1);
	g->gl->EnableVertexArrayAttrib(mesh->array, location);
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

void gpu_mesh_draw_instances(const gpu *g, const gpu_mesh *mesh, uint32_t program, uint32_t count)
{
	g->gl->UseProgram(program);
	g->gl->BindVertexArray(mesh->array);
	g->gl->DrawElementsInstanced(GL_TRIANGLES, (GLsizei)mesh->index_count, GL_UNSIGNED_INT, NULL, (GLsizei)count);
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

/* Was there memory for it? Asked of the texture, for errors may be the host's. */
static bool has_storage(const gpu *g, GLuint texture)
{
	GLint width = 0;
	g->gl->GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_WIDTH, &width);
	return width > 0;
}

/* ---- depth maps ---- */

gi_result gpu_depth_maps_create(gpu *g, gpu_depth_maps *maps, uint32_t size, uint32_t layers)
{
	if (maps->texture && maps->size == size && maps->layers == layers)
		return GI_OK;
	gpu_depth_maps_free(g, maps);
	if (!layers)
		return GI_OK;
	g->gl->CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &maps->texture);
	gpu_label(g, GL_TEXTURE, maps->texture, "shadow maps");
	g->gl->TextureStorage3D(maps->texture, 1, GL_DEPTH_COMPONENT32F, (GLsizei)size, (GLsizei)size, (GLsizei)layers);
	if (!has_storage(g, maps->texture)) {
		gpu_depth_maps_free(g, maps);
		gpu_forget_errors(g);
		return gi_fail(&g->log, GI_ERROR_OUT_OF_MEMORY, "no GPU memory for %u shadow maps", layers);
	}
	g->gl->TextureParameteri(maps->texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	g->gl->TextureParameteri(maps->texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	g->gl->TextureParameteri(maps->texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	g->gl->TextureParameteri(maps->texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	g->gl->TextureParameteri(maps->texture, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
	g->gl->TextureParameteri(maps->texture, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
	g->gl->CreateSamplers(1, &maps->plain_sampler);
	gpu_label(g, GL_SAMPLER, maps->plain_sampler, "shadow maps' depths");
	g->gl->SamplerParameteri(maps->plain_sampler, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	g->gl->SamplerParameteri(maps->plain_sampler, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	g->gl->SamplerParameteri(maps->plain_sampler, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	g->gl->SamplerParameteri(maps->plain_sampler, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	g->gl->CreateFramebuffers(1, &maps->framebuffer);
	gpu_label(g, GL_FRAMEBUFFER, maps->framebuffer, "shadow maps");
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
	gpu_draw_unscissored(g);
	g->gl->ClearBufferfv(GL_DEPTH, 0, &farthest);
	g->gl->ViewportIndexedf(0, 0, 0, (float)maps->size, (float)maps->size);
	if (border)
		gpu_draw_scissor(g, (const int[]){1, 1}, (const int[]){1 + inside, 1 + inside});
}

void gpu_depth_maps_bind(const gpu *g, const gpu_depth_maps *maps, uint32_t unit)
{
	g->gl->BindTextureUnit(unit, maps->texture);
	g->gl->BindSampler(unit, 0);
	g->gl->BindTextureUnit(unit + 1, maps->texture);
	g->gl->BindSampler(unit + 1, maps->plain_sampler);
}

/* ---- targets ---- */

static GLuint make_texture(const gpu *g, const char *label, GLenum format, const gpu_target *t)
{
	GLuint texture = 0;
	g->gl->CreateTextures(GL_TEXTURE_2D, 1, &texture);
	gpu_label(g, GL_TEXTURE, texture, label);
	g->gl->TextureStorage2D(texture, 1, format, (GLsizei)t->width, (GLsizei)t->height);
	g->gl->TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	g->gl->TextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	return texture;
}

static void attach_textures(const gpu *g, gpu_target *t, const char *label, const gpu_format formats[GPU_TARGET_COLORS],
			    bool depth)
{
	static const GLenum internal[] = {GL_NONE, GL_RGBA32F, GL_RGBA32UI};
	GLenum attached[GPU_TARGET_COLORS] = {GL_NONE};
	const uint64_t pixels = (uint64_t)t->width * t->height;
	g->gl->CreateFramebuffers(1, &t->framebuffer);
	gpu_label(g, GL_FRAMEBUFFER, t->framebuffer, label);
	for (GLuint k = 0; k < GPU_TARGET_COLORS && formats[k]; k++) {
		attached[k] = GL_COLOR_ATTACHMENT0 + k;
		t->color[k] = make_texture(g, label, internal[formats[k]], t);
		g->gl->NamedFramebufferTexture(t->framebuffer, attached[k], t->color[k], 0);
		t->bytes += 4 * sizeof(float) * pixels;
	}
	g->gl->NamedFramebufferDrawBuffers(t->framebuffer, GPU_TARGET_COLORS, attached);
	if (!depth)
		return;
	t->depth = make_texture(g, label, GL_DEPTH_COMPONENT32F, t);
	g->gl->NamedFramebufferTexture(t->framebuffer, GL_DEPTH_ATTACHMENT, t->depth, 0);
	t->bytes += sizeof(float) * pixels;
}

static bool has_colors(const gpu_target *t, const gpu_format formats[GPU_TARGET_COLORS])
{
	bool same = true;
	for (int k = 0; k < GPU_TARGET_COLORS; k++)
		same = same && (t->color[k] != 0) == (formats[k] != GPU_FORMAT_NONE);
	return same;
}

gi_result gpu_target_create(gpu *g, gpu_target *t, const char *label, const gpu_format formats[GPU_TARGET_COLORS],
			    bool depth, uint32_t width, uint32_t height)
{
	if (t->framebuffer && t->width == width && t->height == height && has_colors(t, formats))
		return GI_OK;
	gpu_target_free(g, t);
	t->width = width;
	t->height = height;
	attach_textures(g, t, label, formats, depth);
	g->buffer_bytes += t->bytes;
	/* A texture without memory makes it incomplete. */
	if (g->gl->CheckNamedFramebufferStatus(t->framebuffer, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE)
		return GI_OK;
	gpu_target_free(g, t);
	gpu_forget_errors(g);
	return gi_fail(&g->log, GI_ERROR_OUT_OF_MEMORY, "no GPU memory for a picture of %u x %u", width, height);
}

void gpu_target_free(gpu *g, gpu_target *t)
{
	if (!g->lost) {
		g->gl->DeleteTextures(GPU_TARGET_COLORS, t->color); /* 0 is ignored */
		g->gl->DeleteTextures(1, &t->depth);
		g->gl->DeleteFramebuffers(1, &t->framebuffer);
	}
	g->buffer_bytes -= t->bytes;
	*t = (gpu_target){0};
}

void gpu_target_clear(const gpu *g, const gpu_target *t)
{
	static const GLfloat black[4];
	g->gl->ClearNamedFramebufferfv(t->framebuffer, GL_COLOR, 0, black);
}

void gpu_bind_texture(const gpu *g, uint32_t unit, uint32_t texture)
{
	g->gl->BindTextureUnit(unit, texture);
	g->gl->BindSampler(unit, 0);
}

void gpu_bind_host_texture(const gpu *g, uint32_t unit, uint32_t texture, uint32_t sampler)
{
	g->gl->BindTextureUnit(unit, texture);
	g->gl->BindSampler(unit, sampler);
}

bool gpu_is_host_texture(const gpu *g, uint32_t name)
{
	GLint target = 0;
	if (!g->gl->IsTexture(name))
		return false;
	g->gl->GetTextureParameteriv(name, GL_TEXTURE_TARGET, &target);
	return target == GL_TEXTURE_2D;
}

bool gpu_is_host_sampler(const gpu *g, uint32_t name)
{
	return g->gl->IsSampler(name) == GL_TRUE;
}

void gpu_bind_uniform_range(const gpu *g, uint32_t binding, const gpu_buffer *buffer, uint64_t offset, uint64_t bytes)
{
	const GLintptr first = (GLintptr)offset;
	const GLsizeiptr size = (GLsizeiptr)bytes;
	g->gl->BindBuffersRange(GL_UNIFORM_BUFFER, binding, 1, &buffer->name, &first, &size);
}

void gpu_set_corner(const gpu *g, uint32_t program, int location, const int corner[2])
{
	g->gl->ProgramUniform2i(program, location, corner[0], corner[1]);
}
