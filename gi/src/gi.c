/* The public functions: arguments are checked here, work is done by the modules (context.h). */
#include "context.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t CONTEXT_COOKIE = 0x47493031u, OBJECT_COOKIE = 0x47494f31u;

const char *gi_result_text(gi_result result)
{
#define GI_RESULT_TEXT(name, text) text,
	static const char *const texts[] = {GI_RESULTS(GI_RESULT_TEXT)};
#undef GI_RESULT_TEXT
	return (unsigned)result < GI_RESULT_COUNT ? texts[result] : "unknown result";
}

const char *gi_pass_name(gi_pass pass)
{
	static const char *const names[] = {"pose", "cut", "factor", "flag", "trace", "close", "solve", "light", "shadow", "draw"};
	return (unsigned)pass < GI_PASS_COUNT ? names[pass] : "unknown";
}

gi_context_def gi_context_def_default(void)
{
	return (gi_context_def){
		.row_tolerance = 0.01f,
		.emitter_refinement = 20.0f,
		.emitter_samples = 16,
		.near_samples = 4,
		.solve_tolerance = 1e-4f,
		.max_sweeps = 100,
		.profile = true,
		.internal = CONTEXT_COOKIE,
	};
}

gi_object_def gi_object_def_default(void)
{
	return (gi_object_def){
		.draw_levels = 2,
		.scale = {1, 1, 1},
		.pose = gi_pose_identity(),
		.internal = OBJECT_COOKIE,
	};
}

gi_pose gi_pose_identity(void)
{
	return (gi_pose){.rotation = {0, 0, 0, 1}};
}

/* A pointer that has to be there is not. Without a context there is no callback: stderr gets the line. */
static gi_result missing(const gi_context *gi, const char *what)
{
	static const gi_log no_log;
	return gi_fail(gi ? &gi->gpu.log : &no_log, GI_ERROR_INVALID_ARGUMENT, "%s must not be NULL", gi ? what : "the context");
}

/* ---- context ---- */

static gi_result check_context_def(const gi_log *log, const gi_context_def *def)
{
	if (def->internal != CONTEXT_COOKIE)
		return gi_fail(log, GI_ERROR_INVALID_DEF, "start from gi_context_def_default()");
	if (!def->get_proc_address)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "get_proc_address is required");
	if (!(def->row_tolerance > 1e-6f && def->row_tolerance <= 1.0f))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "row_tolerance %g is outside (1e-6, 1]", (double)def->row_tolerance);
	if (!(def->emitter_refinement >= 1.0f && isfinite(def->emitter_refinement)))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "emitter_refinement %g is below 1", (double)def->emitter_refinement);
	if (def->emitter_samples < 4 || def->emitter_samples > 16)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "emitter_samples %u is outside 4..16", def->emitter_samples);
	if (def->near_samples < 1 || def->near_samples > 16)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "near_samples %u is outside 1..16", def->near_samples);
	if (!(def->solve_tolerance > 0.0f && def->solve_tolerance <= 1.0f))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "solve_tolerance %g is outside (0, 1]", (double)def->solve_tolerance);
	if (def->max_sweeps < 1 || def->max_sweeps > 1000)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "max_sweeps %u is outside 1..1000", def->max_sweeps);
	if ((unsigned)def->sky > GI_SKY_ON)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "sky %d is none of gi_sky", (int)def->sky);
	for (int c = 0; c < 3; c++)
		if (!(def->sky_exitance[c] >= 0.0f && isfinite(def->sky_exitance[c])))
			return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "sky_exitance must be finite and not negative");
	return GI_OK;
}

static gi_result start_context(gi_context *gi)
{
	gi_result result = gpu_init(&gi->gpu, gi->def.get_proc_address);
	if (!result)
		result = gpu_buffer_allocate(&gi->gpu, &gi->state, sizeof(uint32_t) * GI_STATE_WORDS, NULL);
	if (!result)
		result = gpu_readback_create(&gi->gpu, &gi->readback, sizeof(uint32_t) * GI_STATE_WORDS);
	if (!result)
		result = rows_init(gi);
	if (!result)
		result = solver_init(gi);
	if (!result)
		gpu_buffer_clear(&gi->state, 0, gi->state.size, 0);
	return result;
}

