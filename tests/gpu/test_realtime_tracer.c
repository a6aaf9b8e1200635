/* Real-time ray tracing (tests/bench/realtime_tracer.h) against off-line ray tracing, which has its own tests, and
 * against itself. */
#include "harness.h"
#include "scenes/cornell.h"

#include "../bench/path_tracer.h"
#include "../bench/realtime_tracer.h"
#include "../bench/trace_box.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 40, VALUES = 3 * SIDE * SIDE };

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
	/* The box's edges run through the middles of pixels else, where a rounding decides what is seen. */
	v->view_from_world[12] += 0.037f;
	v->view_from_world[13] += 0.021f;
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
	realtime_tracer *t =
	    realtime_tracer_create(&v->scene, settings, SIDE, SIDE, &build_ms, message, sizeof message);
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

/* W/m2/sr: only lamps are brighter, and their images. */
static const float LAMP = 4;

static int by_value(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* RMS over the RMS of the truth, without the worst hundredth: where an edge passes a pixel's middle by a rounding, one
 * renderer shows what is before it and the other what is behind. */
static double relative_rms(const linear_image *image, const linear_image *wanted)
{
	static double errors[VALUES];
	double sum = 0, squares = 0;
	for (int k = 0; k < VALUES; k++) {
		const double d = (double)image->rgb[k] - (double)wanted->rgb[k];
		errors[k] = d * d;
		if (wanted->rgb[k] < LAMP)
			squares += (double)wanted->rgb[k] * (double)wanted->rgb[k];
	}
	qsort(errors, VALUES, sizeof *errors, by_value);
	for (int k = 0; k < VALUES * 99 / 100; k++)
		sum += errors[k];
	return sqrt(sum / squares);
}

/* Of all that is no lamp: its mean over that of the truth. */
static double mean_ratio(const linear_image *image, const linear_image *wanted)
{
	double sum = 0, wanted_sum = 0;
	for (int k = 0; k < VALUES; k++)
		if (wanted->rgb[k] < LAMP) {
			sum += (double)image->rgb[k];
			wanted_sum += (double)wanted->rgb[k];
		}
	return sum / wanted_sum;
}

typedef struct limits {
	double rms, mean;
} limits;

static void judge(const char *what, const linear_image *got, const linear_image *wanted, limits most, int line)
{
	const double rms = relative_rms(got, wanted), mean = mean_ratio(got, wanted) - 1;
	printf("%s: relative RMS %.4f, at most %g; mean off by %+.4f, at most %g\n", what, rms, most.rms, mean,
	       most.mean);
	if (!(rms <= most.rms && fabs(mean) <= most.mean))
		_fail(__FILE__, line);
}

static void check(const char *what, views *v, const realtime_settings *settings, gi_mode light, uint32_t frames,
		  limits most, int line)
{
	linear_image wanted = truth(v, light, 256), got = real_time(v, settings, light, frames);
	judge(what, &got, &wanted, most, line);
	linear_image_free(&wanted);
	linear_image_free(&got);
}

#define CHECK(what, v, settings, light, frames, rms, mean)                                                             \
	check(what, v, settings, light, frames, (limits){rms, mean}, __LINE__)

/* At rest paths alone converge to off-line ray tracing: what is left is noise of both, and edges that the rasteriser
 * puts a rounding beside those of rays. */
static void test_paths_alone(void **state)
{
	(void)state;
	views *v = open_views(false);
	const realtime_settings plain = plain_settings();
	CHECK("direct light", v, &plain, GI_MODE_DIRECT, 64, 0.015, 0.003);
	CHECK("indirect light", v, &plain, GI_MODE_INDIRECT, 64, 0.15, 0.01);
	CHECK("global light", v, &plain, GI_MODE_GLOBAL, 64, 0.07, 0.008);
	close_views(v);
}

static void test_mirror_and_glass(void **state)
{
	(void)state;
	views *v = open_views(true);
	const realtime_settings plain = plain_settings();
	CHECK("mirror and glass", v, &plain, GI_MODE_GLOBAL, 64, 0.13, 0.02);
	close_views(v);
}

/* With all that makes it fast, which blurs and lags. */
static void test_tuned(void **state)
{
	(void)state;
	views *v = open_views(false);
	const realtime_settings tuned = realtime_settings_tuned();
	CHECK("one frame", v, &tuned, GI_MODE_GLOBAL, 1, 0.2, 0.08);
	CHECK("at rest", v, &tuned, GI_MODE_GLOBAL, 48, 0.05, 0.03);
	close_views(v);
}

/* The Buddha on its way; the last picture. */
static linear_image in_motion(views *v, realtime_tracer *t)
{
	linear_image image = new_image();
	realtime_tracer_reset(t);
	for (int k = 0; k < 16; k++) {
		trace_box_buddha_at(&v->scene, (float)k / 30);
		realtime_tracer_frame(t, v->view_from_world, v->clip_from_view, GI_MODE_GLOBAL, true, NULL);
	}
	realtime_tracer_read(t, &image);
	return image;
}

/* History is found again where things went, and a second time the same bits come out. */
static void test_moving(void **state)
{
	(void)state;
	views *v = open_views(false);
	const realtime_settings tuned = realtime_settings_tuned();
	realtime_tracer *t = open_tracer(v, &tuned);
	linear_image once = in_motion(v, t), twice = in_motion(v, t), wanted = truth(v, GI_MODE_GLOBAL, 256);
	assert_memory_equal(once.rgb, twice.rgb, VALUES * sizeof *once.rgb);
	judge("while it moves", &once, &wanted, (limits){0.12, 0.06}, __LINE__);
	realtime_tracer_destroy(t);
	linear_image_free(&once);
	linear_image_free(&twice);
	linear_image_free(&wanted);
	close_views(v);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_paths_alone),
	    cmocka_unit_test(test_mirror_and_glass),
	    cmocka_unit_test(test_tuned),
	    cmocka_unit_test(test_moving),
	};
	return cmocka_run_group_tests(tests, harness_open, harness_close);
}
