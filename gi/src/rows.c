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
#include "bits.h"
#include "changes.h"
#include "context.h"
#include "host_memory.h"
#include "loans.h"
#include "sky.h"
#include "specular_rows.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* Entries per leaf are about 3.3 over the row tolerance in the Cornell box and some 40 more, those across narrow gaps
 * among them; their blocks are 1.4 times that, 1.7 times while objects move. Where this was too few the pool doubles,
 * which builds all rows anew. */
static const double ENTRIES_TIMES_TOLERANCE = 4.5;
static const double ENTRIES_AT_LEAST = 128;

/* Black sky only has to close rows: its patches may be this much coarser than others. */
static const float BLACK_SKY_COARSENESS = 14.0f;

void rows_programs(gi_rows *r, gpu_program_file list[ROWS_PROGRAMS])
{
	const gpu_program_file programs[ROWS_PROGRAMS] = {
	    {"pose.comp", &r->pose_program},         {"cut.comp", &r->cut_program},
	    {"factor.comp", &r->factor_program},     {"flag.comp", &r->flag_program},
	    {"trace.comp", &r->trace_program},       {"close.comp", &r->close_program},
	    {"recycle.comp", &r->recycle_program},   {"prepare.comp", &r->prepare_program},
	    {"renumber.comp", &r->renumber_program}, {"trace_tops.comp", &r->tops_program},
	    {"concern.comp", &r->concern_program},   {"changed.comp", &r->changed_program},
	    {"unmark.comp", &r->unmark_program},     {"cut_kept.comp", &r->kept_program},
	    {"covered.comp", &r->covered_program}};
	memcpy(list, programs, sizeof programs);
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
	gi_result result = gpu_buffer_allocate(g, &r->entries, gpu_bound_label(GI_BIND_ENTRIES),
					       sizeof(gi_uvec4) * r->entry_limit, NULL);
	if (!result)
		result = gpu_buffer_allocate(g, &r->targets, gpu_bound_label(GI_BIND_TARGETS),
					     sizeof(uint32_t) * r->entry_limit, NULL);
	if (!result)
		result = gpu_buffer_allocate(g, &r->queue, gpu_bound_label(GI_BIND_QUEUE),
					     sizeof(uint32_t) * r->entry_limit, NULL);
	if (!result)
		result = gpu_buffer_allocate(g, &r->links, gpu_bound_label(GI_BIND_LINKS),
					     2 * sizeof(uint32_t) * r->link_limit, NULL);
	if (!result)
		result = allocate_pool(gi, &r->entry_pool, gpu_bound_label(GI_BIND_ENTRY_POOL), r->entry_limit);
	if (!result)
		result = allocate_pool(gi, &r->link_pool, gpu_bound_label(GI_BIND_LINK_POOL), r->link_limit);
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
	const uint64_t leaves = gi->scene.leaf_count;
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
	const uint64_t leaves = s->leaf_count;
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
		       gi->scene.leaf_count, (sizeof(gi_uvec4) * needed >> 20) + 1,
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

/* ---- what has to be done ---- */

typedef struct plan {
	bool part;    /* under a budget: the chosen rows alone */
	bool several; /* rows may have several candidates: flagged entries are marked */
	uint32_t pose_runs, pose_threads, cut_runs, movers;
	uint32_t first_emitter, end_emitter; /* in the lists of objects */
	uint32_t first_swept, swept;         /* likewise, in fours of words */
	uint64_t cut_threads;
	loans loans; /* in part alone */
} plan;

static bool add_run(gi_rows *r, uint32_t at, gi_uvec4 run)
{
	if (at >= r->run_capacity) {
		const uint32_t capacity = 2 * at + 64;
		gi_uvec4 *grown = gi_realloc(r->run_data, sizeof *grown * capacity);
		if (!grown)
			return false;
		r->run_data = grown;
		r->run_capacity = capacity;
	}
	r->run_data[at] = run;
	return true;
}

/* An object's changes that not every row has seen; the sky has none. */
static bool slot_moved(const gi_context *gi, uint32_t slot)
{
	return gi->rows.rebuild || gi->scene.object_data[slot].changed.x > gi->rows.current;
}

static bool slot_relit(const gi_context *gi, uint32_t slot)
{
	return gi->scene.object_data[slot].changed.y > gi->rows.current;
}

/* Is there one in [first, end)? */
static bool holds_any(const uint32_t *sorted, uint32_t count, uint32_t first, uint32_t end)
{
	uint32_t low = 0, high = count;
	while (low < high) {
		const uint32_t middle = low + (high - low) / 2;
		if (sorted[middle] < first)
			low = middle + 1;
		else
			high = middle;
	}
	return low < count && sorted[low] < end;
}

/* Tops change with what is below them. The topmost one need not see one that left: it may be another top of before. */
static void number_tops(gi_context *gi)
{
	gi_scene *s = &gi->scene;
	const uint32_t update = gi->rows.update;
	uint32_t count = 0;
	for (uint32_t slot = 0; slot < s->first_source; slot++) {
		const gi_uvec4 changed = s->object_data[slot].changed;
		if (changed.x == update || changed.y == update)
			s->changed_slots[count++] = slot;
	}
	for (uint32_t k = 0; count && k < s->top_count; k++) {
		scene_top *top = &s->tops[k];
		if (!holds_any(s->changed_slots, count, top->first_slot, top->end_slot))
			continue;
		top->changed = s->topology[top->node].corners.y = update;
		gpu_buffer_upload(&gi->gpu, &s->topology_gpu, sizeof(gi_node_topology) * top->node,
				  sizeof(gi_node_topology), &s->topology[top->node]);
	}
	const uint32_t newest = s->tops[0].changed > s->statics_update ? s->tops[0].changed : s->statics_update;
	s->object_data[s->statics_slot].changed = (gi_uvec4){newest, newest, 0, 0};
}

static void number_changes(gi_context *gi)
{
	gi_scene *s = &gi->scene;
	const uint32_t update = ++gi->rows.update;
	if (gi->rows.lost)
		gi->rows.lost_update = update;
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		if (s->slots[slot] == GI_NONE)
			continue;
		object_record *o = &s->objects[s->slots[slot]];
		o->moved_update = o->moved ? update : o->moved_update;
		o->relit_update = o->relit ? update : o->relit_update;
		s->object_data[slot].changed = (gi_uvec4){o->moved_update, o->relit_update, 0, 0};
		s->object_data[slot].extra.w = 0;
	}
	if (s->statics_slot != GI_NONE)
		number_tops(gi);
}

