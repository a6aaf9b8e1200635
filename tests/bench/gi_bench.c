/* The benchmark: what a frame of the moving Buddha costs on this machine, an update against a rebuild, a scene at rest.
 *
 * Prints figures, never passes or fails on one. Both sides of a comparison run in turn in the same loop, ratios are of
 * medians.
 */
#include "context.h"
#include "gi/gi.h"
#include "samples.h"
#include "scenes/cornell.h"
#include "tonemap.h"

#include <argp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MAX_FRAMES = MAX_SAMPLES };

typedef struct options {
	engine_context_kind kind;
	uint32_t frames;
	int size;
	float row_tolerance;      /* of the frame-rate run */
	float emitter_refinement; /* likewise */
	uint32_t wall_levels;
	uint32_t pixel_lamps;
	gi_budget budget; /* of the frame-rate run */
	float fps;        /* of its animation */
} options;

/* ---- scenes ---- */

static void fail(const char *what)
{
	fprintf(stderr, "gi_bench: %s\n", what);
	exit(1);
}

static void check(gi_result result)
{
	if (result)
		fail(gi_result_text(result));
}

static gi_context *open_gi(engine_context *context, const options *o, float row_tolerance)
{
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = engine_context_get_proc_address(context);
	def.row_tolerance = row_tolerance;
	def.emitter_refinement = o->emitter_refinement;
	def.near_samples = 1;
	def.pixel_lamps = o->pixel_lamps;
	gi_context *gi;
	check(gi_context_create(&def, &gi));
	return gi;
}

static cornell open_cornell(gi_context *gi, uint32_t wall_levels)
{
	cornell_def def = cornell_def_default();
	def.wall_levels = wall_levels;
	cornell scene;
	check(cornell_create(gi, &def, &scene));
	check(gi_commit(gi));
	return scene;
}

static gi_report step(gi_context *gi)
{
	gi_report report;
	check(gi_update(gi, NULL));
	check(gi_finish(gi));
	check(gi_get_report(gi, &report));
	return report;
}

/* ---- frames ---- */

typedef struct frame_figures {
	samples total, passes[GI_PASS_COUNT], sweeps, rays, new_share, flagged_share, waiting, stale;
} frame_figures;

static void draw(gi_context *gi, engine_target *target, int size)
{
	gi_view view = gi_view_default();
	view.width = view.height = (uint32_t)size;
	cornell_camera(1, view.view_from_world, view.clip_from_view);
	engine_target_begin(target);
	check(gi_draw(gi, &view));
	engine_target_tonemap(target, 0.35f);
}

static void collect(frame_figures *f, const gi_report *r)
{
	for (int k = 0; k < GI_PASS_COUNT; k++)
		samples_add(&f->passes[k], r->pass_ms[k]);
	samples_add(&f->sweeps, r->sweeps);
	samples_add(&f->rays, (double)r->rays);
	samples_add(&f->new_share, (double)r->new_entries / (double)r->entries);
	samples_add(&f->flagged_share, (double)r->flagged_entries / (double)r->entries);
	samples_add(&f->waiting, (double)r->waiting_rows / r->leaves);
	samples_add(&f->stale, (double)r->stale_bound);
}

static void print_frames(const frame_figures *f, const gi_report *r)
{
	printf("| leaves | entries per leaf | links per leaf | entries cut anew | flagged | rays | sweeps | GPU memory "
	       "|\n");
	printf("|---|---|---|---|---|---|---|---|\n");
	printf("| %u | %.1f | %.1f | %.1f %% | %.1f %% | %.0f | %.0f | %.1f MB |\n\n", r->leaves,
	       (double)r->entries / r->leaves, (double)r->links / r->leaves, 100 * samples_median(&f->new_share),
	       100 * samples_median(&f->flagged_share), samples_median(&f->rays), samples_median(&f->sweeps),
	       1e-6 * (double)r->gpu_bytes);
	printf("| pass |");
	for (int k = 0; k < GI_PASS_COUNT; k++)
		printf(" %s |", gi_pass_name((gi_pass)k));
	printf(" frame |\n|---|");
	for (int k = 0; k <= GI_PASS_COUNT; k++)
		printf("---|");
	printf("\n| median ms |");
	for (int k = 0; k < GI_PASS_COUNT; k++)
		printf(" %.2f |", samples_median(&f->passes[k]));
	printf(" %.1f |\n\n", samples_median(&f->total));
	printf("frames a second: median %.1f, best %.1f, worst %.1f\n\n", 1e3 / samples_median(&f->total),
	       1e3 / samples_quantile(&f->total, 0), 1e3 / samples_quantile(&f->total, 1));
}

