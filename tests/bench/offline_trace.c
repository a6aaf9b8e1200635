/* A picture by off-line ray tracing (path_tracer.h), of the demos' scenes by the demos' camera: the truth that
 * others are held against, or itself a rival. */
#include "bench_options.h"
#include "bench_scene.h"
#include "image.h"
#include "output.h"
#include "path_tracer.h"
#include "pfm.h"
#include "trace_box.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct options {
	bool balls; /* else the Buddha */
	gi_mode light;
	int width, height;
	uint32_t samples, fineness, seed, threads;
	float time, exposure;
	bool antialias;
	const char *out, *linear;
} options;

static const float DEMO_EXPOSURE = 1.6f;

static bool create_scene(const options *o, trace_scene *scene)
{
	const bool made = o->balls ? trace_box_balls(scene) : trace_box_buddha(scene, o->fineness, NULL);
	if (made && o->balls)
		trace_box_balls_at(scene, o->time);
	else if (made)
		trace_box_buddha_at(scene, o->time);
	return made;
}

static path_tracer *open_tracer(const options *o, const trace_scene *scene)
{
	float view_from_world[16], clip_from_view[16];
	cornell_camera((float)o->width / (float)o->height, view_from_world, clip_from_view);
	const path_tracer_def def = {.scene = scene,
				     .camera = trace_camera_make(view_from_world, clip_from_view, o->width, o->height),
				     .light = o->light,
				     .antialias = o->antialias,
				     .seed = o->seed,
				     .threads = o->threads};
	return path_tracer_create(&def);
}

/* Traces in steps, each told on stderr. */
static void trace(const options *o, path_tracer *tracer)
{
	const double began = now_ms();
	double told = began;
	for (uint32_t done = 0; done < o->samples;) {
		const uint32_t step = o->samples - done < 4 ? o->samples - done : 4;
		if (!path_tracer_add(tracer, step))
			fail("out of memory");
		done += step;
		const double now = now_ms();
		if (now - told > 2000) {
			fprintf(stderr, "offline_trace: %u of %u paths a pixel, %.0f s\n", done, o->samples,
				(now - began) / 1000);
			told = now;
		}
	}
	fprintf(stderr, "offline_trace: %u paths a pixel in %.1f s\n", o->samples, (now_ms() - began) / 1000);
}

static void write_png(const options *o, engine_context_kind kind, const linear_image *image)
{
	char message[512];
	engine_context *context = bench_open_window(kind, 64);
	uint8_t *rgb = malloc(3 * (size_t)o->width * (size_t)o->height);
	if (!rgb)
		fail("out of memory");
	if (!linear_image_tonemap(image, o->exposure, rgb, message, sizeof message) ||
	    !engine_image_write_png(o->out, o->width, o->height, rgb, message, sizeof message))
		fail(message);
	free(rgb);
	engine_context_destroy(context);
}

/* ---- options ---- */

static gi_mode parse_light(const char *argument, struct argp_state *state)
{
	static const char *const names[] = {"global", "direct", "indirect"}; /* as gi_mode counts them */
	for (int k = 0; k < 3; k++)
		if (strcmp(argument, names[k]) == 0)
			return (gi_mode)k;
	argp_error(state, "--light is direct, indirect or global, not '%s'", argument);
	return GI_MODE_GLOBAL;
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
	options *o = state->input;
	switch (key) {
	case 's':
		o->balls = strcmp(argument, "two_balls") == 0;
		if (!o->balls && strcmp(argument, "buddha") != 0)
			argp_error(state, "--scene is buddha or two_balls, not '%s'", argument);
		return 0;
	case 'l':
		o->light = parse_light(argument, state);
		return 0;
	case 'p':
		bench_parse_area(argument, &o->width, &o->height, state);
		return 0;
	case 'n':
		o->samples = bench_parse_count(argument, 1, 1 << 20, "samples", state);
		return 0;
	case 'f':
		o->fineness = bench_parse_count(argument, 1, 32, "fineness", state);
		return 0;
	case 't':
		o->time = bench_parse_number(argument, 0, 1e6f, "time", state);
		return 0;
	case 'e':
		o->exposure = bench_parse_number(argument, 1e-6f, 1e6f, "exposure", state);
		return 0;
	case 'r':
		o->seed = bench_parse_count(argument, 0, UINT32_MAX, "seed", state);
		return 0;
	case 'j':
		o->threads = bench_parse_count(argument, 1, 64, "threads", state);
		return 0;
	case 'a':
		o->antialias = true;
		return 0;
	case 'o':
		o->out = argument;
		return 0;
	case 'x':
		o->linear = argument;
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp_option option_list[] = {
    {"scene", 's', "NAME", 0, "buddha or two_balls, default buddha", 0},
    {"light", 'l', "KIND", 0, "direct, indirect or global, as gi_draw has them; default global", 0},
    {"size", 'p', "WxH", 0, "pixels, default 512x512", 0},
    {"samples", 'n', "N", 0, "paths through each pixel, powers of two are best; default 64", 0},
    {"time", 't', "S", 0, "where what moves is, seconds; default 0", 0},
    {"antialias", 'a', NULL, 0, "the mean over each pixel; default: what its middle shows, as gi_draw has it", 0},
    {"fineness", 'f', "N", 0, "2 N^2 triangles of each of the Buddha's 992 faces, default 8", 0},
    {"seed", 'r', "N", 0, "another one is an independent picture, default 1", 0},
    {"threads", 'j', "N", 0, "default: one a processor; no bit depends on it", 0},
    {"exposure", 'e', "F", 0, "of the PNG, default 1.6 as in the demos", 0},
    {"out", 'o', "FILE", 0, "a PNG, tone-mapped as the demos do", 0},
    {"linear", 'x', "FILE", 0, "a PFM of radiance, W/m2/sr", 0},
    {0},
};

int main(int argc, char **argv)
{
	const bench_command command = {"offline_trace", "A picture by path tracing, from all processors.", option_list,
				       parse_option};
	options o = {.light = GI_MODE_GLOBAL,
		     .width = 512,
		     .height = 512,
		     .samples = 64,
		     .fineness = 8,
		     .seed = 1,
		     .exposure = DEMO_EXPOSURE};
	const engine_context_kind kind = bench_parse(&command, argc, argv, &o);
	char message[512];
	linear_image image;
	trace_scene *scene = calloc(1, sizeof *scene);
	if (!scene || !linear_image_create(o.width, o.height, &image) || !create_scene(&o, scene))
		fail("out of memory");
	path_tracer *tracer = open_tracer(&o, scene);
	if (!tracer)
		fail("Embree or memory fails");
	trace(&o, tracer);
	path_tracer_picture(tracer, &image);
	if (o.linear && !engine_pfm_write(o.linear, o.width, o.height, image.rgb, message, sizeof message))
		fail(message);
	if (o.out)
		write_png(&o, kind, &image);
	path_tracer_destroy(tracer);
	trace_scene_free(scene);
	free(scene);
	linear_image_free(&image);
	return 0;
}
