#include "file_lights.h"

#include "options.h"

#include <stdlib.h>
#include <string.h>

static gi_light_def def_of(const engine_scene *scene, uint32_t k, double time_s)
{
	static const gi_light_type types[] = {[ENGINE_LIGHT_POINT] = GI_LIGHT_POINT,
					      [ENGINE_LIGHT_SPOT] = GI_LIGHT_SPOT,
					      [ENGINE_LIGHT_DIRECTIONAL] = GI_LIGHT_DIRECTIONAL};
	const engine_scene_light *from = &scene->lights[k];
	gi_light_def def = gi_light_def_default();
	def.type = types[from->type];
	memcpy(def.intensity, from->intensity, sizeof def.intensity);
	def.range = from->range;
	if (from->type == ENGINE_LIGHT_SPOT) {
		def.inner_angle = from->inner_angle;
		def.outer_angle = from->outer_angle;
	}
	def.enabled = engine_scene_light_at(scene, k, time_s, def.position, def.direction);
	return def;
}

gi_result file_lights_create(file_lights *lights, const engine_scene *scene, gi_context *gi, const char *program)
{
	const uint32_t count = scene->light_count < GI_MOST_LIGHTS ? scene->light_count : GI_MOST_LIGHTS;
	if (count < scene->light_count)
		options_say(program, "the first %u of %u lights are taken", count, scene->light_count);
	lights->handles = calloc((size_t)count + 1, sizeof *lights->handles);
	if (!lights->handles)
		return GI_ERROR_OUT_OF_MEMORY;
	gi_result result = GI_OK;
	for (; !result && lights->count < count; lights->count += !result) {
		const gi_light_def def = def_of(scene, lights->count, 0);
		result = gi_create_light(gi, &def, &lights->handles[lights->count]);
	}
	return result;
}

gi_result file_lights_animate(const file_lights *lights, const engine_scene *scene, gi_context *gi, double time_s)
{
	gi_result result = GI_OK;
	for (uint32_t k = 0; !result && k < lights->count; k++) {
		if (!scene->lights[k].animated)
			continue;
		const gi_light_def def = def_of(scene, k, time_s);
		result = gi_set_light(gi, lights->handles[k], &def);
	}
	return result;
}

void file_lights_free(file_lights *lights)
{
	free(lights->handles);
	*lights = (file_lights){0};
}
