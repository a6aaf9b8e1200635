/* What the picture costs in each of the benchmark's scenes, and how far it is from the pictures of another build.
 *
 * `--out FOLDER` writes the pictures; `--against FOLDER` compares with what another build wrote there, 8-bit sRGB
 * values as a display shows them. Prints figures, never passes or fails on one.
 */
#include "bench_options.h"
#include "bench_scene.h"
#include "gi/gi.h"
#include "image.h"
#include "samples.h"
#include "scenes/scenes.h"
#include "tonemap.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct options {
	const char *scene; /* NULL: all */
	const char *out, *against, *shaders;
	uint32_t frames;
	int size;
	float zoom, row_tolerance;
} options;

static const float SECONDS_A_FRAME = 0.25f;

/* ---- comparing ---- */

/* Of values 0..255. */
typedef struct difference {
	double squares; /* sum */
	uint64_t count, over_1, over_2;
	int most;
} difference;

static void add_difference(difference *d, const uint8_t *a, const uint8_t *b, size_t bytes)
{
	for (size_t k = 0; k < bytes; k++) {
		const int by = abs(a[k] - b[k]);
		d->squares += by * by;
		d->over_1 += by > 1;
		d->over_2 += by > 2;
		d->most = by > d->most ? by : d->most;
	}
	d->count += bytes;
}

static void file_name(char *name, size_t size, const char *folder, const char *scene, uint32_t frame)
{
	snprintf(name, size, "%s/%s_%02u.png", folder, scene, frame);
}

static void compare(const options *o, const char *scene, uint32_t frame, const uint8_t *rgb, difference *d)
{
	char name[1024], message[512];
	int width, height;
	uint8_t *other;
	file_name(name, sizeof name, o->against, scene, frame);
	if (!engine_image_read_png(name, &width, &height, &other, message, sizeof message))
		fail(message);
	if (width != o->size || height != o->size)
		fail("the pictures to compare with have another size");
	add_difference(d, rgb, other, 3 * (size_t)width * (size_t)height);
	free(other);
}

static void write(const options *o, const char *scene, uint32_t frame, const uint8_t *rgb)
{
	char name[1024], message[512];
	file_name(name, sizeof name, o->out, scene, frame);
	if (!engine_image_write_png(name, o->size, o->size, rgb, message, sizeof message))
		fail(message);
}

/* ---- drawing ---- */

typedef struct figures {
	samples shadow, draw, tonemap;
	samples processor; /* of all threads, for gi_draw: other programs on the machine do not disturb it */
	difference difference;
} figures;

static gi_context *open_gi(engine_context *context, const options *o, const scene_kind *kind, gi_object *mover)
{
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = engine_context_find_gl;
	def.get_proc_user = context;
	def.row_tolerance = o->row_tolerance;
	def.near_samples = 1;
	def.sky = kind->sky;
	def.shader_directory = o->shaders;
	gi_context *gi;
	check(gi_context_create(&def, &gi));
	check(kind->create(gi, mover));
	check(gi_commit(gi));
	return gi;
}

static void draw(gi_context *gi, engine_target *target, const options *o, const scene_kind *kind, figures *f)
{
	gi_view view = gi_view_default();
	view.width = view.height = (uint32_t)o->size;
	kind->camera(1, view.view_from_world, view.clip_from_view);
	view.clip_from_view[0] *= o->zoom;
	view.clip_from_view[5] *= o->zoom;
	engine_target_begin(target);
	check(gi_finish(gi));
	const double began = processor_ms();
	check(gi_draw(gi, &view));
	check(gi_finish(gi));
	samples_add(&f->processor, processor_ms() - began);
	const double mapped = now_ms();
	engine_target_tonemap(target, kind->exposure);
	check(gi_finish(gi));
	samples_add(&f->tonemap, now_ms() - mapped);
}

static void run_frame(gi_context *gi, engine_target *target, const options *o, const scene_kind *kind, uint32_t frame,
		      uint8_t *rgb, figures *f)
{
	gi_report report;
	draw(gi, target, o, kind, f);
	check(gi_get_report(gi, &report));
	samples_add(&f->shadow, (double)report.pass_ms[GI_PASS_SHADOW]);
	samples_add(&f->draw, (double)report.pass_ms[GI_PASS_DRAW]);
	engine_target_read(target, rgb);
	if (o->out)
		write(o, kind->name, frame, rgb);
	if (o->against)
		compare(o, kind->name, frame, rgb, &f->difference);
}

