#include "receive.h"

#include "binding.h"
#include "context.h"
#include "host_memory.h"

enum { FIRST = 0, COUNT = 1, LIGHT_COUNT = 2, ROWS = 3 };

static const char *const FILES[RECEIVE_KINDS] = {"receive.comp", "receive_harmonics.comp", "receive_punctual.comp",
						 "receive_harmonics_punctual.comp"};

static uint32_t count_facing(const gi_context *gi)
{
	const gi_scene *s = &gi->scene;
	uint32_t count = 0;
	for (uint32_t k = 0; k < s->set_count; k++)
		if (!receiver_set_is_round(&gi->receivers.list[s->sets[k].set]))
			count += s->sets[k].count;
	return count;
}

static gi_result want_kind(gi_context *gi, receive_kind facing_or_round)
{
	const bool lit = light_list_alive(&gi->light_list);
	const receive_kind kind = facing_or_round + (lit ? RECEIVE_FACING_LIT : 0);
	uint32_t *program = &gi->receive->programs[kind];
	return *program ? GI_OK : gpu_programs_compute(&gi->gpu, &(gpu_program_file){FILES[kind], program}, 1);
}

static gi_result make_programs(gi_context *gi)
{
	gi_receive *r = gi->receive;
	const gpu_program_file all_round[] = {{"factor_round.comp", &r->factor_program},
					      {"trace_round.comp", &r->trace_program}},
			       tops = {"trace_tops_round.comp", &r->tops_program};
	gi_result result = GI_OK;
	r->facing = count_facing(gi);
	r->round = r->facing < gi->scene.receiver_count;
	if (r->facing)
		result = want_kind(gi, RECEIVE_FACING);
	if (!result && r->round)
		result = want_kind(gi, RECEIVE_ROUND);
	if (!result && r->round && !r->trace_program)
		result = gpu_programs_compute(&gi->gpu, all_round, sizeof all_round / sizeof *all_round);
	if (!result && r->round && gi->scene.statics_slot != GI_NONE && !r->tops_program)
		result = gpu_programs_compute(&gi->gpu, &tops, 1);
	return result;
}

gi_result receive_prepare(gi_context *gi)
{
	const uint64_t bytes = sizeof(gi_vec4) * gi->scene.light_words;
	if (!bytes) {
		receive_free(gi);
		return GI_OK;
	}
	if (!gi->receive)
		gi->receive = gi_calloc(1, sizeof *gi->receive);
	if (!gi->receive)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	gi_result result = make_programs(gi);
	if (!result && gi->receive->light.size != bytes)
		result = gpu_buffer_allocate(&gi->gpu, &gi->receive->light, buffer_labels.RECEIVED, bytes, NULL);
	return result;
}

uint32_t receive_factor_program(const gi_context *gi)
{
	return gi->receive && gi->receive->round ? gi->receive->factor_program : gi->rows.factor_program;
}

uint32_t receive_trace_program(const gi_context *gi, bool tops)
{
	const gi_receive *r = gi->receive;
	if (r && r->round)
		return tops ? r->tops_program : r->trace_program;
	return tops ? gi->rows.tops_program : gi->rows.trace_program;
}

static void run(gi_context *gi, receive_kind facing_or_round, uint32_t lights, uint32_t first, uint32_t count)
{
	const uint32_t program = gi->receive->programs[facing_or_round + (lights ? RECEIVE_FACING_LIT : 0)];
	if (!count)
		return;
	if (lights) {
		gpu_set_uint(&gi->gpu, program, LIGHT_COUNT, lights);
		gpu_set_uint(&gi->gpu, program, ROWS, scene_row_count(&gi->scene));
	}
	gpu_set_uint(&gi->gpu, program, FIRST, gi->scene.leaf_count + first);
	gpu_set_uint(&gi->gpu, program, COUNT, count);
	gpu_dispatch(&gi->gpu, program, count);
}

void receive_update(gi_context *gi, uint32_t lights)
{
	gi_receive *owner = gi->receive;
	if (!owner)
		return;
	gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_RECEIVE]);
	RECEIVER_BUFFERS(BUFFER_BIND)
	run(gi, RECEIVE_FACING, lights, 0, owner->facing);
	run(gi, RECEIVE_ROUND, lights, owner->facing, gi->scene.receiver_count - owner->facing);
	bind_rows(gi);
	gpu_timer_end(&gi->gpu, &gi->timers[GI_PASS_RECEIVE]);
	owner->written = true;
}

void receive_invalidate(gi_context *gi)
{
	if (gi->receive)
		gi->receive->written = false;
}

const receiver_place *receive_place(const gi_context *gi, const receiver_set *set)
{
	const bool written = set->committed && gi->receive && gi->receive->written;
	return written ? &gi->scene.sets[set->place] : NULL;
}

void receive_free(gi_context *gi)
{
	gi_receive *owner = gi->receive;
	if (!owner)
		return;
	uint32_t *programs[] = {&owner->factor_program, &owner->trace_program, &owner->tops_program};
	for (int k = 0; k < RECEIVE_KINDS; k++)
		gpu_program_free(&gi->gpu, &owner->programs[k]);
	for (size_t k = 0; k < sizeof programs / sizeof *programs; k++)
		gpu_program_free(&gi->gpu, programs[k]);
	RECEIVER_BUFFERS(BUFFER_FREE)
	gi_free(owner);
	gi->receive = NULL;
}