/* Does the cut of `source` for leaves of `receiver` have to be done again? */
static bool pair_is_dirty(const gi_context *gi, uint32_t receiver, uint32_t source)
{
	if (gi->rows.rebuild || slot_relit(gi, source))
		return true;
	return receiver != source && (slot_moved(gi, receiver) || slot_moved(gi, source));
}

static bool plan_poses(gi_context *gi, plan *p)
{
	for (uint32_t slot = 0; slot < gi->scene.slot_count; slot++) {
		const gi_object_data *data = &gi->scene.object_data[slot];
		if (!gi->rows.rebuild && !gi->rows.kept && data->changed.x != gi->rows.update)
			continue;
		if (!add_run(&gi->rows, p->pose_runs++, (gi_uvec4){p->pose_threads, slot, 0, data->nodes.x}))
			return false;
		p->pose_threads += data->nodes.y - data->nodes.x;
		if (!add_run(&gi->rows, p->pose_runs++, (gi_uvec4){p->pose_threads, slot, 1, data->extra.y}))
			return false;
		p->pose_threads += data->extra.z - data->extra.y;
	}
	return true;
}

static bool plan_cuts(gi_context *gi, plan *p)
{
	const gi_scene *s = &gi->scene;
	for (uint32_t receiver = 0; receiver < s->slot_count; receiver++) {
		const gi_uvec4 nodes = s->object_data[receiver].nodes;
		if (nodes.w == nodes.z || s->slots[receiver] == GI_NONE)
			continue;
		for (uint32_t source = s->first_source; source < s->slot_count; source++) {
			if (!pair_is_dirty(gi, receiver, source))
				continue;
			const gi_uvec4 run = {(uint32_t)p->cut_threads, receiver, source, nodes.z};
			if (!add_run(&gi->rows, p->pose_runs + p->cut_runs++, run))
				return false;
			p->cut_threads += nodes.w - nodes.z;
		}
	}
	return true;
}

