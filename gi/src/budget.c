/* Updates that may not refresh every row: which rows go first, and what those that wait may be off by.
 *
 *   light_bounds     the range of B of each object
 *   survey           of every row: whether anything changed, a bound on what refreshing it changes for all that is
 *                    known without its entries, the bucket of its priority
 *   choose, enlist   the rows to assess: as many as fit into a budget of time, all without one
 *   assess           of those: the rays that they take, a bound that asks their entries, the bucket of their priority
 *   choose, enlist   the rows to refresh, in a list that cut, flag and close work through
 *   (rows, solve)
 *   stale            the largest bound of a row that waits
 *
 * Let B solve the rows that are there and B* those that an exact update would have. |B - B*| <= d + rho F* |B - B*|
 * leaf by leaf, d bounding what refreshing the row changes at B; since no row sums to more than 1, the leaf that is off
 * most bounds them all: |B - B*| <= max d / (1 - rho). The B of the frame is within solve_bound of B.
 *
 * A budget of time is shared out to what updates before were seen to take: a solve and rows to assess get their shares
 * of it, but a sweep and LEAST_ROWS at least, and rays what is left.
 */
#include "budget.h"

#include "bits.h"
#include "context.h"
#include "state.h"
#include "view.h"

#include <math.h>

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
	if (budget->view && !view_is_finite(budget->view))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "budget.view: a matrix is not finite");
	if (budget->ms > 0 && !gi->def.profile)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT,
			       "budget.ms needs the GPU timers: set gi_context_def.profile, or give budget.rays");
	return GI_OK;
}

gi_result budget_allocate(gi_context *gi)
{
	gi_budget_state *r = &gi->budget;
	gpu *g = &gi->gpu;
	if (!r->made) {
		const gpu_program_file programs[] = {{"light_bounds.comp", &r->light_bounds_program},
						     {"survey.comp", &r->survey_program},
						     {"assess.comp", &r->assess_program},
						     {"choose.comp", &r->choose_program},
						     {"enlist.comp", &r->enlist_program},
						     {"stale.comp", &r->stale_program},
						     {"lend.comp", &r->lend_program}};
		const gi_result result = gpu_programs_compute(g, programs, sizeof programs / sizeof *programs);
		if (result)
			return result;
		r->made = true;
	}
	const uint64_t leaves = scene_row_count(&gi->scene), slots = gi->scene.slot_count;
	const struct {
		gpu_buffer *buffer;
		const char *label;
		uint64_t bytes;
	} sizes[] = {
	    {&r->choices, buffer_labels.CHOICES, sizeof(uint32_t) * (GI_CHOICE_CHOSEN + 2 * leaves)},
	    {&r->pending, buffer_labels.PENDING, sizeof(gi_pending) * leaves},
	    {&r->light_bounds, buffer_labels.LIGHT_BOUNDS, sizeof(uint32_t) * GI_LIGHT_BOUND_WORDS * (slots + 1)}};
	gi_result result = GI_OK;
	for (size_t k = 0; !result && k < sizeof sizes / sizeof *sizes; k++) {
		gpu_buffer *buffer = sizes[k].buffer;
		if (buffer->name && buffer->size >= sizes[k].bytes)
			continue;
		result = gpu_buffer_allocate(g, buffer, sizes[k].label, sizes[k].bytes, NULL);
		if (!result)
			gpu_buffer_clear(&gi->gpu, buffer, 0, buffer->size, 0); /* no row was assessed */
	}
	return result;
}

/* ---- limits ---- */

static bool is_timed(const gi_budget *budget)
{
	return budget && budget->ms > 0;
}

gi_budget budget_less(const gi_budget *budget, float ms)
{
	gi_budget left = *budget;
	left.ms = budget->ms > 0 ? fmaxf(GI_COSTS_LEAST_SHARE * budget->ms, budget->ms - ms) : 0;
	return left;
}

