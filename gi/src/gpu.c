#include "gpu.h"

#include "buffers.h"
#include "clock.h"
#include "host_memory.h"

#include <gi_gl.h>

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { TEXEL_BYTES = 16, MARK_LABEL = 48 };

/* ---- start ---- */

/* What the shaders of gi take of a device. OpenGL promises less of the first two, and as much of the others. */
static gi_result check_limits(gpu *g)
{
	static const struct {
		GLenum name;
		int least;
		const char *what;
	} needs[] = {
	    {GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, GPU_BINDINGS, "storage buffer bindings"},
	    {GL_MAX_TEXTURE_BUFFER_SIZE, 1 << 22, "texels in a buffer texture"},
	    {GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, 8, "storage blocks in a compute shader"},
	    {GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS, 16, "textures in a compute shader"},
	    {GL_MAX_VERTEX_TEXTURE_IMAGE_UNITS, 16, "textures in a vertex shader"},
	};
	for (size_t k = 0; k < sizeof needs / sizeof *needs; k++) {
		GLint has = 0;
		g->gl->GetIntegerv(needs[k].name, &has);
		if (has < needs[k].least)
			return gi_fail(&g->log, GI_ERROR_NO_OPENGL_45,
				       "this device has %d %s and %d are needed: update its driver or use another", has,
				       needs[k].what, needs[k].least);
	}
	GLint viewport[2] = {0}, texture = 0;
	g->gl->GetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
	g->gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
	const GLint side = viewport[0] < viewport[1] ? viewport[0] : viewport[1];
	g->most_pixels = (uint32_t)(side < texture ? side : texture);
	GLint64 bytes = 0, texels = 0;
	g->gl->GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
	g->gl->GetInteger64v(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
	g->texture_bytes = (uint64_t)(TEXEL_BYTES * texels);
	const uint64_t whole = (uint64_t)bytes / TEXEL_BYTES * TEXEL_BYTES; /* NVIDIA promises a byte less than 2 GiB */
	g->block_bytes = whole < g->texture_bytes ? whole : g->texture_bytes;
	return GI_OK;
}

/* Names of vertex arrays are a context's own, even where contexts share objects, and nobody else writes this label. */
static int mark_label(const gpu *g, char label[MARK_LABEL])
{
	return snprintf(label, MARK_LABEL, "gi context %p", (const void *)g);
}

static void mark_context(gpu *g)
{
	char label[MARK_LABEL];
	g->gl->CreateVertexArrays(1, &g->mark);
	g->gl->ObjectLabel(GL_VERTEX_ARRAY, g->mark, mark_label(g, label), label);
}

bool gpu_is_current(const gpu *g)
{
	char label[MARK_LABEL], found[MARK_LABEL] = "";
	/* Without a current context OpenGL's functions do nothing and return 0. */
	if (!g->gl->GetString(GL_VERSION) || !g->gl->IsVertexArray(g->mark))
		return false;
	g->gl->GetObjectLabel(GL_VERTEX_ARRAY, g->mark, sizeof found, NULL, found);
	mark_label(g, label);
	return strcmp(label, found) == 0;
}

gi_result gpu_check_current(const gpu *g, const char *function)
{
	if (gpu_is_current(g))
		return GI_OK;
	return gi_fail(&g->log, GI_ERROR_WRONG_CONTEXT,
		       "%s: make the OpenGL context current on this thread that was current in gi_context_create",
		       function);
}

void gpu_close(gpu *g)
{
	if (g->mark && !g->lost)
		g->gl->DeleteVertexArrays(1, &g->mark);
	gpu_free_functions(g);
	gi_free(g->shader_directory);
	gi_free(g->programs);
	*g = (gpu){0};
}

gi_result gpu_init(gpu *g, gi_get_proc_address_fn *get_proc_address, void *user)
{
	gi_result result = gpu_load_functions(g, get_proc_address, user);
	if (!result)
		result = check_limits(g);
	if (result)
		return result;
	mark_context(g);
	snprintf(g->renderer, sizeof g->renderer, "%s", (const char *)g->gl->GetString(GL_RENDERER));
	static const char *const software[] = {"llvmpipe", "softpipe", "SWR"};
	for (size_t k = 0; k < sizeof software / sizeof *software; k++)
		g->software = g->software || strstr(g->renderer, software[k]);
	/* 64 threads fill a wavefront or two warps; software renderers take any multiple of their vectors. */
	g->group_size = 64;
	return GI_OK;
}

/* ---- buffers ---- */

/* Every buffer can be read as a texture of four words a texel (buffers.glsl). */
static void make_texture(const gpu *g, gpu_buffer *buffer, const char *label)
{
	g->gl->CreateTextures(GL_TEXTURE_BUFFER, 1, &buffer->texture);
	g->gl->TextureBuffer(buffer->texture, GL_RGBA32UI, buffer->name);
	gpu_label(g, GL_BUFFER, buffer->name, label);
	gpu_label(g, GL_TEXTURE, buffer->texture, label);
}

/* Where a deleted buffer was bound by index, Mesa (22.3) empties the general binding too, which is the host's. */
static void delete_buffer(const gpu *g, GLuint name)
{
	static const GLenum targets[2] = {GL_SHADER_STORAGE_BUFFER, GL_UNIFORM_BUFFER},
			    bindings[2] = {GL_SHADER_STORAGE_BUFFER_BINDING, GL_UNIFORM_BUFFER_BINDING};
	GLint before[2] = {0}, after = 0;
	for (int k = 0; k < 2; k++)
		g->gl->GetIntegerv(bindings[k], &before[k]);
	g->gl->DeleteBuffers(1, &name);
	for (int k = 0; k < 2; k++) {
		g->gl->GetIntegerv(bindings[k], &after);
		if (after != before[k] && before[k] != (GLint)name)
			g->gl->BindBuffer(targets[k], (GLuint)before[k]);
	}
}

void gpu_buffer_free(gpu *g, gpu_buffer *buffer)
{
	if (!buffer->name)
		return;
	if (buffer->texture && !g->lost)
		g->gl->DeleteTextures(1, &buffer->texture);
	if (!g->lost)
		delete_buffer(g, buffer->name);
	g->buffer_bytes -= buffer->capacity;
	*buffer = (gpu_buffer){0};
}

void gpu_forget_errors(const gpu *g)
{
	/* A context that was lost reports errors for ever. */
	for (int k = 0; k < 64 && g->gl->GetError() != GL_NO_ERROR; k++)
		;
}

/* The memory behind a new name. False when there is none; the name is the caller's to delete. The buffer is asked, not
 * OpenGL's errors, which may be the host's. */
static bool make_storage(const gpu *g, gpu_buffer *buffer, const void *data)
{
	GLint64 size = 0;
	g->gl->CreateBuffers(1, &buffer->name);
	g->gl->NamedBufferStorage(buffer->name, (GLsizeiptr)buffer->capacity, data, GL_DYNAMIC_STORAGE_BIT);
	g->gl->GetNamedBufferParameteri64v(buffer->name, GL_BUFFER_SIZE, &size);
	return size == (GLint64)buffer->capacity;
}

/* Does a storage block reach farther than the device promises? A shader writes the first word beyond. */
static bool reaches_beyond(gpu *g)
{
	static const uint32_t TRIAL = 0x52454c55u;
	gpu_buffer tried = {.capacity = g->block_bytes + TEXEL_BYTES};
	uint32_t found = 0, program = 0;
	if (gpu_programs_compute(g, &(gpu_program_file){"block_trial.comp", &program}, 1))
		return false;
	GLint bound = 0;
	g->gl->GetIntegeri_v(GL_SHADER_STORAGE_BUFFER_BINDING, 0, &bound);
	const bool made = make_storage(g, &tried, NULL);
	if (made) {
		gpu_buffer_clear(g, &tried, g->block_bytes, TEXEL_BYTES, 0);
		g->gl->BindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, 1, &tried.name);
		gpu_set_uint(g, program, 0, (uint32_t)(g->block_bytes / sizeof found));
		gpu_set_uint(g, program, 1, TRIAL);
		gpu_dispatch_groups(g, program, 1);
		gpu_buffer_read(g, &tried, g->block_bytes, sizeof found, &found);
		g->gl->BindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, 1, &(const GLuint){(GLuint)bound});
	}
	g->gl->DeleteBuffers(1, &tried.name);
	if (!made)
		gpu_forget_errors(g);
	gpu_program_free(g, &program);
	return found == TRIAL;
}

