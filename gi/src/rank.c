#include "rank.h"

#include "bits.h"
#include "host_memory.h"

#include <stdlib.h>

static bool emits(const object_record *o, const gi_primitive *p)
{
	/* A primitive's leaves are of one material. */
	return material_emits(&o->materials[o->hierarchy.leaf_material[gi_bits_from_float(p->a.w)]]);
}

static int order(double a, double b)
{
	return (a > b) - (a < b);
}

typedef struct ranked {
	object_record *object;
	double area;
	uint64_t created;
	bool emits; /* some of it */
} ranked;

static int compare_objects(const void *left, const void *right)
{
	const ranked *a = left, *b = right;
	const int by_area = order(b->area, a->area);
	return by_area ? by_area : (a->created > b->created) - (a->created < b->created);
}

static uint32_t collect(const gi_scene *s, ranked *list)
{
	uint32_t count = 0;
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		if (s->slots[slot] == GI_NONE)
			continue;
		object_record *o = &s->objects[s->slots[slot]];
		bool lit = false;
		for (uint32_t m = 0; m < o->material_count; m++)
			lit = lit || material_emits(&o->materials[m]);
		o->lowest_rank = GI_NONE;
		list[count++] = (ranked){o, o->hierarchy.area, o->created, lit};
	}
	return count;
}

static void store(object_record *o, uint32_t number, uint32_t rank, gi_primitive *primitives, gi_uvec4 *leaves)
{
	const gi_primitive *p = &o->bvh.primitives[number];
	const uint32_t first = gi_bits_from_float(p->a.w), end = gi_bits_from_float(p->b.w);
	/* Ranks in ascending order. */
	if (o->lowest_rank == GI_NONE)
		o->lowest_rank = rank;
	o->highest_rank = rank;
	primitives[o->primitive_base + number].b.w = gi_float_from_bits(rank);
	for (uint32_t leaf = first; leaf < end; leaf++)
		leaves[o->leaf_base + leaf].w = rank;
}

/* Of those of an object that emit, or do not. */
static uint32_t store_all(const ranked *r, bool lit, uint32_t rank, gi_primitive *primitives, gi_uvec4 *leaves)
{
	object_record *o = r->object;
	if (lit && !r->emits)
		return rank;
	for (uint32_t n = 0; n < o->bvh.primitive_count; n++) {
		const uint32_t number = o->by_size[n];
		if (!r->emits || emits(o, &o->bvh.primitives[number]) == lit)
			store(o, number, rank++, primitives, leaves);
	}
	return rank;
}

bool rank_primitives(const gi_scene *s, gi_primitive *primitives, gi_uvec4 *leaves)
{
	ranked *list = gi_malloc(sizeof *list * ((size_t)s->slot_count + 1));
	if (!list)
		return false;
	const uint32_t count = collect(s, list);
	qsort(list, count, sizeof *list, compare_objects);
	uint32_t rank = 0;
	for (int lit = 0; lit < 2; lit++)
		for (uint32_t k = 0; k < count; k++)
			rank = store_all(&list[k], lit, rank, primitives, leaves);
	gi_free(list);
	return true;
}

static uint32_t material_of(const object_record *o, uint32_t number)
{
	return o->hierarchy.leaf_material[gi_bits_from_float(o->bvh.primitives[number].a.w)];
}

/* Those that did not emit at the commit have an object's lowest ranks, those that did its highest. */
void rank_again(const object_record *o, gi_primitive *primitives)
{
	const uint32_t count = o->bvh.primitive_count;
	uint32_t lit = 0, dark = 0;
	for (uint32_t n = 0; n < count; n++)
		lit += o->emission[material_of(o, n)].ranked;
	uint32_t next_lit = o->highest_rank + 1 - lit;
	for (uint32_t n = 0; n < count; n++) {
		const uint32_t number = o->by_size[n];
		const bool emitted = o->emission[material_of(o, number)].ranked;
		primitives[number].b.w = gi_float_from_bits(emitted ? next_lit++ : o->lowest_rank + dark++);
	}
}
