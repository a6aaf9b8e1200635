#include "rows_plan.h"

#include "changes.h"
#include "context.h"
#include "host_memory.h"
#include "receiver_sets.h"
#include "sky.h"
#include "specular_rows.h"

#include <math.h>
#include <string.h>

/* Black sky only has to close rows: its patches may be this much coarser than others. */
static const float BLACK_SKY_COARSENESS = 14.0f;

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

bool rows_slot_moved(const gi_context *gi, uint32_t slot)
{
	return gi->rows.rebuild || gi->scene.object_data[slot].changed.x > gi->rows.current;
}

/* The same of having been lit or put out. */
static bool slot_relit(const gi_context *gi, uint32_t slot)
{
	return gi->scene.object_data[slot].changed.y > gi->rows.current;
}

/* The same of having another shape. */
static bool slot_reshaped(const gi_context *gi, uint32_t slot)
{
	return gi->scene.object_data[slot].changed.z > gi->rows.current;
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
		o->reshaped_update = o->reshaped ? update : o->reshaped_update;
		s->object_data[slot].changed = (gi_uvec4){o->moved_update, o->relit_update, o->reshaped_update, 0};
		s->object_data[slot].extra.w = 0;
	}
	receiver_sets_number(gi, update);
	if (s->statics_slot != GI_NONE)
		number_tops(gi);
}

/* Does the cut of `source` for leaves of `receiver` have to be done again? */
static bool pair_is_dirty(const gi_context *gi, uint32_t receiver, uint32_t source)
{
	if (gi->rows.rebuild || slot_relit(gi, source))
		return true;
	if (receiver == source)
		return slot_reshaped(gi, source);
	return rows_slot_moved(gi, receiver) || rows_slot_moved(gi, source);
}

