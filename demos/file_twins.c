#include "file_twins.h"

#include <stdlib.h>
#include <string.h>

/* ---- meshes ---- */

static bool is_same(const void *a, const void *b, size_t bytes)
{
	return a && b ? memcmp(a, b, bytes) == 0 : a == b;
}

static bool is_same_mesh(const engine_mesh *a, const engine_mesh *b)
{
	return a->vertex_count == b->vertex_count && a->face_count == b->face_count &&
	       a->index_count == b->index_count &&
	       is_same(a->positions, b->positions, 3 * sizeof *a->positions * a->vertex_count) &&
	       is_same(a->face_counts, b->face_counts, sizeof *a->face_counts * a->face_count) &&
	       is_same(a->indices, b->indices, sizeof *a->indices * a->index_count) &&
	       is_same(a->face_materials, b->face_materials, sizeof *a->face_materials * a->face_count) &&
	       is_same(a->uvs, b->uvs, 2 * sizeof *a->uvs * a->index_count) &&
	       is_same(a->colors, b->colors, 4 * sizeof *a->colors * a->index_count);
}

static bool are_twins(const engine_scene_object *a, const engine_scene_object *b)
{
	return !a->deforms && !b->deforms && !a->scale_animated && !b->scale_animated && a->scheme == b->scheme &&
	       a->levels == b->levels && a->double_sided == b->double_sided &&
	       is_same(a->rest.scale, b->rest.scale, sizeof a->rest.scale) && is_same_mesh(&a->mesh, &b->mesh);
}

/* ---- which go together ---- */

typedef struct candidate {
	uint64_t hash;
	uint32_t object;
} candidate;

/* FNV-1a */
static uint64_t add_bytes(uint64_t hash, const void *data, size_t bytes)
{
	for (size_t k = 0; k < bytes; k++)
		hash = (hash ^ ((const unsigned char *)data)[k]) * 1099511628211u;
	return hash;
}

static uint64_t hash_of(const engine_scene_object *o)
{
	const uint64_t hash = add_bytes(14695981039346656037u, o->rest.scale, sizeof o->rest.scale);
	return add_bytes(hash, o->mesh.positions, 3 * sizeof *o->mesh.positions * o->mesh.vertex_count);
}

static int compare(const void *a, const void *b)
{
	const candidate *x = a, *y = b;
	if (x->hash != y->hash)
		return x->hash < y->hash ? -1 : 1;
	return (x->object > y->object) - (x->object < y->object);
}

bool file_twins_find(const engine_scene *scene, uint32_t *first)
{
	const uint32_t count = scene->object_count;
	candidate *all = malloc(sizeof *all * ((size_t)count + 1));
	if (!all)
		return false;
	for (uint32_t k = 0; k < count; k++)
		all[k] = (candidate){hash_of(&scene->objects[k]), k};
	qsort(all, count, sizeof *all, compare);
	for (uint32_t k = 0, run = 0; k < count; k++) {
		run = k && all[k].hash == all[k - 1].hash ? run : k;
		first[all[k].object] = all[k].object;
		if (k > run && are_twins(&scene->objects[all[run].object], &scene->objects[all[k].object]))
			first[all[k].object] = all[run].object;
	}
	free(all);
	return true;
}

/* ---- leaves ---- */

static bool is_same_cut(const gi_leaf_cut *a, const gi_leaf_cut *b)
{
	return a->face == b->face && a->parts == b->parts && is_same(a->from, b->from, sizeof a->from) &&
	       is_same(a->to, b->to, sizeof a->to);
}

bool file_twins_have_same_leaves(const gi_object_def *a, const gi_object_def *b)
{
	bool same = a->leaf_size == b->leaf_size && a->levels == b->levels && a->face_count == b->face_count &&
		    a->leaf_cut_count == b->leaf_cut_count &&
		    is_same(a->leaf_sizes, b->leaf_sizes, sizeof *a->leaf_sizes * a->face_count);
	for (uint32_t k = 0; same && k < a->leaf_cut_count; k++)
		same = is_same_cut(&a->leaf_cuts[k], &b->leaf_cuts[k]);
	return same;
}
