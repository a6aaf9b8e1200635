/* Error against time: this engine, updated or rebuilt, and path tracing of the same leaves, on the CPU with Embree and
 * in this engine's shaders, in four scenes, from scratch and per frame while something moves.
 *
 * The truth is Embree's, in two independent halves whose noise drops out of the errors (reference/error.h), or known
 * exactly. All errors are of the irradiance of the same leaves at the same pose, the last one of the moving frames.
 * Prints figures, never passes or fails on one.
 */
#include "bench_leaves.h"
#include "bench_options.h"
#include "bench_scene.h"
#include "error_table.h"
#include "gi/gi.h"
#include "output.h"
#include "samples.h"
#include "scenes/scenes.h"

#include "tests/reference/reference_error.h"
#include "tests/reference/leaves.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct options {
	const char *scene; /* NULL: all */
	const char *out;
	double seconds; /* that the whole may take, about */
	float emitter_refinement;
	bool quick;
} options;

/* What is measured in now. */
typedef struct session {
	const options *options;
	engine_context *context;
	error_table table;
	const scene_kind *kind;
	double budget_ms; /* of this scene */
	leaf_scene leaves;
	uint32_t leaf_count;
	double *truth[2]; /* 3 a leaf */
} session;

/* The pose that errors are measured at, seconds along the mover's way, and the step of a frame. */
static const float LAST_POSE = 1.5f, FRAME = 1 / 30.0f;

enum { ESTIMATE_LEAVES = 1024 };

/* Shares of a scene's time: the reference; the most that a series goes on to: each next setting costs more. */
static const double REFERENCE_SHARE = 0.25, SETTING_SHARE = 0.1;

static void *allocate(size_t count, size_t size)
{
	void *data = calloc(count + 1, size);
	if (!data)
		fail("out of memory");
	return data;
}

/* ---- the engine ---- */

/* How a frame is brought up to date. */
typedef struct frame_kind {
	const char *method;
	bool rebuild; /* every row anew */
	gi_budget budget;
} frame_kind;

static const frame_kind frame_kinds[] = {{.method = "engine"}, {.method = "engine rebuilt", .rebuild = true}};
enum { FRAME_KINDS = sizeof frame_kinds / sizeof *frame_kinds };

static gi_context *open_gi(const session *s, float row_tolerance, uint32_t estimate_leaves, gi_object *mover)
{
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = engine_context_find_gl;
	def.get_proc_user = s->context;
	def.row_tolerance = row_tolerance;
	def.emitter_refinement = s->options->emitter_refinement;
	def.near_samples = 1;
	def.sky = s->kind->sky;
	def.estimate_leaves = estimate_leaves;
	def.profile = false; /* on a software renderer it waits after every pass */
	gi_context *gi;
	check(gi_context_create(&def, &gi));
	check(s->kind->create(gi, mover));
	check(gi_commit(gi));
	return gi;
}

static void advance(gi_context *gi, const frame_kind *kind)
{
	if (kind->rebuild)
		gi_invalidate(gi);
	check(gi_update(gi, &kind->budget));
	check(gi_finish(gi));
}

static gi_report report_of(gi_context *gi)
{
	gi_report report;
	check(gi_get_report(gi, &report));
	return report;
}

/* ---- records ---- */

static error_record measure(const session *s, const double *h, const char *method, double setting, double ms)
{
	reference_error e;
	if (!reference_error_measure(h, s->truth[0], s->truth[1], s->leaves.areas, s->leaf_count, &e))
		fail("the reference is dark or something is not finite");
	return (error_record){.scene = s->kind->name,
			      .method = method,
			      .setting = setting,
			      .ms = ms,
			      .error = 100 * e.rms,
			      .bias = 100 * e.bias,
			      .reference_noise = s->kind->exact_irradiance > 0 ? 0 : 100 * e.noise,
			      .entries = NAN,
			      .solve_bound = NAN,
			      .stale_bound = NAN,
			      .sampling_error = NAN,
			      .leaves = s->leaf_count};
}

