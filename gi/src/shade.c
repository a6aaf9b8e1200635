/* The picture: direct light per pixel (lamp.c, shadow.c), indirect light from the leaves (drawn_surface.h).
 *
 *   surfaces   what is seen: place, normal, material, light through the leaves    draw.vert surface.frag
 *   lamps      one pass over the picture each; the last one's goes to the host    screen.vert light_*.frag
 *
 * In a scene with textures surfaces also have the reflectance of each pixel (textured.h), which the last pass takes
 * instead of the material's.
 *
 * Surfaces first, so that what is expensive is done once a pixel: on a software renderer a triangle of a few pixels
 * costs whole blocks of 4 x 4.
 */
#include "shade.h"

#include "binding.h"
#include "context.h"
#include "host_memory.h"
#include "overlay.h"
#include "overlay_receivers.h"
#include "punctual_shadow.h"
#include "reflections.h"
#include "shadow.h"
#include "specular.h"
#include "textured.h"
#include "view.h"

#include <math.h>

/* Of a lamp: where nothing can hide it, and next to that where something may. */
typedef enum program {
	PROGRAM_OWN,
	PROGRAM_OWN_TEXTURED,
	PROGRAM_SURFACE,
	PROGRAM_SURFACE_TRANSLUCENT, /* the same in a scene with translucent objects */
	/* In a scene with textures: of what has none, and of what has some. */
	PROGRAM_SURFACE_ALBEDO,
	PROGRAM_SURFACE_ALBEDO_TRANSLUCENT,
	PROGRAM_SURFACE_TEXTURED,
	PROGRAM_MORE,
	PROGRAM_MORE_SHADOWS,
	PROGRAM_LAST,
	PROGRAM_LAST_SHADOWS,
	PROGRAM_SURFACE_LAST, /* no lamp at all */
	PROGRAM_LAST_ALBEDO,  /* these three in a scene with textures */
	PROGRAM_LAST_ALBEDO_SHADOWS,
	PROGRAM_SURFACE_LAST_ALBEDO,
	PROGRAM_PUNCTUAL, /* a light without a surface */
	PROGRAM_COUNT
} program;
static const char *const PROGRAM_FILES[PROGRAM_COUNT][2] = {
    [PROGRAM_OWN] = {"draw.vert", "draw_none.frag"},
    [PROGRAM_OWN_TEXTURED] = {"draw_textured.vert", "own_textured.frag"},
    [PROGRAM_SURFACE] = {"draw.vert", "surface.frag"},
    [PROGRAM_SURFACE_TRANSLUCENT] = {"draw_translucent.vert", "surface.frag"},
    [PROGRAM_SURFACE_ALBEDO] = {"draw.vert", "surface_albedo.frag"},
    [PROGRAM_SURFACE_ALBEDO_TRANSLUCENT] = {"draw_translucent.vert", "surface_albedo.frag"},
    [PROGRAM_SURFACE_TEXTURED] = {"draw_textured.vert", "surface_textured.frag"},
    [PROGRAM_MORE] = {"screen.vert", "light_more.frag"},
    [PROGRAM_MORE_SHADOWS] = {"screen.vert", "light_more_shadows.frag"},
    [PROGRAM_LAST] = {"screen.vert", "light_last.frag"},
    [PROGRAM_LAST_SHADOWS] = {"screen.vert", "light_last_shadows.frag"},
    [PROGRAM_SURFACE_LAST] = {"screen.vert", "surface_last.frag"},
    [PROGRAM_LAST_ALBEDO] = {"screen.vert", "light_last_albedo.frag"},
    [PROGRAM_LAST_ALBEDO_SHADOWS] = {"screen.vert", "light_last_albedo_shadows.frag"},
    [PROGRAM_SURFACE_LAST_ALBEDO] = {"screen.vert", "surface_last_albedo.frag"},
    [PROGRAM_PUNCTUAL] = {"screen.vert", "light_punctual.frag"},
};

struct gi_shade {
	uint32_t programs[PROGRAM_COUNT]; /* made when wanted */
	gi_surfaces objects;
	gpu_mesh screen;
	bool others;                 /* so_far has light of others than the last lamp, of the picture that is drawn */
	gpu_target surfaces, so_far; /* of the last view's size */
	gi_shadow shadow;
	gi_punctual_shadow punctual;
	gi_overlays overlays;
	gi_receiver_marks marks;
	gi_reflections reflections;
};

