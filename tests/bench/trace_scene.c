#include "trace_scene.h"

#include <stdlib.h>
#include <string.h>

static void *copy(const void *data, size_t size)
{
	void *out = malloc(size);
	if (out)
		memcpy(out, data, size);
	return out;
}

/* What was there may be moved and nothing else: an object that could not be made leaves no trace. */
static trace_object *begin_object(trace_scene *scene)
{
	if (scene->object_count == TRACE_MOST_OBJECTS)
		return NULL;
	trace_object *o = &scene->objects[scene->object_count];
	*o = (trace_object){0};
	glm_mat4_identity(o->world);
	return o;
}

static void free_object(trace_object *o)
{
	free(o->positions);
	free(o->normals);
	free(o->corners);
	*o = (trace_object){0};
}

static trace_object *end_object(trace_scene *scene, trace_object *o, bool whole)
{
	if (!whole) {
		free_object(o);
		return NULL;
	}
	scene->object_count++;
	return o;
}

trace_object *trace_scene_add_quad(trace_scene *scene, const float corner[3], const float u[3], const float v[3])
{
	static const uint32_t corners[6] = {0, 1, 2, 0, 2, 3};
	trace_object *o = begin_object(scene);
	if (!o)
		return NULL;
	float positions[12];
	for (int c = 0; c < 3; c++) {
		positions[c] = corner[c];
		positions[3 + c] = corner[c] + u[c];
		positions[6 + c] = corner[c] + u[c] + v[c];
		positions[9 + c] = corner[c] + v[c];
	}
	o->positions = copy(positions, sizeof positions);
	o->corners = copy(corners, sizeof corners);
	o->vertex_count = 4;
	o->triangle_count = 2;
	return end_object(scene, o, o->positions && o->corners);
}

static float *mean_normals(const engine_mesh *m)
{
	float *normals = calloc(m->vertex_count, sizeof(vec3));
	for (uint32_t t = 0; normals && t < m->face_count; t++) {
		const uint32_t *v = m->indices + 3 * (size_t)t;
		vec3 a, b, n;
		float *p[3];
		for (int k = 0; k < 3; k++)
			p[k] = m->positions + 3 * (size_t)v[k];
		glm_vec3_sub(p[1], p[0], a);
		glm_vec3_sub(p[2], p[0], b);
		glm_vec3_cross(a, b, n);
		for (int k = 0; k < 3; k++)
			glm_vec3_add(normals + 3 * (size_t)v[k], n, normals + 3 * (size_t)v[k]);
	}
	for (uint32_t v = 0; normals && v < m->vertex_count; v++)
		glm_vec3_normalize(normals + 3 * (size_t)v);
	return normals;
}

trace_object *trace_scene_add_mesh(trace_scene *scene, const engine_mesh *triangles, float *normals)
{
	trace_object *o = begin_object(scene);
	if (!o) {
		free(normals);
		return NULL;
	}
	o->positions = copy(triangles->positions, sizeof(vec3) * triangles->vertex_count);
	o->normals = normals ? normals : mean_normals(triangles);
	o->corners = copy(triangles->indices, 3 * sizeof *o->corners * triangles->face_count);
	o->vertex_count = triangles->vertex_count;
	o->triangle_count = triangles->face_count;
	return end_object(scene, o, o->positions && o->normals && o->corners);
}

void trace_object_set_pose(trace_object *object, gi_pose pose)
{
	versor rotation = {pose.rotation[0], pose.rotation[1], pose.rotation[2], pose.rotation[3]}; /* aligned */
	glm_quat_mat4(rotation, object->world);
	glm_vec3_copy(pose.position, object->world[3]);
}

static bool any(const float rgb[3])
{
	return rgb[0] > 0 || rgb[1] > 0 || rgb[2] > 0;
}

bool trace_object_is_smooth(const trace_object *object)
{
	return any(object->specular.reflectance) || any(object->specular.transmittance);
}

bool trace_object_emits(const trace_object *object)
{
	return any(object->exitance);
}

void trace_object_corner(const trace_object *object, uint32_t triangle, int k, vec3 out)
{
	const uint32_t vertex = object->corners[3 * (size_t)triangle + (size_t)k];
	glm_mat4_mulv3((vec4 *)object->world, object->positions + 3 * (size_t)vertex, 1, out);
}

void trace_object_flat_normal(const trace_object *object, uint32_t triangle, vec3 out)
{
	vec3 p[3];
	for (int k = 0; k < 3; k++)
		trace_object_corner(object, triangle, k, p[k]);
	glm_vec3_sub(p[1], p[0], p[1]);
	glm_vec3_sub(p[2], p[0], p[2]);
	glm_vec3_cross(p[1], p[2], out);
}

void trace_object_normal(const trace_object *object, uint32_t triangle, float u, float v, vec3 out)
{
	if (!object->normals) {
		trace_object_flat_normal(object, triangle, out);
		glm_vec3_normalize(out);
		return;
	}
	const float weights[3] = {1 - u - v, u, v};
	vec3 n = {0, 0, 0};
	for (int k = 0; k < 3; k++)
		glm_vec3_muladds(object->normals + 3 * (size_t)object->corners[3 * (size_t)triangle + (size_t)k],
				 weights[k], n);
	glm_mat4_mulv3((vec4 *)object->world, n, 0, out);
	glm_vec3_normalize(out);
}

void trace_scene_free(trace_scene *scene)
{
	for (uint32_t k = 0; k < scene->object_count; k++)
		free_object(&scene->objects[k]);
	scene->object_count = 0;
}