static void add(session *s, error_record r, error_phase phase)
{
	r.phase = phase;
	error_table_add(&s->table, &r);
}

static void say(const error_record *r, const char *what)
{
	fprintf(stderr, "%s: %s at %g, %s: %.1f ms, error %.2f %% (bias %+.2f %%)\n", r->scene, r->method, r->setting,
		what, r->ms, r->error, r->bias);
}

static void add_engine(session *s, gi_context *gi, const char *method, double setting, double ms, error_phase phase)
{
	uint32_t count;
	gi_leaf *leaves = bench_leaves(gi, &count);
	double *h = allocate(3 * (size_t)count, sizeof *h);
	leaf_irradiance(leaves, count, h);
	error_record r = measure(s, h, method, setting, ms);
	const gi_report report = report_of(gi);
	r.entries = (double)report.entries / report.leaves;
	r.solve_bound = 100 * (double)report.solve_relative;
	r.stale_bound = 100 * (double)report.stale_relative;
	add(s, r, phase);
	say(&r, phase == PHASE_SCRATCH ? "from scratch" : "a moving frame");
	free(h);
	free(leaves);
}

/* ---- engine series ---- */

/* Everything but the objects anew: uploads, rows, a cold solve. */
static double timed_scratch(gi_context *gi)
{
	gi_reset_radiosity(gi);
	const double began = now_ms();
	check(gi_commit(gi));
	advance(gi, &frame_kinds[0]);
	return now_ms() - began;
}

/* The mover's last frames up to the pose that is measured; the frame before them is at rest. */
static void play(const session *s, gi_context *gi, gi_object mover, const frame_kind *kind, uint32_t frames,
		 samples *times)
{
	for (uint32_t k = 0; k <= frames; k++) {
		check(gi_set_pose(gi, mover, s->kind->pose(LAST_POSE - FRAME * (float)(frames - k))));
		const double began = now_ms();
		advance(gi, k ? kind : &frame_kinds[0]);
		if (k)
			samples_add(times, now_ms() - began);
	}
}

static uint32_t repeats(const session *s, double ms, uint32_t most)
{
	const double fit = SETTING_SHARE * s->budget_ms / (6 * ms);
	return fit < 1 ? 1 : fit > most ? most : (uint32_t)fit;
}

/* The engine's own estimate of the error, %; apart from what is timed. */
static double estimated_error(const session *s, float tolerance)
{
	gi_object mover;
	gi_context *gi = open_gi(s, tolerance, ESTIMATE_LEAVES, &mover);
	check(gi_set_pose(gi, mover, s->kind->pose(LAST_POSE)));
	advance(gi, &frame_kinds[0]);
	const double estimate = 100 * (double)report_of(gi).sampling_relative;
	gi_context_destroy(gi);
	return estimate;
}

static void run_engine_setting(session *s, float tolerance)
{
	gi_object mover;
	gi_context *gi = open_gi(s, tolerance, 0, &mover);
	check(gi_set_pose(gi, mover, s->kind->pose(LAST_POSE)));
	static samples scratch, moving[FRAME_KINDS];
	scratch.count = 0;
	advance(gi, &frame_kinds[0]); /* shaders compile */
	double ms = timed_scratch(gi);
	samples_add(&scratch, ms);
	for (uint32_t k = 1; k < repeats(s, ms, 5); k++)
		samples_add(&scratch, timed_scratch(gi));
	add_engine(s, gi, frame_kinds[0].method, (double)tolerance, samples_median(&scratch), PHASE_SCRATCH);
	s->table.records[s->table.count - 1].sampling_error = estimated_error(s, tolerance);
	const uint32_t frames = repeats(s, ms, 8), rounds = frames > 1 ? 2 : 1;
	for (int kind = 0; kind < FRAME_KINDS; kind++)
		moving[kind].count = 0;
	for (uint32_t round = 0; round < rounds; round++)
		for (int kind = 0; kind < FRAME_KINDS; kind++) {
			play(s, gi, mover, &frame_kinds[kind], frames, &moving[kind]);
			if (round + 1 == rounds)
				add_engine(s, gi, frame_kinds[kind].method, (double)tolerance,
					   samples_median(&moving[kind]), PHASE_MOVING);
		}
	gi_context_destroy(gi);
}

