/* The rows of M: which nodes each leaf receives from, form factors, visibility, closing. Builds them and keeps them
 * current.
 *
 *   segments   one block per (leaf, object): the cut of that object's hierarchy in the leaf's row
 *   entries    pool of blocks; an entry is node, F, visibility
 *   queue      entries to work on in this update: cut anew first, flagged ones behind them
 *   targets    of every entry: the node whose B it takes
 *   links      pool of blocks, one per leaf: the closed row as the solve reads it
 *
 * An update cuts anew the segments with a mover at one end, flags what a mover may have changed between bodies at rest
 * to each other, traces both, and closes the rows touched. Each step is a pure function of poses and geometry, so rows
 * kept by updates are those of a rebuild, bit for bit.
 */
#include "rows.h"

#include "binding.h"
#include "changes.h"
#include "context.h"
#include "host_memory.h"
#include "loans.h"
#include "receive.h"
#include "rows_plan.h"
#include "specular_rows.h"
#include "state.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* Entries per leaf are about 3.3 over the row tolerance in the Cornell box and some 40 more, those across narrow gaps
 * among them; their blocks are 1.4 times that, 1.7 times while objects move. Where this was too few the pool doubles,
 * which builds all rows anew. */
static const double ENTRIES_TIMES_TOLERANCE = 4.5;
static const double ENTRIES_AT_LEAST = 128;

uint32_t rows_programs(gi_rows *r, rows_set set, gpu_program_file list[ROWS_PROGRAMS])
{
	const struct {
		rows_set set;
		gpu_program_file program;
	} programs[] = {{ROWS_ALWAYS, {"pose.comp", &r->pose_program}},
			{ROWS_ALWAYS, {"cut.comp", &r->cut_program}},
			{ROWS_ALWAYS, {"factor.comp", &r->factor_program}},
			{ROWS_ALWAYS, {"trace.comp", &r->trace_program}},
			{ROWS_ALWAYS, {"close.comp", &r->close_program}},
			{ROWS_ALWAYS, {"recycle.comp", &r->recycle_program}},
			{ROWS_ALWAYS, {"prepare.comp", &r->prepare_program}},
			{ROWS_ALWAYS, {"changed.comp", &r->changed_program}},
			{ROWS_MOTION, {"concern.comp", &r->concern_program}},
			{ROWS_MOTION, {"flag.comp", &r->flag_program}},
			{ROWS_MOTION, {"unmark.comp", &r->unmark_program}},
			{ROWS_STATICS, {"trace_tops.comp", &r->tops_program}},
			{ROWS_STATICS_MOTION, {"cut_kept.comp", &r->kept_program}},
			{ROWS_STATICS_MOTION, {"covered.comp", &r->covered_program}},
			{ROWS_KEPT, {"renumber.comp", &r->renumber_program}},
			{ROWS_DEFORMING, {"cut_own.comp", &r->own_program}}};
	uint32_t count = 0;
	for (size_t k = 0; k < sizeof programs / sizeof *programs; k++)
		if (programs[k].set == set)
			list[count++] = programs[k].program;
	return count;
}

gi_result rows_init(gi_context *gi)
{
	return gpu_buffer_allocate(&gi->gpu, &gi->rows.frame, "frame", sizeof(gi_frame), NULL);
}

/* Free lists of all classes of a pool together, in words. */
static uint64_t list_words(uint64_t limit)
{
	uint64_t words = 0;
	for (uint32_t c = 0; c < GI_BLOCK_CLASSES; c++)
		words += limit / ((uint64_t)GI_BLOCK_SMALLEST << c);
	return words;
}

static gi_result allocate_pool(gi_context *gi, gpu_buffer *pool, const char *label, uint64_t limit)
{
	const uint64_t list = GI_POOL_PENDING_LIST + 2 * (uint64_t)GI_POOL_PENDING_MAX;
	return gpu_buffer_allocate(&gi->gpu, pool, label, sizeof(uint32_t) * (list + list_words(limit)), NULL);
}

