/* The benchmark: what a frame of the moving Buddha costs on this machine, what a budget makes of it, an update against
 * a rebuild, a scene at rest.
 *
 * Prints figures, never passes or fails on one. Both sides of a comparison run in turn in the same loop, ratios are of
 * medians.
 */
#include "bench_options.h"
#include "bench_frames.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MAX_FRAMES = MAX_SAMPLES };

typedef struct options {
	uint32_t frames;
	int size;
	bench_settings settings; /* of the frame-rate runs */
	gi_budget budget;        /* of the first of them */
	float fps;               /* of its animation */
	float budget_fps;        /* asked for in the frame rates' table; 0: two usual ones */
	float update_ms;         /* likewise of an update, in the budgets' */
} options;

/* ---- update against rebuild ---- */

static gi_context *open_gi(engine_context *context, const options *o, float row_tolerance)
{
	bench_settings settings = o->settings;
	settings.row_tolerance = row_tolerance;
	return bench_open(context, &settings);
}

/* One frame of one side; everything that gi_update issues, waited for. */
static double timed_step(gi_context *gi, gi_object object, gi_pose pose, bool rebuild)
{
	check(gi_set_pose(gi, object, pose));
	if (rebuild)
		gi_invalidate(gi);
	const double began = now_ms();
	bench_step(gi);
	return now_ms() - began;
}

/* From nothing: objects, refinement, hierarchies, trees, rows, a cold solve. */
static double timed_restart(engine_context *context, const options *o, float row_tolerance, gi_pose pose)
{
	gi_context *gi = open_gi(context, o, row_tolerance);
	const double began = now_ms();
	const cornell scene = bench_create(gi, o->settings.wall_levels);
	check(gi_set_pose(gi, scene.buddha, pose));
	bench_step(gi);
	const double ms = now_ms() - began;
	gi_context_destroy(gi);
	return ms;
}

static void run_update_and_rebuild(engine_context *context, const options *o, float row_tolerance, bool ball)
{
	gi_context *sides[2];
	cornell scenes[2];
	for (int k = 0; k < 2; k++) {
		sides[k] = open_gi(context, o, row_tolerance);
		scenes[k] = bench_create(sides[k], o->settings.wall_levels);
		bench_step(sides[k]);
	}
	static samples times[2], restart;
	times[0].count = times[1].count = restart.count = 0;
	for (uint32_t k = 0; k < o->frames / 2 + 2; k++) {
		const float t = 0.1f * (float)(k + 1);
		gi_pose pose = cornell_buddha_pose(t);
		if (ball) {
			check(gi_get_pose(sides[0], scenes[0].balls[1], &pose));
			pose.position[1] = 0.4f + 0.3f * fabsf(sinf(t));
		}
		for (int side = 0; side < 2; side++) {
			const gi_object object = ball ? scenes[side].balls[1] : scenes[side].buddha;
			const double ms = timed_step(sides[side], object, pose, side == 1);
			if (k >= 2)
				samples_add(&times[side], ms);
		}
		if (!ball && k % 8 == 2)
			samples_add(&restart, timed_restart(context, o, row_tolerance, pose));
	}
	gi_report report;
	check(gi_get_report(sides[0], &report));
	printf("| %s | %g | %.0f | %.1f %% | %.1f | %.1f | %.2f |", ball ? "small ball" : "Buddha",
	       (double)row_tolerance, (double)report.entries / report.leaves,
	       100.0 * (double)report.dirty_entries / (double)report.entries, samples_median(&times[0]),
	       samples_median(&times[1]), samples_median(&times[1]) / samples_median(&times[0]));
	if (restart.count)
		printf(" %.0f | %.1f |\n", samples_median(&restart),
		       samples_median(&restart) / samples_median(&times[0]));
	else
		printf(" | |\n");
	for (int k = 0; k < 2; k++)
		gi_context_destroy(sides[k]);
}

static void run_updates_and_rebuilds(engine_context *context, const options *o)
{
	printf("## Update against rebuild, the same frames in turn\n\n");
	printf("| mover | row tolerance | entries per leaf | dirty | update ms | rebuild ms | ratio | from nothing ms "
	       "| ratio |\n");
	printf("|---|---|---|---|---|---|---|---|---|\n");
	run_update_and_rebuild(context, o, o->settings.row_tolerance, false);
	run_update_and_rebuild(context, o, 0.01f, false);
	run_update_and_rebuild(context, o, o->settings.row_tolerance, true);
	run_update_and_rebuild(context, o, 0.01f, true);
}

/* ---- budgets that keep a frame rate ---- */

