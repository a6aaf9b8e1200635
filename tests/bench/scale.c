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
 *
 * A pair of halls of the same size and as many leaves, one of N boxes, the other of 20 that are cut finer, shows what
 * objects cost that are not leaves: movers in both take turns, and "ratio" is the median of the rounds' quotients.
 */
#include "bench_options.h"
#include "bench_scene.h"
#include "scale_world.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- events ---- */

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
static const char *const event_names[EVENTS] = {"first",           "one moves",     "ten move",  "a door turns",
						"material",        "one more",      "one less",  "one more stays",
						"that one is lit", "that one goes", "first move"};

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

/* What a line begins with. */
typedef struct subject {
	const char *world;
	uint32_t objects;
	const char *event;
} subject;

static void print_value(const subject *s, const gi_report *r, const char *measure, double value)
{
	printf("%s,%u,%u,%s,%s,%.6g\n", s->world, s->objects, r->leaves, s->event, measure, value);
}

static void print_tally(const subject *s, const tally *t)
{
	const gi_report *r = &t->report;
	char name[32];
	print_value(s, r, "cpu ms", samples_median(&t->cpu));
	print_value(s, r, "call cpu ms", samples_median(&t->call));
	print_value(s, r, "wall ms", samples_median(&t->wall));
	for (int k = 0; k < GI_PASS_COUNT; k++) {
		snprintf(name, sizeof name, "%s ms", gi_pass_name((gi_pass)k));
		if (samples_median(&t->passes[k]) > 0)
			print_value(s, r, name, samples_median(&t->passes[k]));
	}
	print_value(s, r, "entries", (double)r->entries);
	print_value(s, r, "entries per leaf", (double)r->entries / r->leaves);
	print_value(s, r, "dirty entries", (double)r->dirty_entries);
	print_value(s, r, "rays", (double)r->rays);
	print_value(s, r, "gpu bytes", (double)r->gpu_bytes);
	fflush(stdout);
}

/* ---- options ---- */

typedef struct options {
	scale_settings world;
	bool one_kind; /* world.kind was asked for */
	uint32_t rounds;
	uint32_t pair; /* boxes of the hall beside one of 20; 0: no such pair */
	float row_tolerance;
	const char *counts;
	bool chosen[EVENTS]; /* that are measured */
} options;

static void open_world(engine_context *context, const options *o, const scale_settings *world, scale_world *out)
{
	bench_settings settings = bench_settings_fine();
	settings.row_tolerance = o->row_tolerance;
	scale_world_build(out, bench_open(context, &settings), world);
}

static void close_world(scale_world *w)
{
	gi_context_destroy(w->gi);
	scale_world_free(w);
}

static void print_event(const scale_world *w, event e, const tally *t)
{
	print_tally(&(subject){scale_kind_name(w->settings.kind), w->settings.objects, event_names[e]}, t);
}

static void measure_world(engine_context *context, const options *o, const scale_settings *world)
{
	static tally tallies[EVENTS];
	memset(tallies, 0, sizeof tallies);
	scale_world w;
	open_world(context, o, world, &w);
	measure(&w, FIRST, 0, &tallies[FIRST]);
	print_event(&w, FIRST, &tallies[FIRST]);
	for (uint32_t round = 0; round < o->rounds; round++)
		for (event e = MOVE; e < EVENTS; e++)
			if (o->chosen[e] && happens(&w, e))
				measure(&w, e, round, &tallies[e]);
	for (event e = MOVE; e < EVENTS; e++)
		if (o->chosen[e] && happens(&w, e))
			print_event(&w, e, &tallies[e]);
	close_world(&w);
}

/* ---- a pair ---- */

enum { FEW = 20, FEW_STAY = 10 }; /* boxes; the others move */

/* Of MANY and the others: the mover cut as finely as all of FEW, or as coarsely as in the world of many. */
typedef enum side { MANY, FEW_ALIKE, FEW_WITH_SMALL_MOVERS, SIDES } side;

/* Boxes in all have the leaves of `boxes` that have one a face. */
static uint32_t cells_of(double boxes, uint32_t shared_by)
{
	return (uint32_t)fmax(1, round(sqrt(boxes / shared_by)));
}