static void reset_pool(gi_context *gi, gpu_buffer *pool, uint64_t limit)
{
	uint32_t head[GI_POOL_PENDING_LIST] = {0};
	head[GI_POOL_LIMIT] = (uint32_t)limit;
	head[GI_POOL_LIST] = GI_POOL_PENDING_LIST + 2 * GI_POOL_PENDING_MAX;
	gpu_buffer_upload(&gi->gpu, pool, 0, sizeof head, head);
}

gi_result rows_allocate_pools(gi_context *gi)
{
	gi_rows *r = &gi->rows;
	gpu *g = &gi->gpu;
	gi_result result =
	    gpu_buffer_allocate(g, &r->entries, buffer_labels.ENTRIES, sizeof(gi_uvec4) * r->entry_limit, NULL);
	if (!result)
		result =
		    gpu_buffer_allocate(g, &r->targets, buffer_labels.TARGETS, sizeof(uint32_t) * r->entry_limit, NULL);
	if (!result)
		result =
		    gpu_buffer_allocate(g, &r->queue, buffer_labels.QUEUE, sizeof(uint32_t) * r->entry_limit, NULL);
	if (!result)
		result =
		    gpu_buffer_allocate(g, &r->links, buffer_labels.LINKS, 2 * sizeof(uint32_t) * r->link_limit, NULL);
	if (!result)
		result = allocate_pool(gi, &r->entry_pool, buffer_labels.ENTRY_POOL, r->entry_limit);
	if (!result)
		result = allocate_pool(gi, &r->link_pool, buffer_labels.LINK_POOL, r->link_limit);
	return result;
}

void rows_copy_pool(gi_context *gi, gpu_buffer *from, uint64_t from_limit, gpu_buffer *to, uint64_t to_limit)
{
	const uint64_t word = sizeof(uint32_t), lists = GI_POOL_PENDING_LIST + 2 * (uint64_t)GI_POOL_PENDING_MAX;
	const uint32_t limit = (uint32_t)to_limit;
	uint64_t from_at = lists, to_at = lists;
	gpu_buffer_copy(&gi->gpu, from, 0, to, 0, word * GI_POOL_PENDING_LIST);
	gpu_buffer_upload(&gi->gpu, to, word * GI_POOL_LIMIT, sizeof limit, &limit);
	for (uint32_t c = 0; c < GI_BLOCK_CLASSES; c++) {
		const uint64_t size = (uint64_t)GI_BLOCK_SMALLEST << c;
		if (from_limit / size)
			gpu_buffer_copy(&gi->gpu, from, word * from_at, to, word * to_at, word * (from_limit / size));
		from_at += from_limit / size;
		to_at += to_limit / size;
	}
}

/* No block: class 255, and any offset; a row sum of 0, which leaves that see nothing keep. */
static void clear_rows(gi_context *gi)
{
	gi_rows *r = &gi->rows;
	const uint32_t no_row[4] = {0, GI_BLOCK_NO_CLASS << 24, r->update, 0};
	gpu_buffer_clear(&gi->gpu, &r->segments, 0, r->segments.size, GI_BLOCK_NO_CLASS << 24);
	gpu_buffer_fill(&gi->gpu, &r->headers, no_row);
}

/* Of a table or pool, where so many are wanted. */
uint64_t rows_most_entries(gi_context *gi, uint64_t wanted)
{
	return gpu_buffer_limit(&gi->gpu, sizeof(gi_uvec4) * wanted) / sizeof(gi_uvec4);
}

/* How much finer surfaces are cut than if nothing emitted, on the mean over their area. */
static double mean_refinement(const gi_context *gi)
{
	const gi_scene *s = &gi->scene;
	double sum = 0, area = 1e-30;
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		if (s->slots[slot] == GI_NONE)
			continue;
		const object_record *o = &s->objects[s->slots[slot]];
		for (uint32_t m = 0; m < o->material_count; m++) {
			const double finer = exp2((double)o->emission[m].steps);
			sum += o->emission[m].area * fmin(finer, (double)gi->def.emitter_refinement);
			area += o->emission[m].area;
		}
	}
	return fmax(sum / area, 1);
}