/* Finer and finer while the next is expected to fit: cost goes as 1 / tolerance. */
static void run_engine(session *s)
{
	static const float all[] = {0.4f, 0.2f, 0.1f, 0.05f, 0.024f, 0.01f, 0.004f}, quick[] = {1, 0.4f};
	const float *tolerances = s->options->quick ? quick : all;
	const size_t count = s->options->quick ? sizeof quick / sizeof *quick : sizeof all / sizeof *all;
	for (size_t k = 0; k < count; k++) {
		const double began = now_ms();
		run_engine_setting(s, tolerances[k]);
		const double took = now_ms() - began;
		if (k + 1 < count &&
		    took * (double)(tolerances[k] / tolerances[k + 1]) > 2 * SETTING_SHARE * s->budget_ms) {
			fprintf(stderr, "%s: finer row tolerances would take too long here\n", s->kind->name);
			break;
		}
	}
}

/* Frames under a budget, long enough for rows to wait their turn; settings are rays, or the error in % of the largest
 * B. */
static void run_budgets(session *s)
{
	static const float TOLERANCE = 0.1f, COARSE = 0.4f; /* coarse where everything emits, and is cut finer */
	static const frame_kind kinds[] = {
	    {.method = "engine budget", .budget.rays = 2000},  {.method = "engine budget", .budget.rays = 8000},
	    {.method = "engine budget", .budget.rays = 32000}, {.method = "engine error", .budget.error = 0.3f},
	    {.method = "engine error", .budget.error = 0.1f},  {.method = "engine error", .budget.error = 0.03f}};
	enum { KINDS = sizeof kinds / sizeof *kinds, FRAMES = 24, SECONDS = 1000 };
	const float tolerance = s->options->quick || s->kind->exact_irradiance > 0 ? COARSE : TOLERANCE;
	gi_object mover;
	gi_context *gi = open_gi(s, tolerance, 0, &mover);
	check(gi_set_pose(gi, mover, s->kind->pose(LAST_POSE)));
	advance(gi, &frame_kinds[0]);
	/* Where an exact update takes seconds, as in the furnace, fewer frames have to do. */
	const double began = now_ms();
	check(gi_set_pose(gi, mover, s->kind->pose(0)));
	advance(gi, &frame_kinds[0]);
	const double ms = now_ms() - began;
	const uint32_t frames = s->options->quick ? 2 : ms < SECONDS ? FRAMES : repeats(s, ms, FRAMES);
	check(gi_set_pose(gi, mover, s->kind->pose(FRAME)));
	advance(gi, &kinds[0]); /* shaders compile */
	static samples times;
	for (int kind = 0; kind < KINDS; kind++) {
		const gi_budget *b = &kinds[kind].budget;
		times.count = 0;
		play(s, gi, mover, &kinds[kind], frames, &times);
		add_engine(s, gi, kinds[kind].method, b->rays ? (double)b->rays : 100 * (double)b->error,
			   samples_median(&times), PHASE_MOVING);
	}
	gi_context_destroy(gi);
}

/* ---- path tracing, the rival ---- */

/* It has no memory: a moving frame costs what the first one does. */
static void add_paths(session *s, const double *h, const char *method, double paths, double ms)
{
	const error_record r = measure(s, h, method, paths, ms);
	for (int phase = 0; phase < PHASE_COUNT; phase++)
		add(s, r, (error_phase)phase);
	say(&r, "any frame");
}

enum { MOST_PATHS = 1 << 20, PATHS_STEP = 4 };

static bool goes_on(const session *s, double ms)
{
	return PATHS_STEP * ms < SETTING_SHARE * s->budget_ms;
}

