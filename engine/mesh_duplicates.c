#include "mesh_duplicates.h"

#include "mesh.h"

#include <stdlib.h>
#include <string.h>

typedef struct face {
	const uint32_t *corners;
	uint32_t count, start; /* it begins with its least vertex */
	uint32_t number;
} face;

static face face_at(const uint32_t *corners, uint32_t count, uint32_t number)
{
	face f = {corners, count, 0, number};
	for (uint32_t k = 1; k < count; k++)
		if (corners[k] < corners[f.start])
			f.start = k;
	return f;
}

static int compare_corners(const face *a, const face *b)
{
	if (a->count != b->count)
		return a->count < b->count ? -1 : 1;
	for (uint32_t k = 0; k < a->count; k++) {
		const uint32_t p = a->corners[(a->start + k) % a->count], q = b->corners[(b->start + k) % b->count];
		if (p != q)
			return p < q ? -1 : 1;
	}
	return 0;
}

static int compare_faces(const void *left, const void *right)
{
	const face *a = left, *b = right;
	const int by_corners = compare_corners(a, b);
	return by_corners ? by_corners : (a->number > b->number) - (a->number < b->number);
}

/* Marks every face that has the corners of one before it. */
static uint32_t mark(const engine_mesh *mesh, face *faces, bool *again)
{
	uint32_t first = 0, count = 0;
	for (uint32_t f = 0; f < mesh->face_count; first += mesh->face_counts[f], f++)
		faces[f] = face_at(mesh->indices + first, mesh->face_counts[f], f);
	qsort(faces, mesh->face_count, sizeof *faces, compare_faces);
	for (uint32_t f = 1; f < mesh->face_count; f++)
		if (compare_corners(&faces[f - 1], &faces[f]) == 0) {
			again[faces[f].number] = true;
			count++;
		}
	return count;
}

static bool is_first(const void *again, uint32_t number, const uint32_t *corners)
{
	(void)corners;
	return !((const bool *)again)[number];
}

bool engine_mesh_drop_duplicates(engine_mesh *mesh, uint32_t *dropped)
{
	face *faces = malloc(((size_t)mesh->face_count + 1) * sizeof *faces);
	bool *again = calloc((size_t)mesh->face_count + 1, sizeof *again);
	const bool enough = faces && again;
	*dropped = enough ? mark(mesh, faces, again) : 0;
	if (*dropped)
		engine_mesh_keep_faces(mesh, is_first, again);
	free(faces);
	free(again);
	return enough;
}
