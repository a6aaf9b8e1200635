/* Real-time ray tracing's frames of figure 6. */
#include "six.h"

#include "bench_scene.h"
#include "gl.h"
#include "image_error.h"
#include "realtime_tracer.h"
#include "trace_box.h"

#include <math.h>
#include <stdio.h>

typedef struct session {
	const six_scene *s;
	realtime_tracer *tracer;
	linear_image picture;
	samples times;
	realtime_times parts; /* sums over the timed frames */
} session;

static double frame(session *r, float time, bool moves)
{
	realtime_times parts;
	const double began = now_ms();
	trace_box_buddha_at(r->s->scene, time);
	realtime_tracer_frame(r->tracer, r->s->view_from_world, r->s->clip_from_view, GI_MODE_GLOBAL, moves, &parts);
	const double ms = now_ms() - began;
	samples_add(&r->times, ms);
	r->parts.surface += parts.surface;
	r->parts.trace += parts.trace;
	r->parts.filter += parts.filter;
	return ms;
}

static void begin_timing(session *r)
{
	r->times.count = 0;
	r->parts = (realtime_times){0};
}

static double error_now(session *r)
{
	realtime_tracer_read(r->tracer, &r->picture);
	return image_relative_mse(&r->picture, r->s->truth);
}

/* Frames up to the pose that is measured. */
static void play(session *r, uint32_t frames)
{
	for (uint32_t k = frames; k-- > 0;)
		frame(r, SIX_TIME - SIX_FRAME * (float)k, true);
}

static void fill_row(session *r, const char *folder, double build_ms, six_row *row)
{
	char path[1024];
	realtime_tracer_read(r->tracer, &r->picture);
	snprintf(path, sizeof path, "%s/figure6_%s_%u.png", folder, six_method_names[row->method], row->triangles);
	six_judge(r->s, &r->picture, row, row->motion == SIX_MOVING ? path : NULL);
	row->ms = samples_median(&r->times);
	row->parts[SIX_BUILD] = build_ms;
	row->parts[SIX_BVH] = 0; /* rigid: only a matrix changes */
	row->parts[SIX_SURFACE] = r->parts.surface / r->times.count;
	row->parts[SIX_TRACE] = r->parts.trace / r->times.count;
	row->parts[SIX_FILTER] = r->parts.filter / r->times.count;
}

/* What a moving frame takes at radiosity's error: with more paths a pixel. */
static double equal_moving(session *r, double first_error, double wanted)
{
	static const uint32_t paths[] = {3, 9};
	const uint32_t frames = r->s->effort->frames < 6 ? r->s->effort->frames : 6;
	six_course course = six_course_begin();
	six_course_add(&course, samples_median(&r->times), first_error, wanted);
	realtime_settings settings = realtime_settings_tuned();
	for (size_t k = 0; k < sizeof paths / sizeof *paths && isnan(course.reached_ms); k++) {
		settings.paths = paths[k];
		realtime_tracer_set(r->tracer, &settings);
		begin_timing(r);
		play(r, frames);
		six_course_add(&course, samples_median(&r->times), error_now(r), wanted);
	}
	settings = realtime_settings_tuned();
	realtime_tracer_set(r->tracer, &settings);
	return course.reached_ms;
}

/* At rest frames add up, from none. */
static double equal_rest(session *r, double wanted)
{
	six_course course = six_course_begin();
	double ms = 0;
	for (uint32_t k = 1; k <= r->s->effort->most_frames; k++) {
		ms += frame(r, SIX_TIME, false);
		if ((k & (k - 1)) == 0 || k == r->s->effort->frames)
			six_course_add(&course, ms, error_now(r), wanted);
	}
	return course.reached_ms;
}

void six_realtime(const six_scene *scene, const char *folder, const double wanted[SIX_MOTIONS],
		  six_row rows[SIX_MOTIONS])
{
	static session r;
	char message[512];
	double build_ms;
	const realtime_settings settings = realtime_settings_tuned();
	r = (session){.s = scene};
	r.tracer = realtime_tracer_create(scene->scene, &settings, scene->effort->width, scene->effort->height,
					  &build_ms, message, sizeof message);
	if (!r.tracer)
		fail(message);
	if (!linear_image_create(scene->effort->width, scene->effort->height, &r.picture))
		fail("out of memory");
	/* History as after a while of motion; shaders compile. */
	for (uint32_t k = 8; k > 0; k--)
		frame(&r, SIX_TIME - SIX_FRAME * (float)(scene->effort->frames + k - 1), true);
	begin_timing(&r);
	play(&r, scene->effort->frames);
	rows[SIX_MOVING] = six_row_of(scene, SIX_REALTIME, SIX_MOVING);
	fill_row(&r, folder, build_ms, &rows[SIX_MOVING]);
	rows[SIX_MOVING].equal_error_ms = equal_moving(&r, rows[SIX_MOVING].relative_mse, wanted[SIX_MOVING]);
	realtime_tracer_reset(r.tracer);
	begin_timing(&r);
	const double equal = equal_rest(&r, wanted[SIX_REST]);
	rows[SIX_REST] = six_row_of(scene, SIX_REALTIME, SIX_REST);
	fill_row(&r, folder, build_ms, &rows[SIX_REST]);
	rows[SIX_REST].equal_error_ms = equal;
	realtime_tracer_destroy(r.tracer);
	linear_image_free(&r.picture);
}