/* Paths of each leaf, both halves together; the time is the whole call's, Embree's scene included. */
static double trace_embree(const session *s, uint32_t paths, uint64_t seed, double *h)
{
	reference_result r;
	const double began = now_ms();
	if (!reference_trace(&s->leaves.scene, paths, seed, &r))
		fail("Embree's path tracer failed");
	const double ms = now_ms() - began;
	for (size_t k = 0; h && k < 3 * (size_t)s->leaf_count; k++)
		h[k] = 0.5 * (r.irradiance[0][k] + r.irradiance[1][k]);
	reference_result_free(&r);
	return ms;
}

static double trace_shader(const session *s, gi_context *gi, uint32_t paths, uint32_t seed, double *h)
{
	float *floats = allocate(3 * (size_t)s->leaf_count, sizeof *floats);
	const gi_path_options o = {.paths = paths, .seed = seed};
	uint32_t count;
	const double began = now_ms();
	check(gi_trace_paths(gi, &o, floats, s->leaf_count, &count));
	const double ms = now_ms() - began;
	reference_widen(floats, 3, s->leaf_count, h);
	free(floats);
	return ms;
}

/* Seeds apart from the reference's. */
static const uint64_t RIVAL_SEED = 1000;

static void run_paths(session *s)
{
	double *h = allocate(3 * (size_t)s->leaf_count, sizeof *h);
	gi_object mover;
	gi_context *gi = open_gi(s, 0.5f, 0, &mover);
	check(gi_set_pose(gi, mover, s->kind->pose(LAST_POSE)));
	advance(gi, &frame_kinds[0]);
	trace_embree(s, 2, RIVAL_SEED, h);
	trace_shader(s, gi, 1, (uint32_t)RIVAL_SEED, h); /* compiles */
	bool embree = true, shader = true;
	static samples times;
	for (uint32_t paths = 2; paths <= MOST_PATHS && (embree || shader); paths *= PATHS_STEP) {
		if (embree) {
			times.count = 0;
			for (uint32_t k = 0; k < 3 && (k == 0 || times.values[0] < 0.02 * s->budget_ms); k++)
				samples_add(&times, trace_embree(s, paths, RIVAL_SEED + k, h));
			add_paths(s, h, "Embree paths", paths, samples_median(&times));
			embree = goes_on(s, samples_median(&times));
		}
		if (shader) {
			times.count = 0;
			for (uint32_t k = 0; k < 3 && (k == 0 || times.values[0] < 0.02 * s->budget_ms); k++)
				samples_add(&times, trace_shader(s, gi, paths, (uint32_t)RIVAL_SEED + k, h));
			add_paths(s, h, "shader paths", paths, samples_median(&times));
			shader = goes_on(s, samples_median(&times));
		}
	}
	gi_context_destroy(gi);
	free(h);
}

/* ---- truth ---- */

/* As many paths as fit the time, a power of two. */
static uint32_t reference_paths(const session *s)
{
	const uint32_t pilot = 16;
	const double ms = trace_embree(s, pilot, 1, NULL), fit = pilot * REFERENCE_SHARE * s->budget_ms / ms;
	uint32_t paths = 64;
	while (2 * paths <= fit && paths < MOST_PATHS)
		paths *= 2;
	return paths;
}

static void find_truth(session *s)
{
	gi_object mover;
	gi_context *gi = open_gi(s, 0.5f, 0, &mover);
	check(gi_set_pose(gi, mover, s->kind->pose(LAST_POSE)));
	advance(gi, &frame_kinds[0]);
	gi_leaf *leaves = bench_leaves(gi, &s->leaf_count);
	gi_context_destroy(gi);
	if (!leaf_scene_make(leaves, s->leaf_count, &s->leaves))
		fail("out of memory");
	free(leaves);
	const size_t values = 3 * (size_t)s->leaf_count;
	for (int half = 0; half < 2; half++)
		s->truth[half] = allocate(values, sizeof *s->truth[half]);
	if (s->kind->exact_irradiance > 0) {
		for (size_t k = 0; k < values; k++)
			s->truth[0][k] = s->truth[1][k] = (double)s->kind->exact_irradiance;
		return;
	}
	const uint32_t paths = reference_paths(s);
	fprintf(stderr, "%s: %u leaves, reference with %u paths each ...\n", s->kind->name, s->leaf_count, paths);
	reference_result r;
	if (!reference_trace(&s->leaves.scene, paths, 1, &r))
		fail("Embree's path tracer failed");
	for (int half = 0; half < 2; half++)
		memcpy(s->truth[half], r.irradiance[half], sizeof(double) * values);
	reference_result_free(&r);
}