/* ---- life ---- */

static bool redraw_object(gi_context *gi, gi_shade *shade, uint32_t slot)
{
	overlay_invalidate(gi, &shade->overlays);
	return (!shade->objects.built || surfaces_redraw(gi, &shade->objects, slot)) &&
	       shadow_reshape(gi, &shade->shadow, slot);
}

/* Shapes that changed, which nobody looked at so far. */
static gi_result refit_drawn(gi_context *gi, gi_shade *shade)
{
	bool ok = true;
	for (uint32_t slot = 0; ok && slot < gi->scene.slot_count; slot++) {
		object_record *o = scene_object_in(&gi->scene, slot);
		if (o && object_refit_drawn(o))
			ok = redraw_object(gi, shade, slot);
	}
	if (ok)
		return GI_OK;
	shade_invalidate(gi);
	return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
}

static gi_result prepare(gi_context *gi)
{
	if (!gi->shade)
		gi->shade = gi_calloc(1, sizeof *gi->shade);
	gi_shade *shade = gi->shade;
	if (!shade)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	gi_result result = refit_drawn(gi, shade);
	if (!result && !shade->objects.built)
		result = surfaces_build(gi, &shade->objects);
	return result ? result : textured_check(gi, &shade->objects);
}

void shade_invalidate_textures(gi_context *gi)
{
	if (gi->shade)
		surfaces_invalidate(gi, &gi->shade->objects);
}

void shade_invalidate(gi_context *gi)
{
	if (!gi->shade)
		return;
	surfaces_invalidate(gi, &gi->shade->objects);
	shadow_invalidate(gi, &gi->shade->shadow);
	punctual_shadow_invalidate(&gi->shade->punctual);
	overlay_invalidate(gi, &gi->shade->overlays);
}

void shade_free(gi_context *gi)
{
	if (!gi->shade)
		return;
	shade_invalidate(gi);
	surfaces_free(gi, &gi->shade->objects);
	shadow_free(gi, &gi->shade->shadow);
	punctual_shadow_free(gi, &gi->shade->punctual);
	overlay_free(gi, &gi->shade->overlays);
	overlay_receivers_free(gi, &gi->shade->marks);
	reflections_free(gi, &gi->shade->reflections);
	gpu_mesh_free(&gi->gpu, &gi->shade->screen);
	gpu_target_free(&gi->gpu, &gi->shade->surfaces);
	gpu_target_free(&gi->gpu, &gi->shade->so_far);
	for (int k = 0; k < PROGRAM_COUNT; k++)
		gpu_program_free(&gi->gpu, &gi->shade->programs[k]);
	gi_free(gi->shade);
	gi->shade = NULL;
}

/* ---- drawing ---- */

static bool is_heat_map(const gi_view *view)
{
	return view->overlay != GI_OVERLAY_NONE && view->overlay != GI_OVERLAY_WIREFRAME &&
	       view->overlay != GI_OVERLAY_RECEIVERS;
}

/* Some object that is drawn has textures. */
static bool is_textured(const gi_context *gi)
{
	return gi->shade->objects.part_count > 0;
}

/* Of what has no textures. */
static program surface_program(const gi_context *gi)
{
	const bool translucent = gi->scene.translucent_leaves > 0;
	if (is_textured(gi))
		return translucent ? PROGRAM_SURFACE_ALBEDO_TRANSLUCENT : PROGRAM_SURFACE_ALBEDO;
	return translucent ? PROGRAM_SURFACE_TRANSLUCENT : PROGRAM_SURFACE;
}

/* The last pass of a picture that lamps light, or of one that none does. */
static program last_program(const gi_context *gi, bool lit)
{
	if (is_textured(gi))
		return lit ? PROGRAM_LAST_ALBEDO : PROGRAM_SURFACE_LAST_ALBEDO;
	return lit ? PROGRAM_LAST : PROGRAM_SURFACE_LAST;
}

static gi_result want_program(gi_context *gi, program which)
{
	uint32_t *program = &gi->shade->programs[which];
	return gpu_program_want(&gi->gpu, PROGRAM_FILES[which][0], PROGRAM_FILES[which][1], program);
}

