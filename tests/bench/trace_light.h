/* What emits in a trace_scene, to draw points of light from. */
#ifndef TESTS_BENCH_TRACE_LIGHT_H
#define TESTS_BENCH_TRACE_LIGHT_H

#include "trace_scene.h"

typedef struct trace_light {
	vec3 origin, u, v, normal; /* of a triangle: origin + s u + t v; unit */
	vec3 exitance;
	float area;
	float power_up_to; /* of this and all before, as a share of all */
} trace_light;

typedef struct trace_lights {
	trace_light *lights; /* every emitting triangle */
	uint32_t count;
	float power; /* mean of the channels, W */
} trace_lights;

/* A point of light. */
typedef struct trace_light_point {
	const trace_light *light;
	vec3 point;
	float density; /* by area, 1/m2 */
} trace_light_point;

/* False when out of memory; a scene without light is fine. */
bool trace_lights_find(const trace_scene *scene, trace_lights *out);
void trace_lights_free(trace_lights *lights);

/* As likely as it is bright; numbers in [0, 1). There is light. */
trace_light_point trace_lights_draw(const trace_lights *lights, const float numbers[2]);

/* With what density that draws a point of an object of such exitance. */
float trace_lights_density(const trace_lights *lights, const float exitance[3]);

#endif
