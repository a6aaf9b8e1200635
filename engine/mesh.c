#include "mesh.h"

#include <stdlib.h>
#include <string.h>

void engine_mesh_free(engine_mesh *mesh)
{
	free(mesh->positions);
	free(mesh->face_counts);
	free(mesh->indices);
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
	copy_array(mesh->face_materials, sizeof(uint32_t) * mesh->face_count, (void **)&out->face_materials, &ok);
	copy_array(mesh->crease_vertices, sizeof(uint32_t) * 2 * mesh->crease_count, (void **)&out->crease_vertices,
		   &ok);
	copy_array(mesh->crease_sharpness, sizeof(float) * mesh->crease_count, (void **)&out->crease_sharpness, &ok);
	if (!ok)
		engine_mesh_free(out);
	return ok;
}
