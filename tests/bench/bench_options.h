/* Command lines of the benchmarks. What is wrong with one is argp's line, and the end of the program. */
#ifndef TESTS_BENCH_BENCH_OPTIONS_H
#define TESTS_BENCH_BENCH_OPTIONS_H

#include "context.h"

#include <argp.h>
#include <stdint.h>

/* Options of one benchmark; --context, which all have, is not among them. */
typedef struct bench_command {
	const char *name; /* of the program */
	const char *about;
	const struct argp_option *options;
	argp_parser_t parse; /* state->input is what bench_parse was given */
} bench_command;

/* Returns what --context says. Also sees to it that an output that cannot be written fails the program. */
engine_context_kind bench_parse(const bench_command *command, int argc, char **argv, void *options);

/* What an option's argument says; `option` is its long name. */
uint32_t bench_parse_count(const char *argument, uint32_t least, uint32_t most, const char *option,
			   struct argp_state *state);
float bench_parse_number(const char *argument, float least, float most, const char *option, struct argp_state *state);
int bench_parse_size(const char *argument, struct argp_state *state);                           /* pixels, 16..8192 */
void bench_parse_area(const char *argument, int *width, int *height, struct argp_state *state); /* the same, WxH */

#endif