static gi_vec4 matrix_row(const float matrix[16], int row)
{
	return (gi_vec4){matrix[row], matrix[4 + row], matrix[8 + row], matrix[12 + row]};
}

/* Whose picture counts. */
static void set_view(const gi_view *view, gi_frame *frame)
{
	float clip[16], eye[4];
	view_clip_from_world(view, clip);
	view_eye(view, eye);
	frame->update.w |= GI_UPDATE_VIEWED;
	frame->view_x = matrix_row(clip, 0);
	frame->view_y = matrix_row(clip, 1);
	frame->view_w = matrix_row(clip, 3);
	frame->view_eye = (gi_vec4){eye[0], eye[1], eye[2], eye[3]};
}

void budget_limits(gi_context *gi, const gi_budget *budget, gi_frame *frame)
{
	const gi_costs *c = &gi->budget.costs;
	double rays = budget->rays ? (double)budget->rays : INFINITY, rows = INFINITY;
	if (is_timed(budget)) {
		frame->update.w |= GI_UPDATE_TIMED;
		rays = fmin(rays, gi_costs_rays(c, budget->ms));
		rows = gi_costs_rows(c, budget->ms);
	}
	gi->budget.last = *budget;
	gi->budget.last.view = NULL; /* the host's, for this update alone */
	if (budget->view)
		set_view(budget->view, frame);
	frame->limit = (gi_vec4){(float)fmin(rays, 4e9), budget->error, 0, 0};
	frame->budget.z = (uint32_t)fmin(rows, scene_row_count(&gi->scene));
}

bool budget_times_solve(const gi_context *gi, const gi_budget *budget)
{
	/* The first rows get a whole solve. */
	return is_timed(budget) && gi->budget.in_force;
}

uint32_t budget_sweeps(const gi_context *gi, const gi_budget *budget)
{
	return (uint32_t)fmin(gi_costs_sweeps(&gi->budget.costs, budget->ms), gi->def.max_sweeps);
}

/* ---- what updates take ---- */

static float assess_ms(const gi_context *gi)
{
	return gpu_timer_ms(&gi->budget.assess_timer, gi->report.frame);
}

float budget_choose_ms(const gi_context *gi)
{
	return gpu_timer_ms(&gi->timers[GI_PASS_CHOOSE], gi->report.frame) + assess_ms(gi);
}

static float pass_sum(const gi_report *report, const gi_pass *passes, size_t count)
{
	float sum = 0;
	for (size_t k = 0; k < count; k++)
		sum += report->pass_ms[passes[k]];
	return sum;
}

void budget_learn(gi_context *gi)
{
	static const gi_pass fixed[] = {GI_PASS_POSE,  GI_PASS_CHOOSE, GI_PASS_LIGHTS,
					GI_PASS_SOLVE, GI_PASS_LIGHT,  GI_PASS_RECEIVE};
	static const gi_pass by_ray[] = {GI_PASS_CUT, GI_PASS_FACTOR, GI_PASS_FLAG, GI_PASS_TRACE, GI_PASS_CLOSE};
	const gi_report *report = &gi->report;
	gi_budget_state *r = &gi->budget;
	if (!gi->def.profile || report->frame == r->learned)
		return;
	r->learned = report->frame;
	gi_spent spent = {.rays = report->rays - report->light_rays,
			  .rows = report->assessed_rows,
			  .sweeps = report->sweeps,
			  .late = r->late,
			  .by_ray = pass_sum(report, by_ray, sizeof by_ray / sizeof *by_ray),
			  .by_row = assess_ms(gi),
			  .by_sweep = report->pass_ms[GI_PASS_SOLVE],
			  .fixed = pass_sum(report, fixed, sizeof fixed / sizeof *fixed)};
	/* On a software renderer the CPU waits for each pass: all else that gi_update does is time too. A commit is not
	 * what updates take: it is taken off the budget of the one that it is in. */
	if (gi->gpu.software)
		spent.fixed =
		    fmaxf(spent.fixed,
			  report->update_ms - gi->issued[report->frame % GPU_READBACK_RING].commit_ms - spent.by_ray);
	gi_costs_learn(&r->costs, &spent);
}

