#include "programs.h"

#include "context.h"

enum { MOST_PROGRAMS = ROWS_PROGRAMS + SOLVER_PROGRAMS };

static uint32_t list_programs(gi_context *gi, rows_set set, gpu_program_file list[MOST_PROGRAMS])
{
	const uint32_t count = rows_programs(&gi->rows, set, list);
	if (set != ROWS_ALWAYS)
		return count;
	solver_programs(&gi->solver, list + count);
	return count + SOLVER_PROGRAMS;
}

/* The host hears of the programs that every scene takes; the others are few. */
static gi_progress_fn *hush(gi_context *gi, rows_set set)
{
	gi_progress_fn *progress = gi->gpu.log.progress;
	if (set != ROWS_ALWAYS)
		gi->gpu.log.progress = NULL;
	return progress;
}

gi_result programs_begin(gi_context *gi, rows_set set)
{
	gpu_program_file list[MOST_PROGRAMS];
	if (gi->programs[set] != PROGRAMS_NONE)
		return GI_OK;
	const uint32_t count = list_programs(gi, set, list);
	gi_progress_fn *progress = hush(gi, set);
	const gi_result result = gpu_programs_begin(&gi->gpu, list, count);
	gi->gpu.log.progress = progress;
	if (result)
		gpu_programs_free(&gi->gpu, list, count);
	else
		gi->programs[set] = PROGRAMS_BEGUN;
	return result;
}

static gi_result wait_for(gi_context *gi, const bool wanted[ROWS_SETS])
{
	gi_result result = GI_OK;
	for (rows_set set = 0; !result && set < ROWS_SETS; set++)
		if (wanted[set])
			result = programs_begin(gi, set);
	for (rows_set set = 0; !result && set < ROWS_SETS; set++) {
		gpu_program_file list[MOST_PROGRAMS];
		if (!wanted[set] || gi->programs[set] == PROGRAMS_READY)
			continue;
		gi_progress_fn *progress = hush(gi, set);
		result = gpu_programs_end(&gi->gpu, list, list_programs(gi, set, list));
		gi->gpu.log.progress = progress;
		gi->programs[set] = result ? PROGRAMS_BEGUN : PROGRAMS_READY;
	}
	return result;
}

gi_result programs_for_commit(gi_context *gi)
{
	const gi_scene *s = &gi->scene;
	uint32_t moving = 0, still = 0, ever_still = 0, deforming = 0;
	for (uint32_t k = 0; k < s->object_count; k++) {
		const object_record *o = &s->objects[k];
		if (!object_is_alive(o))
			continue;
		moving += o->mobility != GI_MOBILITY_STATIC;
		still += o->mobility != GI_MOBILITY_MOVABLE;
		ever_still += o->mobility == GI_MOBILITY_STATIC;
		deforming += o->deform != NULL;
	}
	const bool keeps = s->ever_committed && gi->rows.fitted && !gi->rows.rebuild;
	const bool moves = moving || keeps, statics = ever_still > 1 || still >= GI_AUTOMATIC_OBJECTS;
	const bool wanted[ROWS_SETS] = {[ROWS_ALWAYS] = true,     [ROWS_MOTION] = moves,
					[ROWS_STATICS] = statics, [ROWS_STATICS_MOTION] = moves && statics,
					[ROWS_KEPT] = keeps,      [ROWS_DEFORMING] = deforming};
	return wait_for(gi, wanted);
}

gi_result programs_for_rows(gi_context *gi)
{
	const bool moves = !gi->rows.rebuild, statics = gi->scene.statics_slot != GI_NONE;
	bool deforming = false;
	for (uint32_t k = 0; k < gi->scene.object_count; k++)
		deforming = deforming || gi->scene.objects[k].deform;
	const bool wanted[ROWS_SETS] = {[ROWS_MOTION] = moves,
					[ROWS_STATICS] = statics,
					[ROWS_STATICS_MOTION] = moves && statics,
					[ROWS_DEFORMING] = deforming};
	return wait_for(gi, wanted);
}

void programs_reloaded(gi_context *gi)
{
	for (rows_set set = 0; set < ROWS_SETS; set++)
		if (gi->programs[set] == PROGRAMS_BEGUN)
			gi->programs[set] = PROGRAMS_READY;
}

void programs_free(gi_context *gi)
{
	for (rows_set set = 0; set < ROWS_SETS; set++) {
		gpu_program_file list[MOST_PROGRAMS];
		gpu_programs_free(&gi->gpu, list, list_programs(gi, set, list));
	}
}