static void draw_surfaces(const gi_context *gi, program plain, program textured, const gi_view *view,
			  const float clip_from_world[16])
{
	const gi_shade *shade = gi->shade;
	const program drawn[2] = {plain, textured};
	for (int k = 0; k < (is_textured(gi) ? 2 : 1); k++) {
		gpu_set_matrices(&gi->gpu, shade->programs[drawn[k]], 0, 1, clip_from_world);
		gpu_set_uint(&gi->gpu, shade->programs[drawn[k]], 1, (uint32_t)view->mode);
	}
	if (is_textured(gi))
		textured_draw(gi, &shade->objects, shade->programs[plain], shade->programs[textured]);
	else
		gpu_mesh_draw(&gi->gpu, &shade->objects.mesh, shade->programs[plain]);
}

/* A pass over a rectangle of the picture, whose corner is where the framebuffer has it. */
static void draw_rect(const gi_context *gi, program which, float farthest, const int corner[2], int x0, int y0, int x1,
		      int y1)
{
	const gi_shade *shade = gi->shade;
	if (x0 >= x1 || y0 >= y1)
		return;
	const uint32_t program = shade->programs[which];
	const int lower[2] = {corner[0] + x0, corner[1] + y0}, upper[2] = {corner[0] + x1, corner[1] + y1};
	gpu_set_corner(&gi->gpu, program, 0, corner);
	if (which >= PROGRAM_LAST && which <= PROGRAM_SURFACE_LAST_ALBEDO) {
		gpu_set_uint(&gi->gpu, program, 1, !shade->others);
		gpu_set_floats(&gi->gpu, program, 2, 1, 1, &farthest);
	}
	gpu_draw_scissor(&gi->gpu, lower, upper);
	gpu_mesh_draw(&gi->gpu, &shade->screen, program);
}

/* Where it may be hidden, and the rest around. */
static void draw_lamp(gi_context *gi, program which, uint32_t lamp, const gi_view *view, const int corner[2])
{
	gi_shade *shade = gi->shade;
	const uint32_t size[2] = {view->width, view->height};
	const int width = (int)view->width, height = (int)view->height;
	const float farthest = view_farthest(view);
	float window_from_world[16];
	view_window_from_world(view, window_from_world);
	screen_rect r = shadow_rect(gi, &shade->shadow, lamp, window_from_world, size);
	if (r.upper[0] <= r.lower[0] || r.upper[1] <= r.lower[1])
		r = (screen_rect){{0, 0}, {0, 0}};
	gpu_bind_uniform_range(&gi->gpu, GI_UNIFORM_LAMP, &shade->shadow.uniforms, lamp * sizeof(gi_lamp),
			       sizeof(gi_lamp));
	draw_rect(gi, which + 1, farthest, corner, r.lower[0], r.lower[1], r.upper[0], r.upper[1]);
	draw_rect(gi, which, farthest, corner, 0, 0, width, r.lower[1]);
	draw_rect(gi, which, farthest, corner, 0, r.upper[1], width, height);
	draw_rect(gi, which, farthest, corner, 0, r.lower[1], r.lower[0], r.upper[1]);
	draw_rect(gi, which, farthest, corner, r.upper[0], r.lower[1], width, r.upper[1]);
	gpu_draw_unscissored(&gi->gpu);
}

/* For the lamps' passes: what they light, and the picture's depths. */
static void bind_surfaces(gi_context *gi, const gpu_target *surfaces)
{
	gi_shade *shade = gi->shade;
	gpu_depth_maps_bind(&gi->gpu, &shade->shadow.maps, GI_UNIT_MAPS);
	gpu_bind_texture(&gi->gpu, GI_UNIT_PLACE, surfaces->color[0]);
	gpu_bind_texture(&gi->gpu, GI_UNIT_LOOK, surfaces->color[1]);
	if (is_textured(gi))
		gpu_bind_texture(&gi->gpu, GI_UNIT_ALBEDO, shade->surfaces.color[2]);
	gpu_bind_texture(&gi->gpu, GI_UNIT_DEPTH, shade->surfaces.depth);
	gpu_bind_texture(&gi->gpu, GI_UNIT_SO_FAR, shade->so_far.color[0]);
	gpu_bind_texture(&gi->gpu, GI_UNIT_MASKS, shade->shadow.mask_words.texture);
}