static uint64_t block_limit(gpu *g, uint64_t wanted)
{
	if (wanted <= g->block_bytes || g->block_bytes + TEXEL_BYTES >= g->texture_bytes || g->tried ||
	    !gpu_is_current(g)) /* objects may be made while it is not */
		return g->block_bytes;
	g->tried = true;
	if (reaches_beyond(g))
		g->block_bytes = g->texture_bytes;
	return g->block_bytes;
}

uint64_t gpu_buffer_limit(gpu *g, uint64_t wanted)
{
	const uint64_t limit = block_limit(g, g->host_limit && g->host_limit < wanted ? g->host_limit : wanted);
	return g->host_limit && g->host_limit < limit ? g->host_limit : limit;
}

/* Whole texels, and one at least: a binding of no bytes is an error, and empty scenes are not. */
static uint64_t whole_texels(uint64_t size)
{
	return size ? (size + TEXEL_BYTES - 1) / TEXEL_BYTES * TEXEL_BYTES : TEXEL_BYTES;
}

const char *gpu_limit_text(const gpu *g, uint64_t limit)
{
	static GI_THREAD_LOCAL char text[96];
	const bool hosts = g->host_limit && limit >= g->host_limit;
	snprintf(text, sizeof text, "%s %" PRIu64 " MiB%s",
		 hosts ? "gi_context_def.max_buffer_mib allows" : "this renderer binds", limit >> 20,
		 hosts ? "" : " at once");
	return text;
}

