/* How what changes costs as worlds grow (scale_world.h): one thing moves, ten do, a door turns, one comes, one goes, a
 * material changes. One measured value a line:
 *
 *     world,objects,leaves,event,measure,value
 *     hall,100,696,move,cpu ms,86.1
 *     ...
 *
 * "cpu ms" is processor time of the process, all threads, medians of several events; the passes are what gi_report
 * says. "first" is the update after the first commit; "one more" is movable, "one more stays" static where all
 * are, and "first move" is that of a static one.
 */
#define _GNU_SOURCE /* program_invocation_short_name */
#include "bench_options.h"
#include "bench_scene.h"
#include "output.h"
#include "scale_world.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

/* ---- events ---- */

static double processor_ms(void)
{
	struct rusage u;
	getrusage(RUSAGE_SELF, &u);
	return 1e3 * ((double)u.ru_utime.tv_sec + (double)u.ru_stime.tv_sec) +
	       1e-3 * ((double)u.ru_utime.tv_usec + (double)u.ru_stime.tv_usec);
}

typedef enum event {
	FIRST,
	MOVE,
	MOVE_TEN,
	DOOR,
	MATERIAL,
	ADD,
	REMOVE,
	ADD_STAYING,
	LIGHT,
	REMOVE_STAYING,
	FIRST_MOVE,
	EVENTS
} event;
static const char *const event_names[EVENTS] = {
    "first",	"one moves", "ten move",	 "a door turns",   "material",
    "one more", "one less",  "one more stays", "that one is lit", "that one goes",
    "first move"};

typedef struct tally {
	samples cpu, call, wall, passes[GI_PASS_COUNT];
	gi_report report;
} tally;

static bool happens(const scale_world *w, event e)
{
	if (e == FIRST_MOVE)
		return w->settings.kind == SCALE_HALL && w->settings.fixed;
	return e != DOOR || w->doors;
}

/* Calls what makes it happen; returns their processor time. */
static double make_happen(scale_world *w, event e, uint32_t round)
{
	const double began = processor_ms();
	const uint32_t movers = e == MOVE ? 1 : e == MOVE_TEN ? 10 : 0;
	for (uint32_t k = 0; k < movers; k++)
		scale_world_move(w, k, 2 * round + (e == MOVE_TEN)); /* each time another pose */
	if (e == DOOR)
		scale_world_turn_door(w, round);
	if (e == MATERIAL)
		scale_world_paint(w, round);
	if (e == ADD || e == ADD_STAYING)
		scale_world_add(w, e == ADD_STAYING);
	if (e == LIGHT)
		scale_world_light_guest(w);
	if (e == REMOVE || e == REMOVE_STAYING)
		scale_world_remove(w);
	if (e == FIRST_MOVE)
		scale_world_move_staying(w, round);
	if (e == FIRST || (e >= ADD && e != LIGHT && e != FIRST_MOVE))
		check(gi_commit(w->gi));
	return processor_ms() - began;
}

static void measure(scale_world *w, event e, uint32_t round, tally *t)
{
	samples_add(&t->call, make_happen(w, e, round));
	const double began = processor_ms(), wall = now_ms();
	t->report = bench_step(w->gi);
	samples_add(&t->cpu, processor_ms() - began);
	samples_add(&t->wall, now_ms() - wall);
	for (int k = 0; k < GI_PASS_COUNT; k++)
		samples_add(&t->passes[k], (double)t->report.pass_ms[k]);
}

static void print_value(const scale_world *w, const gi_report *r, event e, const char *measure, double value)
{
	printf("%s,%u,%u,%s,%s,%.6g\n", scale_kind_name(w->settings.kind), w->settings.objects, r->leaves, event_names[e], measure, value);
}

static void print_tally(const scale_world *w, event e, const tally *t)
{
	const gi_report *r = &t->report;
	char name[32];
	print_value(w, r, e, "cpu ms", samples_median(&t->cpu));
	print_value(w, r, e, "call cpu ms", samples_median(&t->call));
	print_value(w, r, e, "wall ms", samples_median(&t->wall));
	for (int k = 0; k < GI_PASS_COUNT; k++) {
		snprintf(name, sizeof name, "%s ms", gi_pass_name((gi_pass)k));
		if (samples_median(&t->passes[k]) > 0)
			print_value(w, r, e, name, samples_median(&t->passes[k]));
	}
	print_value(w, r, e, "entries", (double)r->entries);
	print_value(w, r, e, "entries per leaf", (double)r->entries / r->leaves);
	print_value(w, r, e, "dirty entries", (double)r->dirty_entries);
	print_value(w, r, e, "rays", (double)r->rays);
	print_value(w, r, e, "gpu bytes", (double)r->gpu_bytes);
	fflush(stdout);
}

/* ---- options ---- */

typedef struct options {
	engine_context_kind kind;
	scale_settings world;
	bool one_kind; /* world.kind was asked for */
	uint32_t rounds;
	float row_tolerance;
	const char *counts;
	bool chosen[EVENTS]; /* that are measured */
} options;

