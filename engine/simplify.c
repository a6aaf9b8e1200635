#include "simplify.h"
#include "mesh_clean.h"

#include <meshoptimizer.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool copy_mesh(const engine_mesh *in, engine_mesh *copy)
{
	*copy = (engine_mesh){0};
	if (!engine_mesh_append(copy, in, 0))
		return false;
	free(copy->uvs); /* they belong to corners, which change */
	free(copy->colors);
	copy->uvs = copy->colors = NULL;
	return true;
}

/* Splits every face into a fan: a b c, a c d, ... Replaces the arrays of faces. */
static bool split_into_triangles(engine_mesh *mesh)
{
	uint32_t triangles = mesh->index_count - 2 * mesh->face_count;
	engine_mesh fan = {.face_counts = malloc((triangles + 1) * sizeof(uint32_t)),
			   .indices = malloc((3 * (size_t)triangles + 1) * sizeof(uint32_t)),
			   .face_materials = malloc((triangles + 1) * sizeof(uint32_t))};
	if (!fan.face_counts || !fan.indices || !fan.face_materials) {
		engine_mesh_free(&fan);
		return false;
	}
	const uint32_t *corners = mesh->indices;
	for (uint32_t f = 0; f < mesh->face_count; corners += mesh->face_counts[f++]) {
		for (uint32_t k = 2; k < mesh->face_counts[f]; k++) {
			memcpy(fan.indices + fan.index_count,
			       (const uint32_t[3]){corners[0], corners[k - 1], corners[k]}, 3 * sizeof(uint32_t));
			fan.index_count += 3;
			fan.face_materials[fan.face_count] = mesh->face_materials[f];
			fan.face_counts[fan.face_count++] = 3;
		}
	}
	fan.positions = mesh->positions;
	fan.vertex_count = mesh->vertex_count;
	mesh->positions = NULL;
	engine_mesh_free(mesh);
	*mesh = fan;
	return true;
}

/* The simplifier keeps a subset of the vertices, so materials travel on them: one of those that meet there. */
static uint32_t *materials_of_vertices(const engine_mesh *mesh)
{
	uint32_t *materials = malloc(((size_t)mesh->vertex_count + 1) * sizeof *materials);
	for (uint32_t i = 0; materials && i < mesh->index_count; i++)
		materials[mesh->indices[i]] = mesh->face_materials[i / 3];
	return materials;
}

/* The material at two corners or more, else that at the first. */
static uint32_t dominant(uint32_t a, uint32_t b, uint32_t c)
{
	return b == c ? b : a;
}

/* Replaces the triangles by the simplified ones. Needs triangles only. */
static bool simplify_triangles(engine_mesh *mesh, uint32_t target_faces)
{
	uint32_t *materials = materials_of_vertices(mesh);
	uint32_t *indices = malloc(((size_t)mesh->index_count + 1) * sizeof *indices);
	bool enough = materials && indices;
	if (enough) {
		/* Error 1 is the size of the mesh: the number of triangles decides, not the error. */
		size_t count =
		    meshopt_simplify(indices, mesh->indices, mesh->index_count, mesh->positions, mesh->vertex_count,
				     3 * sizeof(float), 3 * (size_t)target_faces, 1.0f, 0, NULL);
		memcpy(mesh->indices, indices, count * sizeof *indices);
		mesh->index_count = (uint32_t)count;
		mesh->face_count = (uint32_t)(count / 3);
		for (uint32_t f = 0; f < mesh->face_count; f++) {
			const uint32_t *corner = mesh->indices + 3 * (size_t)f;
			mesh->face_materials[f] =
			    dominant(materials[corner[0]], materials[corner[1]], materials[corner[2]]);
		}
	}
	free(materials);
	free(indices);
	return enough;
}

static bool simplify_copy(engine_mesh *mesh, uint32_t target_faces, char *message, size_t message_size)
{
	engine_clean_report report;
	if (!engine_mesh_clean(mesh, &report, message, message_size))
		return false;
	if (mesh->face_count == 0) {
		snprintf(message, message_size, "a mesh without any face of some area cannot be simplified");
		return false;
	}
	uint32_t target = target_faces < 4 ? 4 : target_faces;
	bool enough = split_into_triangles(mesh);
	/* Debian's meshoptimizer asserts that it is asked for no more triangles than there are. */
	if (enough && mesh->face_count > target)
		enough = simplify_triangles(mesh, target);
	if (!enough) {
		snprintf(message, message_size, "out of memory for simplifying a mesh");
		return false;
	}
	return engine_mesh_clean(mesh, &report, message, message_size);
}

bool engine_simplify(const engine_mesh *in, uint32_t target_faces, engine_mesh *out, char *message, size_t message_size)
{
	if (!copy_mesh(in, out))
		snprintf(message, message_size, "out of memory for simplifying a mesh");
	else if (simplify_copy(out, target_faces, message, message_size))
		return true;
	engine_mesh_free(out);
	return false;
}
