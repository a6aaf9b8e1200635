#include "trace_light.h"

#include <math.h>
#include <stdlib.h>

static float brightness(const float rgb[3])
{
	return (rgb[0] + rgb[1] + rgb[2]) / 3;
}

static void add_triangle(const trace_object *o, uint32_t triangle, trace_lights *out)
{
	trace_light *l = &out->lights[out->count++];
	trace_object_corner(o, triangle, 0, l->origin);
	trace_object_corner(o, triangle, 1, l->u);
	trace_object_corner(o, triangle, 2, l->v);
	glm_vec3_sub(l->u, l->origin, l->u);
	glm_vec3_sub(l->v, l->origin, l->v);
	glm_vec3_cross(l->u, l->v, l->normal);
	l->area = 0.5f * glm_vec3_norm(l->normal);
	glm_vec3_normalize(l->normal);
	glm_vec3_copy((float *)o->exitance, l->exitance);
	out->power += l->area * brightness(l->exitance);
	l->power_up_to = out->power;
}

bool trace_lights_find(const trace_scene *scene, trace_lights *out)
{
	*out = (trace_lights){0};
	uint32_t most = 0;
	for (uint32_t k = 0; k < scene->object_count; k++)
		most += trace_object_emits(&scene->objects[k]) ? scene->objects[k].triangle_count : 0;
	out->lights = calloc(most + 1, sizeof *out->lights);
	if (!out->lights)
		return false;
	for (uint32_t k = 0; k < scene->object_count; k++)
		for (uint32_t t = 0; trace_object_emits(&scene->objects[k]) && t < scene->objects[k].triangle_count;
		     t++)
			add_triangle(&scene->objects[k], t, out);
	for (uint32_t k = 0; k < out->count; k++)
		out->lights[k].power_up_to /= out->power;
	return true;
}

void trace_lights_free(trace_lights *lights)
{
	free(lights->lights);
	*lights = (trace_lights){0};
}

trace_light_point trace_lights_draw(const trace_lights *lights, const float numbers[2])
{
	uint32_t low = 0, high = lights->count - 1;
	while (low < high) {
		const uint32_t middle = low + (high - low) / 2;
		if (numbers[0] < lights->lights[middle].power_up_to)
			high = middle;
		else
			low = middle + 1;
	}
	const trace_light *l = &lights->lights[low];
	/* What is left of the first number is as evenly spread within the triangle. */
	const float before = low ? lights->lights[low - 1].power_up_to : 0;
	const float rest = glm_clamp((numbers[0] - before) / (l->power_up_to - before), 0, 1);
	const float root = sqrtf(rest);
	trace_light_point p = {.light = l, .density = trace_lights_density(lights, l->exitance)};
	glm_vec3_copy((float *)l->origin, p.point);
	glm_vec3_muladds((float *)l->u, root * (1 - numbers[1]), p.point);
	glm_vec3_muladds((float *)l->v, root * numbers[1], p.point);
	return p;
}

float trace_lights_density(const trace_lights *lights, const float exitance[3])
{
	return brightness(exitance) / lights->power;
}