static void run_rates(const bench_run *usual, const options *o)
{
	bench_run run = *usual;
	printf("## Under a budget that keeps a frame rate, %d x %d, row tolerance %g\n\n", run.size, run.size,
	       (double)run.settings.row_tolerance);
	bench_rate_head();
	run.fps = o->budget_fps > 0 ? o->budget_fps : 30;
	bench_rate(&run);
	if (!(o->budget_fps > 0) && run.settings.wall_levels > 0) {
		run.fps = 60;
		run.settings.wall_levels--;
		bench_rate(&run);
	}
	printf("\n");
}

/* ---- budgets of time ---- */

static void run_budgets(engine_context *context, const options *o)
{
	static const char *const scenes[] = {"cornell", "corridor"};
	printf("## Under a budget of time, the library's defaults\n\n");
	bench_budget_head();
	for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++)
		bench_budget(context, scene_kind_find(scenes[k]), o->update_ms, o->frames);
	printf("\n");
}

/* ---- options ---- */

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
	options *o = state->input;
	switch (key) {
	case 'n':
		o->frames = bench_parse_count(argument, 4, MAX_FRAMES, "frames", state);
		return 0;
	case 's':
		o->size = bench_parse_size(argument, state);
		return 0;
	case 't':
		o->settings.row_tolerance = bench_parse_number(argument, 1e-5f, 1, "row-tolerance", state);
		return 0;
	case 'e':
		o->settings.emitter_refinement = bench_parse_number(argument, 1, 1e6f, "emitter-refinement", state);
		return 0;
	case 'w':
		o->settings.wall_levels = bench_parse_count(argument, 0, 6, "wall-levels", state);
		return 0;
	case 'm':
		o->budget.ms = bench_parse_number(argument, 0, 1e6f, "budget-ms", state);
		return 0;
	case 'r':
		o->budget.rays = bench_parse_count(argument, 0, UINT32_MAX, "budget-rays", state);
		return 0;
	case 'l':
		o->settings.pixel_lamps = bench_parse_count(argument, 0, 32, "pixel-lamps", state);
		return 0;
	case 'b':
		o->budget_fps = bench_parse_number(argument, .01f, 1e4f, "budget-fps", state);
		return 0;
	case 'u':
		o->update_ms = bench_parse_number(argument, .01f, 1e5f, "update-ms", state);
		return 0;
	case 'f':
		o->fps = bench_parse_number(argument, .01f, 1e4f, "fps", state);
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

int main(int argc, char **argv)
{
	static const struct argp_option list[] = {
	    {"frames", 'n', "N", 0, "frames measured, default 40", 0},
	    {"size", 's', "PIXELS", 0, "width and height, default 512", 0},
	    {"row-tolerance", 't', "T", 0, "of the frame-rate run, default 0.1", 0},
	    {"emitter-refinement", 'e', "F", 0, "emitters are cut at the row tolerance over this, default 4", 0},
	    {"wall-levels", 'w', "N", 0, "refinement of the walls, default 3: 4,124 leaves in all", 0},
	    {"budget-ms", 'm', "MS", 0, "budget of an update of the frame-rate run", 0},
	    {"budget-rays", 'r', "N", 0, "likewise", 0},
	    {"pixel-lamps", 'l', "N", 0, "polygons that light per pixel, default 32; 0: all light through the leaves",
	     0},
	    {"budget-fps", 'b', "R", 0,
	     "frames a second that a budget is to keep, default 30, and 60 with walls one step coarser", 0},
	    {"update-ms", 'u', "MS", 0, "what updates are given in the table of budgets of time, default 4", 0},
	    {"fps", 'f', "R", 0, "frames a second of the frame-rate run's animation, default 10", 0},
	    {0},
	};
	const bench_command command = {"gi_bench", "What a frame of the moving Buddha costs on this machine.", list,
				       parse_option};
	options o = {.frames = 40, .size = 512, .settings = bench_settings_coarse(), .fps = 10, .update_ms = 4};
	const engine_context_kind kind = bench_parse(&command, argc, argv, &o);
	engine_context *context = bench_open_window(kind, o.size);
	printf("# gi_bench on %s\n\nbuilt from %s\n\n", engine_context_describe(context), RELUME_COMMIT);
	const bench_run run = {.context = context,
			       .settings = o.settings,
			       .frames = o.frames,
			       .size = o.size,
			       .fps = o.fps,
			       .budget = o.budget};
	bench_frames(&run);
	run_rates(&run, &o);
	run_budgets(context, &o);
	run_updates_and_rebuilds(context, &o);
	engine_context_destroy(context);
	return 0;
}
