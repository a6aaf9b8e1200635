/* Updates that may not refresh every row: which rows go first, and what those that wait may be off by.
 *
 *   shine    the range of B of each object
 *   assess   of every row: the rays that it takes, a bound on what refreshing it changes, the bucket of its priority
 *   choose   the lowest bucket that the budget reaches
 *   enlist   the rows to refresh, in a list that cut, flag and close work through
 *   (rows, solve)
 *   stale    the largest bound of a row that waits
 *
 * Let B solve the rows that are there and B* those that an exact update would have. |B - B*| <= d + rho F* |B - B*|
 * leaf by leaf, d bounding what refreshing the row changes at B; since no row sums to more than 1, the leaf that is off
 * most bounds them all: |B - B*| <= max d / (1 - rho). The B of the frame is within solve_bound of B.
 */
#include "bits.h"
#include "context.h"

#include <math.h>

/* A frame's ray costs change slowly; a single timing is noise. */
static const float LEARNING = 0.3f;

/* Fewer rays tell the price of dispatches, not of rays. */
static const uint64_t RAYS_TO_LEARN = 2000;

/* However little time is left, some rows are refreshed. */
static const float LEAST_SHARE = 0.1f;

bool budget_is_exact(const gi_budget *budget)
{
	return !budget || (budget->ms <= 0 && !budget->rays && budget->error <= 0);
}

gi_result budget_check(const gi_context *gi, const gi_budget *budget)
{
	const gi_log *log = &gi->gpu.log;
	if (!budget)
		return GI_OK;
	if (!(budget->ms >= 0 && isfinite(budget->ms)))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "budget.ms %g must be finite and not negative",
			       (double)budget->ms);
	if (!(budget->error >= 0 && budget->error <= 1))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "budget.error %g is outside [0, 1]",
			       (double)budget->error);
	if (budget->ms > 0 && !gi->def.profile)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT,
			       "budget.ms needs the GPU timers: set gi_context_def.profile, or give budget.rays");
	return GI_OK;
}

gi_result budget_allocate(gi_context *gi)
{
	gi_rations *r = &gi->rations;
	gpu *g = &gi->gpu;
	if (!r->made) {
		const gpu_program_file programs[] = {{"shine.comp", &r->shine_program},
						     {"assess.comp", &r->assess_program},
						     {"choose.comp", &r->choose_program},
						     {"enlist.comp", &r->enlist_program},
						     {"stale.comp", &r->stale_program}};
		const gi_result result = gpu_programs_compute(g, programs, sizeof programs / sizeof *programs);
		if (result)
			return result;
		r->made = true;
	}
	const uint64_t leaves = gi->scene.leaf_count, slots = gi->scene.slot_count;
	const struct {
		gpu_buffer *buffer;
		uint64_t bytes;
	} sizes[] = {{&r->choices, sizeof(uint32_t) * (GI_BUCKETS + leaves)},
		     {&r->pending, sizeof(gi_pending) * leaves},
		     {&r->shine, sizeof(uint32_t) * GI_SHINE_WORDS * slots}};
	gi_result result = GI_OK;
	for (size_t k = 0; !result && k < sizeof sizes / sizeof *sizes; k++)
		if (!sizes[k].buffer->name || sizes[k].buffer->size < sizes[k].bytes)
			result = gpu_buffer_allocate(g, sizes[k].buffer, sizes[k].bytes, NULL);
	return result;
}

/* ---- limits ---- */

static float pass_sum(const gi_context *gi, const gi_pass *passes, size_t count)
{
	float sum = 0;
	for (size_t k = 0; k < count; k++)
		sum += gi->timers[passes[k]].ms;
	return sum;
}

/* The rays that fit into the time left by the passes that a budget does not shorten. */
static double rays_in(const gi_context *gi, float ms)
{
	static const gi_pass fixed[] = {GI_PASS_POSE, GI_PASS_CHOOSE, GI_PASS_SOLVE, GI_PASS_LIGHT};
	const float left = fmaxf(LEAST_SHARE * ms, ms - pass_sum(gi, fixed, sizeof fixed / sizeof *fixed));
	return gi->rations.ms_per_ray > 0 ? (double)(left / gi->rations.ms_per_ray) : INFINITY;
}

