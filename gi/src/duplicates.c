#include "duplicates.h"

#include "faces.h"
#include "host_memory.h"

#include <stdlib.h>
#include <string.h>

typedef struct place {
	float position[3];
	uint32_t vertex;
} place;

typedef struct face {
	const uint32_t *corners; /* first vertex of each place */
	uint32_t count, start;   /* it begins with its least corner */
	uint32_t number;
} face;

/* One more than asked for: no size is zero. */
static void *allocate(size_t count, size_t size)
{
	return gi_calloc(count + 1, size);
}

static int compare_places(const void *left, const void *right)
{
	const place *a = left, *b = right;
	for (int k = 0; k < 3; k++)
		if (a->position[k] != b->position[k])
			return a->position[k] < b->position[k] ? -1 : 1;
	return (a->vertex > b->vertex) - (a->vertex < b->vertex);
}

/* Of each vertex the first that is where it is. */
static bool find_first_vertices(const gi_object_def *def, uint32_t *first)
{
	for (uint32_t v = 0; v < def->vertex_count; v++)
		first[v] = v;
	if (def->crease_count)
		return true;
	place *places = allocate(def->vertex_count, sizeof *places);
	if (!places)
		return false;
	for (uint32_t v = 0; v < def->vertex_count; v++) {
		memcpy(places[v].position, def->positions + 3 * (size_t)v, sizeof places[v].position);
		places[v].vertex = v;
	}
	qsort(places, def->vertex_count, sizeof *places, compare_places);
	for (uint32_t k = 1; k < def->vertex_count; k++) {
		const float *p = places[k].position, *q = places[k - 1].position;
		if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2])
			first[places[k].vertex] = first[places[k - 1].vertex];
	}
	gi_free(places);
	return true;
}

static face face_at(const uint32_t *corners, uint32_t count, uint32_t number)
{
	face f = {corners, count, 0, number};
	for (uint32_t k = 1; k < count; k++)
		if (corners[k] < corners[f.start])
			f.start = k;
	return f;
}

static uint32_t corner_at(const face *f, uint32_t k)
{
	return f->corners[f->start + k < f->count ? f->start + k : f->start + k - f->count];
}

