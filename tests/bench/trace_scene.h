/* A scene as ray tracers take it: triangles, normals, materials. What the rivals of figure 6 (docs/figures.md) render.
 *
 * Surfaces emit and reflect on their front, from which corners run counter-clockwise; backs are black and opaque, as in
 * gi.h. Lengths are metres, exitance W/m2.
 */
#ifndef TESTS_BENCH_TRACE_SCENE_H
#define TESTS_BENCH_TRACE_SCENE_H

#include "gi/gi.h"
#include "mesh.h"

#include <cglm/cglm.h>

#include <stdbool.h>
#include <stdint.h>

typedef struct trace_object {
	float *positions;  /* vertex_count * 3, in its own space */
	float *normals;    /* likewise, unit, of the smooth surface that the triangles stand for; NULL: it is flat */
	uint32_t *corners; /* triangle_count * 3 */
	uint32_t vertex_count, triangle_count;
	float rho[3], exitance[3];
	gi_specular specular; /* a mirror or glass; rho is 0 then */
	bool moves;           /* its pose may change from picture to picture */
	mat4 world;           /* of its own space: rotation and translation */
} trace_object;

enum { TRACE_MOST_OBJECTS = 16 };

typedef struct trace_scene {
	trace_object objects[TRACE_MOST_OBJECTS];
	uint32_t object_count;
} trace_scene;

/* Adds a parallelogram, which faces the way that u x v does. NULL when out of memory or places; materials are the
 * caller's to set. */
trace_object *trace_scene_add_quad(trace_scene *scene, const float corner[3], const float u[3], const float v[3]);

/* Adds a mesh of triangles. `normals` (vertex_count * 3) becomes the scene's and is freed on failure too; NULL: the
 * mean of the triangles at a vertex, by area, as the library draws such meshes. */
trace_object *trace_scene_add_mesh(trace_scene *scene, const engine_mesh *triangles, float *normals);

void trace_object_set_pose(trace_object *object, gi_pose pose);
bool trace_object_is_smooth(const trace_object *object);
bool trace_object_emits(const trace_object *object);

/* Corner k of a triangle in the world, and its normal there, not normalised and twice the area long. */
void trace_object_corner(const trace_object *object, uint32_t triangle, int k, vec3 out);
void trace_object_flat_normal(const trace_object *object, uint32_t triangle, vec3 out);

/* The normal of the smooth surface at barycentric u, v of a triangle, unit, in the world. */
void trace_object_normal(const trace_object *object, uint32_t triangle, float u, float v, vec3 out);

void trace_scene_free(trace_scene *scene);

#endif
