/* A trace_scene for Embree's rays: what stays is one scene, each object that moves an instance of its own. */
#ifndef TESTS_BENCH_TRACE_EMBREE_H
#define TESTS_BENCH_TRACE_EMBREE_H

#include "trace_scene.h"

typedef struct trace_embree trace_embree;

/* Where a ray ended. */
typedef struct trace_hit {
	const trace_object *object; /* NULL: nowhere */
	uint32_t triangle;
	float distance, u, v;
	vec3 point;
	vec3 flat, normal; /* of the triangle and of the smooth surface, unit, both of the front */
	bool front;
} trace_hit;

/* `scene` is read until the end and stays where it is. NULL when memory or Embree fails. */
trace_embree *trace_embree_create(const trace_scene *scene);

/* Takes in the poses of what moves. */
void trace_embree_update(trace_embree *embree);

void trace_embree_destroy(trace_embree *embree);

/* How far beside a surface rays start, metres: a rounding of the scene's extent. */
float trace_embree_lift(const trace_embree *embree);

/* Where rays start that leave what a ray of that direction met: over the surface, and back on its way, so that next
 * to a wall they do not start within that. */
void trace_embree_leave(const trace_embree *embree, const trace_hit *hit, const vec3 direction, vec3 origin);

/* direction: unit. Any number of threads at once. */
trace_hit trace_embree_closest(const trace_embree *embree, const vec3 origin, const vec3 direction);
bool trace_embree_is_free(const trace_embree *embree, const vec3 from, const vec3 to);

#endif
