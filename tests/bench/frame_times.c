/* What the moving Buddha's frames take, one measured value a line, for scripts/bench against: it compiles this against
 * two commits and runs them in turn.
 *
 *     series,measure,value
 *     fine,update ms,441.3
 *     ...
 *
 * fine: the library's defaults. coarse: row tolerance 0.1. Before them a line "# " and the renderer.
 */
#include "bench_options.h"
#include "bench_scene.h"

#include <stdio.h>
#include <stdlib.h>

enum { SETTLE = 2 }; /* frames before those that count: pools grow, shaders compile */

static const float DEMO_FPS = 24; /* how far the Buddha goes from frame to frame */

typedef struct frame_times {
	const char *series;
	bench_settings settings;
	engine_context *context;
	engine_target *target;
	int size;
	uint32_t frames, rebuilds;
	gi_context *gi;
	cornell scene;
} frame_times;

static void print_value(const frame_times *f, const char *measure, double value)
{
	printf("%s,%s,%.4f\n", f->series, measure, value);
}

static void print_ms(const frame_times *f, const char *measure, double began)
{
	char name[32];
	snprintf(name, sizeof name, "%s ms", measure);
	print_value(f, name, now_ms() - began);
}

static void pose(const frame_times *f, uint32_t k)
{
	check(gi_set_pose(f->gi, f->scene.buddha, cornell_buddha_pose((float)(k + 1) / DEMO_FPS)));
}

static void print_passes(const frame_times *f, const gi_report *r)
{
	char name[32];
	for (int k = 0; k < GI_PASS_COUNT; k++) {
		snprintf(name, sizeof name, "%s ms", gi_pass_name((gi_pass)k));
		if (r->pass_ms[k] > 0)
			print_value(f, name, (double)r->pass_ms[k]);
	}
	print_value(f, "rays", (double)r->rays);
	print_value(f, "sweeps", r->sweeps);
}

/* An update, its picture, both waited for. */
static void measure_frame(const frame_times *f, uint32_t k)
{
	gi_report report;
	const double began = now_ms();
	pose(f, k);
	bench_step(f->gi);
	if (k >= SETTLE)
		print_ms(f, "update", began);
	bench_draw(f->gi, f->target, f->size);
	check(gi_finish(f->gi));
	if (k < SETTLE)
		return;
	print_ms(f, "frame", began);
	check(gi_get_report(f->gi, &report));
	print_passes(f, &report);
}

/* All rows, hierarchies and trees kept. */
static void measure_rebuild(const frame_times *f, uint32_t k)
{
	pose(f, k);
	gi_invalidate(f->gi);
	const double began = now_ms();
	bench_step(f->gi);
	print_ms(f, "rebuild", began);
}

static void destroy_objects(const frame_times *f)
{
	const cornell *c = &f->scene;
	const gi_object all[] = {c->floor, c->ceiling, c->back,     c->left,    c->right,
				 c->light, c->buddha,  c->balls[0], c->balls[1]};
	for (size_t k = 0; k < sizeof all / sizeof *all; k++)
		check(gi_destroy_object(f->gi, all[k]));
	check(gi_commit(f->gi));
	bench_step(f->gi);
}

/* Objects, refinement, hierarchies, trees, rows, a solve from B = E; shaders are compiled before. */
static void measure_from_nothing(frame_times *f, uint32_t k)
{
	destroy_objects(f);
	const double began = now_ms();
	f->scene = bench_create(f->gi, f->settings.wall_levels);
	pose(f, k);
	bench_step(f->gi);
	print_ms(f, "from nothing", began);
}

static void measure_series(frame_times *f)
{
	f->gi = bench_open(f->context, &f->settings);
	f->scene = bench_create(f->gi, f->settings.wall_levels);
	const gi_report first = bench_step(f->gi);
	print_value(f, "leaves", first.leaves);
	print_value(f, "entries", (double)first.entries);
	for (uint32_t k = 0; k < f->frames + SETTLE; k++)
		measure_frame(f, k);
	for (uint32_t k = 0; k < f->rebuilds; k++) {
		measure_rebuild(f, k);
		measure_from_nothing(f, k);
	}
	gi_context_destroy(f->gi);
}

/* ---- options ---- */

typedef struct options {
	uint32_t frames, rebuilds;
	int size;
	float row_tolerance; /* of the fine series; 0: the library's default */
} options;

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
	options *o = state->input;
	switch (key) {
	case 'n':
		o->frames = bench_parse_count(argument, 1, MAX_SAMPLES - SETTLE, "frames", state);
		return 0;
	case 'r':
		o->rebuilds = bench_parse_count(argument, 0, MAX_SAMPLES, "rebuilds", state);
		return 0;
	case 's':
		o->size = bench_parse_size(argument, state);
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
	    {"frames", 'n', "N", 0, "moving frames of a series, default 6", 0},
	    {"rebuilds", 'r', "N", 0, "rebuilds and starts from nothing of a series, default 2", 0},
	    {"size", 's', "PIXELS", 0, "width and height, default 512", 0},
	    {"row-tolerance", 't', "T", 0, "of the fine series, default the library's", 0},
	    {0},
	};
	const bench_command command = {"frame_times", "What frames of the moving Buddha take, as CSV.", list,
				       parse_option};
	options o = {.frames = 6, .rebuilds = 2, .size = 512};
	const engine_context_kind kind = bench_parse(&command, argc, argv, &o);
	engine_context *context = bench_open_window(kind, o.size);
	engine_target *target = bench_open_target(o.size);
	frame_times series[] = {{.series = "fine", .settings = bench_settings_fine()},
				{.series = "coarse", .settings = bench_settings_coarse()}};
	if (o.row_tolerance > 0)
		series[0].settings.row_tolerance = o.row_tolerance;
	printf("# %s\nseries,measure,value\n", engine_context_describe(context));
	for (size_t k = 0; k < sizeof series / sizeof *series; k++) {
		frame_times *f = series + k;
		f->context = context;
		f->target = target;
		f->size = o.size;
		f->frames = o.frames;
		f->rebuilds = o.rebuilds;
		print_value(f, "row tolerance", (double)f->settings.row_tolerance);
		measure_series(f);
	}
	engine_target_destroy(target);
	engine_context_destroy(context);
	return 0;
}
