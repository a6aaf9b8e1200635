#include "probes.h"

#include "binding.h"
#include "context.h"
#include "host_memory.h"

#include <math.h>

/* Uniforms of probe_planes.comp. */
enum { FIRST_ROW = 0, FIRST_PLANE = 1, COUNT = 2, ALL = 3, REACH = 4, LIFT = 5 };

/* Planes of a probe. */
enum { PLANES = 16 * 16 };

static const uint32_t PROBES_COOKIE = 0x47495042u;

/* As many as receivers may be (receivers.c). */
static const uint32_t MOST_PROBES = GI_ENTRY_LEAF_MASK;

/* ---- planes ---- */

static const receiver_set *grid_of(const gi_context *gi, uint32_t place)
{
	const receiver_set *set = &gi->receivers.list[gi->scene.sets[place].set];
	return set->grid.spacing > 0 ? set : NULL;
}

/* Probes of the grids before a place. */
static uint32_t probes_before(const gi_context *gi, uint32_t place)
{
	uint32_t count = 0;
	for (uint32_t k = 0; k < place; k++)
		count += grid_of(gi, k) ? gi->scene.sets[k].count : 0;
	return count;
}

gi_result probes_prepare(gi_context *gi)
{
	const uint64_t bytes = sizeof(gi_vec4) * PLANES * (uint64_t)probes_before(gi, gi->scene.set_count);
	if (!bytes) {
		probes_free(gi);
		return GI_OK;
	}
	if (!gi->probes && !(gi->probes = gi_calloc(1, sizeof *gi->probes)))
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	gi_probes *p = gi->probes;
	const gpu_program_file file = {"probe_planes.comp", &p->program};
	gi_result result = p->program ? GI_OK : gpu_programs_compute(&gi->gpu, &file, 1);
	if (result || p->planes.size == bytes)
		return result;
	p->stale = true;
	return gpu_buffer_allocate(&gi->gpu, &p->planes, buffer_labels.PROBE_PLANES, bytes, NULL);
}

void probes_update(gi_context *gi)
{
	gi_probes *owner = gi->probes;
	if (!owner)
		return;
	const float lift = scene_ray_lift(&gi->scene);
	const bool all = owner->stale || (gi->frame.update.w & GI_UPDATE_REBUILD);
	gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_RECEIVE]);
	PROBE_BUFFERS(BUFFER_BIND)
	gpu_set_uint(&gi->gpu, owner->program, ALL, all);
	gpu_set_floats(&gi->gpu, owner->program, LIFT, 1, 1, &lift);
	for (uint32_t k = 0; k < gi->scene.set_count; k++) {
		const receiver_set *set = grid_of(gi, k);
		if (!set)
			continue;
		const float reach = sqrtf(3) * set->grid.spacing;
		gpu_set_uint(&gi->gpu, owner->program, FIRST_ROW, gi->scene.leaf_count + gi->scene.sets[k].first);
		gpu_set_uint(&gi->gpu, owner->program, FIRST_PLANE, PLANES * probes_before(gi, k));
		gpu_set_uint(&gi->gpu, owner->program, COUNT, PLANES * set->count);
		gpu_set_floats(&gi->gpu, owner->program, REACH, 1, 1, &reach);
		gpu_dispatch(&gi->gpu, owner->program, (uint64_t)PLANES * set->count);
	}
	bind_rows(gi);
	gpu_timer_end(&gi->gpu, &gi->timers[GI_PASS_RECEIVE]);
	owner->stale = false;
}

void probes_invalidate(gi_context *gi)
{
	if (gi->probes)
		gi->probes->stale = true;
}

void probes_free(gi_context *gi)
{
	gi_probes *owner = gi->probes;
	if (!owner)
		return;
	gpu_program_free(&gi->gpu, &owner->program);
	PROBE_BUFFERS(BUFFER_FREE)
	gi_free(owner);
	gi->probes = NULL;
}

/* ---- public ---- */

