#include "reflections.h"

#include "binding.h"
#include "caustics.h"
#include "context.h"
#include "specular.h"
#include "view.h"

/* Uniforms. */
enum { EYE = 0, WAY = 1, MODE = 2, LIFT = 3, SKY = 4, FARTHEST = 5, SKY_ROWS = 6 };
enum { CORNER = 0, LIT = 1 };

enum { WITH_TRANSLUCENT = 1, WITH_SKY_IMAGE = 2, TRACE_PROGRAMS = 4 };
static const char *const TRACES[TRACE_PROGRAMS] = {"mirror.frag", "mirror_translucent.frag", "mirror_sky.frag",
						   "mirror_sky_translucent.frag"};

/* specular.glsl */
static const uint32_t WAYS[GI_LAYER_COUNT] = {1, 2};

static bool overlap(const screen_rect *a, const screen_rect *b)
{
	return a->lower[0] < b->upper[0] && b->lower[0] < a->upper[0] && a->lower[1] < b->upper[1] &&
	       b->lower[1] < a->upper[1];
}

/* A part goes together with those it overlaps, for layers are added to the picture, and with the last where there is
 * no place. */
static void add_part(gi_reflections *r, reflections_part part)
{
	for (uint32_t k = 0; k < r->part_count;) {
		const reflections_part *other = &r->parts[k];
		if (!overlap(&part.rect, &other->rect) &&
		    (r->part_count < REFLECTIONS_PARTS || k + 1 < r->part_count)) {
			k++;
			continue;
		}
		for (int axis = 0; axis < 2; axis++) {
			const int lower = other->rect.lower[axis], upper = other->rect.upper[axis];
			part.rect.lower[axis] = lower < part.rect.lower[axis] ? lower : part.rect.lower[axis];
			part.rect.upper[axis] = upper > part.rect.upper[axis] ? upper : part.rect.upper[axis];
		}
		part.glass = part.glass || other->glass;
		r->parts[k] = r->parts[--r->part_count];
		k = 0; /* it is larger now */
	}
	r->parts[r->part_count++] = part;
}

/* The balls around smooth objects. */
static void find_parts(const gi_context *gi, gi_reflections *r, const gi_view *view)
{
	const gi_scene *s = &gi->scene;
	float window_from_world[16];
	view_window_from_world(view, window_from_world);
	const uint32_t size[2] = {view->width, view->height};
	r->part_count = 0;
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		const object_record *o = scene_object_in(s, slot);
		if (!o || !scene_slot_is_seen(s, slot) || !object_is_smooth(o))
			continue;
		const gi_vec4 sphere = s->object_data[slot].sphere;
		reflections_part part = {screen_rect_empty(), object_has_glass(o)};
		screen_rect_add(&part.rect, window_from_world, size, gi_vec3d_from(sphere), sphere.w);
		if (part.rect.upper[0] > part.rect.lower[0] && part.rect.upper[1] > part.rect.lower[1])
			add_part(r, part);
	}
}

static int which_trace(const gi_context *gi)
{
	return (gi->scene.translucent_leaves > 0 ? WITH_TRANSLUCENT : 0) | (sky_shows_image(gi) ? WITH_SKY_IMAGE : 0);
}

/* What draws photons, where there are any. */
static gi_result prepare_splats(gi_context *gi, gi_reflections *r)
{
	static const gpu_attribute attributes[] = {{2, false, 0}, {0}};
	static const float corners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
	static const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
	if (!caustics_light(gi))
		return GI_OK;
	gi_result result = gpu_program_want(&gi->gpu, "splat.vert", "splat.frag", &r->splat_program);
	if (!result && !r->square.array)
		result = gpu_mesh_create(&gi->gpu, &r->square, "disc of a photon", attributes, sizeof *corners, 4,
					 corners, 6, indices);
	return result;
}