static bool boxes_overlap(const object_record *a, const object_record *b)
{
	const float *al = &a->world_lower.x, *au = &a->world_upper.x, *bl = &b->world_lower.x, *bu = &b->world_upper.x;
	for (int k = 0; k < 3; k++)
		if (al[k] > bu[k] || bl[k] > au[k])
			return false;
	return true;
}

static bool append(gi_slot_list *list, uint32_t slot)
{
	if (list->count == list->capacity) {
		const uint32_t capacity = 2 * list->capacity + 64;
		uint32_t *grown = gi_realloc(list->slots, sizeof *grown * capacity);
		if (!grown)
			return false;
		list->slots = grown;
		list->capacity = capacity;
	}
	list->slots[list->count++] = slot;
	return true;
}

static bool list_movers(const gi_context *gi, gi_slot_list *list)
{
	bool ok = true;
	for (uint32_t slot = 0; ok && slot < gi->scene.slot_count; slot++)
		if (gi->scene.slots[slot] != GI_NONE && (slot_moved(gi, slot) || slot_relit(gi, slot)))
			ok = append(list, slot);
	return ok;
}

/* Segments within a mover stay inside its box: only what is there too can hide them. */
static bool list_neighbours(const gi_context *gi, uint32_t mover, gi_slot_list *list)
{
	const gi_scene *s = &gi->scene;
	bool ok = true;
	for (uint32_t slot = 0; ok && slot < s->slot_count; slot++)
		if (slot != mover && s->slots[slot] != GI_NONE &&
		    boxes_overlap(&s->objects[s->slots[mover]], &s->objects[s->slots[slot]]))
			ok = append(list, slot);
	return ok;
}

/* More emitting objects than this are not asked for one by one (survey.comp). */
enum { MOST_EMITTERS = 32 };

/* Appends the emitting objects, [*first, *end); first > end: too many, or what they give comes by way of others. */
static bool list_emitters(const gi_context *gi, gi_slot_list *list, uint32_t *first, uint32_t *end)
{
	const gi_scene *s = &gi->scene;
	bool ok = true;
	*first = list->count;
	for (uint32_t slot = s->first_source; ok && slot < s->slot_count; slot++)
		if (s->topology[s->object_data[slot].nodes.x].range.w & GI_NODE_EMITTER)
			ok = append(list, slot);
	*end = list->count;
	if (*end - *first > MOST_EMITTERS || specular_rows_bring_exitance(gi))
		*first = *end + 1;
	return ok;
}

/* As gi_shared.h says. */
static bool append_swept(gi_slot_list *list, gi_uvec4 change, const gi_vec4 corners[4])
{
	uint32_t words[4 * GI_SWEPT_PARTS] = {change.x, change.y, change.z, change.w};
	memcpy(words + 4, corners, sizeof *corners * (GI_SWEPT_PARTS - 1));
	bool ok = true;
	for (uint32_t k = 0; ok && k < 4 * GI_SWEPT_PARTS; k++)
		ok = append(list, words[k]);
	return ok;
}

