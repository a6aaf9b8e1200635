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