static scale_settings side_settings(const options *o, side which)
{
	scale_settings s = {.kind = SCALE_HALL, .objects = o->pair, .cell = o->world.cell, .cells = 1, .fixed = true};
	if (which == MANY)
		return s;
	s.objects = FEW;
	s.room = o->pair;
	s.cells = cells_of(o->pair, FEW);
	if (which == FEW_WITH_SMALL_MOVERS) {
		s.mover_cells = 1;
		s.cells = cells_of(o->pair - (FEW - FEW_STAY), FEW_STAY);
	}
	return s;
}

static void print_pair(const options *o, tally tallies[SIDES])
{
	static const char *const events[SIDES] = {"one moves", "one moves", "one of a leaf a face moves"};
	for (int k = 0; k < SIDES; k++) {
		const subject about = {"pair", k == MANY ? o->pair : FEW, events[k]};
		print_tally(&about, &tallies[k]);
		static samples ratios;
		ratios.count = 0;
		for (uint32_t n = 0; k != MANY && n < tallies[k].cpu.count; n++)
			samples_add(&ratios, tallies[MANY].cpu.values[n] / tallies[k].cpu.values[n]);
		if (k != MANY)
			print_value(&about, &tallies[k].report, "ratio", samples_median(&ratios));
	}
	fflush(stdout);
}

/* Pools have grown and shaders are compiled after two rounds. */
enum { SETTLE = 2 };

static void measure_pair(engine_context *context, const options *o)
{
	static tally tallies[SIDES], before;
	scale_world worlds[SIDES];
	for (int k = 0; k < SIDES; k++) {
		const scale_settings settings = side_settings(o, (side)k);
		open_world(context, o, &settings, &worlds[k]);
		check(gi_commit(worlds[k].gi));
		bench_step(worlds[k].gi);
	}
	for (uint32_t round = 0; round < SETTLE + o->rounds; round++)
		for (int k = 0; k < SIDES; k++)
			measure(&worlds[k], MOVE, round, round < SETTLE ? &before : &tallies[k]);
	print_pair(o, tallies);
	for (int k = 0; k < SIDES; k++)
		close_world(&worlds[k]);
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
	case 'n':
		o->counts = argument;
		return 0;
	case 'r':
		o->rounds = bench_parse_count(argument, 1, MAX_SAMPLES, "rounds", state);
		return 0;
	case 'p':
		o->pair = bench_parse_count(argument, 0, 1000000, "pair", state);
		if (o->pair && o->pair < FEW)
			argp_error(state, "--pair is 0, or %d and more", FEW);
		return 0;
	case 'b':
		o->world.cells = bench_parse_count(argument, 1, 1000, "cells", state);
		return 0;
	case 'l':
		o->world.cell = bench_parse_number(argument, .01f, 1000, "leaf-size", state);
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
		o->row_tolerance = bench_parse_number(argument, 1e-5f, 1, "row-tolerance", state);
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

int main(int argc, char **argv)
{
	static const struct argp_option list[] = {
	    {"world", 'w', "KIND", 0, "hall or street; default both", 0},
	    {"objects", 'n', "N,N,...", 0, "objects of each world, at least 10, default 10,30,100,300", 0},
	    {"rounds", 'r', "N", 0, "times each event happens, default 3", 0},
	    {"events", 'e', "NAME,...", 0, "those alone, by the names that are printed, default all", 0},
	    {"pair", 'p', "N", 0, "a hall of N boxes beside one of 20 and as many leaves, default 2000; 0: none", 0},
	    {"leaf-size", 'l', "M", 0, "of rooms, metres, default 1", 0},
	    {"cells", 'b', "N", 0, "cells a side of boxes and furniture, default 1", 0},
	    {"static", 's', NULL, 0, "what does not move is GI_MOBILITY_STATIC", 0},
	    {"row-tolerance", 't', "T", 0, "default 0.3", 0},
	    {0},
	};
	const bench_command command = {"gi_scale", "How what changes costs as worlds grow, as CSV.", list,
				       parse_option};
	options o = {.rounds = 3,
		     .pair = 2000,
		     .world = {.cell = 1, .cells = 1},
		     .row_tolerance = .3f,
		     .counts = "10,30,100,300"};
	memset(o.chosen, true, sizeof o.chosen);
	const engine_context_kind kind = bench_parse(&command, argc, argv, &o);
	engine_context *context = bench_open_window(kind, 64);
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
	if (o.pair) {
		fprintf(stderr, "gi_scale: halls of %u and %d boxes in turn\n", o.pair, FEW);
		measure_pair(context, &o);
	}
	engine_context_destroy(context);
	return 0;
}