/* Where movers were and are, and what went. */
static bool list_swept(const gi_context *gi, gi_slot_list *list, plan *p)
{
	const gi_scene *s = &gi->scene;
	const gi_rows *r = &gi->rows;
	bool ok = true;
	while (ok && list->count % 4)
		ok = append(list, 0);
	p->first_swept = list->count / 4;
	for (uint32_t slot = 0; ok && slot < s->slot_count; slot++) {
		const object_record *o = scene_object_in(s, slot);
		if (!o || !slot_moved(gi, slot))
			continue;
		gi_vec4 corners[4] = {o->trail_lower, o->trail_upper, o->world_lower, o->world_upper};
		object_include_box(o, &corners[2], &corners[3]);
		gi->scene.object_data[slot].extra.w = ++p->swept;
		ok = append_swept(list, (gi_uvec4){o->moved_update, slot, o->trails, 0}, corners);
	}
	const gi_vec4 lost[4] = {r->lost_lower, r->lost_upper, r->lost_lower, r->lost_upper};
	if (ok && r->lost_lower.x <= r->lost_upper.x && ++p->swept)
		ok = append_swept(list, (gi_uvec4){r->lost_update, GI_NONE, 1, 0}, lost);
	return ok;
}

/* Objects that may have changed what entries see (gi_object_data), movers first, those that emit, and what was
 * swept. */
static gi_result upload_object_lists(gi_context *gi, plan *p)
{
	gi_scene *s = &gi->scene;
	gpu_buffer *buffer = &gi->rows.object_lists;
	gi_slot_list list = gi->rows.object_list;
	list.count = 0;
	const bool wanted = !gi->rows.rebuild; /* rows that are built anew ask nobody */
	bool ok = !wanted || list_movers(gi, &list);
	p->movers = list.count;
	for (uint32_t k = 0; ok && k < p->movers; k++) {
		gi_object_data *data = &s->object_data[list.slots[k]];
		data->bvh.w = list.count;
		ok = list_neighbours(gi, list.slots[k], &list);
		data->extra.x = list.count;
		p->several = p->several || data->extra.x - data->bvh.w > 1;
	}
	ok = ok && (!p->part || list_emitters(gi, &list, &p->first_emitter, &p->end_emitter));
	ok = ok && (!wanted || list_swept(gi, &list, p));
	p->several = p->several || p->swept > 1;
	gi_result result = GI_OK;
	const uint64_t bytes = sizeof *list.slots * list.count;
	if (!ok)
		result = gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	else if (bytes > buffer->size || !buffer->name)
		result = gpu_buffer_allocate(&gi->gpu, buffer, gpu_bound_label(GI_BIND_OBJECT_LISTS), 2 * bytes, NULL);
	if (!result)
		gpu_buffer_upload(&gi->gpu, buffer, 0, bytes, list.slots);
	gi->rows.object_list = list; /* its memory, for the next time */
	return result;
}

static gi_result upload_plan(gi_context *gi, const plan *p)
{
	gi_rows *r = &gi->rows;
	const uint64_t bytes = sizeof(gi_uvec4) * (p->pose_runs + p->cut_runs);
	if (bytes > r->runs.size || !r->runs.name) {
		gi_result result =
		    gpu_buffer_allocate(&gi->gpu, &r->runs, gpu_bound_label(GI_BIND_RUNS), bytes + bytes / 2, NULL);
		if (result)
			return result;
	}
	gpu_buffer_upload(&gi->gpu, &r->runs, 0, bytes, r->run_data);
	gpu_buffer_upload(&gi->gpu, &gi->scene.objects_gpu, 0, sizeof(gi_object_data) * gi->scene.slot_count,
			  gi->scene.object_data);
	return GI_OK;
}

static bool materials_changed(const gi_context *gi)
{
	if (gi->light_changed)
		return true;
	for (uint32_t k = 0; k < gi->scene.object_count; k++)
		if (gi->scene.objects[k].material_changed || gi->scene.objects[k].relit)
			return true;
	return false;
}

