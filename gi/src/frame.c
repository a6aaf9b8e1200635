/* A frame: what changed, rows and solve issued, reports taken in when the GPU is done with them. */
#include "bits.h"
#include "caustics.h"
#include "clock.h"
#include "commit.h"
#include "context.h"
#include "emitters.h"
#include "host_memory.h"
#include "programs.h"
#include "reshape.h"
#include "probes.h"
#include "receive.h"
#include "receiver_sets.h"
#include "specular.h"

#include <math.h>
#include <string.h>

static gi_outcome outcome_of(const gi_state *state)
{
	if (state->counts.not_finite)
		return GI_OUTCOME_NOT_FINITE;
	if (state->counts.overflow)
		return GI_OUTCOME_TRUNCATED;
	if (state->solve.verdict == GI_SOLVE_ROUNDING)
		return GI_OUTCOME_ROUNDING;
	return state->solve.verdict == GI_SOLVE_CONVERGED ? GI_OUTCOME_CONVERGED : GI_OUTCOME_SWEEPS;
}

static gi_method method_of(const gi_state *state)
{
	/* Sweeps of GI_MANNER_POLISH count as those of the method before them. */
	const bool chebyshev = state->solve.reach > 0 && state->solve.manner != GI_MANNER_GIVEN_UP;
	return chebyshev ? GI_METHOD_CHEBYSHEV : GI_METHOD_JACOBI;
}

static void fill_report(gi_context *gi, const gi_state *state, uint64_t frame)
{
	gi_report *r = &gi->report;
	const uint32_t ring = (uint32_t)(frame % GPU_READBACK_RING);
	r->frame = frame;
	r->outcome = outcome_of(state);
	r->entries = state->rows.entries;
	r->links = state->rows.links;
	r->new_entries = state->counts.new_entries;
	r->dirty_entries = state->counts.queued;
	r->flagged_entries = r->dirty_entries - r->new_entries;
	r->dirty_rows = state->counts.dirty_rows;
	r->closed_rows = state->counts.changed_rows;
	r->rays = state->counts.rays;
	r->light_rays = state->counts.light_rays;
	r->sweeps = gi->issued[ring].solved ? state->solve.sweeps : 0;
	r->jacobi_sweeps = state->solve.jacobi_sweeps;
	r->method = method_of(state);
	r->residual = state->solve.residual;
	r->contraction = state->solve.contraction;
	r->solve_bound = state->solve.bound;
	r->solve_relative = state->solve.bound_relative;
	r->rounding_bound = state->solve.rounding;
	r->amplification = state->solve.amplification;
	r->radiosity_max = state->solve.largest_b;
	r->reflected_max = fmaxf(state->solve.scale.x, fmaxf(state->solve.scale.y, state->solve.scale.z));
	if (gi->scene.leaf_count == 0) { /* no sweep ran: the values are those of an earlier scene */
		r->residual = r->contraction = r->radiosity_max = r->reflected_max = 0;
		r->amplification = 1;
	}
	budget_report(state, r);
	const float squared = state->estimate.squared;
	const float power = state->estimate.power;
	r->sampling_estimate = squared > 0 ? sqrtf(squared) : 0;
	r->sampling_relative = squared > 0 && power > 0 ? sqrtf(squared / power) : 0;
	r->sampling_squared = squared;
	r->sampling_local_squared = state->estimate.local;
	r->sampling_local = sqrtf(fmaxf(0, r->sampling_local_squared));
	r->sampling_rays = state->estimate.rays;
	r->dispatches = gi->issued[ring].dispatches;
	r->uploaded_bytes = gi->issued[ring].uploaded_bytes;
	r->update_ms = gi->issued[ring].update_ms;
}

/* Rows of the newest report: may the next update be at rest, and how far back must it look? */
static void take_waiting(gi_context *gi, const gi_state *state, uint64_t frame)
{
	const uint32_t update = gi->issued[frame % GPU_READBACK_RING].rows_update;
	gi->budget.late = state->refresh.late_rows > 0;
	if (!state->refresh.waiting_rows && !state->counts.overflow && update > gi->rows.current)
		gi->rows.current = update;
}

/* What each pass of the reported update took; 0 for those that did not run in it. */
static void fill_passes(gi_context *gi)
{
	gi_report *r = &gi->report;
	for (int k = 0; k < GI_PASS_SHADOW; k++)
		r->pass_ms[k] = gpu_timer_ms(&gi->timers[k], r->frame);
	if (r->pass_ms[GI_PASS_CHOOSE] > 0)
		r->pass_ms[GI_PASS_CHOOSE] = budget_choose_ms(gi);
}