static gi_result check_size(gpu *g, uint64_t size)
{
	const uint64_t limit = gpu_buffer_limit(g, size);
	if (size <= limit)
		return GI_OK;
	return gi_fail(&g->log, GI_ERROR_OUT_OF_MEMORY,
		       "a buffer of %" PRIu64 " MiB is needed and %s: fewer or larger leaves take less, and coarser "
		       "meshes where these are drawn",
		       (size >> 20) + 1, gpu_limit_text(g, limit));
}

/* Of a size that was checked, with room for `capacity` bytes where there is memory for that. */
static gi_result make_buffer(gpu *g, gpu_buffer *buffer, const char *label, uint64_t size, uint64_t capacity,
			     const void *data)
{
	const uint64_t least = whole_texels(size);
	gpu_buffer fresh = {.size = least, .capacity = capacity};
	bool made = make_storage(g, &fresh, capacity == size ? data : NULL);
	if (!made && capacity > least) {
		g->gl->DeleteBuffers(1, &fresh.name);
		gpu_forget_errors(g);
		fresh.capacity = capacity = least;
		made = make_storage(g, &fresh, capacity == size ? data : NULL);
	}
	if (!made) {
		g->gl->DeleteBuffers(1, &fresh.name);
		gpu_forget_errors(g);
		return gi_fail(&g->log, GI_ERROR_OUT_OF_MEMORY, "no GPU memory for %" PRIu64 " bytes", least);
	}
	if (capacity != size && size && data)
		g->gl->NamedBufferSubData(fresh.name, 0, (GLsizeiptr)size, data);
	if (data)
		g->uploaded_bytes += size;
	make_texture(g, &fresh, label);
	gpu_buffer_free(g, buffer);
	*buffer = fresh;
	g->buffer_bytes += capacity;
	return GI_OK;
}

gi_result gpu_buffer_allocate(gpu *g, gpu_buffer *buffer, const char *label, uint64_t size, const void *data)
{
	const gi_result result = check_size(g, whole_texels(size));
	return result ? result : make_buffer(g, buffer, label, size, whole_texels(size), data);
}

/* Whatever is larger is not worth to be there twice. */
static const uint64_t LARGEST_SPARE = 32 << 20;

/* A spare that is wanted this much smaller goes, but small ones. */
static bool is_fitting(const gpu_buffer *spare, uint64_t size)
{
	static const uint64_t SMALL = 65536;
	return spare->name && spare->capacity >= size && spare->capacity <= 2 * size + SMALL;
}

