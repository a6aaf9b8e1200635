/* How far off the rows are: visibility and discretisation, estimated on leaves chosen by chance.
 *
 * A chosen leaf's row is compared with samples of the same integral that know no nodes: entries drawn by importance,
 * each replaced by a leaf below its node (estimate.comp), with the form factor from a point and a fresh ray
 * (estimate_trace.comp). They come in independent groups, so that products across groups hold the row's error without
 * the samples' noise (estimate_sum.comp), and the mean over leaves goes into the report (estimate_mean.comp).
 *
 * Half of the chances are by area, which is what the mean is over, half are alike for all leaves: small ones, a
 * figure's, often have most of the error. No leaf then counts more than twice its area's share.
 */
#include "estimate.h"

#include "binding.h"
#include "context.h"
#include "state.h"

/* Leaves a dispatch works on: the samples of more would only take memory. */
enum { CHUNK = 256 };

/* Rows that may have links through mirrors and glass are read by a program of their own. */
static gi_result make_specular_program(gi_context *gi)
{
	gi_specular_rows *rows = gi->specular_rows;
	const bool wanted = rows && !rows->estimate_program;
	const gpu_program_file file = {"estimate_specular.comp", rows ? &rows->estimate_program : NULL};
	return wanted ? gpu_programs_compute(&gi->gpu, &file, 1) : GI_OK;
}

static gi_result make_programs(gi_context *gi)
{
	gi_estimate *e = &gi->estimate;
	const uint32_t leaves = gi->def.estimate_leaves, most = leaves < CHUNK ? leaves : CHUNK;
	if (e->mean_program && e->results.size >= sizeof(gi_estimate_leaf) * leaves) /* the last that is made */
		return GI_OK;
	const gpu_program_file programs[] = {{"estimate.comp", &e->samples_program},
					     {"estimate_trace.comp", &e->trace_program},
					     {"estimate_sum.comp", &e->sum_program},
					     {"estimate_mean.comp", &e->mean_program}};
	gi_result result = GI_OK;
	if (!e->mean_program)
		result = gpu_programs_compute(&gi->gpu, programs, sizeof programs / sizeof *programs);
	const uint64_t items = (uint64_t)GI_ESTIMATE_ITEMS * most;
	const struct {
		gpu_buffer *buffer;
		const char *label;
		uint64_t size;
	} buffers[] = {{&e->items, buffer_labels.ESTIMATE_ITEMS, sizeof(gi_uvec4) * items},
		       {&e->shares, buffer_labels.ESTIMATE_SHARES, sizeof(float) * items},
		       {&e->results, buffer_labels.ESTIMATE_RESULTS, sizeof(gi_estimate_leaf) * leaves}};
	for (size_t k = 0; !result && k < sizeof buffers / sizeof *buffers; k++)
		result = gpu_buffer_allocate(&gi->gpu, buffers[k].buffer, buffers[k].label, buffers[k].size, NULL);
	return result;
}

static double leaf_area(const object_record *o, uint32_t local)
{
	return o->hierarchy.geometry[o->hierarchy.leaf_node[local]].moment.w;
}

/* Chances of the leaves: x where each one's part of [0,1] ends, y the part. */
static void fill_chances(gi_context *gi, float *chances)
{
	const gi_scene *s = &gi->scene;
	double end = 0;
	gi->estimate.area = 0;
	for (int pass = 0; pass < 2; pass++)
		for (uint32_t slot = 0; slot < s->slot_count; slot++) {
			if (!scene_slot_is_seen(s, slot))
				continue;
			const object_record *o = &s->objects[s->slots[slot]];
			for (uint32_t k = 0; k < o->hierarchy.leaf_count; k++) {
				if (pass == 0) {
					gi->estimate.area += leaf_area(o, k);
					continue;
				}
				const double part = .5 * leaf_area(o, k) / gi->estimate.area + .5 / s->leaf_count;
				end += part;
				chances[2 * (o->leaf_base + k)] = (float)end;
				chances[2 * (o->leaf_base + k) + 1] = (float)part;
			}
		}
}

