/* The solve: Jacobi, or Chebyshev where that would be slow, from last frame's B until the certified bound meets the
 * tolerance; then the light of what is drawn.
 *
 * A sweep is gather (leaves; in single precision, or in double where that would not do), hand_over (to the nodes that
 * links lead to, those of leaves) and check, which chooses the next gather and ends the solve, on the GPU, by zeroing
 * the group counts of what is queued but not wanted: no read-back in the frame. After the last one pull gives all other
 * nodes their area means. Every sweep certifies its bound and leaves the light too, so that a solve may end with any:
 * under a budget of time it takes as many as fit, and the next update goes on from there.
 */
#include "solver.h"

#include "binding.h"
#include "caustics.h"
#include "context.h"
#include "state.h"

#include <string.h>

/* check.comp's uniforms, and what its stage may be. */
enum { CHECK_STAGE = 0, CHECK_MAX_SWEEPS = 1 };
enum { STAGE_SWEPT = 0, STAGE_BEGIN = 1, STAGE_GO_ON = 2 };

/* A cold start takes a step; one in the place of a warm start that was refused, the refused sweep too. Where to begin
 * takes a step to set, and where one sweep is all there is, that sweep. Coming back from steps that went astray takes
 * the place of a sweep, but after the last: then it takes a step and a sweep to certify what came back. */
enum { SPARE_SWEEPS = 6 };

/* What begins a solve is weighed: the first sweep, the one behind the step of a cold start, and the one behind both. */
enum { WEIGHED_SWEEPS = 3 };

void solver_programs(gi_solver *s, gpu_program_file list[SOLVER_PROGRAMS])
{
	const gpu_program_file programs[SOLVER_PROGRAMS] = {{"emitted.comp", &s->emitted_program},
							    {"gather.comp", &s->gather_program},
							    {"gather_double.comp", &s->double_program},
							    {"weigh.comp", &s->weigh_program},
							    {"pull.comp", &s->pull_program},
							    {"pull_large.comp", &s->large_program},
							    {"check.comp", &s->check_program},
							    {"start.comp", &s->start_program},
							    {"light.comp", &s->light_program},
							    {"hand_over.comp", &s->hand_over_program}};
	memcpy(list, programs, sizeof programs);
}

/* What start.comp writes, for nodes (to_leaves false) or for leaves; other parts of their buffers are 0. */
static void fill_start(const gi_scene *s, bool to_leaves, gi_vec4 *out)
{
	for (uint32_t n = 0; n < s->node_count; n++) {
		const gi_uvec4 range = s->topology[n].range;
		const bool sky = range.w & GI_NODE_SKY;
		const gi_vec4 e = s->node_exitance[n], b = {e.x, e.y, e.z, 0}, r = {0, 0, 0, sky ? 0 : 1};
		if (!to_leaves) {
			out[GI_NODE_B * s->node_count + n] = b;
			out[GI_NODE_R * s->node_count + n] = r;
		} else if (!sky && (range.w & GI_NODE_LEAF)) {
			out[GI_LEAF_B * s->leaf_count + range.y] = b;
			out[GI_LEAF_R * s->leaf_count + range.y] = r;
			out[GI_LEAF_BEFORE * s->leaf_count + range.y] = r;
		}
	}
}

static gi_result allocate_start(gi_context *gi, gpu_buffer *buffer, uint32_t binding, bool to_leaves)
{
	const gi_scene *s = &gi->scene;
	const uint64_t count =
	    to_leaves ? GI_LEAF_PARTS * (uint64_t)s->leaf_count : GI_NODE_PARTS * (uint64_t)s->node_count;
	gi_arena_measure(&gi->passing);
	gi_arena_take(&gi->passing, count, sizeof(gi_vec4));
	if (!gi_arena_reserve(&gi->passing))
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	gi_vec4 *start = gi_arena_take(&gi->passing, count, sizeof *start);
	memset(start, 0, sizeof *start * count);
	fill_start(s, to_leaves, start);
	return gpu_buffer_renew(&gi->gpu, buffer, binding, sizeof *start * count, start);
}

gi_result solver_allocate(gi_context *gi)
{
	gi_solver *s = &gi->solver;
	const gi_scene *scene = &gi->scene;
	const uint64_t vec = sizeof(gi_vec4);
	gi_result result = allocate_start(gi, &s->radiosity, GI_BIND_RADIOSITY, false);
	if (!result)
		result = allocate_start(gi, &s->leaf_radiosity, GI_BIND_LEAF_RADIOSITY, true);
	if (!result)
		result =
		    gpu_buffer_renew(&gi->gpu, &s->leaf_indirect, GI_BIND_LEAF_INDIRECT, vec * scene->leaf_count, NULL);
	if (!result)
		result = gpu_buffer_renew(&gi->gpu, &s->light, GI_BIND_LIGHT, vec * scene->light_count, NULL);
	if (result)
		return result;
	gpu_buffer_clear(&gi->gpu, &s->leaf_indirect, 0, s->leaf_indirect.size, 0);
	gpu_buffer_clear(&gi->gpu, &s->light, 0, s->light.size, 0);
	return GI_OK;
}

