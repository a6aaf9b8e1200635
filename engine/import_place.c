/* Where an object stands: its pose, and what of its matrix or its mesh no pose can hold. */
#include "mesh_clean.h"
#include "import_build.h"

#include <math.h>

/* Fronts stay fronts: a mirrored face turns over, so its corners run the other way. */
static void mirror_mesh(engine_scene_object *object)
{
	engine_mesh *mesh = &object->mesh;
	for (size_t v = 0; v < mesh->vertex_count; v++)
		mesh->positions[3 * v] = -mesh->positions[3 * v];
	object->offset[0] = -object->offset[0];
	uint32_t *corners = mesh->indices;
	for (uint32_t f = 0; f < mesh->face_count; corners += mesh->face_counts[f++])
		engine_mesh_turn_face(mesh, corners, mesh->face_counts[f]);
}

static void stretch_mesh(engine_scene_object *object)
{
	const double *s = object->stretch;
	for (size_t v = 0; v < object->mesh.vertex_count; v++) {
		float *p = object->mesh.positions + 3 * v;
		double q[3];
		for (int row = 0; row < 3; row++)
			q[row] = s[3 * row] * p[0] + s[3 * row + 1] * p[1] + s[3 * row + 2] * p[2];
		for (int row = 0; row < 3; row++)
			p[row] = (float)q[row];
	}
}

static bool is_near(const engine_scene_object *object, const uint32_t *corners, uint32_t count)
{
	for (size_t i = 0; i < 3 * (size_t)count; i++) {
		const double position = (double)object->mesh.positions[3 * (size_t)corners[i / 3] + i % 3];
		if (fabs(position * (double)object->rest.scale[i % 3]) > IMPORT_FARTHEST)
			return false;
	}
	return true;
}

/* One corner far off costs its faces alone. */
static bool face_is_near(const void *context, uint32_t face, const uint32_t *corners)
{
	const engine_scene_object *object = context;
	return is_near(object, corners, object->mesh.face_counts[face]);
}

/* Area in the world at rest, by Newell's method relative to the first corner. */
static double world_area(const engine_scene_object *object, const uint32_t *corners, uint32_t count)
{
	const float *scale = object->rest.scale;
	double n[3], area2 = 0;
	engine_mesh_face_normal(&object->mesh, corners, count, n);
	for (int k = 0; k < 3; k++) {
		double part = n[k] * (double)scale[(k + 1) % 3] * (double)scale[(k + 2) % 3];
		area2 += part * part;
	}
	return sqrt(area2);
}

/* Whether the library would not find the leaves of a face too small. */
static bool is_large_enough(const void *context, uint32_t face, const uint32_t *corners)
{
	const engine_scene_object *object = context;
	return world_area(object, corners, object->mesh.face_counts[face]) >
	       ldexp(IMPORT_LEAST_AREA, 2 * (int)object->levels);
}

/* Finds the pose as graph->world has it; where the matrix mirrors or shears, the mesh takes that part. */
static import_pose_result find_pose(const engine_scene_graph *graph, engine_scene_object *object)
{
	import_pose_result result = import_object_pose(graph, object, &object->rest, NULL);
	if (result == IMPORT_POSE_MIRRORED) {
		object->mirrored = true;
		mirror_mesh(object);
		result = import_object_pose(graph, object, &object->rest, NULL);
	}
	if (result != IMPORT_POSE_SHEARED)
		return result;
	object->baked = true;
	result = import_object_pose(graph, object, &object->rest, object->stretch);
	if (result == IMPORT_POSE_MIRRORED) {
		object->mirrored = true;
		mirror_mesh(object);
		result = import_object_pose(graph, object, &object->rest, object->stretch);
	}
	if (result == IMPORT_POSE_OK)
		stretch_mesh(object);
	return result;
}

import_pose_result import_stand_object(import_loader *loader, engine_scene_object *object)
{
	import_pose_result result = find_pose(loader->scene->graph, object);
	if (result != IMPORT_POSE_OK)
		return result;
	const uint32_t far = engine_mesh_keep_faces(&object->mesh, face_is_near, object);
	if (object->mesh.face_count == 0 || (far > 0 && !engine_mesh_drop_unused_vertices(&object->mesh)))
		return IMPORT_POSE_FAR;
	import_note_many(loader, far, object->name, "faces beyond 1e9 m are left out");
	engine_mesh_keep_faces(&object->mesh, is_large_enough, object);
	return object->mesh.face_count > 0 ? IMPORT_POSE_OK : IMPORT_POSE_TINY;
}
