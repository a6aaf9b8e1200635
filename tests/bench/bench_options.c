#include "bench_options.h"

#include "output.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

static error_t parse_context(int key, char *argument, struct argp_state *state)
{
	if (key != 'c')
		return ARGP_ERR_UNKNOWN;
	if (!engine_context_kind_from_name(argument, state->input))
		argp_error(state, "--context is auto, glfw, egl or osmesa, not '%s'", argument);
	return 0;
}

/* What argp's one input has to hold for two parsers. */
typedef struct inputs {
	argp_parser_t parse;
	void *options;
	engine_context_kind kind;
} inputs;

static error_t parse_own(int key, char *argument, struct argp_state *state)
{
	inputs *in = state->input;
	if (key == ARGP_KEY_INIT)
		state->child_inputs[0] = &in->kind;
	state->input = in->options;
	const error_t result = in->parse(key, argument, state);
	state->input = in;
	return result;
}

engine_context_kind bench_parse(const bench_command *command, int argc, char **argv, void *options)
{
	static const struct argp_option context[] = {
	    {"context", 'c', "KIND", 0, "auto (default), glfw, egl or osmesa", 0}, {0}};
	static const struct argp common = {context, parse_context, NULL, NULL, NULL, NULL, NULL};
	const struct argp_child children[] = {{&common, 0, NULL, 0}, {0}};
	const struct argp argp = {command->options, parse_own, NULL, command->about, children, NULL, NULL};
	inputs in = {command->parse, options, ENGINE_CONTEXT_AUTO};
	engine_output_watch(command->name);
	argp_parse(&argp, argc, argv, 0, NULL, &in);
	return in.kind;
}

uint32_t bench_parse_count(const char *argument, uint32_t least, uint32_t most, const char *option,
			   struct argp_state *state)
{
	char *end;
	errno = 0;
	const long long n = strtoll(argument, &end, 10);
	if (end == argument || *end || errno || n < (long long)least || n > (long long)most)
		argp_error(state, "--%s is %u..%u, not '%s'", option, least, most, argument);
	return (uint32_t)n;
}

float bench_parse_number(const char *argument, float least, float most, const char *option, struct argp_state *state)
{
	char *end;
	const float x = strtof(argument, &end);
	if (end == argument || *end || !(x >= least && x <= most))
		argp_error(state, "--%s is %g..%g, not '%s'", option, (double)least, (double)most, argument);
	return x;
}

int bench_parse_size(const char *argument, struct argp_state *state)
{
	return (int)bench_parse_count(argument, 16, 8192, "size", state);
}

void bench_parse_area(const char *argument, int *width, int *height, struct argp_state *state)
{
	char end;
	if (sscanf(argument, "%dx%d%c", width, height, &end) != 2 || *width < 16 || *width > 8192 || *height < 16 ||
	    *height > 8192)
		argp_error(state, "--size is WIDTHxHEIGHT, 16..8192 each, not '%s'", argument);
}
