#include "rank.h"

#include "bits.h"

#include <stdlib.h>

static bool emits(const scene_object *o, const gi_primitive *p)
{
	/* A primitive's leaves are of one material. */
	return scene_emits(&o->materials[o->hierarchy.leaf_material[gi_bits_from_float(p->a.w)]]);
}

static int order(double a, double b)
{
	return (a > b) - (a < b);
}

/* ---- within an object ---- */

typedef struct sized {
	double size;
	uint32_t number;
} sized;

static int compare_sizes(const void *left, const void *right)
{
	const sized *a = left, *b = right;
	const int by_size = order(b->size, a->size);
	return by_size ? by_size : order(a->number, b->number);
}

uint32_t *rank_by_size(const gi_bvh *bvh)
{
	const uint32_t count = bvh->primitive_count;
	sized *list = malloc(sizeof *list * ((size_t)count + 1));
	uint32_t *numbers = malloc(sizeof *numbers * ((size_t)count + 1));
	for (uint32_t k = 0; list && k < count; k++)
		list[k] = (sized){(double)bvh->primitives[k].c.w + bvh->primitives[k].d.w, k};
	if (list)
		qsort(list, count, sizeof *list, compare_sizes);
	for (uint32_t k = 0; list && numbers && k < count; k++)
		numbers[k] = list[k].number;
	if (!list) {
		free(numbers);
		return NULL;
	}
	free(list);
	return numbers;
}

/* ---- among objects ---- */

static int compare_objects(const void *left, const void *right)
{
	const scene_object *a = *(scene_object *const *)left, *b = *(scene_object *const *)right;
	const int by_area = order(b->hierarchy.area, a->hierarchy.area);
	return by_area ? by_area : order((double)a->created, (double)b->created);
}

static uint32_t collect(const gi_scene *s, scene_object **list)
{
	uint32_t count = 0;
	for (uint32_t slot = 0; slot < s->slot_count; slot++)
		if (s->slots[slot] != GI_NONE)
			list[count++] = &s->objects[s->slots[slot]];
	for (uint32_t k = 0; k < count; k++)
		list[k]->lowest_rank = GI_NONE;
	return count;
}

static void store(scene_object *o, uint32_t number, uint32_t rank, gi_primitive *primitives, gi_uvec4 *leaves)
{
	const gi_primitive *p = &o->bvh.primitives[number];
	const uint32_t first = gi_bits_from_float(p->a.w), end = gi_bits_from_float(p->b.w);
	/* From low to high. */
	if (o->lowest_rank == GI_NONE)
		o->lowest_rank = rank;
	o->highest_rank = rank;
	primitives[o->primitive_base + number].b.w = gi_float_from_bits(rank);
	for (uint32_t leaf = first; leaf < end; leaf++)
		leaves[o->leaf_base + leaf].w = rank;
}

bool rank_primitives(const gi_scene *s, gi_primitive *primitives, gi_uvec4 *leaves)
{
	scene_object **list = malloc(sizeof *list * ((size_t)s->slot_count + 1));
	if (!list)
		return false;
	const uint32_t count = collect(s, list);
	qsort(list, count, sizeof *list, compare_objects);
	uint32_t rank = 0;
	for (int lit = 0; lit < 2; lit++)
		for (uint32_t k = 0; k < count; k++)
			for (uint32_t n = 0; n < list[k]->bvh.primitive_count; n++) {
				const uint32_t number = list[k]->by_size[n];
				if (emits(list[k], &list[k]->bvh.primitives[number]) == lit)
					store(list[k], number, rank++, primitives, leaves);
			}
	free(list);
	return true;
}
