#include "bench_options.h"

#include <stdlib.h>

engine_context_kind bench_parse_context(const char *argument, struct argp_state *state)
{
	engine_context_kind kind = ENGINE_CONTEXT_AUTO;
	if (!engine_context_kind_from_name(argument, &kind))
		argp_error(state, "--context is auto, glfw, egl or osmesa, not '%s'", argument);
	return kind;
}

int bench_parse_size(const char *argument, struct argp_state *state)
{
	const int size = atoi(argument);
	if (size < 16 || size > 8192)
		argp_error(state, "--size is 16..8192 pixels");
	return size;
}
