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

/* One function of a library loaded at run time. */
typedef struct engine_symbol {
	const char *name;
	size_t offset; /* of the pointer in the table of functions */
} engine_symbol;

/* Opens the first library of the NULL-ended list that is there and fills the table's function pointers.
 * Returns false with a message that names the library, what_to_do in it, when the library or one of its functions is
 * missing. A library stays open until the process ends: drivers do not survive being unloaded.
 */
bool engine_library_load(const char *const *file_names, const engine_symbol *symbols, size_t symbol_count, void *table,
			 const char *what_to_do, char *message, size_t message_size);

#endif