static void run_scene(session *s, const scene_kind *kind)
{
	s->kind = kind;
	find_truth(s);
	run_engine(s);
	run_budgets(s);
	run_paths(s);
	leaf_scene_free(&s->leaves);
	for (int half = 0; half < 2; half++)
		free(s->truth[half]);
}

/* ---- output ---- */

static void print_processor(FILE *out)
{
	char line[256];
	FILE *info = fopen("/proc/cpuinfo", "r");
	bool found = false;
	while (info && !found && fgets(line, sizeof line, info))
		found = strncmp(line, "model name", 10) == 0;
	if (info)
		fclose(info);
	const char *name = found ? strchr(line, ':') : NULL;
	fprintf(out, "%ld processors of type %s", sysconf(_SC_NPROCESSORS_ONLN), name ? name + 2 : "unknown\n");
}

/* What a budget costs and leaves undone, reported and measured. */
static void print_budgets(FILE *out, const error_table *t, const char *scene)
{
	fprintf(out, "Under a budget: what was reported, and measured.\n\n"
		     "| method | setting | ms a frame | stale bound, %% of the largest R | error of H measured, %% "
		     "|\n|---|---|---|---|---|\n");
	for (uint32_t k = 0; k < t->count; k++) {
		const error_record *r = &t->records[k];
		if (strcmp(r->scene, scene) == 0 && r->phase == PHASE_MOVING && strncmp(r->method, "engine", 6) == 0 &&
		    strcmp(r->method, "engine rebuilt") != 0)
			fprintf(out, "| %s | %g | %.1f | %.2f | %.2f |\n", r->method, r->setting, r->ms, r->stale_bound,
				r->error);
	}
	fprintf(out, "\n");
}

/* The estimate beside what it estimates. */
static void print_estimates(FILE *out, const error_table *t, const char *scene)
{
	fprintf(out,
		"The engine's own estimate of its error (one update, %u leaves looked at), beside the measured one.\n\n"
		"| row tolerance | estimated, %% | measured, %% |\n|---|---|---|\n",
		ESTIMATE_LEAVES);
	for (uint32_t k = 0; k < t->count; k++) {
		const error_record *r = &t->records[k];
		if (strcmp(r->scene, scene) == 0 && isfinite(r->sampling_error))
			fprintf(out, "| %g | %.3g | %.3g |\n", r->setting, r->sampling_error, r->error);
	}
	fprintf(out, "\n");
}

