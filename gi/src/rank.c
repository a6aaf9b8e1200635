#include "rank.h"

#include "bits.h"

#include <stdlib.h>

typedef struct candidate {
	scene_object *object;
	const gi_primitive *primitive; /* of its object: leaf numbers are local */
	bool emits;
	uint32_t number; /* in the scene */
} candidate;

static bool emits(const scene_object *o, const gi_primitive *p)
{
	/* A primitive's leaves are of one material. */
	return scene_emits(&o->materials[o->hierarchy.leaf_material[gi_bits_from_float(p->a.w)]]);
}

static int order(double a, double b)
{
	return (a > b) - (a < b);
}

static int compare(const void *left, const void *right)
{
	const candidate *a = left, *b = right;
	const int by[] = {
	    order(a->emits, b->emits),
	    order(b->object->hierarchy.area, a->object->hierarchy.area),
	    order((double)a->object->created, (double)b->object->created),
	    order((double)b->primitive->c.w + b->primitive->d.w, (double)a->primitive->c.w + a->primitive->d.w),
	    order(a->number, b->number),
	};
	for (size_t k = 0; k < sizeof by / sizeof *by; k++)
		if (by[k])
			return by[k];
	return 0;
}

/* Returns how many there are. */
static uint32_t collect(const gi_scene *s, candidate *list)
{
	uint32_t count = 0;
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		if (s->slots[slot] == GI_NONE)
			continue;
		scene_object *o = &s->objects[s->slots[slot]];
		o->lowest_rank = GI_NONE;
		for (uint32_t k = 0; k < o->bvh.primitive_count; k++, count++) {
			const gi_primitive *p = &o->bvh.primitives[k];
			list[count] = (candidate){o, p, emits(o, p), o->primitive_base + k};
		}
	}
	return count;
}

static void store(const candidate *c, uint32_t rank, gi_primitive *primitives, gi_uvec4 *leaves)
{
	/* From low to high. */
	if (c->object->lowest_rank == GI_NONE)
		c->object->lowest_rank = rank;
	c->object->highest_rank = rank;
	const uint32_t first = gi_bits_from_float(c->primitive->a.w), end = gi_bits_from_float(c->primitive->b.w);
	primitives[c->number].b.w = gi_float_from_bits(rank);
	for (uint32_t leaf = first; leaf < end; leaf++)
		leaves[c->object->leaf_base + leaf].w = rank;
}

bool rank_primitives(const gi_scene *s, uint32_t primitive_count, gi_primitive *primitives, gi_uvec4 *leaves)
{
	candidate *list = calloc((size_t)primitive_count + 1, sizeof *list);
	if (!list)
		return false;
	const uint32_t count = collect(s, list);
	qsort(list, count, sizeof *list, compare);
	for (uint32_t rank = 0; rank < count; rank++)
		store(&list[rank], rank, primitives, leaves);
	free(list);
	return true;
}
