/* How what changes costs as worlds grow: a hall full of boxes, one of which moves, one comes, one goes, a material
 * changes. One measured value a line:
 *
 *     objects,leaves,event,measure,value
 *     100,696,move,cpu ms,86.1
 *     ...
 *
 * "cpu ms" is processor time of the process, all threads, medians of several events; the passes are what gi_report
 * says. Events: first (the update after the first commit), move, rest of ten that move, material, one that is movable
 * comes and goes, one that stays where it is comes, is lit and goes, another moves for the first time. "call cpu ms": of
 * the calls before gi_update.
 */
#define _GNU_SOURCE /* program_invocation_short_name */
#include "bench_options.h"
#include "bench_scene.h"
#include "output.h"
#include "scenes/body.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

/* ---- the world ---- */

static const float PITCH = 1.5f; /* between boxes, metres */
static const float HEIGHT = 3;

typedef struct world {
	gi_context *gi;
	gi_object *boxes;
	uint32_t count, columns;
	uint32_t box_cells;
	bool statics;
} world;

/* A number in [0,1) of two: the same whatever else there is. */
static float random_of(uint32_t a, uint32_t b)
{
	uint32_t h = a * 0x9e3779b9u ^ (b + 0x7f4a7c15u) * 0x85ebca6bu;
	h = (h ^ h >> 16) * 0x7feb352du;
	h = (h ^ h >> 15) * 0x846ca68bu;
	return (float)((h ^ h >> 16) >> 8) * (1.0f / 16777216.0f);
}

/* The k-th of those that move, all over the hall. */
static uint32_t mover_of(const world *w, uint32_t k)
{
	return (w->count / 2 + k * (w->count / 10 + 1)) % w->count;
}

static bool moves(const world *w, uint32_t number)
{
	bool found = false;
	for (uint32_t k = 0; k < 10 && k < w->count; k++)
		found = found || mover_of(w, k) == number;
	return found;
}

static gi_object add_mesh(const world *w, bool stays, const char *name, engine_mesh *mesh, gi_material material,
			  gi_pose pose)
{
	gi_object_def def = scene_mesh_def(mesh);
	def.name = name;
	def.materials = &material;
	def.material_count = 1;
	def.pose = pose;
	def.mobility = w->statics && stays ? GI_MOBILITY_STATIC : GI_MOBILITY_MOVABLE;
	gi_object object;
	check(gi_create_object(w->gi, &def, &object));
	engine_mesh_free(mesh);
	return object;
}

static gi_pose pose_of(const world *w, uint32_t number, float shift)
{
	const uint32_t i = number % w->columns, j = number / w->columns;
	const float turn = 1.5f * random_of(number, 5);
	return (gi_pose){{PITCH * ((float)i + .3f + .4f * random_of(number, 1)) + shift, .01f,
			  PITCH * ((float)j + .3f + .4f * random_of(number, 2))},
			 {0, sinf(turn), 0, cosf(turn)}};
}

static gi_object add_box(world *w, uint32_t number, bool stays)
{
	engine_mesh mesh;
	const float half = .15f + .15f * random_of(number, 3), high = .3f + 1.2f * random_of(number, 4);
	if (!shape_box((float[]){-half, 0, -half}, (float[]){half, high, half}, w->box_cells, false, &mesh))
		fail("out of memory");
	const gi_material material = {.rho = {.7f, .6f, .3f + .4f * random_of(number, 6)}};
	return add_mesh(w, stays, "box", &mesh, material, pose_of(w, number, 0));
}

static void build_world(world *w)
{
	engine_mesh mesh;
	w->columns = (uint32_t)ceil(sqrt((double)w->count + 1)); /* room for the one that comes */
	const float side = PITCH * (float)w->columns;
	if (!shape_box((float[]){0, 0, 0}, (float[]){side, HEIGHT, side}, 4, true, &mesh))
		fail("out of memory");
	add_mesh(w, true, "hall", &mesh, (gi_material){.rho = {.6f, .6f, .6f}}, gi_pose_identity());
	const float middle = .5f * side, half = .1f * side;
	if (!shape_quad((float[]){middle - half, HEIGHT - .05f, middle - half}, (float[]){2 * half, 0, 0},
			(float[]){0, 0, 2 * half}, 2, 2, &mesh))
		fail("out of memory");
	add_mesh(w, true, "lamp", &mesh, (gi_material){.exitance = {10, 10, 9}}, gi_pose_identity());
	w->boxes = calloc(w->count + 1, sizeof *w->boxes);
	if (!w->boxes)
		fail("out of memory");
	for (uint32_t k = 0; k < w->count; k++)
		w->boxes[k] = add_box(w, k, !moves(w, k));
}

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
	MATERIAL,
	ADD,
	REMOVE,
	ADD_STAYING,
	LIGHT,
	REMOVE_STAYING,
	FIRST_MOVE,
	EVENTS
} event;
static const char *const event_names[EVENTS] = {"first",  "move",        "move ten", "material",       "add",
						"remove", "add staying", "light",    "remove staying", "first move"};

typedef struct tally {
	samples cpu, commit, wall, passes[GI_PASS_COUNT];
	gi_report report;
} tally;