/* The update that last saw something that moved, was lit or put out, or went. */
static uint32_t newest_change(const gi_context *gi)
{
	uint32_t newest = gi->rows.lost_update;
	for (uint32_t slot = 0; slot < gi->scene.slot_count; slot++) {
		const gi_uvec4 changed = gi->scene.object_data[slot].changed;
		newest = changed.x > newest ? changed.x : newest;
		newest = changed.y > newest ? changed.y : newest;
	}
	return newest;
}

static gi_vec4 higher_of(gi_vec4 a, gi_vec4 b)
{
	return (gi_vec4){fmaxf(a.x, b.x), fmaxf(a.y, b.y), fmaxf(a.z, b.z), fmaxf(a.w, b.w)};
}

/* The sky has rho 0: its E / (1 - rho) is E. */
static gi_vec4 ceiling_of(const gi_context *gi)
{
	const float *sky = gi->def.sky_exitance;
	gi_vec4 ceiling = {sky[0], sky[1], sky[2], 1};
	for (uint32_t k = 0; k < gi->scene.object_count; k++)
		if (gi->scene.objects[k].committed)
			ceiling = higher_of(ceiling, gi->scene.objects[k].ceiling);
	return ceiling;
}

/* Primitives lie in the order of slots. */
static uint32_t static_primitives(const gi_scene *s)
{
	if (!s->first_source)
		return 0;
	const object_record *last = &s->objects[s->slots[s->first_source - 1]];
	return last->primitive_base + last->bvh.primitive_count;
}

static void upload_frame(gi_context *gi, const plan *p, const gi_budget *budget)
{
	const gi_scene *s = &gi->scene;
	const gi_context_def *def = &gi->def;
	const bool lit = sky_is_lit(def);
	const float sky_tolerance = lit ? def->row_tolerance : BLACK_SKY_COARSENESS * def->row_tolerance;
	gi->frame = (gi_frame){
	    .counts = {s->leaf_count, s->node_count, s->slot_count, s->vertex_count},
	    .limits = {(uint32_t)gi->rows.entry_limit, (uint32_t)gi->rows.entry_limit, def->near_samples,
		       def->emitter_samples},
	    .tolerance = {def->row_tolerance, def->row_tolerance / def->emitter_refinement, sky_tolerance,
			  def->solve_tolerance},
	    .work = {p->pose_runs, p->pose_threads, p->cut_runs, (uint32_t)p->cut_threads},
	    .misc = {s->tlas_all, s->large_count, s->light_count, lit},
	    .grid = s->tlas_grid,
	    .cells = s->tlas_cells,
	    .inner = {s->tlas_inner_first, s->tlas_inner_end, lit ? GI_NONE : s->sky_slot, p->several},
	    .ceiling = ceiling_of(gi),
	    .swept = {p->first_swept, p->swept, s->first_source, s->statics_slot},
	    .statics = {static_primitives(s), specular_rows_bring_exitance(gi), specular_rows_are_heavy(gi), 0},
	};
	gi->frame.update = (gi_uvec4){gi->rows.update, 0, p->movers, gi->rows.rebuild ? GI_UPDATE_REBUILD : 0};
	gi->frame.update.w |= materials_changed(gi) || gi->rows.kept ? GI_UPDATE_MATERIAL : 0;
	gi->frame.update.w |= s->translucent_leaves || gi->specular_rows ? GI_UPDATE_BY_ROWS : 0;
	if (p->part) {
		gi->frame.update.w |= GI_UPDATE_PART;
		gi->frame.budget = (gi_uvec4){p->first_emitter, p->end_emitter, 0, newest_change(gi)};
		budget_limits(gi, budget, &gi->frame);
	}
	gpu_buffer_upload(&gi->gpu, &gi->rows.frame, 0, sizeof gi->frame, &gi->frame);
}

