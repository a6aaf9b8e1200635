/* Real-time ray tracing (tests/bench/realtime_tracer.h) against off-line ray tracing, which has its own tests, and against
 * itself. */
#include "harness.h"
#include "scenes/cornell.h"

#include "../bench/path_tracer.h"
#include "../bench/realtime_tracer.h"
#include "../bench/trace_box.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 48, VALUES = 3 * SIDE * SIDE };

typedef struct views {
	trace_scene scene;
	float view_from_world[16], clip_from_view[16];
	trace_camera camera;
} views;

static views *open_views(bool balls)
{
	harness_require_context();
	views *v = calloc(1, sizeof *v);
	assert_non_null(v);
	assert_true(balls ? trace_box_balls(&v->scene) : trace_box_buddha(&v->scene, 1, NULL));
	cornell_camera(1, v->view_from_world, v->clip_from_view);
	v->camera = trace_camera_make(v->view_from_world, v->clip_from_view, SIDE, SIDE);
	return v;
}

static void close_views(views *v)
{
	trace_scene_free(&v->scene);
	free(v);
}

static linear_image new_image(void)
{
	linear_image image;
	assert_true(linear_image_create(SIDE, SIDE, &image));
	return image;
}

static linear_image truth(const views *v, gi_mode light, uint32_t samples)
{
	const path_tracer_def def = {.scene = &v->scene, .camera = v->camera, .light = light, .seed = 1};
	path_tracer *tracer = path_tracer_create(&def);
	assert_non_null(tracer);
	assert_true(path_tracer_add(tracer, samples));
	linear_image image = new_image();
	path_tracer_picture(tracer, &image);
	path_tracer_destroy(tracer);
	return image;
}

static realtime_tracer *open_tracer(const views *v, const realtime_settings *settings)
{
	char message[512];
	double build_ms;
	realtime_tracer *t = realtime_tracer_create(&v->scene, settings, SIDE, SIDE, &build_ms, message, sizeof message);
	if (!t)
		fail_msg("%s", message);
	return t;
}

static linear_image real_time(const views *v, const realtime_settings *settings, gi_mode light, uint32_t frames)
{
	realtime_tracer *t = open_tracer(v, settings);
	for (uint32_t k = 0; k < frames; k++)
		realtime_tracer_frame(t, v->view_from_world, v->clip_from_view, light, false, NULL);
	linear_image image = new_image();
	realtime_tracer_read(t, &image);
	realtime_tracer_destroy(t);
	return image;
}

/* Paths alone: no light of the last frame, no filter, nothing cut off. */
static realtime_settings plain_settings(void)
{
	realtime_settings s = realtime_settings_tuned();
	s.reuse = false;
	s.filter_steps = 0;
	s.bounces = 12;
	s.largest = 1e30f;
	return s;
}

/* RMS over the RMS of the truth, of all pixels but the brightest hundredth, which are lamps and their mirror images: where
 * an edge of a lamp crosses a pixel's middle one renderer shows it and the other does not. */
static int by_value(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double relative_rms(const linear_image *image, const linear_image *wanted)
{
	static double errors[VALUES], squares;
	double sum = 0;
	const int kept = VALUES * 99 / 100;
	squares = 0;
	for (int k = 0; k < VALUES; k++) {
		const double d = (double)image->rgb[k] - (double)wanted->rgb[k];
		errors[k] = d * d;
		squares += (double)wanted->rgb[k] < 4 ? (double)wanted->rgb[k] * (double)wanted->rgb[k] : 0;
	}
	qsort(errors, VALUES, sizeof *errors, by_value);
	for (int k = 0; k < kept; k++)
		sum += errors[k];
	return sqrt(sum / squares);
}

static void check(views *v, const realtime_settings *settings, gi_mode light, uint32_t frames, double limit, int line)
{
	static const char *const names[] = {"global", "direct", "indirect"};
	linear_image wanted = truth(v, light, 256), got = real_time(v, settings, light, frames);
	const double error = relative_rms(&got, &wanted);
	printf("%s light, %u frames: relative RMS %.4f, at most %g\n", names[light], frames, error, limit);
	if (!(error <= limit))
		_fail(__FILE__, line);
	linear_image_free(&wanted);
	linear_image_free(&got);
}

/* At rest it converges to off-line ray tracing. */
static void test_converges(void **state)
{
	(void)state;
	views *v = open_views(false);
	const realtime_settings plain = plain_settings();
	check(v, &plain, GI_MODE_DIRECT, 256, 0.02, __LINE__);
	check(v, &plain, GI_MODE_GLOBAL, 256, 0.02, __LINE__);
	close_views(v);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_converges),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