static gi_result make_chances(gi_context *gi)
{
	gi_estimate *e = &gi->estimate;
	if (e->fresh)
		return GI_OK;
	const uint64_t bytes = 2 * sizeof(float) * (uint64_t)gi->scene.leaf_count;
	gi_arena_measure(&e->memory);
	gi_arena_take(&e->memory, gi->scene.leaf_count, 2 * sizeof(float));
	if (!gi_arena_reserve(&e->memory))
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	float *chances = gi_arena_take(&e->memory, gi->scene.leaf_count, 2 * sizeof(float));
	fill_chances(gi, chances);
	const gi_result result =
	    gpu_buffer_replace(&gi->gpu, &e->chances, buffer_labels.ESTIMATE_CHANCES, bytes, chances);
	e->fresh = !result;
	return result;
}

static void bind(gi_context *gi)
{
	const gi_estimate *owner = &gi->estimate;
	bind_all(gi);
	ESTIMATE_BUFFERS(BUFFER_BIND)
}

static uint32_t salt_of(uint64_t frame, uint32_t first)
{
	return (uint32_t)frame * 2654435761u + first * 40503u;
}

static void look_at(gi_context *gi, uint32_t first, uint32_t count)
{
	gi_estimate *e = &gi->estimate;
	const uint32_t salt = salt_of(gi->frame_number, first);
	const float area = (float)e->area;
	const uint32_t samples = gi->specular_rows ? gi->specular_rows->estimate_program : e->samples_program;
	gpu_set_uint(&gi->gpu, samples, 0, salt);
	gpu_set_uint(&gi->gpu, samples, 1, first);
	gpu_set_uint(&gi->gpu, samples, 2, count);
	gpu_set_uint(&gi->gpu, samples, 3, gi->def.estimate_leaves);
	gpu_dispatch(&gi->gpu, samples, (uint64_t)GI_ESTIMATE_GROUPS * count);
	gpu_set_uint(&gi->gpu, e->trace_program, 0, salt ^ 0x68e31da4u);
	gpu_set_uint(&gi->gpu, e->trace_program, 1, GI_ESTIMATE_ITEMS * count);
	gpu_dispatch(&gi->gpu, e->trace_program, (uint64_t)GI_ESTIMATE_ITEMS * count);
	gpu_set_uint(&gi->gpu, e->sum_program, 0, first);
	gpu_set_uint(&gi->gpu, e->sum_program, 1, count);
	gpu_set_floats(&gi->gpu, e->sum_program, 2, 1, 1, &area);
	gpu_dispatch(&gi->gpu, e->sum_program, count);
}

gi_result estimate_update(gi_context *gi)
{
	const uint32_t leaves = gi->def.estimate_leaves;
	if (!leaves && gi->estimate.results.name) /* there was one before the host wanted none */
		STATE_CLEAR(gi, estimate);
	if (!leaves || !gi->scene.leaf_count)
		return GI_OK;
	gi_result result = make_programs(gi);
	if (!result)
		result = make_specular_program(gi);
	if (!result)
		result = make_chances(gi);
	if (result)
		return result;
	gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_ESTIMATE]);
	bind(gi);
	for (uint32_t first = 0; first < leaves; first += CHUNK)
		look_at(gi, first, leaves - first < CHUNK ? leaves - first : CHUNK);
	gpu_set_uint(&gi->gpu, gi->estimate.mean_program, 0, leaves);
	gpu_dispatch_groups(&gi->gpu, gi->estimate.mean_program, 1);
	gpu_timer_end(&gi->gpu, &gi->timers[GI_PASS_ESTIMATE]);
	bind_scene(gi);
	bind_rows(gi);
	return GI_OK;
}

void estimate_invalidate(gi_context *gi)
{
	gi->estimate.fresh = false;
}

void estimate_free(gi_context *gi)
{
	gi_estimate *owner = &gi->estimate;
	ESTIMATE_BUFFERS(BUFFER_FREE)
	gi_arena_free(&owner->memory);
	uint32_t *programs[] = {&owner->samples_program, &owner->trace_program, &owner->sum_program,
				&owner->mean_program};
	for (size_t k = 0; k < sizeof programs / sizeof *programs; k++)
		gpu_program_free(&gi->gpu, programs[k]);
}