/* ---- the passes ---- */

void rows_clear_counts(gi_context *gi)
{
	gpu_buffer_clear(&gi->gpu, &gi->state, sizeof(uint32_t) * GI_STATE_CHANGED_ROWS, sizeof(uint32_t), 0);
	gpu_buffer_clear(&gi->gpu, &gi->state, sizeof(uint32_t) * GI_STATE_CONCERNED_ROWS, sizeof(uint32_t), 0);
	gpu_buffer_clear(&gi->gpu, &gi->state, 0, sizeof(uint32_t) * (GI_STATE_OVERFLOW + 1), 0);
	gpu_buffer_clear(&gi->gpu, &gi->state, sizeof(uint32_t) * GI_STATE_NOT_FINITE, sizeof(uint32_t), 0);
	gpu_buffer_clear(&gi->gpu, &gi->state, sizeof(uint32_t) * GI_STATE_STALE_BITS, sizeof(uint32_t), 0);
	gpu_buffer_clear(&gi->gpu, &gi->state, sizeof(uint32_t) * GI_STATE_ASSESSED, sizeof(uint32_t), 0);
}

static void begin(gi_context *gi)
{
	gi_rows *r = &gi->rows;
	rows_clear_counts(gi);
	gpu_buffer_clear(&gi->gpu, &gi->state, sizeof(uint32_t) * GI_STATE_WAITING_ROWS, 3 * sizeof(uint32_t), 0);
	gpu_buffer_clear(&gi->gpu, &gi->state, sizeof(uint32_t) * GI_STATE_CHOSEN, sizeof(uint32_t), 0);
	gpu_buffer_clear(&gi->gpu, &gi->state, sizeof(uint32_t) * GI_STATE_CHOSEN_RAYS, sizeof(uint32_t), 0);
	gpu_buffer_clear(&gi->gpu, &gi->state, sizeof(uint32_t) * GI_STATE_WANTED, sizeof(uint32_t), 0);
	gpu_buffer_clear(&gi->gpu, &r->touched, 0, sizeof(uint32_t) * (GI_TOUCHED_PARTS - 1) * gi->scene.leaf_count, 0);
	if (!r->rebuild) {
		gpu_buffer_clear(&gi->gpu, &r->entry_pool, sizeof(uint32_t) * GI_POOL_PENDING, sizeof(uint32_t), 0);
		gpu_buffer_clear(&gi->gpu, &r->link_pool, sizeof(uint32_t) * GI_POOL_PENDING, sizeof(uint32_t), 0);
		return;
	}
	gpu_buffer_clear(&gi->gpu, &gi->state, sizeof(uint32_t) * GI_STATE_ENTRIES, 2 * sizeof(uint32_t), 0);
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

static void run_indirect(gi_context *gi, gi_pass pass, uint32_t program, uint32_t arguments)
{
	rows_progress(gi, pass);
	gpu_timer_begin(&gi->gpu, &gi->timers[pass]);
	gpu_dispatch_indirect(&gi->gpu, program, &gi->state, sizeof(uint32_t) * arguments);
	gpu_timer_end(&gi->gpu, &gi->timers[pass]);
}

static void run(gi_context *gi, gi_pass pass, uint32_t program, uint64_t threads)
{
	rows_progress(gi, pass);
	gpu_timer_begin(&gi->gpu, &gi->timers[pass]);
	gpu_dispatch(&gi->gpu, program, threads);
	gpu_timer_end(&gi->gpu, &gi->timers[pass]);
}

static uint32_t count_neighbours(const gi_scene *s, uint32_t mover)
{
	uint32_t count = 0;
	for (uint32_t slot = 0; slot < s->slot_count; slot++)
		count += slot != mover && s->slots[slot] != GI_NONE &&
			 boxes_overlap(&s->objects[s->slots[mover]], &s->objects[s->slots[slot]]);
	return count;
}

/* That a row may have (flag.comp): the movers and what went, or of a mover its neighbours. */
static uint32_t count_candidates(const gi_context *gi)
{
	const gi_scene *s = &gi->scene;
	uint32_t movers = 0, most = 0;
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		const object_record *o = scene_object_in(s, slot);
		if (!o || !(o->moved || o->moved_update > gi->rows.current))
			continue;
		const uint32_t neighbours = count_neighbours(s, slot);
		most = neighbours > most ? neighbours : most;
		movers++;
	}
	return movers + 1 > most ? movers + 1 : most;
}

