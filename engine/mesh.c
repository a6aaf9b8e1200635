#include "mesh.h"

#include <stdlib.h>
#include <string.h>

void engine_mesh_free(engine_mesh *mesh)
{
	free(mesh->positions);
	free(mesh->face_counts);
	free(mesh->indices);
	free(mesh->uvs);
	free(mesh->colors);
	free(mesh->face_materials);
	free(mesh->crease_vertices);
	free(mesh->crease_sharpness);
	memset(mesh, 0, sizeof *mesh);
}

/* Once one copy failed, *ok is false and the rest are left out. */
static void copy_array(const void *from, size_t bytes, void **to, bool *ok)
{
	if (!from || !*ok)
		return;
	*to = malloc(bytes + 1);
	if (*to)
		memcpy(*to, from, bytes);
	*ok = *to != NULL;
}

bool engine_mesh_copy(const engine_mesh *mesh, engine_mesh *out)
{
	bool ok = true;
	*out = (engine_mesh){.vertex_count = mesh->vertex_count,
			     .face_count = mesh->face_count,
			     .index_count = mesh->index_count,
			     .crease_count = mesh->crease_count};
	copy_array(mesh->positions, sizeof(float) * 3 * mesh->vertex_count, (void **)&out->positions, &ok);
	copy_array(mesh->face_counts, sizeof(uint32_t) * mesh->face_count, (void **)&out->face_counts, &ok);
	copy_array(mesh->indices, sizeof(uint32_t) * mesh->index_count, (void **)&out->indices, &ok);
	copy_array(mesh->uvs, sizeof(float) * 2 * mesh->index_count, (void **)&out->uvs, &ok);
	copy_array(mesh->colors, sizeof(float) * 4 * mesh->index_count, (void **)&out->colors, &ok);
	copy_array(mesh->face_materials, sizeof(uint32_t) * mesh->face_count, (void **)&out->face_materials, &ok);
	copy_array(mesh->crease_vertices, sizeof(uint32_t) * 2 * mesh->crease_count, (void **)&out->crease_vertices,
		   &ok);
	copy_array(mesh->crease_sharpness, sizeof(float) * mesh->crease_count, (void **)&out->crease_sharpness, &ok);
	if (!ok)
		engine_mesh_free(out);
	return ok;
}

/* Newell's method relative to the first corner, which keeps the digits of a small face far from the origin. */
void engine_mesh_face_normal(const engine_mesh *mesh, const uint32_t *corners, uint32_t count, double normal[3])
{
	const float *origin = mesh->positions + 3 * (size_t)corners[0];
	normal[0] = normal[1] = normal[2] = 0;
	for (uint32_t i = 1; i + 1 < count; i++) {
		const float *p = mesh->positions + 3 * (size_t)corners[i];
		const float *q = mesh->positions + 3 * (size_t)corners[i + 1];
		double a[3], b[3];
		for (int k = 0; k < 3; k++) {
			a[k] = (double)p[k] - origin[k];
			b[k] = (double)q[k] - origin[k];
		}
		for (int k = 0; k < 3; k++)
			normal[k] += 0.5 * (a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
	}
}

void engine_mesh_move_corners(engine_mesh *mesh, size_t to, size_t from, size_t count)
{
	memmove(mesh->indices + to, mesh->indices + from, count * sizeof *mesh->indices);
	if (mesh->uvs)
		memmove(mesh->uvs + 2 * to, mesh->uvs + 2 * from, 2 * count * sizeof *mesh->uvs);
	if (mesh->colors)
		memmove(mesh->colors + 4 * to, mesh->colors + 4 * from, 4 * count * sizeof *mesh->colors);
}

uint32_t engine_mesh_keep_faces(engine_mesh *mesh, engine_mesh_keep *keep, const void *context)
{
	uint32_t read = 0, write = 0, faces = 0;
	for (uint32_t f = 0; f < mesh->face_count; f++) {
		const uint32_t count = mesh->face_counts[f];
		if (keep(context, f, mesh->indices + read)) {
			engine_mesh_move_corners(mesh, write, read, count);
			if (mesh->face_materials)
				mesh->face_materials[faces] = mesh->face_materials[f];
			mesh->face_counts[faces++] = count;
			write += count;
		}
		read += count;
	}
	const uint32_t dropped = mesh->face_count - faces;
	mesh->face_count = faces;
	mesh->index_count = write;
	return dropped;
}