static void print_figures(const options *o, const scene_kind *kind, const figures *f)
{
	printf("| %s |", kind->name);
	const samples *columns[] = {&f->shadow, &f->draw, &f->processor, &f->tonemap};
	for (int k = 0; k < 4; k++)
		printf(" %.2f / %.2f |", samples_median(columns[k]), samples_quantile(columns[k], 0));
	const difference *d = &f->difference;
	if (o->against) {
		const double square = d->squares / (double)d->count;
		printf(" %.3f | %.1f | %d | %.4f %% | %.4f %% |", sqrt(square), 10 * log10(255 * 255 / square), d->most,
		       100.0 * (double)d->over_1 / (double)d->count, 100.0 * (double)d->over_2 / (double)d->count);
	}
	printf("\n");
	fflush(stdout);
}

static void run_scene(engine_context *context, const options *o, const scene_kind *kind)
{
	char message[256];
	engine_target *target = engine_target_create(o->size, o->size, message, sizeof message);
	if (!target)
		fail(message);
	uint8_t *rgb = malloc(3 * (size_t)o->size * (size_t)o->size);
	if (!rgb)
		fail("out of memory");
	gi_object mover;
	gi_context *gi = open_gi(context, o, kind, &mover);
	static figures f;
	check(gi_update(gi, NULL));
	draw(gi, target, o, kind, &f); /* shaders compile */
	f = (figures){0};
	for (uint32_t k = 0; k < o->frames; k++) {
		check(gi_set_pose(gi, mover, kind->pose(SECONDS_A_FRAME * (float)(k + 1))));
		check(gi_update(gi, NULL));
		check(gi_finish(gi));
		run_frame(gi, target, o, kind, k, rgb, &f);
	}
	print_figures(o, kind, &f);
	free(rgb);
	gi_context_destroy(gi);
	engine_target_destroy(target);
}

/* ---- options ---- */

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
	options *o = state->input;
	switch (key) {
	case 'n':
		o->frames = bench_parse_count(argument, 1, 99, "frames", state);
		return 0;
	case 'p':
		o->size = bench_parse_size(argument, state);
		return 0;
	case 'z':
		o->zoom = bench_parse_number(argument, .001f, 1000, "zoom", state);
		return 0;
	case 't':
		o->row_tolerance = bench_parse_number(argument, 1e-5f, 1, "row-tolerance", state);
		return 0;
	case 's':
		if (!scene_kind_find(argument))
			argp_error(state, "--scene is cornell, rooms, corridor or furnace, not '%s'", argument);
		o->scene = argument;
		return 0;
	case 'o':
		o->out = argument;
		return 0;
	case 'd':
		o->shaders = argument;
		return 0;
	case 'a':
		o->against = argument;
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp_option option_list[] = {
    {"frames", 'n', "N", 0, "frames of each scene, a quarter of a second apart, default 16", 0},
    {"size", 'p', "PIXELS", 0, "width and height, default 512", 0},
    {"zoom", 'z', "F", 0, "the middle of the picture this many times larger, default 1", 0},
    {"row-tolerance", 't', "T", 0, "of the indirect light, default 0.2", 0},
    {"scene", 's', "NAME", 0, "cornell, rooms, corridor or furnace alone", 0},
    {"out", 'o', "FOLDER", 0, "where pictures are written", 0},
    {"against", 'a', "FOLDER", 0, "pictures that another build wrote, to compare with", 0},
    {"shaders", 'd', "FOLDER", 0, "shaders read from there instead of those built in", 0},
    {0},
};

int main(int argc, char **argv)
{
	const bench_command command = {"gi_picture", "What the picture costs, and how far it is from another build's.",
				       option_list, parse_option};
	options o = {.frames = 16, .size = 512, .zoom = 1, .row_tolerance = 0.2f};
	const engine_context_kind kind = bench_parse(&command, argc, argv, &o);
	if (o.out && mkdir(o.out, 0777) && errno != EEXIST)
		fail("the folder --out cannot be made");
	engine_context *context = bench_open_window(kind, o.size);
	printf("# gi_picture on %s\n\nbuilt from %s, %d x %d, median / least of %u frames\n\n| scene | shadow ms | "
	       "draw ms | "
	       "processor ms of both | tone map ms |",
	       engine_context_describe(context), RELUME_COMMIT, o.size, o.size, o.frames);
	printf(o.against ? " RMS | PSNR dB | most | off by more than 1 | by more than 2 "
			   "|\n|---|---|---|---|---|---|---|---|---|---|\n"
			 : "\n|---|---|---|---|---|\n");
	for (int k = 0; k < SCENE_KINDS; k++)
		if (!o.scene || strcmp(o.scene, scene_kinds[k].name) == 0)
			run_scene(context, &o, &scene_kinds[k]);
	engine_context_destroy(context);
	return 0;
}
