/* What the three kinds of context share with context.c. A kind fills in a backend; context.c does all the rest. */
#ifndef ENGINE_CONTEXT_INTERNAL_H
#define ENGINE_CONTEXT_INTERNAL_H

#include "context.h"

typedef struct engine_context_backend {
	/* Makes the context and stores it in context->native; context->width and height hold the wish and receive the
	 * result. Leaves nothing behind when it fails.
	 */
	bool (*open)(engine_context *context, const engine_context_def *def, char *message, size_t message_size);
	void (*close)(engine_context *context);
	bool (*make_current)(engine_context *context); /* context->native NULL: releases */
	engine_gl_get_proc get_proc;
	/* The following may be NULL: nothing to do. */
	bool (*resize)(engine_context *context, int width, int height);
	void (*swap)(engine_context *context);
	void (*poll)(engine_context *context);
} engine_context_backend;

struct engine_context {
	const engine_context_backend *backend;
	void *native; /* the backend's own */
	engine_context_kind kind;
	int width, height;
	bool should_close;
	engine_input input;    /* as the last poll left it */
	engine_input incoming; /* being filled by events */
	char description[256];
};

extern const engine_context_backend engine_context_backend_glfw;
extern const engine_context_backend engine_context_backend_egl;
extern const engine_context_backend engine_context_backend_osmesa;

#endif
