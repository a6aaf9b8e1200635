/* Options that all benchmarks have. */
#ifndef TESTS_BENCH_BENCH_OPTIONS_H
#define TESTS_BENCH_BENCH_OPTIONS_H

#include "context.h"

#include <argp.h>

#define BENCH_OPTION_CONTEXT                                                                                           \
	{                                                                                                              \
		"context", 'c', "KIND", 0, "auto (default), glfw, egl or osmesa", 0                                    \
	}

/* What an option's argument says; ends the program with argp's line where it is none. */
engine_context_kind bench_parse_context(const char *argument, struct argp_state *state);
int bench_parse_size(const char *argument, struct argp_state *state); /* pixels, 16..8192 */

#endif
