/* Off-line ray tracing's pictures of figure 6. It has no memory: a picture costs the same whether something moves. */
#include "six.h"

#include "bench_scene.h"
#include "image_error.h"
#include "path_tracer.h"
#include "trace_box.h"

#include <math.h>
#include <stdio.h>

typedef struct session {
	const six_scene *s;
	path_tracer *tracer;
	linear_image picture;
	double update_ms;
} session;

/* A new picture: with its tree. */
static void begin(session *r)
{
	const double began = now_ms();
	trace_box_buddha_at(r->s->scene, SIX_TIME);
	path_tracer_update(r->tracer);
	r->update_ms = now_ms() - began;
}

static double add(session *r, uint32_t samples)
{
	const double began = now_ms();
	if (!path_tracer_add(r->tracer, samples))
		fail("out of memory");
	return now_ms() - began;
}

static void show(session *r, const char *folder, double ms, six_row *row)
{
	char path[1024];
	snprintf(path, sizeof path, "%s/figure6_%s_%u.png", folder, six_method_names[row->method], row->triangles);
	six_judge(r->s, &r->picture, row, path);
	row->ms = ms;
	row->parts[SIX_BVH] = r->update_ms;
	row->parts[SIX_TRACE] = ms - r->update_ms;
}

/* More and more paths until the error is radiosity's; the picture that is shown on the way fills the row. */
static void run(session *r, const char *folder, const double wanted[SIX_MOTIONS], six_row *row,
		six_course courses[SIX_MOTIONS])
{
	const six_effort *effort = r->s->effort;
	bool done = false;
	begin(r);
	double ms = r->update_ms;
	for (uint32_t samples = 1; samples <= effort->most_samples && !done; samples *= 2) {
		ms += add(r, samples - path_tracer_samples(r->tracer));
		path_tracer_picture(r->tracer, &r->picture);
		const double error = image_relative_mse(&r->picture, r->s->truth);
		done = samples >= effort->shown_samples;
		for (int k = 0; k < SIX_MOTIONS; k++) {
			six_course_add(&courses[k], ms, error, wanted[k]);
			done = done && !isnan(courses[k].reached_ms);
		}
		if (samples == effort->shown_samples)
			show(r, folder, ms, row);
	}
}

void six_offline(const six_scene *scene, const char *folder, const double wanted[SIX_MOTIONS],
		 six_row rows[SIX_MOTIONS])
{
	session r = {.s = scene};
	const path_tracer_def def = {.scene = scene->scene,
				     .camera = trace_camera_make(scene->view_from_world, scene->clip_from_view,
								 scene->effort->width, scene->effort->height),
				     .seed = 1};
	const double began = now_ms();
	r.tracer = path_tracer_create(&def);
	const double build_ms = now_ms() - began;
	if (!r.tracer || !linear_image_create(scene->effort->width, scene->effort->height, &r.picture))
		fail("out of memory, or Embree fails");
	six_course courses[SIX_MOTIONS] = {six_course_begin(), six_course_begin()};
	six_row row = six_row_of(scene, SIX_OFFLINE, SIX_REST);
	row.parts[SIX_BUILD] = build_ms;
	run(&r, folder, wanted, &row, courses);
	for (int k = 0; k < SIX_MOTIONS; k++) {
		rows[k] = row;
		rows[k].motion = (six_motion)k;
		rows[k].equal_error_ms = courses[k].reached_ms;
	}
	path_tracer_destroy(r.tracer);
	linear_image_free(&r.picture);
}