/* Lights without a surface, added to what is drawn into. Leaves the lamps' maps bound. */
static void add_lights(gi_context *gi, uint32_t lights, const gi_view *view, screen_rect r)
{
	static const int corner[2] = {0, 0};
	const gi_shade *shade = gi->shade;
	for (uint32_t k = 0; k < lights; k++) {
		punctual_shadow_bind(gi, &shade->punctual, k);
		draw_rect(gi, PROGRAM_PUNCTUAL, view_farthest(view), corner, r.lower[0], r.lower[1], r.upper[0],
			  r.upper[1]);
	}
	if (lights)
		gpu_depth_maps_bind(&gi->gpu, &shade->shadow.maps, GI_UNIT_MAPS);
}

/* All lamps but the last, lights without a surface and caustics, into a picture of their own. */
static void add_others(gi_context *gi, uint32_t lamps, uint32_t lights, const gi_view *view,
		       const float clip_from_world[16])
{
	static const int corner[2] = {0, 0};
	gi_shade *shade = gi->shade;
	const bool caustics = specular_is_ready(gi) && view->mode != GI_MODE_DIRECT && gi->def.pixel_lamps;
	shade->others = lamps > 1 || lights;
	if (lamps <= 1 && !lights && !caustics)
		return;
	gpu_target_clear(&gi->gpu, &shade->so_far);
	gpu_draw_to_target(&gi->gpu, &shade->so_far, view_convention(view));
	gpu_draw_added(&gi->gpu, true);
	for (uint32_t k = 0; k + 1 < lamps; k++)
		draw_lamp(gi, PROGRAM_MORE, k, view, corner);
	add_lights(gi, lights, view, (screen_rect){{0, 0}, {(int)view->width, (int)view->height}});
	gpu_draw_unscissored(&gi->gpu);
	if (caustics)
		shade->others = reflections_splat(gi, &shade->reflections, clip_from_world) || shade->others;
	gpu_draw_added(&gi->gpu, false);
}

/* Of a layer, whose surfaces may be hidden anywhere. */
static void light_layer(gi_context *gi, const screen_rect *r, uint32_t lamps, uint32_t lights, const gi_view *view)
{
	static const int corner[2] = {0, 0};
	gi_shade *shade = gi->shade;
	gpu_target_clear(&gi->gpu, &shade->so_far);
	gpu_draw_to_target(&gi->gpu, &shade->so_far, view_convention(view));
	gpu_draw_added(&gi->gpu, true);
	for (uint32_t k = 0; k < lamps; k++) {
		gpu_bind_uniform_range(&gi->gpu, GI_UNIFORM_LAMP, &shade->shadow.uniforms, k * sizeof(gi_lamp),
				       sizeof(gi_lamp));
		draw_rect(gi, PROGRAM_MORE_SHADOWS, view_farthest(view), corner, r->lower[0], r->lower[1], r->upper[0],
			  r->upper[1]);
	}
	add_lights(gi, lights, view, *r);
	gpu_draw_unscissored(&gi->gpu);
	gpu_draw_added(&gi->gpu, false);
}

static void draw_part(gi_context *gi, const reflections_part *part, uint32_t lamps, uint32_t lights,
		      const gi_view *view, const gpu_draw_state *state, const int corner[2])
{
	gi_shade *shade = gi->shade;
	gi_reflections *r = &shade->reflections;
	for (gi_layer layer = 0; layer < (part->glass ? GI_LAYER_COUNT : GI_LAYER_REFRACTED); layer++) {
		bind_surfaces(gi, &shade->surfaces);
		reflections_trace(gi, r, &part->rect, layer, view, &shade->screen);
		bind_surfaces(gi, &r->layer);
		if (lamps || lights)
			light_layer(gi, &part->rect, lamps, lights, view);
		gpu_draw_to_host(&gi->gpu, state, view->width, view->height);
		reflections_add(gi, r, &part->rect, lamps || lights, view, corner, &shade->screen);
	}
}

static void draw_reflections(gi_context *gi, uint32_t lamps, uint32_t lights, const gi_view *view,
			     const gpu_draw_state *state, const int corner[2])
{
	const gi_reflections *r = &gi->shade->reflections;
	for (uint32_t k = 0; k < r->part_count; k++)
		draw_part(gi, &r->parts[k], lamps, lights, view, state, corner);
}