static bool plan_poses(gi_context *gi, rows_plan *p)
{
	for (uint32_t slot = 0; slot < scene_place_count(&gi->scene); slot++) {
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

static bool slot_deforms(const gi_context *gi, uint32_t slot)
{
	return gi->scene.object_data[slot].bvh.z & GI_OBJECT_DEFORMS;
}

static bool plan_cuts(gi_context *gi, rows_plan *p)
{
	const gi_scene *s = &gi->scene;
	for (uint32_t receiver = 0; receiver < scene_place_count(s); receiver++) {
		const gi_uvec4 nodes = s->object_data[receiver].nodes;
		if (nodes.w == nodes.z || !scene_has_rows(s, receiver))
			continue;
		for (uint32_t source = s->first_source; source < s->slot_count; source++) {
			if (!pair_is_dirty(gi, receiver, source) || (receiver == source && slot_deforms(gi, source)))
				continue;
			const gi_uvec4 run = {(uint32_t)p->cut_threads, receiver, source, nodes.z};
			if (!add_run(&gi->rows, p->pose_runs + p->cut_runs++, run))
				return false;
			p->cut_threads += nodes.w - nodes.z;
		}
	}
	return true;
}

/* Of objects that deform the pairs of their own leaves (cut_own.comp), behind all others. */
static bool plan_own_cuts(gi_context *gi, rows_plan *p)
{
	const gi_scene *s = &gi->scene;
	for (uint32_t slot = s->first_source; slot < s->slot_count; slot++) {
		const gi_uvec4 nodes = s->object_data[slot].nodes;
		if (!slot_deforms(gi, slot))
			continue;
		p->deforms = true;
		if (p->part || !pair_is_dirty(gi, slot, slot))
			continue;
		const gi_uvec4 run = {(uint32_t)(p->cut_threads + p->own_threads), slot, slot, nodes.z};
		if (!add_run(&gi->rows, p->pose_runs + p->cut_runs++, run))
			return false;
		p->own_threads += nodes.w - nodes.z;
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
		if (gi->scene.slots[slot] != GI_NONE && (rows_slot_moved(gi, slot) || slot_relit(gi, slot)))
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
static bool list_swept(const gi_context *gi, gi_slot_list *list, rows_plan *p)
{
	const gi_scene *s = &gi->scene;
	const gi_rows *r = &gi->rows;
	bool ok = true;
	while (ok && list->count % 4)
		ok = append(list, 0);
	p->first_swept = list->count / 4;
	for (uint32_t slot = 0; ok && slot < s->slot_count; slot++) {
		const object_record *o = scene_object_in(s, slot);
		if (!o || !rows_slot_moved(gi, slot))
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
static gi_result upload_object_lists(gi_context *gi, rows_plan *p)
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
		result = gpu_buffer_allocate(&gi->gpu, buffer, buffer_labels.OBJECT_LISTS, 2 * bytes, NULL);
	if (!result)
		gpu_buffer_upload(&gi->gpu, buffer, 0, bytes, list.slots);
	gi->rows.object_list = list; /* its memory, for the next time */
	return result;
}

static gi_result upload_runs(gi_context *gi, const rows_plan *p)
{
	gi_rows *r = &gi->rows;
	const uint64_t bytes = sizeof(gi_uvec4) * (p->pose_runs + p->cut_runs);
	if (bytes > r->runs.size || !r->runs.name) {
		gi_result result = gpu_buffer_allocate(&gi->gpu, &r->runs, buffer_labels.RUNS, bytes + bytes / 2, NULL);
		if (result)
			return result;
	}
	gpu_buffer_upload(&gi->gpu, &r->runs, 0, bytes, r->run_data);
	gpu_buffer_upload(&gi->gpu, &gi->scene.objects_gpu, 0, sizeof(gi_object_data) * scene_place_count(&gi->scene),
			  gi->scene.object_data);
	return GI_OK;
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
	const double longest = LONGEST_ROW * (double)gi->report.entries / scene_row_count(s);
	return (longest + scene_source_count(s)) * count_candidates(gi) > TURNS;
}

gi_result rows_plan_make(gi_context *gi, const gi_budget *budget, rows_plan *p)
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
	if (!plan_poses(gi, p) || (!p->part && !plan_cuts(gi, p)) || !plan_own_cuts(gi, p))
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	if (p->cut_threads + p->own_threads > UINT32_MAX / 2)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "%u leaves times %u objects are too many pairs",
			       scene_row_count(&gi->scene), gi->scene.slot_count);
	result = specular_rows_prepare(gi, p->part);
	if (!result)
		result = upload_object_lists(gi, p);
	if (!result)
		result = upload_runs(gi, p);
	return !result && p->part ? loans_find(gi, &p->loans) : result;
}

/* ---- the frame ---- */

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
	for (uint32_t slot = 0; slot < scene_place_count(&gi->scene); slot++) {
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

/* As large as may be subtracted from. */
static const float BRIGHTEST = 3e38f;

/* The sky has rho 0: its E / (1 - rho) is E. */
static gi_vec4 ceiling_of(const gi_context *gi)
{
	float sky[3];
	sky_brightest(gi, sky);
	gi_vec4 ceiling = {sky[0], sky[1], sky[2], 1};
	/* How much lights bring to a leaf the GPU alone knows: it bounds what is first reflected (emitted.glsl). */
	if (light_list_shines(&gi->light_list))
		ceiling = (gi_vec4){BRIGHTEST, BRIGHTEST, BRIGHTEST, 1};
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

void rows_plan_upload_frame(gi_context *gi, const rows_plan *p, const gi_budget *budget)
{
	const gi_scene *s = &gi->scene;
	const gi_context_def *def = &gi->def;
	const bool lit = sky_is_lit(gi, def);
	const float sky_tolerance = lit ? def->row_tolerance : BLACK_SKY_COARSENESS * def->row_tolerance;
	gi->frame = (gi_frame){
	    .counts = {s->leaf_count, s->node_count, s->slot_count, s->vertex_count},
	    .rows = {scene_row_count(s), 0, 0, 0},
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
	    .statics = {static_primitives(s), specular_rows_bring_exitance(gi), specular_rows_are_heavy(gi),
			(uint32_t)p->own_threads},
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