static void measure_world(engine_context *context, const options *o, const scale_settings *world)
{
	static tally tallies[EVENTS];
	memset(tallies, 0, sizeof tallies);
	bench_settings settings = bench_settings_fine();
	settings.row_tolerance = o->row_tolerance;
	scale_world w;
	scale_world_build(&w, bench_open(context, &settings), world);
	measure(&w, FIRST, 0, &tallies[FIRST]);
	print_tally(&w, FIRST, &tallies[FIRST]);
	for (uint32_t round = 0; round < o->rounds; round++)
		for (event e = MOVE; e < EVENTS; e++)
			if (o->chosen[e] && happens(&w, e))
				measure(&w, e, round, &tallies[e]);
	for (event e = MOVE; e < EVENTS; e++)
		if (o->chosen[e] && happens(&w, e))
			print_tally(&w, e, &tallies[e]);
	gi_context_destroy(w.gi);
	scale_world_free(&w);
}

/* Of names with commas between them; one that goes must come before. */
static void choose_events(options *o, const char *names, struct argp_state *state)
{
	memset(o->chosen, 0, sizeof o->chosen);
	for (const char *next = names; *next;) {
		const size_t length = strcspn(next, ",");
		event e = MOVE;
		while (e < EVENTS && (strlen(event_names[e]) != length || strncmp(next, event_names[e], length)))
			e++;
		if (e == EVENTS)
			argp_error(state, "--events wants names as they are printed, not %s", next);
		o->chosen[e] = true;
		next += length + (next[length] == ',');
	}
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
	options *o = state->input;
	switch (key) {
	case 'c':
		o->kind = bench_parse_context(argument, state);
		return 0;
	case 'n':
		o->counts = argument;
		return 0;
	case 'r':
		o->rounds = (uint32_t)atoi(argument);
		return 0;
	case 'b':
		o->world.cells = (uint32_t)atoi(argument);
		return 0;
	case 'l':
		o->world.cell = (float)atof(argument);
		return 0;
	case 's':
		o->world.fixed = true;
		return 0;
	case 'w':
		o->one_kind = true;
		for (o->world.kind = 0; o->world.kind < SCALE_KINDS; o->world.kind++)
			if (strcmp(argument, scale_kind_name(o->world.kind)) == 0)
				return 0;
		argp_error(state, "--world wants hall or street, not %s", argument);
		return EINVAL;
	case 'e':
		choose_events(o, argument, state);
		return 0;
	case 't':
		o->row_tolerance = (float)atof(argument);
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

int main(int argc, char **argv)
{
	engine_output_watch("gi_scale");
	static const struct argp_option list[] = {
	    BENCH_OPTION_CONTEXT,
	    {"world", 'w', "KIND", 0, "hall or street; default both", 0},
	    {"objects", 'n', "N,N,...", 0, "objects of each world, at least 10, default 10,30,100,300", 0},
	    {"rounds", 'r', "N", 0, "times each event happens, default 3", 0},
	    {"events", 'e', "NAME,...", 0, "those alone, by the names that are printed, default all", 0},
	    {"leaf-size", 'l', "M", 0, "of rooms, metres, default 1", 0},
	    {"cells", 'b', "N", 0, "cells a side of boxes and furniture, default 1", 0},
	    {"static", 's', NULL, 0, "what does not move is GI_MOBILITY_STATIC", 0},
	    {"row-tolerance", 't', "T", 0, "default 0.3", 0},
	    {0},
	};
	const struct argp argp = {list, parse_option, NULL, "How what changes costs as worlds grow, as CSV.", 0, 0, 0};
	options o = {
	    .rounds = 3, .world = {.cell = 1, .cells = 1}, .row_tolerance = .3f, .counts = "10,30,100,300"};
	memset(o.chosen, true, sizeof o.chosen);
	argp_parse(&argp, argc, argv, 0, NULL, &o);
	engine_context *context = bench_open_window(o.kind, 64);
	printf("# %s, commit %s\nworld,objects,leaves,event,measure,value\n", engine_context_describe(context),
	       RELUME_COMMIT);
	for (const char *next = o.counts; *next;) {
		char *end;
		const unsigned long count = strtoul(next, &end, 10);
		if (end == next || count < 10 || count > 1000000)
			fail("--objects wants numbers of 10 and above");
		for (int kind = 0; kind < SCALE_KINDS; kind++) {
			scale_settings world = o.world;
			if (o.one_kind && (int)world.kind != kind)
				continue;
			world.kind = (scale_kind)kind;
			world.objects = (uint32_t)count;
			fprintf(stderr, "gi_scale: %s of %lu objects\n", scale_kind_name(world.kind), count);
			measure_world(context, &o, &world);
		}
		next = *end == ',' ? end + 1 : end;
	}
	engine_context_destroy(context);
	return 0;
}