gi_result rows_allocate_tables(gi_context *gi)
{
	gi_rows *r = &gi->rows;
	gpu *g = &gi->gpu;
	const uint64_t leaves = scene_row_count(&gi->scene);
	const uint64_t table = sizeof(gi_uvec4) * leaves * scene_source_count(&gi->scene);
	gi_result result = gpu_buffer_renew(g, &r->segments, GI_BIND_SEGMENTS, table, NULL);
	if (!result)
		result = gpu_buffer_renew(g, &r->headers, GI_BIND_ROWS, sizeof(gi_uvec4) * leaves, NULL);
	if (!result)
		result = gpu_buffer_renew(g, &r->touched, GI_BIND_TOUCHED, sizeof(uint32_t) * GI_TOUCHED_PARTS * leaves,
					  NULL);
	if (!result)
		clear_rows(gi);
	return result;
}

gi_result rows_allocate(gi_context *gi)
{
	gi_rows *r = &gi->rows;
	const gi_scene *s = &gi->scene;
	const uint64_t leaves = scene_row_count(s);
	const gi_result result = rows_allocate_tables(gi);
	if (result)
		return result;
	const double per_leaf = fmin(
	    ENTRIES_TIMES_TOLERANCE * mean_refinement(gi) / gi->def.row_tolerance + ENTRIES_AT_LEAST, s->node_count);
	uint64_t limit = (uint64_t)((double)leaves * per_leaf) + 4096;
	const uint64_t most = rows_most_entries(gi, limit);
	r->entry_limit = limit < most ? limit : most;
	r->link_limit = r->entry_limit;
	r->fitted = r->kept = r->lost = false;
	r->rebuild = true;
	return rows_allocate_pools(gi);
}

/* Blocks of rows that move take more than those that were just built. */
static const double POOL_SLACK = 1.125;

/* Many sources fill rows however coarse they are: an entry of each. */
static const uint32_t MANY_SOURCES = 200;

static gi_result rows_are_too_large(gi_context *gi, uint64_t needed, uint64_t most)
{
	const bool many = scene_source_count(&gi->scene) > MANY_SOURCES;
	return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY,
		       "rows of %u leaves need a buffer of %" PRIu64 " MiB and %s: raise row_tolerance, %g so far, or "
		       "leaf_size%s",
		       scene_row_count(&gi->scene), (sizeof(gi_uvec4) * needed >> 20) + 1,
		       gpu_limit_text(&gi->gpu, sizeof(gi_uvec4) * most), (double)gi->def.row_tolerance,
		       many ? ", or make what does not move GI_MOBILITY_STATIC" : "");
}

/* What the pass that was cut short lacked is known: once is enough. */
gi_result rows_grow(gi_context *gi)
{
	gi_rows *r = &gi->rows;
	const uint64_t before = r->entry_limit, needed = before + gi->wanted;
	const uint64_t wanted = (uint64_t)fmax(2 * (double)before, POOL_SLACK * (double)needed);
	const uint64_t most = rows_most_entries(gi, wanted);
	if ((gi->wanted_all && needed > most) || before >= most)
		return rows_are_too_large(gi, needed, most);
	r->entry_limit = r->link_limit = wanted < most ? wanted : most;
	const gi_result result = rows_allocate_pools(gi);
	r->rebuild = true;
	if (result)
		r->entry_limit = r->link_limit = before; /* some buffers are no larger */
	return result;
}

/* ---- the passes ---- */

void rows_clear_counts(gi_context *gi)
{
	STATE_CLEAR(gi, counts);
}

static void begin(gi_context *gi)
{
	gi_rows *r = &gi->rows;
	rows_clear_counts(gi);
	STATE_CLEAR(gi, refresh);
	gpu_buffer_clear(&gi->gpu, &r->touched, 0,
			 sizeof(uint32_t) * (GI_TOUCHED_PARTS - 1) * (uint64_t)scene_row_count(&gi->scene), 0);
	if (!r->rebuild) {
		gpu_buffer_clear(&gi->gpu, &r->entry_pool, sizeof(uint32_t) * GI_POOL_PENDING, sizeof(uint32_t), 0);
		gpu_buffer_clear(&gi->gpu, &r->link_pool, sizeof(uint32_t) * GI_POOL_PENDING, sizeof(uint32_t), 0);
		return;
	}
	STATE_CLEAR(gi, rows);
	reset_pool(gi, &r->entry_pool, r->entry_limit);
	reset_pool(gi, &r->link_pool, r->link_limit);
	clear_rows(gi);
}