static gi_result want_programs(gi_context *gi, uint32_t lamps, uint32_t lights, bool more)
{
	const program last = last_program(gi, lamps > 0);
	gi_result result = want_program(gi, surface_program(gi));
	if (!result && is_textured(gi))
		result = want_program(gi, PROGRAM_SURFACE_TEXTURED);
	if (!result && lights)
		result = want_program(gi, PROGRAM_PUNCTUAL);
	for (program k = PROGRAM_MORE; !result && lamps && more && k <= PROGRAM_MORE_SHADOWS; k++)
		result = want_program(gi, k);
	for (program k = last; !result && k <= last + (lamps > 0); k++)
		result = want_program(gi, k);
	return result;
}

static gi_result prepare_lamps(gi_context *gi, const gi_view *view, uint32_t lamps, uint32_t lights)
{
	const gpu_format surfaces[GPU_TARGET_COLORS] = {GPU_FORMAT_FLOAT, GPU_FORMAT_UNSIGNED,
							is_textured(gi) ? GPU_FORMAT_FLOAT : GPU_FORMAT_NONE};
	static const gpu_format so_far[GPU_TARGET_COLORS] = {GPU_FORMAT_FLOAT};
	static const gpu_attribute attributes[] = {{2, false, 0}, {0}};
	static const float corners[3][2] = {{-1, -1}, {3, -1}, {-1, 3}};
	static const uint32_t indices[3] = {0, 1, 2};
	gi_shade *shade = gi->shade;
	gpu *g = &gi->gpu;
	const bool more = lamps > 1 || lights || specular_is_ready(gi);
	gi_result result = want_programs(gi, lamps, lights, more);
	if (!result && !shade->screen.array)
		result = gpu_mesh_create(g, &shade->screen, "whole picture", attributes, sizeof *corners, 3, corners, 3,
					 indices);
	if (!result)
		result = gpu_target_create(g, &shade->surfaces, "surfaces", surfaces, true, view->width, view->height);
	if (!result && more)
		result = gpu_target_create(g, &shade->so_far, "light so far", so_far, false, view->width, view->height);
	return result;
}

/* In a scene without lamps and lights and without mirrors and glass: straight into the host's framebuffer. */
static gi_result draw_own(gi_context *gi, const gi_view *view, const float clip_from_world[16])
{
	gi_result result = want_program(gi, PROGRAM_OWN);
	if (!result && is_textured(gi))
		result = want_program(gi, PROGRAM_OWN_TEXTURED);
	if (!result)
		draw_surfaces(gi, PROGRAM_OWN, PROGRAM_OWN_TEXTURED, view, clip_from_world);
	return result;
}

static gi_result draw_lit(gi_context *gi, const gi_view *view, const gpu_draw_state *state,
			  const float clip_from_world[16])
{
	gi_shade *shade = gi->shade;
	const uint32_t lamps = view->mode == GI_MODE_INDIRECT ? 0 : shade->shadow.lamp_count;
	const uint32_t lights = view->mode == GI_MODE_INDIRECT ? 0 : shade->punctual.count;
	if (!lamps && !lights && !specular_is_ready(gi))
		return draw_own(gi, view, clip_from_world);
	gi_result result = prepare_lamps(gi, view, lamps, lights);
	if (!result && specular_is_ready(gi))
		result = reflections_prepare(gi, &shade->reflections, view);
	if (result)
		return result;
	const int corner[2] = {(int)floorf(state->viewport[0]), (int)floorf(state->viewport[1])};
	gpu_draw_to_target(&gi->gpu, &shade->surfaces, view_convention(view));
	draw_surfaces(gi, surface_program(gi), PROGRAM_SURFACE_TEXTURED, view, clip_from_world);
	bind_surfaces(gi, &shade->surfaces);
	add_others(gi, lamps, lights, view, clip_from_world);
	gpu_draw_to_host(&gi->gpu, state, view->width, view->height);
	if (lamps)
		draw_lamp(gi, last_program(gi, true), lamps - 1, view, corner);
	else
		draw_rect(gi, last_program(gi, false), view_farthest(view), corner, 0, 0, (int)view->width,
			  (int)view->height);
	gpu_draw_unscissored(&gi->gpu);
	if (specular_is_ready(gi))
		draw_reflections(gi, lamps, lights, view, state, corner);
	return GI_OK;
}