/* llvmpipe ends all loops of a thread after 65,535 turns in sum; flagging takes one for each entry and source, times
 * the candidates. Rows of several times the mean length are seen. Objects must be where they are now. */
static bool flagging_would_end_early(const gi_context *gi)
{
	static const double TURNS = 65535, LONGEST_ROW = 5;
	const gi_scene *s = &gi->scene;
	if (!gi->gpu.software || !s->leaf_count)
		return false;
	const double longest = LONGEST_ROW * (double)gi->report.entries / s->leaf_count;
	return (longest + scene_source_count(s)) * count_candidates(gi) > TURNS;
}

static void trace(gi_context *gi)
{
	const gi_rows *r = &gi->rows;
	const uint64_t arguments = sizeof(uint32_t) * GI_STATE_ARGS_TRACE;
	rows_progress(gi, GI_PASS_TRACE);
	gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_TRACE]);
	gpu_dispatch_indirect(&gi->gpu, r->trace_program, &gi->state, arguments);
	if (gi->scene.statics_slot != GI_NONE)
		gpu_dispatch_indirect(&gi->gpu, r->tops_program, &gi->state, arguments);
	specular_rows_follow(gi);
	gpu_timer_end(&gi->gpu, &gi->timers[GI_PASS_TRACE]);
}

static gi_result make_plan(gi_context *gi, const gi_budget *budget, plan *p)
{
	gi_rows *r = &gi->rows;
	p->part = !r->rebuild && !budget_is_exact(budget);
	gi_result result = p->part ? budget_allocate(gi) : GI_OK;
	if (!result)
		result = changes_upload(gi);
	if (result)
		return result;
	r->rebuild = r->rebuild || flagging_would_end_early(gi);
	p->part = p->part && !r->rebuild;
	number_changes(gi);
	if (!plan_poses(gi, p) || (!p->part && !plan_cuts(gi, p)))
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	if (p->cut_threads > UINT32_MAX / 2)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "%u leaves times %u objects are too many pairs",
			       gi->scene.leaf_count, gi->scene.slot_count);
	result = specular_rows_prepare(gi, p->part);
	if (!result)
		result = upload_object_lists(gi, p);
	if (!result)
		result = upload_plan(gi, p);
	return !result && p->part ? loans_find(gi, &p->loans) : result;
}

void rows_recycle(gi_context *gi)
{
	prepare(gi, AFTER_CLOSE);
	gpu_dispatch_indirect(&gi->gpu, gi->rows.recycle_program, &gi->state, sizeof(uint32_t) * GI_STATE_ARGS_RECYCLE);
}

static void cut_by(gi_context *gi, const plan *p, uint32_t program)
{
	if (p->part)
		gpu_dispatch_indirect(&gi->gpu, program, &gi->state, sizeof(uint32_t) * GI_STATE_ARGS_PAIRS);
	else
		gpu_dispatch(&gi->gpu, program, p->cut_threads);
}

/* Of static objects rows keep what is as it was. */
static void cut(gi_context *gi, const plan *p)
{
	const gi_rows *r = &gi->rows;
	const uint32_t statics = gi->scene.statics_slot;
	rows_progress(gi, GI_PASS_CUT);
	gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_CUT]);
	cut_by(gi, p, r->cut_program);
	if (!r->rebuild && statics != GI_NONE && slot_moved(gi, statics))
		cut_by(gi, p, r->kept_program);
	gpu_timer_end(&gi->gpu, &gi->timers[GI_PASS_CUT]);
}

