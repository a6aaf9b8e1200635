/* Figure 6 of Song et al. (docs/figures.md): frames a second against the fineness of the mesh, for radiosity, real-time
 * ray tracing and off-line ray tracing, at rest and while the Buddha moves; how far each picture is from the truth, and
 * how long the rivals take to be as good as radiosity. Prints figures, never passes or fails on one.
 */
#include "bench_options.h"
#include "bench_scene.h"
#include "image.h"
#include "six_table.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct options {
	const char *out;
	int width, height; /* 0: as the effort says */
	bool quick;
} options;

static const six_effort whole_effort = {.width = 256,
					.height = 256,
					.truth_samples = 128,
					.frames = 12,
					.most_frames = 64,
					.most_samples = 256,
					.shown_samples = 16};
static const six_effort quick_effort = {.width = 128,
					.height = 128,
					.truth_samples = 64,
					.frames = 6,
					.most_frames = 32,
					.most_samples = 64,
					.shown_samples = 16};

static const uint32_t finenesses[] = {1000, 4000, 16000, 64000, 256000};
enum { FINENESSES = sizeof finenesses / sizeof *finenesses, QUICK_FINENESSES = 2 };

static void write_truth(const six_scene *s, const char *folder)
{
	char path[1024], message[512];
	snprintf(path, sizeof path, "%s/figure6_truth_%u.png", folder, s->drawn.face_count);
	if (!engine_image_write_png(path, s->effort->width, s->effort->height, s->truth_shown, message, sizeof message))
		fail(message);
}

static void say(const six_row *rows)
{
	for (int k = 0; k < SIX_MOTIONS; k++)
		fprintf(stderr, "figure_six: %u triangles, %s, %s: %.1f ms, relative MSE %.2e, SSIM %.4f\n",
			rows[k].triangles, six_method_names[rows[k].method], six_motion_names[rows[k].motion],
			rows[k].ms, rows[k].relative_mse, rows[k].ssim);
}

static void measure(const options *o, const six_effort *effort, engine_context *context, uint32_t triangles,
		    six_table *table)
{
	six_scene scene;
	six_row rows[SIX_METHODS][SIX_MOTIONS];
	fprintf(stderr, "figure_six: %u triangles: the truth, %u paths a pixel\n", triangles,
		2 * effort->truth_samples);
	six_scene_open(&scene, effort, context, triangles);
	write_truth(&scene, o->out);
	six_radiosity(&scene, o->out, rows[SIX_RADIOSITY]);
	say(rows[SIX_RADIOSITY]);
	double wanted[SIX_MOTIONS];
	for (int k = 0; k < SIX_MOTIONS; k++)
		wanted[k] = rows[SIX_RADIOSITY][k].relative_mse;
	six_realtime(&scene, o->out, wanted, rows[SIX_REALTIME]);
	say(rows[SIX_REALTIME]);
	six_offline(&scene, o->out, wanted, rows[SIX_OFFLINE]);
	say(rows[SIX_OFFLINE]);
	for (int method = 0; method < SIX_METHODS; method++)
		for (int k = 0; k < SIX_MOTIONS; k++)
			six_table_add(table, &rows[method][k]);
	six_scene_close(&scene);
}

static void write_files(const options *o, const six_effort *effort, engine_context *context, const six_table *table)
{
	char path[1024], heading[1024], message[512];
	snprintf(path, sizeof path, "%s/figure6.csv", o->out);
	if (!six_table_write_csv(table, path, message, sizeof message))
		fail(message);
	snprintf(heading, sizeof heading, "%s, %ld processors, %d x %d pixels, commit %s%s\n",
		 engine_context_describe(context), sysconf(_SC_NPROCESSORS_ONLN), effort->width, effort->height,
		 RELUME_COMMIT, o->quick ? ", --quick: too short to quote" : "");
	snprintf(path, sizeof path, "%s/figure6.md", o->out);
	if (!six_table_write_markdown(table, path, heading, message, sizeof message))
		fail(message);
	if (!six_table_plot(o->out))
		fprintf(stderr, "figure_six: no plot: gnuplot cannot be run\n");
}

/* ---- options ---- */

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
	options *o = state->input;
	switch (key) {
	case 'o':
		o->out = argument;
		return 0;
	case 'p':
		bench_parse_area(argument, &o->width, &o->height, state);
		return 0;
	case 'q':
		o->quick = true;
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

int main(int argc, char **argv)
{
	static const struct argp_option list[] = {
	    {"out", 'o', "FOLDER", 0, "where figure6.csv, .md, .png, .svg and pictures go, default out", 0},
	    {"size", 'p', "WxH", 0, "pixels, default 256x256", 0},
	    {"quick", 'q', NULL, 0, "two finenesses, 128x128 pixels: to see that it works", 0},
	    {0},
	};
	const bench_command command = {"figure_six", "Three ways to light a scene, against its fineness.", list,
				       parse_option};
	options o = {.out = "out"};
	const engine_context_kind kind = bench_parse(&command, argc, argv, &o);
	if (mkdir(o.out, 0777) && errno != EEXIST)
		fail("the folder --out cannot be made");
	six_effort effort = o.quick ? quick_effort : whole_effort;
	effort.width = o.width ? o.width : effort.width;
	effort.height = o.height ? o.height : effort.height;
	engine_context *context = bench_open_window(kind, 64);
	static six_table table;
	for (int k = 0; k < (o.quick ? QUICK_FINENESSES : FINENESSES); k++)
		measure(&o, &effort, context, finenesses[k], &table);
	write_files(&o, &effort, context, &table);
	engine_context_destroy(context);
	return 0;
}