gi_result reflections_prepare(gi_context *gi, gi_reflections *r, const gi_view *view)
{
	static const gpu_format formats[GPU_TARGET_COLORS] = {GPU_FORMAT_FLOAT, GPU_FORMAT_UNSIGNED};
	const int which = which_trace(gi);
	gi_result result = gpu_program_want(&gi->gpu, "screen.vert", TRACES[which], &r->trace_program[which]);
	if (!result && sky_shows_image(gi))
		result = sky_upload_texels(gi);
	if (!result)
		result = gpu_program_want(&gi->gpu, "screen.vert", "mirror_add.frag", &r->add_program);
	if (!result)
		result = prepare_splats(gi, r);
	if (!result)
		result = gpu_target_create(&gi->gpu, &r->layer, "layer of reflections", formats, false, view->width,
					   view->height);
	if (!result)
		find_parts(gi, r, view);
	return result;
}

void reflections_trace(gi_context *gi, gi_reflections *r, const screen_rect *rect, gi_layer layer, const gi_view *view,
		       const gpu_mesh *screen)
{
	const gpu *g = &gi->gpu;
	const uint32_t program = r->trace_program[which_trace(gi)];
	const float lift = scene_ray_lift(&gi->scene), farthest = view_farthest(view);
	float eye[4], sky[4] = {0};
	scene_sky_exitance(&gi->scene, sky);
	view_eye(view, eye);
	bind_scene(gi);
	bind_rows(gi); /* for the frame's trees */
	bind_solver(gi);
	specular_bind(gi);
	gpu_set_floats(g, program, EYE, 4, 1, eye);
	gpu_set_uint(g, program, WAY, WAYS[layer]);
	gpu_set_uint(g, program, MODE, (uint32_t)view->mode);
	gpu_set_floats(g, program, LIFT, 1, 1, &lift);
	if (sky_shows_image(gi))
		sky_bind(gi, program, SKY_ROWS);
	else
		gpu_set_floats(g, program, SKY, 4, 1, sky);
	gpu_set_floats(g, program, FARTHEST, 1, 1, &farthest);
	gpu_draw_to_target(g, &r->layer, view_convention(view));
	gpu_draw_scissor(g, rect->lower, rect->upper);
	gpu_mesh_draw(g, screen, program);
	gpu_draw_unscissored(g);
}

void reflections_add(gi_context *gi, gi_reflections *r, const screen_rect *rect, bool lit, const gi_view *view,
		     const int corner[2], const gpu_mesh *screen)
{
	const gpu *g = &gi->gpu;
	int lower[2], upper[2];
	for (int k = 0; k < 2; k++) {
		lower[k] = corner[k] + rect->lower[k];
		upper[k] = corner[k] + rect->upper[k];
	}
	gpu_set_corner(g, r->add_program, CORNER, corner);
	gpu_set_uint(g, r->add_program, LIT, lit);
	gpu_draw_added_in_front(g, true, view_convention(view));
	gpu_draw_scissor(g, lower, upper);
	gpu_mesh_draw(g, screen, r->add_program);
	gpu_draw_unscissored(g);
	gpu_draw_added_in_front(g, false, view_convention(view));
}

bool reflections_splat(gi_context *gi, gi_reflections *r, const float clip_from_world[16])
{
	uint32_t photons_a_pair = 0;
	const uint32_t photons = caustics_draw(gi, &photons_a_pair);
	if (!photons)
		return false;
	gpu_set_matrices(&gi->gpu, r->splat_program, 0, 1, clip_from_world);
	gpu_set_uint(&gi->gpu, r->splat_program, 1, photons_a_pair);
	gpu_draw_cull(&gi->gpu, GPU_CULL_NONE);
	gpu_mesh_draw_instances(&gi->gpu, &r->square, r->splat_program, photons);
	gpu_draw_cull(&gi->gpu, GPU_CULL_BACKS);
	return true;
}

void reflections_free(gi_context *gi, gi_reflections *r)
{
	for (int k = 0; k < TRACE_PROGRAMS; k++)
		gpu_program_free(&gi->gpu, &r->trace_program[k]);
	gpu_program_free(&gi->gpu, &r->add_program);
	gpu_program_free(&gi->gpu, &r->splat_program);
	gpu_target_free(&gi->gpu, &r->layer);
	gpu_mesh_free(&gi->gpu, &r->square);
}
