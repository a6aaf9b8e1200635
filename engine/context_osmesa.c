/* OSMesa: llvmpipe without a window system, into memory of ours. */
#include "context_internal.h"
#include "library.h"

#include <GL/osmesa.h>
#include <stdio.h>
#include <stdlib.h>

/* clang-format off */
#define FUNCTIONS(X) \
	X(OSMesaCreateContextAttribs) X(OSMesaDestroyContext) X(OSMesaMakeCurrent) X(OSMesaGetProcAddress)
/* clang-format on */

#define DECLARE(name) __typeof__(name) *name;
#define SYMBOL(function) {#function, offsetof(struct functions, function)},

static struct functions {
	FUNCTIONS(DECLARE)
} osmesa;

static const engine_symbol symbols[] = {FUNCTIONS(SYMBOL)};
static const char *const file_names[] = {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so", NULL};

typedef struct osmesa_native {
	OSMesaContext context;
	uint8_t *pixels; /* the default framebuffer: RGBA8, bottom row first; nobody looks at it */
} osmesa_native;

static uint8_t *allocate_pixels(int width, int height)
{
	return calloc((size_t)width * (size_t)height, 4);
}

static OSMesaContext create_core_45(void)
{
	static const int attributes[] = {OSMESA_FORMAT,
					 OSMESA_RGBA,
					 OSMESA_PROFILE,
					 OSMESA_CORE_PROFILE,
					 OSMESA_CONTEXT_MAJOR_VERSION,
					 4,
					 OSMESA_CONTEXT_MINOR_VERSION,
					 5,
					 0,
					 0};
	return osmesa.OSMesaCreateContextAttribs(attributes, NULL);
}

static void osmesa_close(engine_context *context)
{
	osmesa_native *native = context->native;
	if (native->context)
		osmesa.OSMesaDestroyContext(native->context);
	free(native->pixels);
	free(native);
	context->native = NULL;
}

static bool osmesa_open(engine_context *context, const engine_context_def *def, char *message, size_t message_size)
{
	(void)def;
	if (!engine_library_load(file_names, symbols, sizeof symbols / sizeof symbols[0], &osmesa,
				 "install libosmesa6 (Mesa has none after 25.0) or use --context egl", message,
				 message_size))
		return false;
	osmesa_native *native = calloc(1, sizeof *native);
	if (!native) {
		snprintf(message, message_size, "out of memory for an OSMesa context");
		return false;
	}
	context->native = native;
	native->pixels = allocate_pixels(context->width, context->height);
	native->context = native->pixels ? create_core_45() : NULL;
	if (native->context)
		return true;
	snprintf(message, message_size,
		 "OSMesa gives no OpenGL 4.5 core context; Mesa 22.3 or newer with llvmpipe is needed");
	osmesa_close(context);
	return false;
}

static bool osmesa_make_current(engine_context *context)
{
	osmesa_native *native = context->native;
	if (!native)
		return osmesa.OSMesaMakeCurrent(NULL, NULL, GL_UNSIGNED_BYTE, 0, 0);
	return osmesa.OSMesaMakeCurrent(native->context, native->pixels, GL_UNSIGNED_BYTE, context->width,
					context->height);
}

static bool osmesa_resize(engine_context *context, int width, int height)
{
	osmesa_native *native = context->native;
	uint8_t *pixels = allocate_pixels(width, height);
	if (!pixels)
		return false;
	if (!osmesa.OSMesaMakeCurrent(native->context, pixels, GL_UNSIGNED_BYTE, width, height)) {
		free(pixels);
		return false;
	}
	free(native->pixels);
	native->pixels = pixels;
	context->width = width;
	context->height = height;
	context->incoming.resized = true;
	return true;
}

static engine_gl_proc osmesa_get_proc(const char *name)
{
	return osmesa.OSMesaGetProcAddress(name);
}

const engine_context_backend engine_context_backend_osmesa = {
    .open = osmesa_open,
    .close = osmesa_close,
    .make_current = osmesa_make_current,
    .get_proc = osmesa_get_proc,
    .resize = osmesa_resize,
};