void budget_limits(gi_context *gi, const gi_budget *budget, gi_vec4 *limit)
{
	double rays = budget->rays ? (double)budget->rays : INFINITY;
	if (budget->ms > 0)
		rays = fmin(rays, rays_in(gi, budget->ms));
	gi->rations.error = budget->error;
	*limit = (gi_vec4){(float)fmin(rays, 4e9), budget->error, 0, 0};
}

void budget_learn(gi_context *gi)
{
	static const gi_pass by_ray[] = {GI_PASS_CUT, GI_PASS_FACTOR, GI_PASS_FLAG, GI_PASS_TRACE, GI_PASS_CLOSE};
	const gi_report *report = &gi->report;
	gi_rations *r = &gi->rations;
	if (!gi->def.profile || report->frame == r->learned || report->rays < RAYS_TO_LEARN)
		return;
	const float ms_per_ray = pass_sum(gi, by_ray, sizeof by_ray / sizeof *by_ray) / (float)report->rays;
	if (ms_per_ray > 0)
		r->ms_per_ray += (r->ms_per_ray > 0 ? LEARNING : 1) * (ms_per_ray - r->ms_per_ray);
	r->learned = report->frame;
}

void budget_report(const uint32_t *state, gi_report *out)
{
	out->waiting_rows = state[GI_STATE_WAITING_ROWS];
	out->waiting_entries = state[GI_STATE_WAITING_ENTRIES];
	out->stale_bound = out->stale_relative = 0;
	if (!out->waiting_rows)
		return;
	out->stale_bound = gi_float_from_bits(state[GI_STATE_STALE_BITS]);
	out->stale_relative = out->radiosity_max > 0 ? out->stale_bound / out->radiosity_max : 0;
}

/* ---- passes ---- */

void budget_choose(gi_context *gi)
{
	gi_rations *r = &gi->rations;
	gpu *g = &gi->gpu;
	gpu_timer_begin(g, &gi->timers[GI_PASS_CHOOSE]);
	gpu_buffer_clear(&r->shine, 0, r->shine.size, 0);
	gpu_buffer_clear(&r->choices, 0, sizeof(uint32_t) * GI_BUCKETS, 0);
	gpu_dispatch(g, r->shine_program, gi->scene.leaf_count);
	gpu_dispatch(g, r->assess_program, gi->scene.leaf_count);
	gpu_set_uint(r->choose_program, 0, 0);
	gpu_dispatch_groups(g, r->choose_program, 1);
	gpu_dispatch(g, r->enlist_program, gi->scene.leaf_count);
	gpu_set_uint(r->choose_program, 0, 1);
	gpu_dispatch_groups(g, r->choose_program, 1);
	gpu_timer_end(g, &gi->timers[GI_PASS_CHOOSE]);
}

void budget_bound(gi_context *gi)
{
	gi_rations *r = &gi->rations;
	gpu_buffer_clear(&gi->state, sizeof(uint32_t) * GI_STATE_STEP_BITS, sizeof(uint32_t), 0);
	for (uint32_t stage = 0; stage < 2; stage++) {
		gpu_set_uint(r->stale_program, 0, stage);
		gpu_dispatch(&gi->gpu, r->stale_program, gi->scene.leaf_count);
	}
}

void budget_bind(const gi_context *gi)
{
	const gi_rations *r = &gi->rations;
	gpu_bind(GI_BIND_CHOICES, &r->choices);
	gpu_bind(GI_BIND_PENDING, &r->pending);
	gpu_bind(GI_BIND_SHINE, &r->shine);
}

void budget_free(gi_context *gi)
{
	gi_rations *r = &gi->rations;
	gpu_buffer *buffers[] = {&r->choices, &r->pending, &r->shine};
	for (size_t k = 0; k < sizeof buffers / sizeof *buffers; k++)
		gpu_buffer_free(&gi->gpu, buffers[k]);
	uint32_t *programs[] = {&r->shine_program, &r->assess_program, &r->choose_program, &r->enlist_program,
				&r->stale_program};
	for (size_t k = 0; k < sizeof programs / sizeof *programs; k++)
		gpu_program_free(programs[k]);
}