void rows_progress(const gi_context *gi, gi_pass pass)
{
	if (!gi->rows.fitted)
		gi_progress(&gi->gpu.log, (uint32_t)pass, ROWS_FIRST_STEPS, "first light: %s", gi_pass_name(pass));
}

/* Stages of prepare.comp. */
enum { AFTER_CUT = 0, AFTER_FLAG = 1, AFTER_CLOSE = 2, ROWS_LISTED = 3, AFTER_TRACE = 4 };

static void prepare(gi_context *gi, uint32_t stage)
{
	gpu_set_uint(&gi->gpu, gi->rows.prepare_program, 0, stage);
	gpu_dispatch_groups(&gi->gpu, gi->rows.prepare_program, 1);
}

/* groups: where they stand in the state. */
static void run_indirect(gi_context *gi, gi_pass pass, uint32_t program, uint64_t groups)
{
	rows_progress(gi, pass);
	gpu_timer_begin(&gi->gpu, &gi->timers[pass]);
	gpu_dispatch_indirect(&gi->gpu, program, &gi->state, groups);
	gpu_timer_end(&gi->gpu, &gi->timers[pass]);
}

static void run(gi_context *gi, gi_pass pass, uint32_t program, uint64_t threads)
{
	rows_progress(gi, pass);
	gpu_timer_begin(&gi->gpu, &gi->timers[pass]);
	gpu_dispatch(&gi->gpu, program, threads);
	gpu_timer_end(&gi->gpu, &gi->timers[pass]);
}

static void trace(gi_context *gi)
{
	rows_progress(gi, GI_PASS_TRACE);
	gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_TRACE]);
	gpu_dispatch_indirect(&gi->gpu, receive_trace_program(gi, false), &gi->state, STATE_OFFSET(trace));
	if (gi->scene.statics_slot != GI_NONE)
		gpu_dispatch_indirect(&gi->gpu, receive_trace_program(gi, true), &gi->state, STATE_OFFSET(trace));
	specular_rows_follow(gi);
	gpu_timer_end(&gi->gpu, &gi->timers[GI_PASS_TRACE]);
}

void rows_recycle(gi_context *gi)
{
	prepare(gi, AFTER_CLOSE);
	gpu_dispatch_indirect(&gi->gpu, gi->rows.recycle_program, &gi->state, STATE_OFFSET(recycle));
}

static void cut_by(gi_context *gi, const rows_plan *p, uint32_t program)
{
	if (p->part)
		gpu_dispatch_indirect(&gi->gpu, program, &gi->state, STATE_OFFSET(pairs));
	else
		gpu_dispatch(&gi->gpu, program, p->cut_threads);
}

/* Of static objects rows keep what is as it was. */
static void cut(gi_context *gi, const rows_plan *p)
{
	const gi_rows *r = &gi->rows;
	const uint32_t statics = gi->scene.statics_slot;
	rows_progress(gi, GI_PASS_CUT);
	gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_CUT]);
	cut_by(gi, p, r->cut_program);
	if (!r->rebuild && statics != GI_NONE && rows_slot_moved(gi, statics))
		cut_by(gi, p, r->kept_program);
	if (p->part && p->deforms)
		gpu_dispatch_indirect(&gi->gpu, r->own_program, &gi->state, STATE_OFFSET(chosen));
	else if (p->own_threads)
		gpu_dispatch(&gi->gpu, r->own_program, p->own_threads);
	gpu_timer_end(&gi->gpu, &gi->timers[GI_PASS_CUT]);
}

/* Rows that static faces hide movers from. */
static void find_covered(gi_context *gi, const rows_plan *p)
{
	const gi_rows *r = &gi->rows;
	if (gi->scene.statics_slot == GI_NONE || !p->swept)
		return;
	if (p->part)
		gpu_dispatch_indirect(&gi->gpu, r->covered_program, &gi->state, STATE_OFFSET(chosen));
	else
		gpu_dispatch(&gi->gpu, r->covered_program, scene_row_count(&gi->scene));
}