/* Rows that static faces hide movers from. */
static void find_covered(gi_context *gi, const plan *p)
{
	const gi_rows *r = &gi->rows;
	if (gi->scene.statics_slot == GI_NONE || !p->swept)
		return;
	if (p->part)
		gpu_dispatch_indirect(&gi->gpu, r->covered_program, &gi->state,
				      sizeof(uint32_t) * GI_STATE_ARGS_CHOSEN);
	else
		gpu_dispatch(&gi->gpu, r->covered_program, gi->scene.leaf_count);
}

/* Queues what movers may have changed, of the rows that they may concern, or of those chosen. */
static void flag(gi_context *gi, const plan *p)
{
	const gi_rows *r = &gi->rows;
	rows_progress(gi, GI_PASS_FLAG);
	gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_FLAG]);
	find_covered(gi, p);
	if (!p->part) {
		gpu_dispatch(&gi->gpu, r->concern_program, gi->scene.leaf_count);
		prepare(gi, ROWS_LISTED);
	}
	gpu_dispatch_indirect(&gi->gpu, r->flag_program, &gi->state,
			      sizeof(uint32_t) * (p->part ? GI_STATE_ARGS_CHOSEN : GI_STATE_ARGS_FLAG));
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
	plan p = {0};
	gi_result result = make_plan(gi, budget, &p);
	if (result)
		return result;
	upload_frame(gi, &p, budget);
	bind_all(gi);
	begin(gi);
	run(gi, GI_PASS_POSE, r->pose_program, p.pose_threads);
	if (p.part) {
		loans_give(gi, &p.loans);
		budget_choose(gi);
	}
	cut(gi, &p);
	prepare(gi, AFTER_CUT);
	run_indirect(gi, GI_PASS_FACTOR, r->factor_program, GI_STATE_ARGS_FACTOR);
	if (!r->rebuild)
		flag(gi, &p);
	prepare(gi, AFTER_FLAG);
	if (p.several && !r->rebuild)
		gpu_dispatch_indirect(&gi->gpu, r->unmark_program, &gi->state, sizeof(uint32_t) * GI_STATE_ARGS_TRACE);
	trace(gi);
	gpu_dispatch(&gi->gpu, r->changed_program, gi->scene.leaf_count);
	prepare(gi, AFTER_TRACE);
	run_indirect(gi, GI_PASS_CLOSE, specular_rows_close_program(gi), GI_STATE_ARGS_CLOSE);
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
	upload_frame(gi, &(plan){0}, NULL);
	rows_clear_counts(gi);
	return GI_OK;
}

/* What a commit makes anew; lists and the frame stay. */
void rows_forget(gi_rows *r)
{
#define FORGET(name, buffer, label) r->buffer = (gpu_buffer){0};
	ROWS_TABLES(FORGET)
	ROWS_POOLS(FORGET)
#undef FORGET
}

#define FREE(name, buffer, label) gpu_buffer_free(&gi->gpu, &r->buffer);

void rows_release(gi_context *gi, gi_rows *r)
{
	ROWS_TABLES(FREE)
	ROWS_POOLS(FREE)
}

void rows_retire(gi_context *gi, gi_rows *r)
{
#define RETIRE(name, buffer, label) gpu_buffer_retire(&gi->gpu, &r->buffer, GI_BIND_##name);
	ROWS_TABLES(RETIRE)
#undef RETIRE
	rows_release(gi, r);
}

void rows_free(gi_context *gi)
{
	gi_rows *r = &gi->rows;
	rows_release(gi, r);
	ROWS_LISTS(FREE)
	gpu_buffer_free(&gi->gpu, &r->frame);
	gi_free(r->run_data);
	gi_free(r->object_list.slots);
}
