#include "six.h"

#include "bench_scene.h"
#include "figure.h"
#include "image.h"
#include "image_error.h"
#include "path_tracer.h"
#include "simplify.h"
#include "trace_box.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const six_method_names[SIX_METHODS] = {"radiosity", "realtime", "offline"};
const char *const six_motion_names[SIX_MOTIONS] = {"rest", "moving"};
const char *const six_part_names[SIX_PARTS] = {"build", "bvh", "rows", "solve", "surface", "trace", "filter", "draw"};

const float SIX_TIME = 1.5f, SIX_FRAME = 1 / 30.0f;
const float SIX_EXPOSURE = 1.6f; /* the demos' */

/* As the demo does with a mesh of a file. */
enum { CAGE_FACES = 900, BUDDHA_FACES = 992 };

/* The limit surface a little finer than wanted, then simplified: the Buddha as a scan of that many triangles is. */
static void make_figure(uint32_t triangles, engine_mesh *out)
{
	char message[512];
	engine_mesh fine;
	uint32_t fineness = 1;
	while (2 * BUDDHA_FACES * fineness * fineness < triangles)
		fineness++;
	if (!trace_box_figure(fineness, &fine))
		fail("out of memory, or Embree fails");
	if (!engine_simplify(&fine, triangles, out, message, sizeof message))
		fail(message);
	engine_mesh_free(&fine);
}

/* As cornell_create fits a figure into the box, so that all methods have the same. */
static void fit(engine_mesh *mesh)
{
	vec3 lower = {INFINITY, INFINITY, INFINITY}, upper = {-INFINITY, -INFINITY, -INFINITY}, origin;
	for (uint32_t v = 0; v < mesh->vertex_count; v++) {
		glm_vec3_minv(lower, mesh->positions + 3 * (size_t)v, lower);
		glm_vec3_maxv(upper, mesh->positions + 3 * (size_t)v, upper);
	}
	const float scale = cornell_def_default().buddha_height / (upper[1] - lower[1]);
	glm_vec3_center(lower, upper, origin);
	origin[1] = lower[1];
	for (uint32_t v = 0; v < mesh->vertex_count; v++) {
		float *p = mesh->positions + 3 * (size_t)v;
		glm_vec3_sub(p, origin, p);
		glm_vec3_scale(p, scale, p);
	}
}

static void find_truth(six_scene *s)
{
	for (uint32_t half = 0; half < 2; half++) {
		const path_tracer_def def = {.scene = s->scene,
					     .camera = trace_camera_make(s->view_from_world, s->clip_from_view,
									 s->effort->width, s->effort->height),
					     .seed = 1000 + half};
		path_tracer *tracer = path_tracer_create(&def);
		if (!tracer || !path_tracer_add(tracer, s->effort->truth_samples) ||
		    !linear_image_create(s->effort->width, s->effort->height, &s->truth[half]))
			fail("out of memory, or Embree fails");
		path_tracer_picture(tracer, &s->truth[half]);
		path_tracer_destroy(tracer);
	}
	for (size_t k = 0; k < 3 * (size_t)s->effort->width * (size_t)s->effort->height; k++)
		s->truth_mean.rgb[k] = 0.5f * (s->truth[0].rgb[k] + s->truth[1].rgb[k]);
}

static void show(const linear_image *picture, uint8_t *rgb)
{
	char message[512];
	if (!linear_image_tonemap(picture, SIX_EXPOSURE, rgb, message, sizeof message))
		fail(message);
}

void six_scene_open(six_scene *s, const six_effort *effort, engine_context *context, uint32_t triangles)
{
	char message[512];
	engine_mesh figure;
	*s = (six_scene){.effort = effort, .context = context};
	make_figure(triangles, &figure);
	fit(&figure);
	if (!figure_make(&figure, CAGE_FACES, &s->drawn, &s->cage, message, sizeof message))
		fail(message);
	engine_mesh_free(&figure);
	s->scene = calloc(1, sizeof *s->scene);
	s->truth_shown = malloc(3 * (size_t)effort->width * (size_t)effort->height);
	if (!s->scene || !s->truth_shown || !trace_box_buddha(s->scene, 0, &s->drawn) ||
	    !linear_image_create(effort->width, effort->height, &s->truth_mean))
		fail("out of memory, or Embree fails");
	trace_box_buddha_at(s->scene, SIX_TIME);
	/* The demos' camera, but for a fraction of a pixel: the box's edges run through the middles of pixels else,
	 * where a rounding decides what each method shows. */
	cornell_camera((float)effort->width / (float)effort->height, s->view_from_world, s->clip_from_view);
	s->view_from_world[12] += 0.007f;
	s->view_from_world[13] += 0.004f;
	find_truth(s);
	show(&s->truth_mean, s->truth_shown);
}

void six_scene_close(six_scene *s)
{
	engine_mesh_free(&s->drawn);
	engine_mesh_free(&s->cage);
	trace_scene_free(s->scene);
	free(s->scene);
	for (int half = 0; half < 2; half++)
		linear_image_free(&s->truth[half]);
	linear_image_free(&s->truth_mean);
	free(s->truth_shown);
}

six_row six_row_of(const six_scene *s, six_method method, six_motion motion)
{
	six_row row = {.triangles = s->drawn.face_count,
		       .mesh_kb = (12.0 * s->drawn.vertex_count + 12.0 * s->drawn.face_count) / 1024,
		       .method = method,
		       .motion = motion,
		       .ms = NAN,
		       .relative_mse = NAN,
		       .ssim = NAN,
		       .equal_error_ms = NAN};
	for (int k = 0; k < SIX_PARTS; k++)
		row.parts[k] = NAN;
	return row;
}

void six_judge(const six_scene *s, const linear_image *picture, six_row *row, const char *path)
{
	char message[512];
	uint8_t *rgb = malloc(3 * (size_t)picture->width * (size_t)picture->height);
	if (!rgb)
		fail("out of memory");
	show(picture, rgb);
	row->relative_mse = image_relative_mse(picture, s->truth);
	row->ssim = image_ssim(rgb, s->truth_shown, picture->width, picture->height);
	if (path && !engine_image_write_png(path, picture->width, picture->height, rgb, message, sizeof message))
		fail(message);
	free(rgb);
}

six_course six_course_begin(void)
{
	return (six_course){.reached_ms = NAN};
}

void six_course_add(six_course *c, double ms, double error, double wanted)
{
	/* Noise of the truth may take an error below 0. */
	const double now = fmax(error, 1e-12);
	if (isnan(c->reached_ms) && now <= wanted) {
		const double share = c->ms > 0 && c->error > now ? log(c->error / wanted) / log(c->error / now) : 1;
		c->reached_ms = c->ms > 0 ? c->ms * pow(ms / c->ms, share) : ms;
	}
	c->ms = ms;
	c->error = now;
}