gi_result gi_context_create(const gi_context_def *def, gi_context **out)
{
	const bool known = def && def->internal == CONTEXT_COOKIE;
	const gi_log log = {known ? def->message : NULL, known ? def->user : NULL};
	if (out)
		*out = NULL;
	if (!def || !out)
		return gi_fail(&log, GI_ERROR_INVALID_ARGUMENT, "gi_context_create: def and out must not be NULL");
	gi_result result = check_context_def(&log, def);
	if (result)
		return result;
	gi_context *gi = calloc(1, sizeof *gi);
	if (!gi)
		return gi_fail(&log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	gi->def = *def;
	gi->gpu = (gpu){.log = log, .shader_directory = def->shader_directory, .profile = def->profile};
	gi->solver.cold = true;
	result = start_context(gi);
	if (result) {
		gi_context_destroy(gi);
		return result;
	}
	*out = gi;
	return GI_OK;
}

void gi_context_destroy(gi_context *gi)
{
	if (!gi)
		return;
	shade_free(gi);
	scene_free(gi);
	rows_free(gi);
	solver_free(gi);
	gpu_readback_free(&gi->gpu, &gi->readback);
	gpu_buffer_free(&gi->gpu, &gi->state);
	for (int k = 0; k < GI_PASS_COUNT; k++)
		gpu_timer_free(&gi->timers[k]);
	free(gi);
}

/* ---- objects ---- */

gi_result gi_create_object(gi_context *gi, const gi_object_def *def, gi_object *out)
{
	if (out)
		*out = (gi_object){0};
	if (!gi || !def || !out)
		return missing(gi, "gi_create_object: def and out");
	if (def->internal != OBJECT_COOKIE)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_DEF, "start from gi_object_def_default()");
	return scene_create_object(gi, def, out);
}

static gi_result stale(const gi_context *gi, const char *function)
{
	return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_HANDLE, "%s: the object was destroyed or never created", function);
}

gi_result gi_destroy_object(gi_context *gi, gi_object object)
{
	if (!gi)
		return missing(gi, "");
	scene_object *o = scene_find(gi, object);
	if (!o)
		return stale(gi, "gi_destroy_object");
	/* Its place is reused only after the commit that takes it out of the uploaded scene, if it is in it. */
	o->generation++;
	if (!o->committed)
		scene_free_object(o);
	gi->scene.uncommitted = true;
	return GI_OK;
}

bool gi_object_is_valid(const gi_context *gi, gi_object object)
{
	return gi && scene_find(gi, object);
}

gi_result gi_set_pose(gi_context *gi, gi_object object, gi_pose pose)
{
	if (!gi)
		return missing(gi, "");
	scene_object *o = scene_find(gi, object);
	if (!o)
		return stale(gi, "gi_set_pose");
	if (!scene_normalise_pose(gi, &pose, o->name))
		return GI_ERROR_INVALID_POSE;
	if (memcmp(&pose, &o->pose, sizeof pose) == 0)
		return GI_OK;
	o->pose = pose;
	o->moved = true;
	return GI_OK;
}

gi_result gi_get_pose(const gi_context *gi, gi_object object, gi_pose *out)
{
	if (!gi || !out)
		return missing(gi, "gi_get_pose: out");
	const scene_object *o = scene_find(gi, object);
	if (!o)
		return stale(gi, "gi_get_pose");
	*out = o->pose;
	return GI_OK;
}

static bool emits(const gi_material *m)
{
	return m->exitance[0] + m->exitance[1] + m->exitance[2] > 0;
}

static bool reflects(const gi_material *m)
{
	return m->rho[0] + m->rho[1] + m->rho[2] > 0;
}

gi_result gi_set_material(gi_context *gi, gi_object object, uint32_t material, gi_material value)
{
	if (!gi)
		return missing(gi, "");
	scene_object *o = scene_find(gi, object);
	if (!o)
		return stale(gi, "gi_set_material");
	if (material >= o->material_count)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT, "object '%s' has %u materials, there is no number %u",
			       o->name, o->material_count, material);
	if (!scene_material_is_valid(gi, &value, o->name, material))
		return GI_ERROR_INVALID_MATERIAL;
	gi_material *m = &o->materials[material];
	if (memcmp(m, &value, sizeof value) == 0)
		return GI_OK;
	if (emits(m) != emits(&value) || reflects(m) != reflects(&value))
		o->relit = true;
	*m = value;
	o->material_changed = true;
	return GI_OK;
}

static void forget_dead_objects(gi_context *gi)
{
	for (uint32_t k = 0; k < gi->scene.object_count; k++) {
		scene_object *o = &gi->scene.objects[k];
		if (!(o->generation & 1) && o->committed)
			scene_free_object(o);
	}
}

