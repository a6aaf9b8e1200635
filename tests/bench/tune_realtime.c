/* How real-time ray tracing was tuned: what a frame costs and how far its picture is from the truth, while the Buddha
 * moves and after some frames at rest, with the settings in use and with each of them changed (docs/figures.md). Prints
 * figures, never passes or fails on one.
 */
#include "bench_options.h"
#include "bench_scene.h"
#include "image_error.h"
#include "realtime_tracer.h"
#include "six.h"
#include "trace_box.h"

#include <stdio.h>

typedef struct options {
	int width, height;
	uint32_t triangles, frames;
} options;

typedef struct variant {
	const char *name;
	realtime_settings settings;
} variant;

enum { MOST_VARIANTS = 48 };

static uint32_t list_variants(variant *out)
{
	const realtime_settings tuned = realtime_settings_tuned();
	uint32_t count = 0;
	out[count++] = (variant){"as tuned", tuned};
#define VARIANT(field, value)                                                                                          \
	out[count] = (variant){#field " " #value, tuned};                                                              \
	out[count++].settings.field = value
	VARIANT(paths, 2);
	VARIANT(paths, 4);
	VARIANT(reuse, false);
	VARIANT(bounces, 1);
	VARIANT(bounces, 2);
	VARIANT(bounces, 5);
	VARIANT(filter_steps, 0);
	VARIANT(filter_steps, 2);
	VARIANT(filter_steps, 3);
	VARIANT(filter_steps, 4);
	VARIANT(filter_steps, 5);
	VARIANT(moving_frames, 4);
	VARIANT(moving_frames, 8);
	VARIANT(moving_frames, 12);
	VARIANT(moving_frames, 16);
	VARIANT(moving_frames, 24);
	VARIANT(moving_frames, 48);
	VARIANT(moving_frames, 96);
	VARIANT(hold, .25f);
	VARIANT(hold, .5f);
	VARIANT(hold, 1);
	VARIANT(hold, 2);
	VARIANT(hold, 3);
	VARIANT(hold, 5);
	VARIANT(hold, 1000);
	VARIANT(depth_edge, .5f);
	VARIANT(depth_edge, 1);
	VARIANT(depth_edge, 2);
	VARIANT(normal_edge, 8);
	VARIANT(normal_edge, 16);
	VARIANT(normal_edge, 32);
	VARIANT(normal_edge, 64);
	VARIANT(normal_edge, 128);
	VARIANT(light_edge, 1);
	VARIANT(light_edge, 2);
	VARIANT(light_edge, 3);
	VARIANT(light_edge, 4);
	VARIANT(light_edge, 8);
	VARIANT(largest, 60);
	VARIANT(largest, 1e30f);
#undef VARIANT
	return count;
}

static void step(const six_scene *s, realtime_tracer *t, float time, bool moves, realtime_times *times)
{
	trace_box_buddha_at(s->scene, time);
	realtime_tracer_frame(t, s->view_from_world, s->clip_from_view, GI_MODE_GLOBAL, moves, times);
}

/* Of the picture now. */
static double error_of(const six_scene *s, realtime_tracer *t, linear_image *picture)
{
	realtime_tracer_read(t, picture);
	return image_relative_mse(picture, s->truth);
}

/* At rest after so many frames from none, then moving, so long that nothing of the rest is left. */
static void measure(const six_scene *s, realtime_tracer *t, const variant *v, uint32_t frames, linear_image *picture)
{
	realtime_times times;
	realtime_tracer_set(t, &v->settings);
	realtime_tracer_reset(t);
	for (uint32_t k = 0; k < frames; k++)
		step(s, t, SIX_TIME, false, &times);
	const double rest = error_of(s, t, picture);
	double spent = 0;
	for (uint32_t k = 2 * frames; k-- > 0;) {
		const double began = processor_ms();
		step(s, t, SIX_TIME - SIX_FRAME * (float)k, true, &times);
		spent += processor_ms() - began;
	}
	printf("| %s | %.0f | %.2e | %.2e |\n", v->name, spent / (2 * frames), error_of(s, t, picture), rest);
	fflush(stdout);
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
	options *o = state->input;
	switch (key) {
	case 'p':
		bench_parse_area(argument, &o->width, &o->height, state);
		return 0;
	case 't':
		o->triangles = bench_parse_count(argument, 1000, 1000000, "triangles", state);
		return 0;
	case 'n':
		o->frames = bench_parse_count(argument, 1, 10000, "frames", state);
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

int main(int argc, char **argv)
{
	static const struct argp_option list[] = {
	    {"size", 'p', "WxH", 0, "pixels, default 192x192", 0},
	    {"triangles", 't', "N", 0, "of the Buddha, default 4000", 0},
	    {"frames", 'n', "N", 0, "at rest, and twice as many that move; default 24", 0},
	    {0},
	};
	const bench_command command = {"tune_realtime", "Settings of real-time ray tracing against each other.", list,
				       parse_option};
	options o = {.width = 192, .height = 192, .triangles = 4000, .frames = 24};
	const engine_context_kind kind = bench_parse(&command, argc, argv, &o);
	engine_context *context = bench_open_window(kind, 64);
	const six_effort effort = {.width = o.width, .height = o.height, .truth_samples = 64};
	six_scene scene;
	six_scene_open(&scene, &effort, context, o.triangles);
	static variant variants[MOST_VARIANTS];
	const uint32_t count = list_variants(variants);
	char message[512];
	double build_ms;
	linear_image picture;
	realtime_tracer *tracer = realtime_tracer_create(scene.scene, &variants[0].settings, o.width, o.height,
							 &build_ms, message, sizeof message);
	if (!tracer)
		fail(message);
	if (!linear_image_create(o.width, o.height, &picture))
		fail("out of memory");
	printf(
	    "| setting | processor ms a frame | relative MSE, moving | at rest after %u frames |\n|---|---|---|---|\n",
	    o.frames);
	for (uint32_t k = 0; k < count; k++)
		measure(&scene, tracer, &variants[k], o.frames, &picture);
	realtime_tracer_destroy(tracer);
	linear_image_free(&picture);
	six_scene_close(&scene);
	engine_context_destroy(context);
	return 0;
}