static gi_result draw_picture(gi_context *gi, const gi_view *view, const gpu_draw_state *state)
{
	gi_result result = GI_OK;
	float clip_from_world[16];
	view_clip_from_world(view, clip_from_world);
	gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_DRAW]);
	gpu_draw_convention(&gi->gpu, view_convention(view));
	gpu_draw_to_host(&gi->gpu, state, view->width, view->height);
	if (!is_heat_map(view))
		result = draw_lit(gi, view, state, clip_from_world);
	if (!result && view->overlay == GI_OVERLAY_RECEIVERS)
		result = overlay_receivers_draw(gi, &gi->shade->marks, view, clip_from_world);
	else if (!result && view->overlay != GI_OVERLAY_NONE)
		result = overlay_draw(gi, &gi->shade->overlays, view, clip_from_world);
	gpu_timer_end(&gi->gpu, &gi->timers[GI_PASS_DRAW]);
	return result;
}

static gi_result check_view(const gi_context *gi, const gi_view *view)
{
	const gi_log *log = &gi->gpu.log;
	if ((unsigned)view->mode > GI_MODE_INDIRECT || (unsigned)view->overlay > GI_OVERLAY_RECEIVERS)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "gi_draw: mode or overlay is not one of gi.h");
	if (!view->width || !view->height || view->width > gi->gpu.most_pixels || view->height > gi->gpu.most_pixels)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT,
			       "gi_draw: a viewport of %u x %u: this device draws 1 to %u pixels each way", view->width,
			       view->height, gi->gpu.most_pixels);
	if (!view_is_finite(view))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "gi_draw: a matrix is not finite");
	if (!(view->overlay_radius >= 0 && view->overlay_radius <= OBJECT_MAX_LENGTH))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "gi_draw: overlay_radius %g is outside 0..1e9 m",
			       (double)view->overlay_radius);
	return GI_OK;
}

/* Without lamps and lights nothing of it is made. */
static gi_result update_shadows(gi_context *gi)
{
	gi_shadow *shadow = &gi->shade->shadow;
	if (!gi->lamps.count && !punctual_shadow_is_wanted(gi)) {
		shadow->lamp_count = 0;
		punctual_shadow_free(gi, &gi->shade->punctual);
		return GI_OK;
	}
	gi_result result = shadow->drawn_rows ? GI_OK : shadow_create(gi, shadow);
	if (result) {
		shadow_invalidate(gi, shadow);
		return result;
	}
	result = shadow_update(gi, shadow);
	return result ? result : punctual_shadow_update(gi, &gi->shade->punctual, shadow);
}

static gi_result draw(gi_context *gi, const gi_view *view)
{
	gi_result result = prepare(gi);
	if (result)
		return result;
	gpu_draw_state state;
	gpu_draw_begin(&gi->gpu, &state);
	bind_scene(gi);
	bind_solver(gi);
	if (view->mode != GI_MODE_INDIRECT && !is_heat_map(view))
		result = update_shadows(gi);
	if (!result)
		result = draw_picture(gi, view, &state);
	gpu_draw_end(&gi->gpu, &state);
	return result;
}

gi_result gi_draw(gi_context *gi, const gi_view *view)
{
	if (!gi || !view)
		return gi_fail_null(gi, "gi_draw: view");
	if (check_view(gi, view))
		return GI_ERROR_INVALID_ARGUMENT;
	if (!gi->scene.ever_committed)
		return gi_fail(&gi->gpu.log, GI_ERROR_NOT_COMMITTED, "call gi_commit() before gi_draw()");
	if (gpu_check_current(&gi->gpu, "gi_draw"))
		return GI_ERROR_WRONG_CONTEXT;
	if (!gpu_host_is_complete(&gi->gpu))
		return gi_fail(&gi->gpu.log, GI_ERROR_FRAMEBUFFER,
			       "gi_draw: the framebuffer that is bound for drawing is not complete");
	gi->gpu.tag = ++gi->picture_number;
	if (!gi->scene.leaf_count)
		return GI_OK;
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	gpu_group_begin(&gi->gpu, "gi_draw");
	const gi_result result = draw(gi, view);
	gpu_group_end(&gi->gpu);
	gi_memory_from(before);
	return result;
}