/* weigh: may the sweep be one that begins the solve? */
static void sweep(gi_context *gi, bool weigh)
{
	const gi_solver *s = &gi->solver;
	const gi_specular_rows *through = gi->specular_rows;
	uint32_t in_single = through ? through->gather_program : s->gather_program,
		 in_double = through ? through->double_program : s->double_program;
	const bool diffuses = diffusion_gathers(gi, &in_single, &in_double);
	gpu_dispatch_indirect(&gi->gpu, in_single, &gi->state, STATE_OFFSET(gather));
	gpu_dispatch_indirect(&gi->gpu, in_double, &gi->state, STATE_OFFSET(gather_double));
	if (diffuses)
		diffusion_sweep(gi);
	if (weigh)
		gpu_dispatch_groups(&gi->gpu, s->weigh_program, 1);
	gpu_dispatch_indirect(&gi->gpu, s->hand_over_program, &gi->state, STATE_OFFSET(hand_over));
	gpu_dispatch_indirect(&gi->gpu, s->check_program, &gi->state, STATE_OFFSET(check));
}

/* A software renderer has done all that was asked of it, so that to look costs nothing; what is queued and not wanted
 * costs it some microseconds a dispatch. */
static bool is_known_to_be_over(const gi_context *gi)
{
	uint32_t groups = 1;
	if (gi->gpu.software)
		gpu_buffer_read(&gi->gpu, &gi->state, STATE_OFFSET(check.x), sizeof groups, &groups);
	return !groups;
}

/* Does anything shine? Where nothing does the solution is B = E = 0, which sweeps from a bright start would approach
 * for ever: the solve starts from there. */
static bool is_lit(const gi_context *gi)
{
	const gi_scene *s = &gi->scene;
	if (light_list_shines(&gi->light_list))
		return true;
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		const gi_vec4 e = s->node_exitance[s->object_data[slot].nodes.x];
		if (e.x + e.y + e.z > 0)
			return true;
	}
	return false;
}

/* What is emitted into each row, of the rows that this update refreshed or of all, and the bounds that follow. */
static void gather_emitted(gi_context *gi)
{
	STATE_CLEAR(gi, emitted);
	const bool through = gi->specular_rows, caustics = caustics_light(gi);
	const uint32_t punctual = punctual_emitted_program(gi);
	const uint32_t program = punctual  ? punctual
				 : through ? gi->specular_rows->emitted_program
					   : gi->solver.emitted_program;
	if (through) {
		gpu_set_uint(&gi->gpu, program, 1, !gi->def.pixel_lamps);
		gpu_set_uint(&gi->gpu, program, 2, caustics);
	}
	if (caustics)
		caustics_bind_light(gi);
	gpu_set_uint(&gi->gpu, program, 0,
		     through || gi->diffusion || program != gi->solver.emitted_by ||
			 (gi->frame.update.w & (GI_UPDATE_MATERIAL | GI_UPDATE_REBUILD)) != 0);
	gpu_dispatch(&gi->gpu, program, gi->scene.leaf_count);
	gi->solver.emitted_by = program;
	if (punctual)
		bind_rows(gi);
	if (gi->diffusion)
		diffusion_emitted(gi);
}

static void solve(gi_context *gi, uint32_t stage, uint32_t sweeps)
{
	gi_solver *s = &gi->solver;
	const bool cold = s->cold || !is_lit(gi);
	rows_progress(gi, GI_PASS_SOLVE);
	gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_SOLVE]);
	if (stage == STAGE_BEGIN)
		gather_emitted(gi);
	if (cold)
		gpu_dispatch(&gi->gpu, s->start_program, gi->scene.node_count);
	gpu_set_uint(&gi->gpu, s->check_program, CHECK_STAGE, stage);
	gpu_set_uint(&gi->gpu, s->check_program, CHECK_MAX_SWEEPS, sweeps);
	gpu_dispatch_groups(&gi->gpu, s->check_program, 1);
	gpu_set_uint(&gi->gpu, s->check_program, CHECK_STAGE, STAGE_SWEPT);
	for (uint32_t k = 0; k < sweeps + SPARE_SWEEPS && !is_known_to_be_over(gi); k++)
		sweep(gi, k < WEIGHED_SWEEPS && stage == STAGE_BEGIN);
	gpu_dispatch(&gi->gpu, s->pull_program, gi->scene.node_count);
	gpu_dispatch_groups(&gi->gpu, s->large_program, gi->scene.large_count);
	gpu_timer_end(&gi->gpu, &gi->timers[GI_PASS_SOLVE]);
}

void solver_update(gi_context *gi, bool anew, const gi_budget *budget)
{
	gi_solver *s = &gi->solver;
	const bool timed = budget_times_solve(gi, budget);
	const bool begin = anew || s->cold || !is_lit(gi);
	bind_all(gi);
	if (gi->diffusion)
		diffusion_bind(gi);
	solve(gi, begin ? STAGE_BEGIN : STAGE_GO_ON, timed ? budget_sweeps(gi, budget) : gi->def.max_sweeps);
	s->cold = false;
	if (gi->diffusion)
		bind_all(gi);

	rows_progress(gi, GI_PASS_LIGHT);
	gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_LIGHT]);
	gpu_dispatch(&gi->gpu, s->light_program, gi->scene.light_count);
	gpu_timer_end(&gi->gpu, &gi->timers[GI_PASS_LIGHT]);
}

void solver_forget(gi_solver *owner)
{
	SOLVER_BUFFERS(BUFFER_FORGET)
}

void solver_release(gi_context *gi, gi_solver *owner)
{
	SOLVER_BUFFERS(BUFFER_FREE)
}

void solver_retire(gi_context *gi, gi_solver *owner)
{
	SOLVER_BUFFERS(BUFFER_RETIRE)
}