static void make_happen(world *w, event e, uint32_t round, double *commit_ms)
{
	const double began = processor_ms();
	const uint32_t movers = e == MOVE ? 1 : e == MOVE_TEN ? 10 : 0;
	for (uint32_t k = 0; k < movers && k < w->count; k++) {
		const uint32_t number = mover_of(w, k);
		check(gi_set_pose(w->gi, w->boxes[number], pose_of(w, number, .02f * (float)(round % 5 + 1))));
	}
	if (e == FIRST_MOVE) { /* which makes it movable: another one each time */
		uint32_t number = (w->count / 3 + round) % w->count;
		while (moves(w, number))
			number = (number + 1) % w->count;
		check(gi_set_pose(w->gi, w->boxes[number], pose_of(w, number, .02f)));
	}
	if (e == MATERIAL) {
		const float rho = .3f + .05f * (float)(round % 7);
		check(gi_set_material(w->gi, w->boxes[w->count / 2], 0, (gi_material){.rho = {rho, rho, rho}}));
	}
	gi_object *last = &w->boxes[w->count];
	if (e == ADD || e == ADD_STAYING)
		*last = add_box(w, w->count, e == ADD_STAYING);
	if (e == LIGHT)
		check(gi_set_material(w->gi, *last, 0, (gi_material){.rho = {.5f, .5f, .5f}, .exitance = {1, 1, 1}}));
	if (e == REMOVE || e == REMOVE_STAYING)
		check(gi_destroy_object(w->gi, *last));
	if (e == FIRST || e == ADD || e == REMOVE || e == ADD_STAYING || e == REMOVE_STAYING)
		check(gi_commit(w->gi));
	*commit_ms = processor_ms() - began;
}

static void measure(world *w, event e, uint32_t round, tally *t)
{
	double commit_ms;
	make_happen(w, e, round, &commit_ms);
	const double began = processor_ms(), wall = now_ms();
	t->report = bench_step(w->gi);
	samples_add(&t->cpu, processor_ms() - began);
	samples_add(&t->commit, commit_ms);
	samples_add(&t->wall, now_ms() - wall);
	for (int k = 0; k < GI_PASS_COUNT; k++)
		samples_add(&t->passes[k], (double)t->report.pass_ms[k]);
}

static void print_value(const world *w, const gi_report *r, event e, const char *measure, double value)
{
	printf("%u,%u,%s,%s,%.6g\n", w->count, r->leaves, event_names[e], measure, value);
}

static void print_tally(const world *w, event e, const tally *t)
{
	const gi_report *r = &t->report;
	char name[32];
	print_value(w, r, e, "cpu ms", samples_median(&t->cpu));
	print_value(w, r, e, "call cpu ms", samples_median(&t->commit));
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
	uint32_t rounds, cells;
	bool statics;
	float row_tolerance;
	const char *counts;
} options;

static void measure_world(engine_context *context, const options *o, uint32_t count)
{
	static tally tallies[EVENTS];
	memset(tallies, 0, sizeof tallies);
	bench_settings settings = bench_settings_fine();
	settings.row_tolerance = o->row_tolerance;
	world w = {.gi = bench_open(context, &settings), .count = count, .box_cells = o->cells, .statics = o->statics};
	build_world(&w);
	measure(&w, FIRST, 0, &tallies[FIRST]);
	print_tally(&w, FIRST, &tallies[FIRST]);
	for (uint32_t round = 0; round < o->rounds; round++)
		for (event e = MOVE; e < EVENTS; e++)
			measure(&w, e, round, &tallies[e]);
	for (event e = MOVE; e < EVENTS; e++)
		print_tally(&w, e, &tallies[e]);
	gi_context_destroy(w.gi);
	free(w.boxes);
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
		o->cells = (uint32_t)atoi(argument);
		return 0;
	case 's':
		o->statics = true;
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
	    {"objects", 'n', "N,N,...", 0, "boxes of each world, default 10,30,100,300", 0},
	    {"rounds", 'r', "N", 0, "times each event happens, default 3", 0},
	    {"cells", 'b', "N", 0, "cells a side of a box, default 1", 0},
	    {"static", 's', NULL, 0, "what does not move is GI_MOBILITY_STATIC", 0},
	    {"row-tolerance", 't', "T", 0, "default 0.3", 0},
	    {0},
	};
	const struct argp argp = {list, parse_option, NULL, "How what changes costs as worlds grow, as CSV.", 0, 0, 0};
	options o = {.rounds = 3, .cells = 1, .row_tolerance = .3f, .counts = "10,30,100,300"};
	argp_parse(&argp, argc, argv, 0, NULL, &o);
	engine_context *context = bench_open_window(o.kind, 64);
	printf("# %s\nobjects,leaves,event,measure,value\n", engine_context_describe(context));
	for (const char *next = o.counts; *next;) {
		char *end;
		const unsigned long count = strtoul(next, &end, 10);
		if (end == next)
			fail("--objects wants numbers");
		fprintf(stderr, "gi_scale: %lu objects\n", count);
		measure_world(context, &o, (uint32_t)count);
		next = *end == ',' ? end + 1 : end;
	}
	engine_context_destroy(context);
	return 0;
}
