#include "specular_rows.h"

#include "binding.h"
#include "context.h"
#include "host_memory.h"
#include "sky.h"
#include "specular.h"
#include "state.h"

enum { LIFT = 0, PHOTONS = 1 };
enum { AFTER_LISTING = 5 }; /* stage of prepare.comp */

static gi_result make_programs(gi_context *gi, bool part)
{
	gi_specular_rows *s = gi->specular_rows;
	const gpu_program_file always[] = {{"specular_list.comp", &s->list_program},
					   {"specular_path.comp", &s->path_program},
					   {"close_specular.comp", &s->close_program},
					   {"gather_specular.comp", &s->gather_program},
					   {"gather_double_specular.comp", &s->double_program},
					   {"emitted_specular.comp", &s->emitted_program}};
	const gpu_program_file of_parts[] = {{"assess_specular.comp", &s->assess_program},
					     {"survey_specular.comp", &s->survey_program}};
	const gpu_program_file tops = {"specular_path_tops.comp", &s->tops_program};
	gi_result result = GI_OK;
	if (!s->list_program)
		result = gpu_programs_compute(&gi->gpu, always, sizeof always / sizeof *always);
	if (!result && part && !s->assess_program)
		result = gpu_programs_compute(&gi->gpu, of_parts, sizeof of_parts / sizeof *of_parts);
	if (!result && gi->scene.statics_slot != GI_NONE && !s->tops_program)
		result = gpu_programs_compute(&gi->gpu, &tops, 1);
	return result;
}

gi_result specular_rows_prepare(gi_context *gi, bool part)
{
	if (!specular_is_ready(gi) && !gi->specular_rows)
		return GI_OK;
	if (!gi->specular_rows)
		gi->specular_rows = gi_calloc(1, sizeof *gi->specular_rows);
	if (!gi->specular_rows)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	gpu_buffer *ends = &gi->specular_rows->ends;
	const uint64_t bytes = 2 * sizeof(uint32_t) * gi->rows.entry_limit;
	const gi_result result = make_programs(gi, part);
	return result || ends->size >= bytes
		   ? result
		   : gpu_buffer_allocate(&gi->gpu, ends, buffer_labels.SPECULAR_ENDS, bytes, NULL);
}

void specular_rows_follow(gi_context *gi)
{
	if (!specular_is_ready(gi))
		return;
	const gi_specular_rows *s = gi->specular_rows;
	const uint64_t arguments = STATE_OFFSET(specular);
	const uint32_t paths[] = {s->path_program, gi->scene.statics_slot != GI_NONE ? s->tops_program : 0};
	const float lift = scene_ray_lift(&gi->scene);
	STATE_CLEAR(gi, counts.specular_paths);
	if (gi->frame.update.w & GI_UPDATE_PART)
		gpu_dispatch_indirect(&gi->gpu, s->list_program, &gi->state, STATE_OFFSET(chosen));
	else
		gpu_dispatch(&gi->gpu, s->list_program, scene_row_count(&gi->scene));
	gpu_set_uint(&gi->gpu, gi->rows.prepare_program, 0, AFTER_LISTING);
	gpu_dispatch_groups(&gi->gpu, gi->rows.prepare_program, 1);
	specular_bind(gi);
	gpu_bind(&gi->gpu, GI_BIND_SPECULAR_ENDS, &s->ends);
	for (int k = 0; k < 2; k++) {
		if (!paths[k])
			continue;
		gpu_set_floats(&gi->gpu, paths[k], LIFT, 1, 1, &lift);
		gpu_set_uint(&gi->gpu, paths[k], PHOTONS, gi->def.caustic_photons > 0);
		gpu_dispatch_indirect(&gi->gpu, paths[k], &gi->state, arguments);
	}
	bind_rows(gi);
	bind_scene(gi);
	gpu_bind(&gi->gpu, GI_BIND_SPECULAR_ENDS, &s->ends); /* for closing */
}

uint32_t specular_rows_close_program(const gi_context *gi)
{
	return specular_is_ready(gi) ? gi->specular_rows->close_program : gi->rows.close_program;
}

void specular_rows_done(gi_context *gi, bool part)
{
	if (!specular_is_ready(gi) && !part)
		specular_rows_free(gi); /* no row has any such link left */
}

bool specular_rows_bring_exitance(const gi_context *gi)
{
	return gi->specular_rows && (sky_is_lit(gi, &gi->def) || !gi->def.caustic_photons);
}

bool specular_rows_are_heavy(const gi_context *gi)
{
	bool mixed = false;
	for (uint32_t k = 0; gi->specular_rows && k < gi->scene.object_count; k++) {
		const object_record *o = &gi->scene.objects[k];
		for (uint32_t m = 0; o->committed && o->specular && m < o->material_count; m++)
			mixed = mixed || material_is_mixed(&o->materials[m], &o->specular[m]);
	}
	return mixed;
}

void specular_rows_free(gi_context *gi)
{
	gi_specular_rows *owner = gi->specular_rows;
	if (!owner)
		return;
	uint32_t *programs[] = {&owner->close_program,    &owner->gather_program, &owner->double_program,
				&owner->emitted_program,  &owner->assess_program, &owner->survey_program,
				&owner->estimate_program, &owner->list_program,   &owner->path_program,
				&owner->tops_program};
	for (size_t k = 0; k < sizeof programs / sizeof *programs; k++)
		gpu_program_free(&gi->gpu, programs[k]);
	SPECULAR_BUFFERS(BUFFER_FREE)
	gi_free(owner);
	gi->specular_rows = NULL;
}