/* Queues what movers may have changed, of the rows that they may concern, or of those chosen. */
static void flag(gi_context *gi, const rows_plan *p)
{
	const gi_rows *r = &gi->rows;
	rows_progress(gi, GI_PASS_FLAG);
	gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_FLAG]);
	find_covered(gi, p);
	if (!p->part) {
		gpu_dispatch(&gi->gpu, r->concern_program, scene_row_count(&gi->scene));
		prepare(gi, ROWS_LISTED);
	}
	gpu_dispatch_indirect(&gi->gpu, r->flag_program, &gi->state,
			      p->part ? STATE_OFFSET(chosen) : STATE_OFFSET(flag));
	gpu_timer_end(&gi->gpu, &gi->timers[GI_PASS_FLAG]);
}

/* Trails that every row has seen. */
static void forget_trails(gi_context *gi)
{
	gi_rows *r = &gi->rows;
	for (uint32_t k = 0; k < gi->scene.object_count; k++) {
		object_record *o = &gi->scene.objects[k];
		o->trails = o->trails && o->moved_update > r->current;
	}
	if (r->lost_update > r->current)
		return;
	r->lost_lower = (gi_vec4){INFINITY, INFINITY, INFINITY, 0};
	r->lost_upper = (gi_vec4){-INFINITY, -INFINITY, -INFINITY, 0};
}

gi_result rows_update(gi_context *gi, const gi_budget *budget)
{
	gi_rows *r = &gi->rows;
	rows_plan p = {0};
	gi_result result = rows_plan_make(gi, budget, &p);
	if (result)
		return result;
	rows_plan_upload_frame(gi, &p, budget);
	bind_all(gi);
	begin(gi);
	run(gi, GI_PASS_POSE, r->pose_program, p.pose_threads);
	if (p.part) {
		loans_give(gi, &p.loans);
		budget_choose(gi);
	}
	cut(gi, &p);
	prepare(gi, AFTER_CUT);
	run_indirect(gi, GI_PASS_FACTOR, receive_factor_program(gi), STATE_OFFSET(factor));
	if (!r->rebuild)
		flag(gi, &p);
	prepare(gi, AFTER_FLAG);
	if (p.several && !r->rebuild)
		gpu_dispatch_indirect(&gi->gpu, r->unmark_program, &gi->state, STATE_OFFSET(trace));
	trace(gi);
	gpu_dispatch(&gi->gpu, r->changed_program, scene_row_count(&gi->scene));
	prepare(gi, AFTER_TRACE);
	run_indirect(gi, GI_PASS_CLOSE, specular_rows_close_program(gi), STATE_OFFSET(close));
	rows_recycle(gi);
	r->rebuild = r->kept = r->lost = false;
	if (!p.part)
		r->current = r->update;
	forget_trails(gi);
	specular_rows_done(gi, p.part);
	return GI_OK;
}

gi_result rows_relight(gi_context *gi)
{
	const gi_result result = changes_upload_materials(gi);
	if (result)
		return result;
	rows_plan_upload_frame(gi, &(rows_plan){0}, NULL);
	rows_clear_counts(gi);
	return GI_OK;
}

/* What a commit makes anew; lists and the frame stay. */
void rows_forget(gi_rows *owner)
{
	ROWS_TABLES(BUFFER_FORGET)
	ROWS_POOLS(BUFFER_FORGET)
}

void rows_release(gi_context *gi, gi_rows *owner)
{
	ROWS_TABLES(BUFFER_FREE)
	ROWS_POOLS(BUFFER_FREE)
}

void rows_retire(gi_context *gi, gi_rows *owner)
{
	ROWS_TABLES(BUFFER_RETIRE)
	rows_release(gi, owner);
}

void rows_free(gi_context *gi)
{
	gi_rows *owner = &gi->rows;
	rows_release(gi, owner);
	ROWS_LISTS(BUFFER_FREE)
	ROWS_UNIFORMS(BUFFER_FREE)
	gi_free(owner->run_data);
	gi_free(owner->object_list.slots);
}