static gi_leaf *read_leaves(gi_context *gi, uint32_t *count)
{
	check(gi_read_leaves(gi, NULL, 0, count));
	gi_leaf *leaves = malloc(sizeof *leaves * (*count + 1));
	if (!leaves)
		fail("out of memory");
	check(gi_read_leaves(gi, leaves, *count, count));
	return leaves;
}

/* What the budget left of the last frame, against an exact update of the same pose. */
static void print_waiting(gi_context *gi, const frame_figures *f, const gi_report *last)
{
	uint32_t count;
	gi_leaf *under = read_leaves(gi, &count);
	step(gi);
	gi_leaf *exact = read_leaves(gi, &count);
	double most = 0, off = 0, whole = 0;
	for (uint32_t k = 0; k < count; k++)
		for (int c = 0; c < 3; c++) {
			const double b = (double)exact[k].radiosity[c] - (double)exact[k].exitance[c],
				     d = (double)under[k].radiosity[c] - (double)exact[k].radiosity[c];
			most = fmax(most, fabs(d));
			off += (double)exact[k].area * d * d;
			whole += (double)exact[k].area * b * b;
		}
	printf("rows that wait: median %.1f %%; reported stale bound: median %.3g W/m2, of the last frame %.3g; "
	       "measured against an "
	       "exact update of it: %.3g W/m2 at most, %.2f %% of B - E (RMS); largest B %.3g\n\n",
	       100 * samples_median(&f->waiting), samples_median(&f->stale), (double)last->stale_bound, most,
	       100 * sqrt(off / whole), (double)last->radiosity_max);
	free(under);
	free(exact);
}

static void run_frames(engine_context *context, const options *o)
{
	char message[256];
	engine_target *target = engine_target_create(o->size, o->size, message, sizeof message);
	if (!target)
		fail(message);
	gi_context *gi = open_gi(context, o, o->row_tolerance);
	const cornell scene = open_cornell(gi, o->wall_levels);
	static frame_figures f;
	gi_report report = step(gi);
	draw(gi, target, o->size); /* shaders compile */
	for (uint32_t k = 0; k < o->frames + 3; k++) {
		const double began = now_ms();
		check(gi_set_pose(gi, scene.buddha, cornell_buddha_pose((float)(k + 1) / o->fps)));
		check(gi_update(gi, &o->budget));
		draw(gi, target, o->size);
		check(gi_finish(gi));
		const double ms = now_ms() - began;
		check(gi_get_report(gi, &report));
		if (k < 3)
			continue; /* pools settle */
		samples_add(&f.total, ms);
		collect(&f, &report);
	}
	printf("## Moving Buddha, %d x %d, row tolerance %g, emitter refinement %g, one ray an indirect entry\n\n",
	       o->size, o->size, (double)o->row_tolerance, (double)o->emitter_refinement);
	print_frames(&f, &report);
	if (report.waiting_rows)
		print_waiting(gi, &f, &report);
	report = step(gi);
	report = step(gi);
	printf("at rest: outcome %d, %u dispatches, %llu bytes uploaded, gi_update %.3f ms\n\n", report.outcome,
	       report.dispatches, (unsigned long long)report.uploaded_bytes, (double)report.update_ms);
	gi_context_destroy(gi);
	engine_target_destroy(target);
}

/* ---- update against rebuild ---- */

/* One frame of one side; everything that gi_update issues, waited for. */
static double timed_step(gi_context *gi, gi_object object, gi_pose pose, bool rebuild)
{
	check(gi_set_pose(gi, object, pose));
	if (rebuild)
		gi_invalidate(gi);
	const double began = now_ms();
	step(gi);
	return now_ms() - began;
}

