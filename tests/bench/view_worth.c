/* What it is worth to tell an update which camera looks (gi_budget.view): the same world under the same budget, with
 * and without, both against an exact one. Prints a table; never passes or fails on a figure.
 *
 * The error of a picture is the RMS of the difference of its linear indirect radiance over the RMS of the exact
 * picture's, that of the scene the RMS of B - E over all leaves by area likewise: what the camera gains, others may
 * lose.
 */
#include "bench_leaves.h"
#include "bench_options.h"
#include "bench_scene.h"
#include "scale_world.h"
#include "scenes/look_at.h"
#include "scenes/scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { EXACT, ALIKE, VIEWED, RUNS };
enum { LOOK_EVERY = 4, TEN_MOVE = 10 };

typedef struct options {
	float share; /* of the rays of the exact update: what the others get */
	float ms;    /* > 0: they get that much time instead */
	uint32_t frames;
	int size;
} options;

/* A world that is made three times. */
typedef struct stage {
	const char *name;
	const scene_kind *kind; /* or else */
	scale_settings settings;
	float eye[3], target[3];
} stage;

static const stage STAGES[] = {
    {.name = "cornell"},
    {.name = "rooms"},
    {.name = "hall",
     .settings = {.kind = SCALE_HALL, .objects = 60, .cell = .5f, .cells = 2},
     .eye = {3, 1.7f, 1},
     .target = {1.5f, .5f, 4}},
    {.name = "street",
     .settings = {.kind = SCALE_STREET, .objects = 60, .cell = .6f, .cells = 1},
     .eye = {.5f, 1.7f, 2.1f},
     .target = {3.4f, .7f, 5.4f}},
};

typedef struct run {
	gi_context *gi;
	scale_world world; /* of a stage without a kind */
	gi_object mover;   /* of one with */
	float *picture;
} run;

typedef struct show {
	const options *o;
	const stage *stage;
	engine_target *target;
	gi_view view;
	run runs[RUNS];
	samples picture[RUNS], scene[RUNS], rays[RUNS];
} show;

static void *allocate(size_t count, size_t size)
{
	void *memory = calloc(count, size);
	if (!memory)
		fail("out of memory");
	return memory;
}

static void open_run(run *r, const stage *s, engine_context *context, int size)
{
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = engine_context_find_gl;
	def.get_proc_user = context;
	def.row_tolerance = bench_settings_coarse().row_tolerance;
	def.sky = s->kind ? s->kind->sky : GI_SKY_OFF;
	check(gi_context_create(&def, &r->gi));
	if (s->kind)
		check(s->kind->create(r->gi, &r->mover));
	else
		scale_world_build(&r->world, r->gi, &s->settings);
	check(gi_commit(r->gi));
	r->picture = allocate(3 * (size_t)size * (size_t)size, sizeof *r->picture);
}

static void close_run(run *r)
{
	scale_world_free(&r->world);
	gi_context_destroy(r->gi);
	free(r->picture);
}

static void move(run *r, const stage *s, uint32_t frame)
{
	if (s->kind)
		check(gi_set_pose(r->gi, r->mover, s->kind->pose((float)frame / 24)));
	for (uint32_t k = 0; !s->kind && k < TEN_MOVE; k++)
		scale_world_move(&r->world, k, frame);
}

static void look(const show *s, run *r)
{
	engine_target_begin(s->target);
	check(gi_draw(r->gi, &s->view));
	engine_target_read_radiance(s->target, r->picture);
}

static double picture_error(const show *s, const run *r)
{
	const size_t values = 3 * (size_t)s->o->size * (size_t)s->o->size;
	double off = 0, all = 0;
	for (size_t k = 0; k < values; k++) {
		const double exact = (double)s->runs[EXACT].picture[k], d = (double)r->picture[k] - exact;
		off += d * d;
		all += exact * exact;
	}
	return 100 * sqrt(off / all);
}

static double scene_error(const show *s, const run *r)
{
	uint32_t count;
	gi_leaf *exact = bench_leaves(s->runs[EXACT].gi, &count), *mine = bench_leaves(r->gi, &count);
	const double off = bench_leaves_distance(mine, exact, count).percent;
	free(exact);
	free(mine);
	return off;
}

