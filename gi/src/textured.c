#include "textured.h"

#include "context.h"
#include "shade_shared.h"

#include <string.h>

/* Uniforms of draw_textured.vert and textured.glsl. */
enum { TEXTURES = 2, BASE_COLOR_FACTOR, EMISSIVE_FACTOR, BASE_COLOR_UV, EMISSIVE_UV = BASE_COLOR_UV + 2 };

/* NULL: it has none. What was destroyed is drawn until the next update, and its textures may be gone. */
static const gi_textures *textures_of(const gi_context *gi, const surfaces_part *part)
{
	const object_record *o = part->material == GI_NONE ? NULL : scene_object_in(&gi->scene, part->slot);
	return o && object_is_alive(o) && o->textures ? &o->textures[part->material] : NULL;
}

static bool are_alike(const gi_textures *a, const gi_textures *b)
{
	return a == b || (a && b && memcmp(a, b, sizeof *a) == 0);
}

static bool is_there(const gi_context *gi, uint32_t texture, uint32_t sampler)
{
	return !texture ||
	       (gpu_is_host_texture(&gi->gpu, texture) && (!sampler || gpu_is_host_sampler(&gi->gpu, sampler)));
}

gi_result textured_check(const gi_context *gi, const gi_surfaces *s)
{
	const gi_textures *before = NULL;
	for (uint32_t k = 0; k < s->part_count; k++) {
		const gi_textures *t = textures_of(gi, &s->parts[k]);
		if (t && !are_alike(t, before) &&
		    !(is_there(gi, t->base_color, t->base_color_sampler) &&
		      is_there(gi, t->emissive, t->emissive_sampler)))
			return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT,
				       "gi_draw: object '%s', material %u: a texture or sampler of it was deleted; "
				       "gi_set_textures with others, or with none, first",
				       scene_object_in(&gi->scene, s->parts[k].slot)->name, s->parts[k].material);
		before = t ? t : before;
	}
	return GI_OK;
}

/* As shaders take it: rows u and v. */
static void set_transform(const gpu *g, uint32_t program, int location, const float transform[2][3])
{
	gpu_set_floats(g, program, location, 3, 2, transform[0]);
}

static void set_textures(const gi_context *gi, uint32_t program, const gi_textures *t)
{
	const gpu *g = &gi->gpu;
	const float emissive[4] = {t->emissive_factor[0], t->emissive_factor[1], t->emissive_factor[2],
				   t->alpha_cutoff};
	gpu_bind_host_texture(g, GI_UNIT_BASE_COLOR, t->base_color, t->base_color_sampler);
	gpu_bind_host_texture(g, GI_UNIT_EMISSIVE, t->emissive, t->emissive_sampler);
	gpu_set_uint(g, program, TEXTURES,
		     (t->base_color ? GI_HAS_BASE_COLOR : 0) | (t->emissive ? GI_HAS_EMISSIVE : 0));
	gpu_set_floats(g, program, BASE_COLOR_FACTOR, 4, 1, t->base_color_factor);
	gpu_set_floats(g, program, EMISSIVE_FACTOR, 4, 1, emissive);
	set_transform(g, program, BASE_COLOR_UV, t->base_color_transform);
	set_transform(g, program, EMISSIVE_UV, t->emissive_transform);
}

/* The mesh from a part on, as far as parts look alike: parts lie one after the other. Returns the part behind. */
static uint32_t join_parts(const gi_context *gi, const gi_surfaces *s, uint32_t first, gpu_range *range)
{
	const gi_textures *t = textures_of(gi, &s->parts[first]);
	uint32_t next = first + 1;
	*range = s->parts[first].range;
	for (; next < s->part_count && are_alike(t, textures_of(gi, &s->parts[next])); next++)
		range->count += s->parts[next].range.count;
	return next;
}

void textured_draw(const gi_context *gi, const gi_surfaces *s, uint32_t plain, uint32_t textured)
{
	gpu_range range;
	for (uint32_t k = 0, next; k < s->part_count; k = next) {
		const gi_textures *t = textures_of(gi, &s->parts[k]);
		next = join_parts(gi, s, k, &range);
		if (t)
			set_textures(gi, textured, t);
		gpu_mesh_draw_ranges(&gi->gpu, &s->mesh, t ? textured : plain, &range, 1);
	}
}