/* From nothing: objects, refinement, hierarchies, trees, rows, a cold solve. */
static double timed_restart(engine_context *context, const options *o, float row_tolerance, gi_pose pose)
{
	gi_context *gi = open_gi(context, o, row_tolerance);
	const double began = now_ms();
	const cornell scene = open_cornell(gi, o->wall_levels);
	check(gi_set_pose(gi, scene.buddha, pose));
	step(gi);
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
		scenes[k] = open_cornell(sides[k], o->wall_levels);
		step(sides[k]);
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

/* ---- options ---- */

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
	options *o = state->input;
	switch (key) {
	case 'c':
		if (!engine_context_kind_from_name(argument, &o->kind))
			argp_error(state, "--context is auto, glfw, egl or osmesa, not '%s'", argument);
		return 0;
	case 'n':
		o->frames = (uint32_t)atoi(argument);
		if (o->frames < 4 || o->frames > MAX_FRAMES)
			argp_error(state, "--frames is 4..%d", MAX_FRAMES);
		return 0;
	case 's':
		o->size = atoi(argument);
		if (o->size < 16 || o->size > 8192)
			argp_error(state, "--size is 16..8192 pixels");
		return 0;
	case 't':
		o->row_tolerance = (float)atof(argument);
		return 0;
	case 'e':
		o->emitter_refinement = (float)atof(argument);
		return 0;
	case 'w':
		o->wall_levels = (uint32_t)atoi(argument);
		if (o->wall_levels > 6)
			argp_error(state, "--wall-levels is 0..6: a wall has 9 * 4^levels leaves");
		return 0;
	case 'm':
		o->budget.ms = (float)atof(argument);
		return 0;
	case 'r':
		o->budget.rays = (uint64_t)atol(argument);
		return 0;
	case 'l':
		o->pixel_lamps = (uint32_t)atoi(argument);
		return 0;
	case 'f':
		o->fps = (float)atof(argument);
		if (!(o->fps > 0))
			argp_error(state, "--fps is above 0");
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

int main(int argc, char **argv)
{
	static const struct argp_option list[] = {
	    {"context", 'c', "KIND", 0, "auto (default), glfw, egl or osmesa", 0},
	    {"frames", 'n', "N", 0, "frames measured, default 40", 0},
	    {"size", 's', "PIXELS", 0, "width and height, default 512", 0},
	    {"row-tolerance", 't', "T", 0, "of the frame-rate run, default 0.1", 0},
	    {"emitter-refinement", 'e', "F", 0, "emitters are cut at the row tolerance over this, default 4", 0},
	    {"wall-levels", 'w', "N", 0, "refinement of the walls, default 3: 4,124 leaves in all", 0},
	    {"budget-ms", 'm', "MS", 0, "budget of an update of the frame-rate run", 0},
	    {"budget-rays", 'r', "N", 0, "likewise", 0},
	    {"pixel-lamps", 'l', "N", 0, "polygons that light per pixel, default 32; 0: all light through the leaves",
	     0},
	    {"fps", 'f', "R", 0, "frames a second of the frame-rate run's animation, default 10", 0},
	    {0},
	};
	const struct argp argp = {
	    list, parse_option, NULL, "What a frame of the moving Buddha costs on this machine.", 0, 0, 0};
	options o = {.frames = 40,
		     .size = 512,
		     .row_tolerance = 0.1f,
		     .emitter_refinement = 4,
		     .wall_levels = 3,
		     .pixel_lamps = 32,
		     .fps = 10};
	argp_parse(&argp, argc, argv, 0, NULL, &o);

	engine_context_def def = engine_context_def_default();
	def.kind = o.kind;
	def.width = def.height = o.size;
	def.hidden = true;
	def.vsync = false;
	char message[512];
	engine_context *context = engine_context_create(&def, message, sizeof message);
	if (!context)
		fail(message);
	printf("# gi_bench on %s\n\nbuilt from %s\n\n", engine_context_describe(context), RELUME_COMMIT);
	run_frames(context, &o);
	printf("## Update against rebuild, the same frames in turn\n\n");
	printf("| mover | row tolerance | entries per leaf | dirty | update ms | rebuild ms | ratio | from nothing ms "
	       "| ratio |\n");
	printf("|---|---|---|---|---|---|---|---|---|\n");
	run_update_and_rebuild(context, &o, o.row_tolerance, false);
	run_update_and_rebuild(context, &o, 0.01f, false);
	run_update_and_rebuild(context, &o, o.row_tolerance, true);
	run_update_and_rebuild(context, &o, 0.01f, true);
	engine_context_destroy(context);
	return 0;
}
