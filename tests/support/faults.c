#include "faults.h"

#include "harness.h"

#include <glad/gl.h>

#include <stdlib.h>
#include <string.h>

static struct {
	bool on, all;
	fault_kind kind;
	uint32_t first, seen, failed;
} fault;

void faults_begin(fault_kind kind, uint32_t first, bool all)
{
	fault.kind = kind;
	fault.first = first;
	fault.all = all;
	fault.seen = fault.failed = 0;
	fault.on = true;
}

uint32_t faults_end(void)
{
	fault.on = false;
	return fault.failed;
}

static bool fails(fault_kind kind)
{
	if (!fault.on || fault.kind != kind)
		return false;
	const uint32_t number = fault.seen++;
	const bool now = fault.all ? number >= fault.first : number == fault.first;
	fault.failed += now;
	return now;
}

/* ---- the CPU's ---- */

static faults_memory memory;

static void note(size_t size, size_t gone)
{
	memory.blocks += (size > 0) - (gone > 0);
	memory.bytes += (int64_t)size - (int64_t)gone;
	memory.allocations += size > 0;
}

static void *allocate(size_t size, void *user)
{
	assert_ptr_equal(user, &memory);
	void *block = fails(FAULT_CPU) ? NULL : malloc(size);
	if (block)
		note(size, 0);
	return block;
}

static void *reallocate(void *block, size_t old_size, size_t new_size, void *user)
{
	assert_ptr_equal(user, &memory);
	void *moved = fails(FAULT_CPU) ? NULL : realloc(block, new_size);
	if (moved)
		note(new_size, old_size);
	return moved;
}

static void release(void *block, size_t size, void *user)
{
	assert_ptr_equal(user, &memory);
	assert_non_null(block);
	note(0, size);
	free(block);
}

gi_allocator faults_allocator(void)
{
	return (gi_allocator){allocate, reallocate, release, &memory};
}

faults_memory faults_memory_now(void)
{
	return memory;
}

/* OpenSubdiv's, as far as its templates are compiled into the library: the linker sends calls here (--wrap). */
void *__real__Znwm(size_t size);
void _ZSt17__throw_bad_allocv(void);
void *__wrap__Znwm(size_t size);

void *__wrap__Znwm(size_t size)
{
	if (fails(FAULT_CPU))
		_ZSt17__throw_bad_allocv();
	return __real__Znwm(size);
}

/* ---- the GPU's: a call that OpenGL refuses ---- */

static gi_get_proc_address_fn *real_get_proc_address;
static PFNGLNAMEDBUFFERSTORAGEPROC real_buffer_storage;
static PFNGLTEXTURESTORAGE2DPROC real_storage_2d;
static PFNGLTEXTURESTORAGE3DPROC real_storage_3d;

static void buffer_storage(GLuint buffer, GLsizeiptr size, const void *data, GLbitfield flags)
{
	real_buffer_storage(buffer, fails(FAULT_GPU) ? -1 : size, data, flags);
}

static void storage_2d(GLuint texture, GLsizei levels, GLenum format, GLsizei width, GLsizei height)
{
	real_storage_2d(texture, fails(FAULT_GPU) ? 0 : levels, format, width, height);
}

static void storage_3d(GLuint texture, GLsizei levels, GLenum format, GLsizei width, GLsizei height, GLsizei depth)
{
	real_storage_3d(texture, fails(FAULT_GPU) ? 0 : levels, format, width, height, depth);
}

static gi_proc get_proc_address(const char *name, void *user)
{
	const gi_proc real = real_get_proc_address(name, user);
	if (strcmp(name, "glNamedBufferStorage") == 0) {
		real_buffer_storage = (PFNGLNAMEDBUFFERSTORAGEPROC)real;
		return (gi_proc)buffer_storage;
	}
	if (strcmp(name, "glTextureStorage2D") == 0) {
		real_storage_2d = (PFNGLTEXTURESTORAGE2DPROC)real;
		return (gi_proc)storage_2d;
	}
	if (strcmp(name, "glTextureStorage3D") == 0) {
		real_storage_3d = (PFNGLTEXTURESTORAGE3DPROC)real;
		return (gi_proc)storage_3d;
	}
	return real;
}

void faults_in(gi_context_def *def)
{
	def->allocator = faults_allocator();
	real_get_proc_address = def->get_proc_address;
	def->get_proc_address = get_proc_address;
}