/* Takes in every finished read-back, or waits for all of them. */
static void collect_reports(gi_context *gi, bool wait)
{
	gi_state state;
	uint64_t frame;
	bool fresh = false;
	while (gpu_readback_take(&gi->gpu, &gi->readback, wait, &state, &frame)) {
		fill_report(gi, &state, frame);
		fresh = true;
		if (frame <= gi->rows_frame)
			continue;
		take_waiting(gi, &state, frame);
		const gi_outcome outcome = gi->report.outcome;
		gi->solver.unconverged = outcome != GI_OUTCOME_CONVERGED && outcome != GI_OUTCOME_ROUNDING;
		if (gi->report.outcome != GI_OUTCOME_TRUNCATED)
			continue;
		gi->truncated = true;
		gi->wanted = GI_BLOCK_SMALLEST * (uint64_t)state.refresh.wanted;
		gi->wanted_all = gi->issued[frame % GPU_READBACK_RING].rebuilt;
	}
	for (int k = 0; k < GI_PASS_COUNT; k++)
		gpu_timer_poll(&gi->gpu, &gi->timers[k], wait);
	gpu_timer_poll(&gi->gpu, &gi->budget.assess_timer, wait);
	if (fresh) {
		fill_passes(gi);
		budget_learn(gi);
	}
}

/* Do rows wait that this budget would not let wait? */
static bool rows_are_due(const gi_context *gi, const gi_budget *budget)
{
	const bool waiting = gi->rows.current < gi->rows.update;
	return waiting && (budget_is_exact(budget) || gi->budget.late || budget->error < gi->budget.last.error);
}

/* What an update has to do again. */
typedef struct changes {
	bool rows;
	bool light;     /* values of materials alone: the solve begins anew, rows are what they were */
	bool receivers; /* rows of receivers alone: the solve knows nothing of them */
} changes;

static changes changed_objects(gi_context *gi)
{
	changes c = {.receivers = receiver_sets_changed(gi)};
	for (uint32_t k = 0; k < gi->scene.object_count; k++) {
		const object_record *o = &gi->scene.objects[k];
		c.rows = c.rows || (o->committed && (o->moved || o->relit));
		c.light = c.light || (o->committed && o->material_changed);
	}
	return c;
}

static gi_result find_changes(gi_context *gi, const gi_budget *budget, changes *c)
{
	*c = changed_objects(gi);
	c->light =
	    c->light || gi->solve_changed || gi->light_changed || gi->light_list.changed || caustics_are_late(gi);
	const bool waiting = gi->rows.current < gi->rows.update;
	c->rows = c->rows || gi->rows.rebuild || gi->rows.kept || rows_are_due(gi, budget);
	/* Among rows that are refreshed for receivers may be some of leaves then. */
	c->rows = c->rows || (c->receivers && waiting);
	if (!c->light || c->rows)
		return GI_OK;
	/* Bounds of rows that wait were made with the materials of before. */
	/* Another emitter may change how fine others are cut. */
	const gi_result result = emitters_weigh(gi);
	c->rows = waiting || changed_objects(gi).rows;
	return result;
}

static void changes_done(gi_context *gi)
{
	gi->solve_changed = gi->light_changed = false;
	light_list_seen(&gi->light_list);
	for (uint32_t k = 0; k < gi->scene.object_count; k++) {
		object_record *o = &gi->scene.objects[k];
		o->moved = o->relit = o->material_changed = o->arrives = o->came = o->reshaped = false;
	}
	receiver_sets_done(gi);
}

/* Pictures and chances of leaves are made of the objects that are seen. */
static void forget_what_was_shown(gi_context *gi)
{
	if (!gi->scene.shown_changed)
		return;
	shade_invalidate(gi);
	estimate_invalidate(gi);
	gi->scene.shown_changed = false;
}

/* Through mirrors and glass, below surfaces, and from lights without a surface. Rows know by now what changed: where it
 * fails the next update must begin it again. */
static gi_result light_beside_rows(gi_context *gi, const gi_budget *budget)
{
	gi_result result = diffusion_update(gi);
	if (!result)
		result = caustics_update(gi, budget);
	if (!result)
		result = punctual_update(gi);
	if (result) {
		caustics_invalidate(gi);
		punctual_invalidate(gi);
		gi->light_changed = true;
	}
	return result;
}

