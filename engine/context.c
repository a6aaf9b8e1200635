#define _POSIX_C_SOURCE 200809L
#include "context_internal.h"
#include "gl.h"

#include <dlfcn.h>
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COOKIE = 0x636f6e74, MAX_SIZE = 16384 };

static const char *const kind_names[] = {"auto", "glfw", "egl", "osmesa"};

/* Which context the process has current: Mesa keeps one dispatch table per thread for EGL and OSMesa together, so the
 * one before must be released by its own library first.
 */
static engine_context *current;

engine_context_def engine_context_def_default(void)
{
	return (engine_context_def){.kind = ENGINE_CONTEXT_AUTO,
				    .width = 512,
				    .height = 512,
				    .title = "Relume",
				    .vsync = true,
				    .cookie = COOKIE};
}

bool engine_context_kind_from_name(const char *name, engine_context_kind *kind)
{
	for (int i = 0; i < 4; i++) {
		if (strcmp(name, kind_names[i]) == 0) {
			*kind = (engine_context_kind)i;
			return true;
		}
	}
	return false;
}

const char *engine_context_kind_name(engine_context_kind kind)
{
	return kind_names[kind];
}

static const engine_context_backend *backend_of(engine_context_kind kind)
{
	switch (kind) {
	case ENGINE_CONTEXT_GLFW:
		return &engine_context_backend_glfw;
	case ENGINE_CONTEXT_EGL:
		return &engine_context_backend_egl;
	default:
		return &engine_context_backend_osmesa;
	}
}

static void release_current(void)
{
	if (!current)
		return;
	engine_context released = *current;
	released.native = NULL;
	current->backend->make_current(&released);
	current = NULL;
}

bool engine_context_make_current(engine_context *context)
{
	if (current == context)
		return true;
	release_current();
	if (!context->backend->make_current(context))
		return false;
	current = context;
	char ignored[256]; /* creation has checked this very context already */
	return engine_gl_load(context->backend->get_proc, ignored, sizeof ignored);
}

static bool start(engine_context *context, const engine_context_def *def, char *message, size_t message_size)
{
	release_current();
	if (!context->backend->open(context, def, message, message_size))
		return false;
	if (!context->backend->make_current(context)) {
		snprintf(message, message_size, "the %s context cannot be made current; try another --context",
			 kind_names[context->kind]);
		return false;
	}
	current = context;
	if (!engine_gl_load(context->backend->get_proc, message, message_size))
		return false;
	snprintf(context->description, sizeof context->description, "%s, OpenGL %s",
		 (const char *)glGetString(GL_RENDERER), (const char *)glGetString(GL_VERSION));
	return true;
}

static engine_context *create_kind(engine_context_kind kind, const engine_context_def *def, char *message,
				   size_t message_size)
{
	engine_context *context = calloc(1, sizeof *context);
	if (!context) {
		snprintf(message, message_size, "out of memory for a context");
		return NULL;
	}
	context->kind = kind;
	context->backend = backend_of(kind);
	context->width = def->width;
	context->height = def->height;
	if (start(context, def, message, message_size))
		return context;
	engine_context_destroy(context);
	return NULL;
}

static engine_context *create_auto(const engine_context_def *def, char *message, size_t message_size)
{
	static const engine_context_kind order[] = {ENGINE_CONTEXT_GLFW, ENGINE_CONTEXT_OSMESA, ENGINE_CONTEXT_EGL};
	char reasons[3][256] = {"", "", ""};
	for (int i = 0; i < 3; i++) {
		engine_context *context = create_kind(order[i], def, reasons[i], sizeof reasons[i]);
		if (context)
			return context;
	}
	snprintf(message, message_size, "no OpenGL 4.5 context: glfw: %s; osmesa: %s; egl: %s", reasons[0], reasons[1],
		 reasons[2]);
	return NULL;
}

static bool size_in_range(int width, int height)
{
	return width >= 1 && height >= 1 && width <= MAX_SIZE && height <= MAX_SIZE;
}

/* A software renderer allocates and frees megabytes a frame; glibc would hand them back to the system each time, and
 * every page would be cleared anew: some 3 ms of a picture.
 */
static void keep_freed_memory(void)
{
	enum { KEPT = 256 << 20 };
	mallopt(M_TRIM_THRESHOLD, KEPT);
}

engine_context *engine_context_create(const engine_context_def *def, char *message, size_t message_size)
{
	keep_freed_memory();
	if (message_size)
		message[0] = '\0';
	if (def->cookie != COOKIE || (unsigned)def->kind > ENGINE_CONTEXT_OSMESA) {
		snprintf(message, message_size, "the context definition was not made by engine_context_def_default()");
		return NULL;
	}
	if (!size_in_range(def->width, def->height)) {
		snprintf(message, message_size, "a picture of %d x %d is not possible; give 1 to %d each way",
			 def->width, def->height, MAX_SIZE);
		return NULL;
	}
	if (def->kind == ENGINE_CONTEXT_AUTO)
		return create_auto(def, message, message_size);
	return create_kind(def->kind, def, message, message_size);
}

void engine_context_destroy(engine_context *context)
{
	if (!context)
		return;
	if (current == context)
		release_current();
	if (context->native)
		context->backend->close(context);
	free(context);
}

engine_context_kind engine_context_get_kind(const engine_context *context)
{
	return context->kind;
}

engine_gl_proc engine_context_find_gl(const char *name, void *context)
{
	return ((const engine_context *)context)->backend->get_proc(name);
}

const char *engine_context_describe(const engine_context *context)
{
	return context->description;
}

int engine_context_width(const engine_context *context)
{
	return context->width;
}

int engine_context_height(const engine_context *context)
{
	return context->height;
}

bool engine_context_resize(engine_context *context, int width, int height)
{
	if (!size_in_range(width, height))
		return false;
	if (context->backend->resize)
		return context->backend->resize(context, width, height);
	context->width = width;
	context->height = height;
	context->incoming.resized = true;
	return true;
}

bool engine_context_has_window(const engine_context *context)
{
	return context->kind == ENGINE_CONTEXT_GLFW;
}

void engine_context_swap(engine_context *context)
{
	if (context->backend->swap)
		context->backend->swap(context);
	else
		glFlush();
}

/* What is held stays in `incoming`, what happened starts again at nothing. */
static void forget_events(engine_input *input)
{
	input->pressed_count = 0;
	memset(input->pressed, 0, sizeof input->pressed);
	memset(input->mouse_pressed, 0, sizeof input->mouse_pressed);
	memset(input->drag, 0, sizeof input->drag);
	input->scroll = 0;
	input->resized = false;
}

const engine_input *engine_context_poll(engine_context *context)
{
	if (context->backend->poll)
		context->backend->poll(context);
	context->input = context->incoming;
	forget_events(&context->incoming);
	return &context->input;
}

bool engine_context_should_close(const engine_context *context)
{
	return context->should_close;
}

void engine_context_request_close(engine_context *context)
{
	context->should_close = true;
}
