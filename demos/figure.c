#include "figure.h"

#include "simplify.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Polygons become fans about their first corner. */
static void fan(const engine_mesh *in, uint32_t *to)
{
	const uint32_t *corners = in->indices;
	for (uint32_t f = 0; f < in->face_count; corners += in->face_counts[f++])
		for (uint32_t k = 2; k < in->face_counts[f]; k++, to += 3) {
			to[0] = corners[0];
			to[1] = corners[k - 1];
			to[2] = corners[k];
		}
}

static bool to_triangles(const engine_mesh *in, engine_mesh *out)
{
	const uint32_t triangles = in->index_count - 2 * in->face_count;
	*out = (engine_mesh){.vertex_count = in->vertex_count, .face_count = triangles, .index_count = 3 * triangles};
	out->positions = malloc(3 * sizeof *out->positions * in->vertex_count);
	out->indices = malloc(3 * sizeof *out->indices * triangles);
	out->face_counts = malloc(sizeof *out->face_counts * triangles);
	if (!out->positions || !out->indices || !out->face_counts) {
		engine_mesh_free(out);
		return false;
	}
	memcpy(out->positions, in->positions, 3 * sizeof *out->positions * in->vertex_count);
	for (uint32_t k = 0; k < triangles; k++)
		out->face_counts[k] = 3;
	fan(in, out->indices);
	return true;
}

bool figure_make(const engine_mesh *in, uint32_t cage_faces, engine_mesh *drawn, engine_mesh *cage, char *message,
		 size_t message_size)
{
	*drawn = *cage = (engine_mesh){0};
	if (!in->face_count) {
		snprintf(message, message_size, "there is no face in it");
		return false;
	}
	if (in->face_count > cage_faces) {
		if (!engine_simplify(in, cage_faces, cage, message, message_size))
			return false;
	} else if (!engine_mesh_copy(in, cage)) {
		snprintf(message, message_size, "out of memory");
		return false;
	}
	if (to_triangles(in, drawn))
		return true;
	engine_mesh_free(cage);
	snprintf(message, message_size, "out of memory");
	return false;
}