/* part / whole; 0 where part is 0, 3e38 where it is more than that. */
static float share_of(float part, float whole)
{
	static const float most = 3e38f;
	if (part <= 0)
		return 0;
	return part / most < whole ? part / whole : most;
}

void budget_report(const gi_state *state, gi_report *out)
{
	out->waiting_rows = state->refresh.waiting_rows;
	out->waiting_entries = state->refresh.waiting_entries;
	out->assessed_rows = state->counts.assessed_rows;
	out->stale_bound = out->stale_relative = 0;
	if (!out->waiting_rows)
		return;
	out->stale_bound = gi_float_from_bits(state->counts.stale_bits);
	out->stale_relative = share_of(out->stale_bound, out->reflected_max);
}

/* ---- passes ---- */

/* Stages of choose.comp, and of enlist.comp halved. */
enum { ASSESS = 0, ASSESS_GROUPS = 1, REFRESH = 2, REFRESH_GROUPS = 3 };

static void run_stage(gi_context *gi, uint32_t stage)
{
	gpu_set_uint(&gi->gpu, gi->budget.choose_program, 0, stage);
	gpu_dispatch_groups(&gi->gpu, gi->budget.choose_program, 1);
}

/* Lists the rows to assess, or to refresh. */
static void enlist(gi_context *gi, uint32_t stage)
{
	run_stage(gi, stage);
	gpu_set_uint(&gi->gpu, gi->budget.enlist_program, 0, stage / REFRESH);
	gpu_dispatch(&gi->gpu, gi->budget.enlist_program, scene_row_count(&gi->scene));
	run_stage(gi, stage + 1);
}

void budget_choose(gi_context *gi)
{
	gi_budget_state *r = &gi->budget;
	gpu *g = &gi->gpu;
	gpu_timer_begin(g, &gi->timers[GI_PASS_CHOOSE]);
	gpu_buffer_clear(&gi->gpu, &r->light_bounds, 0, r->light_bounds.size, 0);
	gpu_buffer_clear(&gi->gpu, &r->choices, 0, sizeof(uint32_t) * GI_CHOICE_CHOSEN, 0);
	gpu_dispatch_groups(g, r->light_bounds_program, gi->scene.slot_count);
	gpu_dispatch(g, gi->specular_rows ? gi->specular_rows->survey_program : r->survey_program,
		     scene_row_count(&gi->scene));
	enlist(gi, ASSESS);
	gpu_timer_end(g, &gi->timers[GI_PASS_CHOOSE]);
	gpu_timer_begin(g, &r->assess_timer);
	gpu_dispatch_indirect(g, gi->specular_rows ? gi->specular_rows->assess_program : r->assess_program, &gi->state,
			      STATE_OFFSET(assess));
	enlist(gi, REFRESH);
	gpu_timer_end(g, &r->assess_timer);
}

void budget_bound(gi_context *gi)
{
	gi_budget_state *r = &gi->budget;
	STATE_CLEAR(gi, budget.step_bits);
	for (uint32_t stage = 0; stage < 2; stage++) {
		gpu_set_uint(&gi->gpu, r->stale_program, 0, stage);
		gpu_dispatch(&gi->gpu, r->stale_program, gi->scene.leaf_count);
	}
}

void budget_free(gi_context *gi)
{
	gi_budget_state *owner = &gi->budget;
	BUDGET_BUFFERS(BUFFER_FREE)
	uint32_t *programs[] = {&owner->light_bounds_program, &owner->survey_program, &owner->assess_program,
				&owner->choose_program,       &owner->enlist_program, &owner->stale_program,
				&owner->lend_program};
	for (size_t k = 0; k < sizeof programs / sizeof *programs; k++)
		gpu_program_free(&gi->gpu, programs[k]);
	gpu_timer_free(&gi->gpu, &owner->assess_timer);
}
