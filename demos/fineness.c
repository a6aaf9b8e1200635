#include "fineness.h"

#include <cglm/cglm.h>

#include <math.h>

static const double LEAVES = 4000;

/* Small objects get leaves smaller by up to this factor, as gi_choose_leaves gives them. */
static const double FINEST = 0.25;

/* A curved mesh lights as well through half its share of the leaves: its light is drawn on all its faces. */
static const double CAGE_SHARE = 0.5;
enum { LEAST_FACES = 400 };

typedef struct extent {
	double area, diagonal;
} extent;

static void corner_of(const engine_scene_object *object, uint32_t vertex, vec3 out)
{
	glm_vec3_mul((float *)object->rest.scale, object->mesh.positions + 3 * (size_t)vertex, out);
}

static double fan_area(const engine_scene_object *object, const uint32_t *corners, uint32_t count)
{
	double area = 0;
	for (uint32_t k = 2; k < count; k++) {
		vec3 a, b, c, normal;
		corner_of(object, corners[0], a);
		corner_of(object, corners[k - 1], b);
		corner_of(object, corners[k], c);
		glm_vec3_sub(b, a, b);
		glm_vec3_sub(c, a, c);
		glm_vec3_cross(b, c, normal);
		area += 0.5 * (double)glm_vec3_norm(normal);
	}
	return area;
}

static extent extent_of(const engine_scene_object *object)
{
	extent e = {0};
	vec3 lower = {INFINITY, INFINITY, INFINITY}, upper = {-INFINITY, -INFINITY, -INFINITY};
	const uint32_t *corners = object->mesh.indices;
	for (uint32_t f = 0; f < object->mesh.face_count; corners += object->mesh.face_counts[f++])
		e.area += fan_area(object, corners, object->mesh.face_counts[f]);
	for (uint32_t v = 0; v < object->mesh.vertex_count; v++) {
		vec3 p;
		corner_of(object, v, p);
		glm_vec3_minv(lower, p, lower);
		glm_vec3_maxv(upper, p, upper);
	}
	e.diagonal = lower[0] <= upper[0] ? (double)glm_vec3_distance(lower, upper) : 0;
	return e;
}

/* What an object's area counts: a quarter as large, leaves of half the size. */
static double weight(const fineness *f, const extent *e)
{
	const double ratio = f->diagonal > 0 ? sqrt(e->diagonal / f->diagonal) : 1;
	return e->area / pow(fmax(ratio, FINEST), 2);
}

fineness fineness_of(const engine_scene *scene, uint32_t leaves)
{
	fineness f = {.leaves = leaves ? leaves : LEAVES};
	for (uint32_t k = 0; k < scene->object_count; k++)
		f.diagonal = fmax(f.diagonal, extent_of(scene->objects + k).diagonal);
	for (uint32_t k = 0; k < scene->object_count; k++) {
		const extent e = extent_of(scene->objects + k);
		f.area += weight(&f, &e);
	}
	return f;
}

uint32_t fineness_most_faces(const fineness *f, const engine_scene_object *object)
{
	const extent e = extent_of(object);
	const double share = f->area > 0 ? CAGE_SHARE * f->leaves * weight(f, &e) / f->area : 0;
	return share > LEAST_FACES ? (uint32_t)share : LEAST_FACES;
}