gi_result gpu_buffer_renew(gpu *g, gpu_buffer *buffer, uint32_t binding, uint64_t size, const void *data)
{
	gpu_buffer *spare = &g->spares[binding];
	const uint64_t padded = whole_texels(size);
	const gi_result result = check_size(g, padded);
	if (result)
		return result;
	if (!is_fitting(spare, padded)) {
		const uint64_t roomy = whole_texels(padded + padded / 8), limit = gpu_buffer_limit(g, roomy);
		gpu_buffer_free(g, spare);
		return make_buffer(g, buffer, buffer_bound_label(binding), size, roomy < limit ? roomy : padded, data);
	}
	gpu_buffer_free(g, buffer);
	*buffer = *spare;
	*spare = (gpu_buffer){0};
	buffer->size = padded;
	if (data)
		gpu_buffer_upload(g, buffer, 0, size, data);
	return GI_OK;
}

gi_result gpu_buffer_replace(gpu *g, gpu_buffer *buffer, const char *label, uint64_t size, const void *data)
{
	if (!buffer->name || buffer->size != whole_texels(size))
		return gpu_buffer_allocate(g, buffer, label, size, data);
	gpu_buffer_upload(g, buffer, 0, size, data);
	return GI_OK;
}

void gpu_buffer_retire(gpu *g, gpu_buffer *buffer, uint32_t binding)
{
	gpu_buffer_free(g, &g->spares[binding]);
	if (buffer->capacity > LARGEST_SPARE) {
		gpu_buffer_free(g, buffer);
		return;
	}
	g->spares[binding] = *buffer;
	*buffer = (gpu_buffer){0};
}

void gpu_spares_free(gpu *g)
{
	for (uint32_t k = 0; k < GPU_BINDINGS; k++)
		gpu_buffer_free(g, &g->spares[k]);
}

void gpu_buffer_upload(gpu *g, gpu_buffer *buffer, uint64_t offset, uint64_t size, const void *data)
{
	if (!size)
		return;
	g->gl->NamedBufferSubData(buffer->name, (GLintptr)offset, (GLsizeiptr)size, data);
	g->uploaded_bytes += size;
}

/* Mesa (22.3) turns the bytes of cleared words round where a host has that set for its uploads. Returns what was set.
 */
static GLint unswap(const gpu *g)
{
	GLint swapped = 0;
	g->gl->GetIntegerv(GL_UNPACK_SWAP_BYTES, &swapped);
	if (swapped)
		g->gl->PixelStorei(GL_UNPACK_SWAP_BYTES, GL_FALSE);
	return swapped;
}

static void swap_again(const gpu *g, GLint swapped)
{
	if (swapped)
		g->gl->PixelStorei(GL_UNPACK_SWAP_BYTES, swapped);
}

void gpu_buffer_clear(const gpu *g, gpu_buffer *buffer, uint64_t offset, uint64_t size, uint32_t word)
{
	const GLint swapped = word ? unswap(g) : 0;
	g->gl->ClearNamedBufferSubData(buffer->name, GL_R32UI, (GLintptr)offset, (GLsizeiptr)size, GL_RED_INTEGER,
				       GL_UNSIGNED_INT, &word);
	swap_again(g, swapped);
}

void gpu_buffer_fill(const gpu *g, gpu_buffer *buffer, const uint32_t words[4])
{
	const GLint swapped = unswap(g);
	g->gl->ClearNamedBufferSubData(buffer->name, GL_RGBA32UI, 0, (GLsizeiptr)buffer->size, GL_RGBA_INTEGER,
				       GL_UNSIGNED_INT, words);
	swap_again(g, swapped);
}

void gpu_buffer_copy(const gpu *g, gpu_buffer *from, uint64_t from_offset, gpu_buffer *to, uint64_t to_offset,
		     uint64_t size)
{
	g->gl->CopyNamedBufferSubData(from->name, to->name, (GLintptr)from_offset, (GLintptr)to_offset,
				      (GLsizeiptr)size);
}

void gpu_buffer_read(const gpu *g, const gpu_buffer *buffer, uint64_t offset, uint64_t size, void *out)
{
	g->gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	if (size)
		g->gl->GetNamedBufferSubData(buffer->name, (GLintptr)offset, (GLsizeiptr)size, out);
}

void gpu_bind(const gpu *g, uint32_t binding, const gpu_buffer *buffer)
{
	g->gl->BindBuffersBase(GL_SHADER_STORAGE_BUFFER, binding, 1,
			       &buffer->name); /* leaves the general binding alone */
	g->gl->BindTextureUnit(GPU_FIRST_TEXEL_UNIT + binding, buffer->texture);
}