static void step(show *s, uint32_t frame)
{
	gi_budget budget = {0}; /* none of the exact run, which is the first */
	for (int k = 0; k < RUNS; k++) {
		gi_report report;
		move(&s->runs[k], s->stage, frame);
		budget.view = k == VIEWED ? &s->view : NULL;
		check(gi_update(s->runs[k].gi, frame ? &budget : NULL));
		check(gi_finish(s->runs[k].gi));
		check(gi_get_report(s->runs[k].gi, &report));
		if (k == EXACT)
			budget =
			    (gi_budget){.ms = s->o->ms,
					.rays = s->o->ms > 0 ? 0 : 1 + (uint64_t)(s->o->share * (float)report.rays)};
		if (frame)
			samples_add(&s->rays[k], (double)report.rays);
	}
	if (frame < s->o->frames / 2 || frame % LOOK_EVERY)
		return;
	for (int k = 0; k < RUNS; k++)
		look(s, &s->runs[k]);
	for (int k = ALIKE; k < RUNS; k++) {
		samples_add(&s->picture[k], picture_error(s, &s->runs[k]));
		samples_add(&s->scene[k], scene_error(s, &s->runs[k]));
	}
}

static void play(engine_context *context, engine_target *target, const stage *stage, const options *o)
{
	show *s = allocate(1, sizeof *s);
	s->o = o;
	s->stage = stage;
	s->target = target;
	s->view = gi_view_default();
	s->view.mode = GI_MODE_INDIRECT;
	s->view.width = s->view.height = (uint32_t)o->size;
	if (stage->kind)
		stage->kind->camera(1, s->view.view_from_world, s->view.clip_from_view);
	else
		look_at(stage->eye, stage->target, 60, 1, s->view.view_from_world, s->view.clip_from_view);
	for (int k = 0; k < RUNS; k++)
		open_run(&s->runs[k], stage, context, o->size);
	for (uint32_t frame = 0; frame <= o->frames; frame++)
		step(s, frame);
	printf("| %s | %.0f | %.0f | %.0f | %.2f %% | %.2f %% | %.2f | %.2f %% | %.2f %% |\n", stage->name,
	       samples_median(&s->rays[EXACT]), samples_median(&s->rays[ALIKE]), samples_median(&s->rays[VIEWED]),
	       samples_median(&s->picture[ALIKE]), samples_median(&s->picture[VIEWED]),
	       samples_median(&s->picture[VIEWED]) / samples_median(&s->picture[ALIKE]),
	       samples_median(&s->scene[ALIKE]), samples_median(&s->scene[VIEWED]));
	fflush(stdout);
	for (int k = 0; k < RUNS; k++)
		close_run(&s->runs[k]);
	free(s);
}

/* ---- the program ---- */

static const struct argp_option OPTIONS[] = {
    {"share", 'r', "X", 0, "rays of an update, of those of an exact one, default 0.1", 0},
    {"budget-ms", 'm', "MS", 0, "milliseconds of an update instead", 0},
    {"frames", 'n', "N", 0, "frames, default 40; those of the second half count", 0},
    {"size", 's', "PIXELS", 0, "width and height, default 128", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
	options *o = state->input;
	switch (key) {
	case 'r':
		o->share = bench_parse_number(argument, 0, 1, "share", state);
		return 0;
	case 'm':
		o->ms = bench_parse_number(argument, 0, 10000, "budget-ms", state);
		return 0;
	case 'n':
		o->frames = bench_parse_count(argument, 8, MAX_SAMPLES, "frames", state);
		return 0;
	case 's':
		o->size = bench_parse_size(argument, state);
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

int main(int argc, char **argv)
{
	static const bench_command command = {.name = "gi_view_worth",
					      .about = "What it is worth to tell an update under a budget which camera "
						       "looks.",
					      .options = OPTIONS,
					      .parse = parse};
	options o = {.share = .1f, .frames = 40, .size = 128};
	engine_context *context = bench_open_window(bench_parse(&command, argc, argv, &o), o.size);
	engine_target *target = bench_open_target(o.size);
	printf(
	    "| scene | rays, exact | budget | with a camera | picture off | with a camera | ratio | scene off | with "
	    "a camera |\n|---|---|---|---|---|---|---|---|---|\n");
	for (size_t k = 0; k < sizeof STAGES / sizeof *STAGES; k++) {
		stage s = STAGES[k];
		s.kind = scene_kind_find(s.name);
		play(context, target, &s, &o);
	}
	engine_target_destroy(target);
	engine_context_destroy(context);
	return 0;
}