gi_probes_def gi_probes_def_default(void)
{
	return (gi_probes_def){
	    .harmonics = 2, .refinement = RECEIVER_REFINEMENT, .samples = RECEIVER_SAMPLES, .internal = PROBES_COOKIE};
}

static bool is_valid(const gi_probes_def *def)
{
	bool right = def->spacing > 0 && def->harmonics >= 1 && def->harmonics <= 2 &&
		     receiver_fineness_is_valid(def->refinement, def->samples);
	double count = 1;
	for (int k = 0; k < 3; k++) {
		count *= def->count[k];
		right = right && fabsf(def->lower[k]) <= OBJECT_MAX_LENGTH &&
			(double)def->spacing * def->count[k] <= (double)OBJECT_MAX_LENGTH;
	}
	return right && count >= 1 && count <= MOST_PROBES;
}

/* Their places, x first; NULL: out of memory. */
static float *place_probes(const gi_probes_def *def, uint32_t count)
{
	float *positions = gi_malloc(3 * sizeof *positions * count);
	for (uint32_t k = 0; positions && k < count; k++) {
		const uint32_t at[3] = {k % def->count[0], k / def->count[0] % def->count[1],
					k / def->count[0] / def->count[1]};
		for (int c = 0; c < 3; c++)
			positions[3 * (size_t)k + (size_t)c] = def->lower[c] + def->spacing * (float)at[c];
	}
	return positions;
}

gi_result gi_create_probes(gi_context *gi, const gi_probes_def *def, gi_receivers *out)
{
	if (out)
		*out = (gi_receivers){0};
	if (!gi || !def || !out)
		return gi_fail_null(gi, "gi_create_probes: def and out");
	if (def->internal != PROBES_COOKIE)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_DEF, "start from gi_probes_def_default()");
	if (!is_valid(def))
		return gi_fail(
		    &gi->gpu.log, GI_ERROR_INVALID_ARGUMENT,
		    "probes: spacing and counts above 0 within 1e9 m, harmonics 1 or 2, refinement from 1 to "
		    "1024 and samples from 1 to 16 are needed");
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	const uint32_t count = def->count[0] * def->count[1] * def->count[2];
	float *positions = place_probes(def, count);
	const gi_receivers_def points = {.positions = positions,
					 .count = count,
					 .harmonics = def->harmonics,
					 .refinement = def->refinement,
					 .samples = def->samples,
					 .pose.rotation[3] = 1};
	const receiver_grid grid = {
	    {def->lower[0], def->lower[1], def->lower[2]}, def->spacing, {def->count[0], def->count[1], def->count[2]}};
	const gi_result result = positions ? receiver_sets_create(gi, &points, &grid, out)
					   : gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "probes: out of memory");
	gi_free(positions);
	gi_memory_from(before);
	return result;
}

gi_result gi_get_probe_buffers(const gi_context *gi, gi_receivers probes, gi_probe_buffers *out)
{
	if (!gi || !out)
		return gi_fail_null(gi, "gi_get_probe_buffers: out");
	const receiver_set *set = receiver_sets_find(gi, probes);
	if (!set || !(set->grid.spacing > 0))
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_HANDLE, "gi_get_probe_buffers: no probes of this handle");
	const receiver_place *place = receive_place(gi, set);
	if (!place || !gi->probes)
		return gi_fail(&gi->gpu.log, GI_ERROR_NOT_COMMITTED,
			       "gi_get_probe_buffers: call gi_commit() and gi_update() first");
	const receiver_grid *g = &set->grid;
	*out = (gi_probe_buffers){.light = gi->receive->light.name,
				  .planes = gi->probes->planes.name,
				  .light_texture = gi->receive->light.texture,
				  .planes_texture = gi->probes->planes.texture,
				  .grid = {{g->lower[0], g->lower[1], g->lower[2]},
					   g->spacing,
					   {g->count[0], g->count[1], g->count[2]},
					   place->light,
					   set->coefficients,
					   PLANES * probes_before(gi, set->place),
					   {0}}};
	return GI_OK;
}