void gpu_bind_uniforms(const gpu *g, uint32_t binding, const gpu_buffer *buffer)
{
	g->gl->BindBuffersBase(GL_UNIFORM_BUFFER, binding, 1, &buffer->name);
}

/* ---- dispatches ---- */

static void order_after(const gpu *g)
{
	g->gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_UNIFORM_BARRIER_BIT |
			     GL_COMMAND_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

void gpu_dispatch_groups(gpu *g, uint32_t program, uint64_t groups)
{
	if (!groups)
		return;
	/* thread_number() of dispatch.glsl undoes the fold. */
	uint64_t x = groups < 32768 ? groups : 32768;
	g->gl->UseProgram(program);
	g->gl->DispatchCompute((GLuint)x, (GLuint)((groups + x - 1) / x), 1);
	order_after(g);
	g->dispatches++;
}

void gpu_dispatch(gpu *g, uint32_t program, uint64_t threads)
{
	gpu_dispatch_groups(g, program, (threads + g->group_size - 1) / g->group_size);
}

void gpu_dispatch_indirect(gpu *g, uint32_t program, const gpu_buffer *arguments, uint64_t offset)
{
	g->gl->UseProgram(program);
	g->gl->BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, arguments->name);
	g->gl->DispatchComputeIndirect((GLintptr)offset);
	order_after(g);
	g->dispatches++;
}

/* ---- timers ---- */

static void note_time(const gpu *g, gpu_timer *timer, float ms)
{
	timer->tag[timer->next] = g->tag;
	timer->ms[timer->next] = ms;
}

static void make_queries(const gpu *g, gpu_timer *timer)
{
	g->gl->CreateQueries(GL_TIMESTAMP, 2 * GPU_TIMER_RING, timer->query[0]);
	for (int k = 0; k < 2 * GPU_TIMER_RING; k++)
		gpu_label(g, GL_QUERY, timer->query[k / 2][k % 2], timer->name ? timer->name : "time");
}

void gpu_timer_begin(gpu *g, gpu_timer *timer)
{
	if (timer->name)
		gpu_group_begin(g, timer->name);
	if (!g->profile)
		return;
	if (g->software) {
		g->gl->Finish();
		timer->began_ms = gi_clock_ms();
		return;
	}
	if (!timer->query[0][0])
		make_queries(g, timer);
	if (timer->pending == GPU_TIMER_RING)
		timer->pending--; /* nobody asked: the oldest is lost */
	note_time(g, timer, -1);
	g->gl->QueryCounter(timer->query[timer->next][0], GL_TIMESTAMP);
}

static void end_time(gpu *g, gpu_timer *timer)
{
	if (g->software) {
		g->gl->Finish();
		note_time(g, timer, (float)(gi_clock_ms() - timer->began_ms));
	} else {
		g->gl->QueryCounter(timer->query[timer->next][1], GL_TIMESTAMP);
		timer->pending++;
	}
	timer->next = (timer->next + 1) % GPU_TIMER_RING;
}

void gpu_timer_end(gpu *g, gpu_timer *timer)
{
	if (g->profile)
		end_time(g, timer);
	if (timer->name)
		gpu_group_end(g);
}

void gpu_timer_poll(const gpu *g, gpu_timer *timer, bool wait)
{
	while (timer->pending) {
		const uint32_t oldest = (timer->next + GPU_TIMER_RING - timer->pending) % GPU_TIMER_RING;
		const GLuint *query = timer->query[oldest];
		GLuint ready = 0;
		g->gl->GetQueryObjectuiv(query[1], GL_QUERY_RESULT_AVAILABLE, &ready);
		if (!ready && !wait)
			return;
		GLuint64 from = 0, to = 0;
		g->gl->GetQueryObjectui64v(query[0], GL_QUERY_RESULT, &from);
		g->gl->GetQueryObjectui64v(query[1], GL_QUERY_RESULT, &to);
		timer->ms[oldest] = (float)((double)(to - from) * 1e-6);
		timer->pending--;
	}
}

/* Of the last measurements, the one `back` before the next. */
static uint32_t timer_slot(const gpu_timer *timer, uint32_t back)
{
	return (timer->next + GPU_TIMER_RING - back) % GPU_TIMER_RING;
}

