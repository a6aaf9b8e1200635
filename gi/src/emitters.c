/* How much finer than others the surfaces that emit are cut.
 *
 * A lamp is small and bright: cut finer, with more rays, it costs little and most of the error goes. Where much of a
 * scene emits that is another matter: the finer cut costs as many times more as the surfaces cover, and brings nothing,
 * since light that comes from everywhere varies little. So the emitting materials are counted from the smallest area
 * up, and what lies in the first 1/k of the scene's area is cut k times finer, up to gi_context_def.emitter_refinement:
 * together that is at most a few times the entries of a scene without emitters. How bright they are does not matter: a
 * night light may be all the light of its room.
 *
 * It is a function of what emits alone, so that rows are, too; k is a power of two, that it seldom changes.
 */
#include "emitters.h"

#include "context.h"
#include "host_memory.h"

#include <math.h>
#include <stdlib.h>

/* Areas this near each other are alike: copies of a lamp differ by rounding. */
static const double ALIKE = 1.001;

/* A material that emits. */
typedef struct emitting {
	object_record *object;
	uint32_t material;
	double area;
} emitting;

static int compare_areas(const void *a, const void *b)
{
	const double x = ((const emitting *)a)->area, y = ((const emitting *)b)->area;
	return (x > y) - (x < y);
}

/* Fills the list, which holds enough, with all that emits; returns how many. */
static size_t list_emitting(const gi_scene *s, emitting *list, double *scene_area)
{
	size_t count = 0;
	*scene_area = 0;
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		object_record *o = scene_object_in(s, slot);
		if (!o || !object_is_seen(o))
			continue;
		*scene_area += o->hierarchy.area;
		for (uint32_t m = 0; m < o->material_count; m++)
			if (material_emits(&o->materials[m]) && o->emission[m].area > 0)
				list[count++] = (emitting){o, m, o->emission[m].area};
	}
	return count;
}

/* Of what lies in the first `share` of the scene's area. A half is a half, however its sum was rounded. */
static uint32_t steps_of(const gi_context *gi, double share)
{
	const double most = ceil(log2((double)gi->def.emitter_refinement)), steps = floor(1e-9 - log2(share));
	return (uint32_t)fmax(fmin(fmin(steps, most), GI_NODE_FINER_MOST), 0);
}

static void set_steps(const emitting *e, uint32_t steps)
{
	object_emission *emission = &e->object->emission[e->material];
	if (emission->steps != steps)
		e->object->relit = e->object->material_changed = true;
	emission->steps = steps;
}

gi_result emitters_weigh(gi_context *gi)
{
	gi_scene *s = &gi->scene;
	size_t most = 1;
	for (uint32_t slot = 0; slot < s->slot_count; slot++)
		most += s->slots[slot] == GI_NONE ? 0 : s->objects[s->slots[slot]].material_count;
	emitting *list = gi_malloc(sizeof *list * most);
	if (!list)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	double scene_area;
	const size_t count = list_emitting(s, list, &scene_area);
	qsort(list, count, sizeof *list, compare_areas);
	double counted = 0;
	for (size_t first = 0, end; first < count; first = end) {
		for (end = first; end < count && list[end].area <= ALIKE * list[first].area; end++)
			counted += list[end].area;
		for (size_t k = first; k < end; k++)
			set_steps(&list[k], steps_of(gi, counted / scene_area));
	}
	gi_free(list);
	return GI_OK;
}