gi_result gi_commit(gi_context *gi)
{
	if (!gi)
		return missing(gi, "");
	shade_invalidate(gi);
	gi_result result = scene_upload(gi);
	if (!result)
		result = rows_allocate(gi);
	if (result)
		return result;
	forget_dead_objects(gi);
	for (uint32_t k = 0; k < gi->scene.object_count; k++) {
		scene_object *o = &gi->scene.objects[k];
		o->committed = o->generation & 1;
		o->moved = o->relit = o->material_changed = false;
	}
	gi->scene.uncommitted = false;
	gi->scene.ever_committed = true;
	return GI_OK;
}

/* ---- frames ---- */

static float float_of(uint32_t bits)
{
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

static gi_outcome outcome_of(const uint32_t *state)
{
	if (state[GI_STATE_NOT_FINITE])
		return GI_OUTCOME_NOT_FINITE;
	if (state[GI_STATE_OVERFLOW])
		return GI_OUTCOME_TRUNCATED;
	return state[GI_STATE_ACTIVE] ? GI_OUTCOME_SWEEPS : GI_OUTCOME_CONVERGED;
}

static void fill_report(gi_context *gi, const uint32_t *state, uint64_t frame)
{
	gi_report *r = &gi->report;
	const uint32_t ring = (uint32_t)(frame % GPU_READBACK_RING);
	r->frame = frame;
	r->outcome = outcome_of(state);
	r->entries = state[GI_STATE_ENTRIES];
	r->links = state[GI_STATE_LINKS];
	r->new_entries = state[GI_STATE_NEW];
	r->dirty_entries = state[GI_STATE_QUEUED];
	r->flagged_entries = r->dirty_entries - r->new_entries;
	r->dirty_rows = state[GI_STATE_DIRTY_ROWS];
	r->rays = state[GI_STATE_RAYS];
	r->sweeps = state[GI_STATE_SWEEPS];
	r->residual = float_of(state[GI_STATE_DONE_RESIDUAL_BITS]);
	r->contraction = float_of(state[GI_STATE_DONE_Q_BITS]);
	r->solve_bound = float_of(state[GI_STATE_BOUND_BITS]);
	r->solve_relative = float_of(state[GI_STATE_BOUND_RELATIVE_BITS]);
	r->radiosity_max = float_of(state[GI_STATE_DONE_B_MAX_BITS]);
	r->dispatches = gi->issued[ring].dispatches;
	r->uploaded_bytes = gi->issued[ring].uploaded_bytes;
	r->update_ms = gi->issued[ring].update_ms;
}

/* Takes in every finished read-back, or waits for all of them. */
static void collect_reports(gi_context *gi, bool wait)
{
	uint32_t state[GI_STATE_WORDS];
	uint64_t frame;
	while (gpu_readback_take(&gi->readback, wait, state, &frame)) {
		const float before = gi->report.residual;
		fill_report(gi, state, frame);
		/* Exact steps shrink by q each: those that no longer do are rounding, and more of them bring nothing. */
		const bool stuck = gi->report.outcome == GI_OUTCOME_SWEEPS && gi->issued[frame % GPU_READBACK_RING].solve_only &&
				   gi->report.residual >= before;
		gi->solver.unconverged = gi->report.outcome != GI_OUTCOME_CONVERGED && !stuck;
		if (gi->report.outcome == GI_OUTCOME_TRUNCATED)
			gi->truncated = true;
	}
	for (int k = 0; k < GI_PASS_COUNT; k++)
		gpu_timer_poll(&gi->timers[k], wait);
}

static bool anything_changed(const gi_context *gi, bool *rows)
{
	bool values = false;
	*rows = gi->rows.rebuild;
	for (uint32_t k = 0; k < gi->scene.object_count; k++) {
		const scene_object *o = &gi->scene.objects[k];
		*rows = *rows || o->moved || o->relit;
		values = values || o->material_changed;
	}
	return *rows || values || gi->solver.cold;
}

static void changes_done(gi_context *gi)
{
	for (uint32_t k = 0; k < gi->scene.object_count; k++) {
		scene_object *o = &gi->scene.objects[k];
		o->moved = o->relit = o->material_changed = false;
	}
}

/* What the report counts of the rows, for a frame that leaves them alone. */
static void count_no_rows(gi_context *gi)
{
	gpu_buffer_clear(&gi->state, 0, sizeof(uint32_t) * (GI_STATE_OVERFLOW + 1), 0);
	gpu_buffer_clear(&gi->state, sizeof(uint32_t) * GI_STATE_NOT_FINITE, sizeof(uint32_t), 0);
}

/* A step of rows and solve; queues its report. */
static gi_result issue(gi_context *gi, bool rows)
{
	gi_result result = GI_OK;
	bool values = false;
	for (uint32_t k = 0; k < gi->scene.object_count; k++)
		values = values || gi->scene.objects[k].material_changed;
	if (rows || values)
		result = rows_update(gi);
	else
		count_no_rows(gi);
	gi->issued[gi->frame_number % GPU_READBACK_RING].solve_only = !rows && !values && !gi->solver.cold;
	if (result)
		return result;
	solver_update(gi);
	gpu_readback_queue(&gi->readback, &gi->state, gi->frame_number);
	gi->issued_frame = gi->frame_number;
	changes_done(gi);
	return GI_OK;
}

/* Doubles the pools and builds again until the rows fit. Waits for the GPU: the price of a pool that was too small. */
static gi_result grow_until_it_fits(gi_context *gi)
{
	while (gi->truncated) {
		gi->truncated = false;
		gi_result result = rows_grow(gi);
		if (!result)
			result = issue(gi, true);
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
	r.new_entries = r.flagged_entries = r.dirty_entries = r.dirty_rows = r.rays = 0;
	r.sweeps = r.dispatches = 0;
	r.uploaded_bytes = 0;
	return r;
}

static void note_issued(gi_context *gi, double began)
{
	const uint32_t ring = (uint32_t)(gi->frame_number % GPU_READBACK_RING);
	gi->issued[ring].dispatches = gi->gpu.dispatches;
	gi->issued[ring].uploaded_bytes = gi->gpu.uploaded_bytes;
	gi->issued[ring].update_ms = (float)(gpu_clock_ms() - began);
	/* Already reported: the first frame after a commit waits for its rows. */
	gi_report *r = &gi->report;
	if (r->frame == gi->frame_number && r->outcome != GI_OUTCOME_AT_REST) {
		r->dispatches = gi->issued[ring].dispatches;
		r->uploaded_bytes = gi->issued[ring].uploaded_bytes;
		r->update_ms = gi->issued[ring].update_ms;
	}
}

gi_result gi_update(gi_context *gi)
{
	if (!gi)
		return missing(gi, "");
	if (gi->scene.uncommitted || !gi->scene.ever_committed)
		return gi_fail(&gi->gpu.log, GI_ERROR_NOT_COMMITTED, "call gi_commit() after creating or destroying objects");
	const double began = gpu_clock_ms();
	collect_reports(gi, false);
	gi->frame_number++;
	gi->gpu.dispatches = 0;
	gi->gpu.uploaded_bytes = 0;
	gi_result result = GI_OK;
	bool rows;
	const bool first = gi->rows.rebuild && !gi->rows.fitted;
	if (gi->truncated)
		result = grow_until_it_fits(gi);
	const bool changed = anything_changed(gi, &rows);
	const bool settled = gi->report.frame >= gi->issued_frame && !gi->solver.unconverged;
	if (!result && (changed || (!settled && gi->report.frame >= gi->issued_frame)))
		result = issue(gi, rows);
	else if (!result && settled && !gi->gpu.dispatches)
		gi->report = at_rest(gi);
	if (!result && first) {
		/* The size of the first rows is not known before they are built: once per commit the GPU is waited for. */
		collect_reports(gi, true);
		result = grow_until_it_fits(gi);
		gi->rows.fitted = true;
	}
	note_issued(gi, began);
	if (gi->report.outcome == GI_OUTCOME_AT_REST)
		gi->report.update_ms = (float)(gpu_clock_ms() - began);
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
		return missing(gi, "");
	gpu_finish();
	collect_reports(gi, true);
	return grow_until_it_fits(gi);
}

gi_result gi_get_report(gi_context *gi, gi_report *out)
{
	if (!gi || !out)
		return missing(gi, "gi_get_report: out");
	collect_reports(gi, false);
	*out = gi->report;
	out->objects = gi->scene.slot_count - (gi->scene.sky_slot != GI_NONE && gi->scene.slot_count ? 1 : 0);
	out->leaves = gi->scene.leaf_count;
	out->nodes = gi->scene.node_count;
	out->gpu_bytes = gi->gpu.buffer_bytes;
	for (int k = 0; k < GI_PASS_COUNT; k++)
		out->pass_ms[k] = gi->timers[k].ms;
	return GI_OK;
}

gi_result gi_get_buffers(gi_context *gi, gi_buffers *out)
{
	if (!gi || !out)
		return missing(gi, "gi_get_buffers: out");
	*out = (gi_buffers){gi->solver.leaf_radiosity.name, gi->solver.leaf_indirect.name, gi->solver.light.name};
	return GI_OK;
}