float gpu_timer_ms(const gpu_timer *timer, uint64_t tag)
{
	float sum = 0;
	for (uint32_t slot = 0; slot < GPU_TIMER_RING; slot++)
		if (tag && timer->tag[slot] == tag && timer->ms[slot] >= 0)
			sum += timer->ms[slot];
	return sum;
}

uint64_t gpu_timer_newest(const gpu_timer *timer)
{
	for (uint32_t back = 1; back <= GPU_TIMER_RING; back++) {
		const uint32_t slot = timer_slot(timer, back);
		if (timer->tag[slot] && timer->ms[slot] >= 0)
			return timer->tag[slot];
	}
	return 0;
}

void gpu_timer_free(const gpu *g, gpu_timer *timer)
{
	if (timer->query[0][0] && !g->lost)
		g->gl->DeleteQueries(2 * GPU_TIMER_RING, timer->query[0]);
	*timer = (gpu_timer){0};
}

/* ---- read-back ---- */

gi_result gpu_readback_create(gpu *g, gpu_readback *r, uint32_t bytes)
{
	*r = (gpu_readback){.slot_bytes = bytes, .buffer.size = (uint64_t)bytes * GPU_READBACK_RING};
	r->buffer.capacity = r->buffer.size;
	GLbitfield access = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
	g->gl->CreateBuffers(1, &r->buffer.name);
	gpu_label(g, GL_BUFFER, r->buffer.name, "read-back");
	g->gl->NamedBufferStorage(r->buffer.name, (GLsizeiptr)r->buffer.size, NULL, access);
	r->mapped = g->gl->MapNamedBufferRange(r->buffer.name, 0, (GLsizeiptr)r->buffer.size, access);
	g->buffer_bytes += r->buffer.size;
	if (!r->mapped)
		gpu_forget_errors(g);
	return r->mapped ? GI_OK : gi_fail(&g->log, GI_ERROR_OUT_OF_MEMORY, "a read-back buffer could not be mapped");
}

static void drop_fence(const gpu *g, gpu_readback *r, uint32_t slot)
{
	if (r->fence[slot])
		g->gl->DeleteSync((GLsync)r->fence[slot]);
	r->fence[slot] = NULL;
}

void gpu_readback_free(gpu *g, gpu_readback *r)
{
	for (uint32_t k = 0; k < GPU_READBACK_RING && !g->lost; k++)
		drop_fence(g, r, k);
	if (r->mapped && !g->lost)
		g->gl->UnmapNamedBuffer(r->buffer.name);
	gpu_buffer_free(g, &r->buffer);
	*r = (gpu_readback){0};
}

void gpu_readback_queue(const gpu *g, gpu_readback *r, gpu_buffer *from, uint64_t tag)
{
	if (r->pending == GPU_READBACK_RING) {
		drop_fence(g, r, r->oldest);
		r->oldest = (r->oldest + 1) % GPU_READBACK_RING;
		r->pending--;
	}
	gpu_buffer_copy(g, from, 0, &r->buffer, (uint64_t)r->next * r->slot_bytes, r->slot_bytes);
	g->gl->MemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
	r->fence[r->next] = g->gl->FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
	r->tag[r->next] = tag;
	r->next = (r->next + 1) % GPU_READBACK_RING;
	r->pending++;
}

bool gpu_readback_take(const gpu *g, gpu_readback *r, bool wait, void *out, uint64_t *tag)
{
	if (!r->pending)
		return false;
	uint32_t slot = r->oldest;
	GLenum state =
	    g->gl->ClientWaitSync((GLsync)r->fence[slot], GL_SYNC_FLUSH_COMMANDS_BIT, wait ? GL_TIMEOUT_IGNORED : 0);
	if (state == GL_TIMEOUT_EXPIRED)
		return false;
	memcpy(out, (const char *)r->mapped + (size_t)slot * r->slot_bytes, r->slot_bytes);
	*tag = r->tag[slot];
	drop_fence(g, r, slot);
	r->oldest = (slot + 1) % GPU_READBACK_RING;
	r->pending--;
	return true;
}

void gpu_finish(const gpu *g)
{
	g->gl->Finish();
}
