#include "punctual_shadow.h"

#include "context.h"
#include "host_memory.h"
#include "punctual_view.h"

#include <string.h>

/* Boxes of all that casts; how many. */
static uint32_t gather_boxes(const gi_shadow *lamps, punctual_box *boxes)
{
	uint32_t count = 0;
	for (uint32_t k = 0; k < lamps->casters.count; k++)
		if (lamps->casters.list[k].range.count)
			memcpy(boxes[count++].corner, lamps->casters.list[k].box, sizeof boxes->corner);
	return count;
}

/* All of each caster, walls about the scene too: a light may be outside. */
static void draw_layer(const gi_context *gi, const gi_shadow *lamps, const gpu_depth_maps *maps, uint32_t layer,
		       const float clip[16])
{
	float matrices[2][16] = {{0}, {0}};
	memcpy(matrices[0], clip, sizeof matrices[0]);
	for (int row = 0; row < 3; row++)
		matrices[1][12 + row] = 1; /* nothing is clipped */
	gpu_depth_maps_begin_layer(&gi->gpu, maps, layer, false);
	gpu_set_matrices(&gi->gpu, lamps->program, 0, 2, matrices[0]);
	for (uint32_t k = 0; k < lamps->casters.count; k++)
		if (lamps->casters.list[k].range.count)
			gpu_mesh_draw_ranges(&gi->gpu, &lamps->casters.mesh, lamps->program,
					     &lamps->casters.list[k].range, 1);
}

static void draw_maps(const gi_context *gi, const gi_punctual_shadow *s, const gi_shadow *lamps,
		      const gi_punctual_view *view)
{
	float clip[16];
	for (uint32_t k = 0; k < view->layers.y; k++) {
		punctual_view_matrix(view, k, clip);
		draw_layer(gi, lamps, &s->maps, view->layers.x + k, clip);
	}
}

bool punctual_shadow_is_wanted(const gi_context *gi)
{
	const uint32_t wanted = GI_PUNCTUAL_THERE | GI_PUNCTUAL_BY_PIXELS;
	uint32_t lights;
	const gi_punctual_light *data = punctual_light_data(gi, &lights);
	for (uint32_t k = 0; k < lights; k++)
		if ((data[k].kind.x & wanted) == wanted)
			return true;
	return false;
}

/* The lights of pictures as they are now, and how many maps they have. */
static uint32_t take_lights(const gi_context *gi, gi_punctual_shadow *s, uint32_t boxes)
{
	const uint32_t wanted = GI_PUNCTUAL_THERE | GI_PUNCTUAL_ENABLED | GI_PUNCTUAL_BY_PIXELS;
	uint32_t lights, layers = 0;
	const gi_punctual_light *data = punctual_light_data(gi, &lights);
	s->count = 0;
	for (uint32_t k = 0; k < lights; k++) {
		if ((data[k].kind.x & wanted) != wanted)
			continue;
		gi_punctual_view *v = &s->views[s->count++];
		punctual_view_fit(v, &data[k], s->boxes, boxes, gi->def.shadow_map_size);
		v->light.kind.x &= ~GI_PUNCTUAL_MOVED;
		v->layers.x = layers;
		layers += v->layers.y;
	}
	return layers;
}

/* Another colour draws no maps. */
static bool same_maps(const gi_punctual_view *a, const gi_punctual_view *b)
{
	gi_punctual_view x = *a, y = *b;
	x.light.color = y.light.color;
	x.light.kind = y.light.kind;
	return memcmp(&x, &y, sizeof x) == 0;
}

static gi_result redraw(gi_context *gi, gi_punctual_shadow *s, const gi_shadow *lamps, uint32_t layers,
			const gi_punctual_view *before, uint32_t count_before)
{
	const bool all = !s->drawn || s->poses != lamps->poses || layers != s->maps.layers;
	gi_result result = gpu_depth_maps_create(&gi->gpu, &s->maps, gi->def.shadow_map_size, layers);
	if (!result)
		result = gpu_buffer_replace(&gi->gpu, &s->uniforms, "lights of pictures", sizeof s->views, s->views);
	if (result)
		return result;
	gpu_draw_cull(&gi->gpu, GPU_CULL_NONE);
	for (uint32_t k = 0; k < s->count; k++)
		if (all || k >= count_before || !same_maps(&s->views[k], &before[k]))
			draw_maps(gi, s, lamps, &s->views[k]);
	gpu_draw_cull(&gi->gpu, GPU_CULL_BACKS);
	return GI_OK;
}

gi_result punctual_shadow_update(gi_context *gi, gi_punctual_shadow *s, const gi_shadow *lamps)
{
	gi_punctual_view before[GI_PIXEL_LIGHTS];
	const uint32_t count_before = s->drawn ? s->count : 0;
	memcpy(before, s->views, sizeof before);
	if (!punctual_shadow_is_wanted(gi)) {
		punctual_shadow_free(gi, s);
		return GI_OK;
	}
	if (!s->boxes)
		s->boxes = gi_calloc((size_t)lamps->casters.count + 1, sizeof *s->boxes);
	if (!s->boxes)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	const uint32_t layers = take_lights(gi, s, gather_boxes(lamps, s->boxes));
	if (s->drawn && s->poses == lamps->poses && count_before == s->count &&
	    memcmp(before, s->views, sizeof before) == 0)
		return GI_OK;
	gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_SHADOW]);
	const gi_result result = redraw(gi, s, lamps, layers, before, count_before);
	gpu_timer_end(&gi->gpu, &gi->timers[GI_PASS_SHADOW]);
	s->drawn = !result;
	s->poses = lamps->poses;
	return result;
}

void punctual_shadow_bind(const gi_context *gi, const gi_punctual_shadow *s, uint32_t light)
{
	gpu_depth_maps_bind(&gi->gpu, &s->maps, GI_UNIT_MAPS);
	gpu_bind_uniform_range(&gi->gpu, GI_UNIFORM_LAMP, &s->uniforms, light * sizeof *s->views, sizeof *s->views);
}

void punctual_shadow_invalidate(gi_punctual_shadow *s)
{
	gi_free(s->boxes);
	s->boxes = NULL;
	s->drawn = false;
}

void punctual_shadow_free(gi_context *gi, gi_punctual_shadow *s)
{
	gpu_depth_maps_free(&gi->gpu, &s->maps);
	gpu_buffer_free(&gi->gpu, &s->uniforms);
	gi_free(s->boxes);
	*s = (gi_punctual_shadow){0};
}
