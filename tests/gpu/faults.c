#include "faults.h"

#include <glad/gl.h>

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

/* ---- the CPU's; the linker sends calls here (--wrap) ---- */

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *memory, size_t size);
void *__real__Znwm(size_t size);
void _ZSt17__throw_bad_allocv(void);

void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *memory, size_t size);
void *__wrap__Znwm(size_t size);

void *__wrap_malloc(size_t size)
{
	return fails(FAULT_CPU) ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
	return fails(FAULT_CPU) ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *memory, size_t size)
{
	return fails(FAULT_CPU) ? NULL : __real_realloc(memory, size);
}

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

void faults_in_gl(gi_context_def *def)
{
	real_get_proc_address = def->get_proc_address;
	def->get_proc_address = get_proc_address;
}
