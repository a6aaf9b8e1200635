/* The library's frames of figure 6. */
#include "six.h"

#include "bench_scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct session {
	const six_scene *s;
	gi_context *gi;
	cornell box;
	engine_target *target;
	samples times;
	double passes[GI_PASS_COUNT]; /* sums over the timed frames, ms */
} session;

/* As frame rates are measured elsewhere (docs/performance.md). */
static void open_gi(session *r)
{
	const bench_settings settings = bench_settings_coarse();
	r->gi = bench_open(r->s->context, &settings);
	cornell_def def = cornell_def_default();
	def.figure = &r->s->drawn;
	def.figure_cage = &r->s->cage;
	check(cornell_create(r->gi, &def, &r->box));
	check(gi_commit(r->gi));
}

static void draw(session *r)
{
	gi_view view = gi_view_default();
	view.width = (uint32_t)r->s->effort->width;
	view.height = (uint32_t)r->s->effort->height;
	memcpy(view.view_from_world, r->s->view_from_world, sizeof view.view_from_world);
	memcpy(view.clip_from_view, r->s->clip_from_view, sizeof view.clip_from_view);
	engine_target_begin(r->target);
	check(gi_draw(r->gi, &view));
}

static void frame(session *r, float time, bool timed)
{
	gi_report report;
	const double began = now_ms();
	check(gi_set_pose(r->gi, r->box.buddha, cornell_buddha_pose(time)));
	check(gi_update(r->gi, NULL));
	draw(r);
	check(gi_finish(r->gi));
	if (!timed)
		return;
	samples_add(&r->times, now_ms() - began);
	check(gi_get_report(r->gi, &report));
	for (int k = 0; k < GI_PASS_COUNT; k++)
		r->passes[k] += (double)report.pass_ms[k];
}

static double pass_sum(const session *r, gi_pass first, gi_pass last)
{
	double sum = 0;
	for (int k = first; k <= (int)last; k++)
		sum += r->passes[k];
	return sum / r->times.count;
}

static void fill_row(session *r, const char *folder, double build_ms, six_row *row)
{
	char path[1024];
	linear_image picture;
	if (!linear_image_create(r->s->effort->width, r->s->effort->height, &picture))
		fail("out of memory");
	engine_target_read_radiance(r->target, picture.rgb);
	snprintf(path, sizeof path, "%s/figure6_%s_%u.png", folder, six_method_names[row->method], row->triangles);
	six_judge(r->s, &picture, row, row->motion == SIX_MOVING ? path : NULL);
	linear_image_free(&picture);
	row->ms = row->equal_error_ms = samples_median(&r->times);
	row->parts[SIX_BUILD] = build_ms;
	row->parts[SIX_ROWS] = pass_sum(r, GI_PASS_POSE, GI_PASS_CLOSE);
	row->parts[SIX_SOLVE] = pass_sum(r, GI_PASS_CAUSTICS, GI_PASS_ESTIMATE);
	row->parts[SIX_DRAW] = pass_sum(r, GI_PASS_SHADOW, GI_PASS_DRAW);
}

static void begin_timing(session *r)
{
	r->times.count = 0;
	for (int k = 0; k < GI_PASS_COUNT; k++)
		r->passes[k] = 0;
}

void six_radiosity(const six_scene *scene, const char *folder, six_row rows[SIX_MOTIONS])
{
	static session r;
	char message[256];
	const uint32_t frames = scene->effort->frames;
	r = (session){.s = scene};
	r.target = engine_target_create(scene->effort->width, scene->effort->height, message, sizeof message);
	if (!r.target)
		fail(message);
	open_gi(&r);
	frame(&r, SIX_TIME - SIX_FRAME * (float)(frames + 2), false); /* shaders compile */
	const double began = now_ms();
	gi_reset_radiosity(r.gi);
	check(gi_commit(r.gi));
	frame(&r, SIX_TIME - SIX_FRAME * (float)(frames + 1), false);
	const double build_ms = now_ms() - began;
	frame(&r, SIX_TIME - SIX_FRAME * (float)frames, false);
	begin_timing(&r);
	for (uint32_t k = frames; k-- > 0;)
		frame(&r, SIX_TIME - SIX_FRAME * (float)k, true);
	rows[SIX_MOVING] = six_row_of(scene, SIX_RADIOSITY, SIX_MOVING);
	fill_row(&r, folder, build_ms, &rows[SIX_MOVING]);
	begin_timing(&r);
	for (uint32_t k = 0; k < frames; k++)
		frame(&r, SIX_TIME, true);
	rows[SIX_REST] = six_row_of(scene, SIX_RADIOSITY, SIX_REST);
	fill_row(&r, folder, build_ms, &rows[SIX_REST]);
	gi_context_destroy(r.gi);
	engine_target_destroy(r.target);
}