static void print_document(FILE *out, const session *s)
{
	fprintf(
	    out,
	    "# Error against time\n\n"
	    "Made by `scripts/bench error-time --docs`%s; every figure is of that one run.\n\n"
	    "How wrong the irradiance of the leaves is after so many milliseconds, for this engine and for path "
	    "tracing of "
	    "the same\nleaves: with Embree on all processors (`Embree paths`) and in this engine's own shaders "
	    "(`shader paths`, `gi_trace_paths`).\nThe error is area-weighted, relative RMS, against a path-traced "
	    "reference whose noise is taken out (or the exact value in the\nfurnace). A frame of the engine is "
	    "`gi_update` and waiting for it, at row tolerances from 0.4 down, one ray an indirect entry, emitters\ncut "
	    "%g times finer; "
	    "`engine rebuilt` is the same with every row built anew. Path tracing has no memory: a moving frame costs "
	    "what any does.\n`engine budget` updates under so many rays and `engine error` lets rows wait for such a "
	    "share of the "
	    "largest R, at a row tolerance\nof 0.1 (0.4 in the furnace) and after up to 24 frames of it. Picture and "
	    "post-processing cost the "
	    "same for all and are in none. Tables are read off the "
	    "log-log lines between\nmeasurements; - is not reached.\n\n",
	    s->options->quick ? " with --quick, too short to quote" : "", (double)s->options->emitter_refinement);
	fprintf(out, "- ");
	print_processor(out);
	fprintf(out, "- %s\n- commit %s\n\n", engine_context_describe(s->context), RELUME_COMMIT);
	static const char *const phases[PHASE_COUNT] = {"From scratch", "Per frame, while it moves"};
	for (int k = 0; k < SCENE_KINDS; k++) {
		const scene_kind *kind = &scene_kinds[k];
		if (s->options->scene && strcmp(s->options->scene, kind->name) != 0)
			continue;
		fprintf(out, "## %s\n\n![Error against time: %s](pictures/error-time-%s.png)\n\n", kind->title,
			kind->title, kind->name);
		for (int phase = 0; phase < PHASE_COUNT; phase++) {
			fprintf(out, "%s:\n\n", phases[phase]);
			error_table_print(&s->table, out, kind->name, (error_phase)phase);
		}
		print_budgets(out, &s->table, kind->name);
		print_estimates(out, &s->table, kind->name);
	}
}

static void write_files(const session *s)
{
	char path[1024];
	if (mkdir(s->options->out, 0777) && errno != EEXIST)
		fail("the folder --out cannot be made");
	snprintf(path, sizeof path, "%s/error-time.csv", s->options->out);
	if (!error_table_write_csv(&s->table, path))
		fail("the CSV cannot be written");
	snprintf(path, sizeof path, "%s/error-time.md", s->options->out);
	FILE *out = fopen(path, "w");
	if (!out)
		fail("the markdown cannot be written");
	print_document(out, s);
	if (fclose(out))
		fail("the markdown cannot be written");
}

/* ---- options ---- */

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
	options *o = state->input;
	switch (key) {
	case 'n':
		if (!scene_kind_find(argument))
			argp_error(state, "--scene is cornell, rooms, corridor or furnace, not '%s'", argument);
		o->scene = argument;
		return 0;
	case 'o':
		o->out = argument;
		return 0;
	case 't':
		o->seconds = (double)bench_parse_number(argument, .1f, 1e6f, "seconds", state);
		return 0;
	case 'e':
		o->emitter_refinement = bench_parse_number(argument, 1, 1e6f, "emitter-refinement", state);
		return 0;
	case 'q':
		o->quick = true;
		o->seconds = 30;
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

int main(int argc, char **argv)
{
	static const struct argp_option list[] = {
	    {"scene", 'n', "NAME", 0, "one of cornell, rooms, corridor, furnace; default all", 0},
	    {"out", 'o', "FOLDER", 0, "where error-time.csv and error-time.md go, default out", 0},
	    {"seconds", 't', "S", 0, "how long all of it may take, about; default 480", 0},
	    {"emitter-refinement", 'e', "F", 0, "emitters are cut at the row tolerance over this, default 20", 0},
	    {"quick", 'q', NULL, 0, "two coarse settings, 30 seconds: to see that it works", 0},
	    {0},
	};
	const bench_command command = {"gi_error_time", "Error of the irradiance against run time.", list,
				       parse_option};
	options o = {.out = "out", .seconds = 480, .emitter_refinement = 20};
	const engine_context_kind kind = bench_parse(&command, argc, argv, &o);

	static session s;
	s.options = &o;
	s.context = bench_open_window(kind, 64);
	s.budget_ms = 1e3 * o.seconds / (o.scene ? 1 : SCENE_KINDS);
	for (int k = 0; k < SCENE_KINDS; k++)
		if (!o.scene || strcmp(o.scene, scene_kinds[k].name) == 0)
			run_scene(&s, &scene_kinds[k]);
	write_files(&s);
	engine_context_destroy(s.context);
	return 0;
}