/* Does the solve take more sweeps although nothing changed? Not before it is known that the last ones were too few. */
static bool solve_goes_on(const gi_context *gi)
{
	return gi->solver.cold || (gi->solver.unconverged && gi->report.frame >= gi->solved_frame);
}

/* A step of rows and solve; queues its report. */
static gi_result issue(gi_context *gi, changes c, const gi_budget *budget)
{
	gi->gpu.tag = gi->frame_number;
	reshape_objects(gi);
	const bool anew = c.rows || c.light, solves = anew || solve_goes_on(gi);
	gi_result result = c.rows || c.receivers ? programs_for_rows(gi) : GI_OK;
	if (!result && anew)
		result = specular_update(gi);
	if (!result)
		result = receive_prepare(gi);
	if (!result)
		result = probes_prepare(gi);
	if (result)
		return result;
	if (c.rows || c.receivers) {
		result = rows_update(gi, budget);
		if (!result)
			probes_update(gi);
		forget_what_was_shown(gi);
	} else if (c.light) {
		result = rows_relight(gi);
	} else {
		rows_clear_counts(gi);
	}
	if (!result && anew)
		result = light_beside_rows(gi, budget);
	else if (!result && c.receivers)
		result = punctual_update(gi);
	if (result)
		return result;
	if (c.rows || c.receivers)
		gi->budget.in_force = gi->frame.update.w & GI_UPDATE_PART;
	if (solves)
		solver_update(gi, anew, budget);
	if (gi->budget.in_force)
		budget_bound(gi);
	receive_update(gi, punctual_bind(gi));
	result = solves ? estimate_update(gi) : GI_OK;
	if (result)
		return result;
	gi->solved_frame = solves ? gi->frame_number : gi->solved_frame;
	gi->issued[gi->frame_number % GPU_READBACK_RING].solved = solves;
	gi->issued[gi->frame_number % GPU_READBACK_RING].rows_update = gi->rows.update;
	gi->issued[gi->frame_number % GPU_READBACK_RING].rebuilt = c.rows && gi->frame.update.w & GI_UPDATE_REBUILD;
	gpu_readback_queue(&gi->gpu, &gi->readback, &gi->state, gi->frame_number);
	gi->issued_frame = gi->frame_number;
	changes_done(gi);
	return GI_OK;
}

/* Doubles the pools and builds again until the rows fit. Waits for the GPU: the price of a pool that was too small. */
static gi_result grow_until_it_fits(gi_context *gi)
{
	while (gi->truncated) {
		gi_result result = rows_grow(gi);
		if (result)
			return result; /* and again by the next update */
		gi->truncated = false;
		result = issue(gi, (changes){.rows = true}, NULL);
		if (result)
			return result;
		collect_reports(gi, true);
	}
	return GI_OK;
}

/* The newest report again, for a frame that did nothing. */
static gi_report at_rest(const gi_context *gi)
{
	gi_report r = gi->report;
	r.frame = gi->frame_number;
	r.outcome = GI_OUTCOME_AT_REST;
	r.new_entries = r.flagged_entries = r.dirty_entries = r.dirty_rows = r.closed_rows = r.rays = 0;
	r.light_rays = 0;
	r.sweeps = r.dispatches = 0;
	r.sampling_rays = 0;
	memset(r.pass_ms, 0, sizeof r.pass_ms);
	r.assessed_rows = 0;
	r.uploaded_bytes = 0;
	return r;
}

static void note_issued(gi_context *gi, double began)
{
	const uint32_t ring = (uint32_t)(gi->frame_number % GPU_READBACK_RING);
	gi->issued[ring].dispatches = gi->gpu.dispatches;
	gi->issued[ring].uploaded_bytes = gi->gpu.uploaded_bytes;
	gi->issued[ring].update_ms = (float)(gi_clock_ms() - began);
	/* Already reported: the first frame after a commit waits for its rows. */
	gi_report *r = &gi->report;
	if (r->frame == gi->frame_number && r->outcome != GI_OUTCOME_AT_REST) {
		r->dispatches = gi->issued[ring].dispatches;
		r->uploaded_bytes = gi->issued[ring].uploaded_bytes;
		r->update_ms = gi->issued[ring].update_ms;
	}
}

/* A static object moved or is not seen any more, or the sky has other patches: the update begins with a commit. What
 * that takes is time of the budget, `left` is what is left of it. */
