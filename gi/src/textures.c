/* Public functions about textures that gi_draw shows. */
#include "context.h"
#include "gpu_draw.h"
#include "handles.h"
#include "host_memory.h"

static const gi_textures NONE = {.base_color_factor = {1, 1, 1, 1},
				 .emissive_factor = {1, 1, 1},
				 .base_color_transform = {{1, 0, 0}, {0, 1, 0}},
				 .emissive_transform = {{1, 0, 0}, {0, 1, 0}}};

/* In `internal` of what gi_textures_default returned. */
enum { BY_DEFAULT = 0x7E27 };

gi_textures gi_textures_default(void)
{
	gi_textures out = NONE;
	out.internal = BY_DEFAULT;
	return out;
}

static bool all_within(const float *values, size_t count, float least, float most)
{
	for (size_t k = 0; k < count; k++)
		if (!(values[k] >= least && values[k] <= most))
			return false;
	return true;
}

/* NULL: none. */
static const char *fault_of(const gi_context *gi, const gi_textures *t)
{
	const gpu *g = &gi->gpu;
	if (!all_within(t->base_color_factor, 4, 0, 1))
		return "base_color_factor is not in [0, 1]";
	if (!all_within(t->emissive_factor, 3, 0, 1e12f))
		return "emissive_factor is not in [0, 1e12] W/m2";
	if (!all_within(t->base_color_transform[0], 6, -1e9f, 1e9f) ||
	    !all_within(t->emissive_transform[0], 6, -1e9f, 1e9f))
		return "a number of a transform is not within 1e9 of 0";
	if (!(t->alpha_cutoff >= 0 && t->alpha_cutoff <= 1e9f))
		return "alpha_cutoff is negative or no number";
	if ((t->base_color && !gpu_is_host_texture(g, t->base_color)) ||
	    (t->emissive && !gpu_is_host_texture(g, t->emissive)))
		return "base_color or emissive is no texture of the target GL_TEXTURE_2D in this OpenGL context";
	if ((t->base_color_sampler && !gpu_is_host_sampler(g, t->base_color_sampler)) ||
	    (t->emissive_sampler && !gpu_is_host_sampler(g, t->emissive_sampler)))
		return "base_color_sampler or emissive_sampler is no sampler in this OpenGL context";
	return NULL;
}

static gi_result check_object(const gi_context *gi, const object_record *o, uint32_t material, const char *function)
{
	const gi_log *log = &gi->gpu.log;
	if (!o)
		return gi_fail(log, GI_ERROR_INVALID_HANDLE,
			       "%s: the handle is stale, was never valid or is another context's", function);
	if (object_is_translucent(o))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT,
			       "object '%s' is translucent: what is seen of it has no texture", o->name);
	if (!o->chart.material_count)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT,
			       "object '%s' is drawn without texture coordinates: it takes gi_object_def.uvs, with a "
			       "draw mesh draw_uvs",
			       o->name);
	if (material >= o->chart.material_count)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "object '%s' has %u materials; there is no material %u",
			       o->name, o->chart.material_count, material);
	return GI_OK;
}

static bool shows(const gi_textures *t)
{
	return t && (t->base_color || t->emissive);
}

static bool any_shows(const object_record *o)
{
	bool any = false;
	for (uint32_t k = 0; k < o->chart.material_count; k++)
		any = any || object_is_textured(o, k);
	return any;
}

/* Room for those of all materials. */
static gi_result want_textures(const gi_context *gi, object_record *o)
{
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	o->textures = gi_malloc(sizeof *o->textures * o->chart.material_count);
	gi_memory_from(before);
	if (!o->textures)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	for (uint32_t k = 0; k < o->chart.material_count; k++)
		o->textures[k] = NONE;
	return GI_OK;
}

gi_result gi_set_textures(gi_context *gi, gi_object object, uint32_t material, const gi_textures *textures)
{
	if (!gi)
		return gi_fail_null(gi, "gi_set_textures: gi");
	if (gpu_check_current(&gi->gpu, "gi_set_textures"))
		return GI_ERROR_WRONG_CONTEXT;
	object_record *o = handles_find(gi, object);
	gi_result result = check_object(gi, o, material, "gi_set_textures");
	if (result)
		return result;
	if (textures && textures->internal != BY_DEFAULT)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_DEF,
			       "start from gi_textures_default() or gi_get_textures()");
	const char *fault = textures ? fault_of(gi, textures) : NULL;
	if (fault)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT, "gi_set_textures: object '%s', material %u: %s",
			       o->name, material, fault);
	if (!o->textures && !shows(textures))
		return GI_OK;
	if (!o->textures && (result = want_textures(gi, o)))
		return result;
	const bool before = object_is_textured(o, material);
	o->textures[material] = shows(textures) ? *textures : NONE;
	if (before == object_is_textured(o, material))
		return GI_OK;
	if (!any_shows(o)) {
		gi_free(o->textures);
		o->textures = NULL;
	}
	shade_invalidate_textures(gi);
	return GI_OK;
}

gi_result gi_get_textures(const gi_context *gi, gi_object object, uint32_t material, gi_textures *out)
{
	if (!gi || !out)
		return gi_fail_null(gi, "gi_get_textures: out");
	const object_record *o = handles_find(gi, object);
	const gi_result result = check_object(gi, o, material, "gi_get_textures");
	if (result)
		return result;
	*out = o->textures ? o->textures[material] : NONE;
	out->internal = BY_DEFAULT;
	return GI_OK;
}