static int compare_corners(const face *a, const face *b)
{
	if (a->count != b->count)
		return a->count < b->count ? -1 : 1;
	for (uint32_t k = 0; k < a->count; k++) {
		const uint32_t p = corner_at(a, k), q = corner_at(b, k);
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

/* Marks the faces that repeat an earlier one; returns how many. `corners` is the index list by first vertices. */
static uint32_t mark_repeats(const gi_object_def *def, const uint32_t *corners, face *faces, bool *repeats)
{
	uint32_t count = 0;
	for (uint32_t k = 0; k < def->face_count; k++) {
		faces[k] = face_at(corners, gi_corner_count(def->face_counts, k), k);
		corners += faces[k].count;
	}
	qsort(faces, def->face_count, sizeof *faces, compare_faces);
	for (uint32_t k = 1; k < def->face_count; k++)
		if (compare_corners(&faces[k - 1], &faces[k]) == 0) {
			repeats[faces[k].number] = true;
			count++;
		}
	return count;
}

static bool find_repeats(const gi_object_def *def, bool *repeats, uint32_t *count)
{
	uint32_t *first = allocate(def->vertex_count, sizeof *first);
	uint32_t *corners = allocate(def->index_count, sizeof *corners);
	face *faces = allocate(def->face_count, sizeof *faces);
	const bool enough = first && corners && faces && find_first_vertices(def, first);
	if (enough) {
		for (uint32_t k = 0; k < def->index_count; k++)
			corners[k] = first[def->indices[k]];
		*count = mark_repeats(def, corners, faces, repeats);
	}
	gi_free(first);
	gi_free(corners);
	gi_free(faces);
	return enough;
}

/* Leaf sizes and cuts go by the faces' numbers, those of repeats with them. */
static bool copy_fineness(const gi_object_def *def, const bool *repeats, gi_unique_faces *out)
{
	uint32_t *number = allocate(def->face_count, sizeof *number), faces = 0, cuts = 0;
	out->leaf_sizes = allocate(def->face_count, sizeof *out->leaf_sizes);
	out->leaf_cuts = allocate(def->leaf_cut_count, sizeof *out->leaf_cuts);
	const bool enough = number && out->leaf_sizes && out->leaf_cuts;
	for (uint32_t k = 0; enough && k < def->face_count; k++) {
		number[k] = faces;
		out->leaf_sizes[faces] = def->leaf_sizes ? def->leaf_sizes[k] : 0;
		faces += !repeats[k];
	}
	for (uint32_t k = 0; enough && k < def->leaf_cut_count; k++) {
		if (repeats[def->leaf_cuts[k].face])
			continue;
		out->leaf_cuts[cuts] = def->leaf_cuts[k];
		out->leaf_cuts[cuts++].face = number[def->leaf_cuts[k].face];
	}
	gi_free(number);
	out->def.leaf_sizes = out->leaf_sizes;
	out->def.leaf_cuts = out->leaf_cuts;
	out->def.leaf_cut_count = cuts;
	return enough;
}

static bool copy_others(const gi_object_def *def, const bool *repeats, gi_unique_faces *out)
{
	out->face_counts = allocate(def->face_count, sizeof *out->face_counts);
	out->indices = allocate(def->index_count, sizeof *out->indices);
	out->face_materials = allocate(def->face_count, sizeof *out->face_materials);
	out->origin = allocate(def->face_count, sizeof *out->origin);
	out->uvs = def->uvs ? allocate(2 * (size_t)def->index_count, sizeof *out->uvs) : NULL;
	if (!out->face_counts || !out->indices || !out->face_materials || !out->origin || (def->uvs && !out->uvs))
		return false;
	uint32_t faces = 0, corners = 0;
	const uint32_t *next = def->indices;
	for (uint32_t k = 0; k < def->face_count; next += gi_corner_count(def->face_counts, k), k++) {
		if (repeats[k])
			continue;
		out->origin[faces] = k;
		out->face_counts[faces] = gi_corner_count(def->face_counts, k);
		out->face_materials[faces] = def->face_materials ? def->face_materials[k] : 0;
		memcpy(out->indices + corners, next, sizeof *next * gi_corner_count(def->face_counts, k));
		if (def->uvs)
			memcpy(out->uvs + 2 * (size_t)corners, def->uvs + 2 * (next - def->indices),
			       sizeof *out->uvs * 2 * gi_corner_count(def->face_counts, k));
		corners += gi_corner_count(def->face_counts, k);
		faces++;
	}
	out->def.face_counts = out->face_counts;
	out->def.face_materials = out->face_materials;
	out->def.indices = out->indices;
	out->def.uvs = out->uvs;
	out->def.face_count = faces;
	out->def.index_count = corners;
	return true;
}

bool gi_unique_faces_make(const gi_object_def *def, gi_unique_faces *out)
{
	*out = (gi_unique_faces){.def = *def};
	bool *repeats = allocate(def->face_count, sizeof *repeats);
	bool enough = repeats && find_repeats(def, repeats, &out->dropped);
	if (enough && out->dropped)
		enough = copy_others(def, repeats, out) && copy_fineness(def, repeats, out);
	gi_free(repeats);
	if (!enough)
		gi_unique_faces_free(out);
	return enough;
}

void gi_unique_faces_free(gi_unique_faces *unique)
{
	gi_free(unique->face_counts);
	gi_free(unique->indices);
	gi_free(unique->face_materials);
	gi_free(unique->origin);
	gi_free(unique->leaf_sizes);
	gi_free(unique->uvs);
	gi_free(unique->leaf_cuts);
	*unique = (gi_unique_faces){.dropped = 0};
}