static gi_result take_regrouped_in(gi_context *gi, const gi_budget **budget, gi_budget *left)
{
	float *commit_ms = &gi->issued[gi->frame_number % GPU_READBACK_RING].commit_ms;
	*commit_ms = 0;
	if (!gi->scene.regroup)
		return GI_OK;
	const double began = gi_clock_ms();
	gi->frame_number--; /* the commit comes before this update, whose report is of what it committed */
	const gi_result result = commit_objects(gi);
	gi->frame_number++;
	*commit_ms = (float)(gi_clock_ms() - began);
	if (*budget) {
		*left = budget_less(*budget, *commit_ms);
		*budget = left;
	}
	return result;
}

static gi_result update(gi_context *gi, const gi_budget *budget)
{
	const double began = gi_clock_ms();
	collect_reports(gi, false);
	gi->frame_number++;
	gi->gpu.dispatches = 0;
	gi->gpu.uploaded_bytes = 0;
	gi_budget left;
	gi_result result = take_regrouped_in(gi, &budget, &left);
	if (result)
		return result;
	changes c = {0};
	const bool first = gi->rows.rebuild && !gi->rows.fitted;
	if (gi->truncated)
		result = grow_until_it_fits(gi);
	if (!result)
		result = find_changes(gi, budget, &c);
	const bool settled = gi->report.frame >= gi->issued_frame && !gi->solver.unconverged;
	if (!result && (c.rows || c.light || c.receivers || solve_goes_on(gi)))
		result = issue(gi, c, budget);
	else if (!result && settled && !gi->gpu.dispatches)
		gi->report = at_rest(gi);
	if (!result && first) {
		/* The size of the first rows is not known before they are built: once per commit the GPU is waited for.
		 */
		gi_progress(&gi->gpu.log, ROWS_FIRST_STEPS, ROWS_FIRST_STEPS, "first light: waiting for the GPU");
		collect_reports(gi, true);
		result = grow_until_it_fits(gi);
		gi->rows.fitted = true;
	}
	note_issued(gi, began);
	if (gi->report.outcome == GI_OUTCOME_AT_REST)
		gi->report.update_ms = (float)(gi_clock_ms() - began);
	return result;
}

gi_result gi_update(gi_context *gi, const gi_budget *budget)
{
	if (!gi)
		return gi_fail_null(gi, "");
	if (budget_check(gi, budget))
		return GI_ERROR_INVALID_ARGUMENT;
	if (gpu_check_current(&gi->gpu, "gi_update"))
		return GI_ERROR_WRONG_CONTEXT;
	if (!gi->scene.ever_committed)
		return gi_fail(&gi->gpu.log, GI_ERROR_NOT_COMMITTED, "call gi_commit() before the first gi_update()");
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	gpu_group_begin(&gi->gpu, "gi_update");
	const gi_result result = update(gi, budget);
	gpu_group_end(&gi->gpu);
	gi_memory_from(before);
	return result;
}

void gi_invalidate(gi_context *gi)
{
	if (gi)
		gi->rows.rebuild = true;
}

void gi_reset_radiosity(gi_context *gi)
{
	if (gi)
		gi->solver.cold = true;
}

gi_result gi_finish(gi_context *gi)
{
	if (!gi)
		return gi_fail_null(gi, "");
	if (gpu_check_current(&gi->gpu, "gi_finish"))
		return GI_ERROR_WRONG_CONTEXT;
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	gpu_finish(&gi->gpu);
	collect_reports(gi, true);
	const gi_result result = grow_until_it_fits(gi);
	gi_memory_from(before);
	return result;
}

gi_result gi_get_report(gi_context *gi, gi_report *out)
{
	if (!gi || !out)
		return gi_fail_null(gi, "gi_get_report: out");
	if (gpu_check_current(&gi->gpu, "gi_get_report"))
		return GI_ERROR_WRONG_CONTEXT;
	collect_reports(gi, false);
	*out = gi->report;
	out->objects = gi->scene.slot_count;
	out->objects -= gi->scene.slot_count && gi->scene.sky_slot != GI_NONE;
	out->objects -= gi->scene.slot_count && gi->scene.statics_slot != GI_NONE;
	out->leaves = gi->scene.leaf_count;
	out->nodes = gi->scene.node_count;
	out->gpu_bytes = gi->gpu.buffer_bytes;
	/* Of the last picture, or the last that the GPU is done with. */
	const gpu_timer *draw = &gi->timers[GI_PASS_DRAW];
	const uint64_t picture = draw->pending ? gpu_timer_newest(draw) : gi->picture_number;
	for (int k = GI_PASS_SHADOW; k < GI_PASS_COUNT; k++)
		out->pass_ms[k] = gpu_timer_ms(&gi->timers[k], picture);
	return GI_OK;
}
