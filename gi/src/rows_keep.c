/* Rows across a commit: those of objects that stay are kept, whatever came or went.
 *
 * Entries and links stay where they lie in their pools; leaves, nodes and slots get the numbers of the new scene
 * (renumber.comp), and what belonged to objects that went is given back. Samples are drawn by ids, which no commit
 * changes, so that the rows are those of a scene that was built at once. Objects that came are movers of the next
 * update, lit anew: they and what sees them are cut then, under a budget if there is one.
 */
#include "binding.h"
#include "context.h"

#include <math.h>

/* Entries grow about as the square of the leaves; their blocks take so many times as much. */
static const double BLOCKS = 1.6;

/* Larger pools beside the old ones, where those would not do. */
static gi_result make_room(gi_context *gi, const gi_rows *before, const rows_moves *moves, bool *larger)
{
	gi_rows *r = &gi->rows;
	const double more = (double)scene_row_count(&gi->scene) / moves->row_count;
	const double wanted = BLOCKS * more * more * (double)gi->report.entries;
	*larger = more > 1 && wanted > (double)before->entry_limit;
	if (!*larger)
		return GI_OK;
	const uint64_t limit = rows_most_entries(gi, (uint64_t)fmax(wanted, 2 * (double)before->entry_limit));
	*larger = limit > before->entry_limit;
	if (!*larger)
		return GI_OK;
	r->entry_limit = r->link_limit = limit;
	return rows_allocate_pools(gi);
}

static void copy_all(const gi_context *gi, gpu_buffer *from, gpu_buffer *to)
{
	gpu_buffer_copy(&gi->gpu, from, 0, to, 0, from->size);
}

static void fill_room(gi_context *gi, gi_rows *before)
{
	gi_rows *r = &gi->rows;
	copy_all(gi, &before->entries, &r->entries);
	copy_all(gi, &before->targets, &r->targets);
	copy_all(gi, &before->links, &r->links);
	rows_copy_pool(gi, &before->entry_pool, before->entry_limit, &r->entry_pool, r->entry_limit);
	rows_copy_pool(gi, &before->link_pool, before->link_limit, &r->link_pool, r->link_limit);
}

static void take(gpu_buffer *to, gpu_buffer *from)
{
	*to = *from;
	*from = (gpu_buffer){0};
}

static void take_pools(gi_rows *r, gi_rows *before)
{
	take(&r->entries, &before->entries);
	take(&r->targets, &before->targets);
	take(&r->queue, &before->queue);
	take(&r->links, &before->links);
	take(&r->entry_pool, &before->entry_pool);
	take(&r->link_pool, &before->link_pool);
}

static bool went(const rows_moves *m, uint32_t slot)
{
	return m->list[slot].now.x == GI_NONE;
}

/* As many leaves at a time as the pools' pending lists have room for blocks of. */
static void renumber(gi_context *gi, uint32_t first, uint32_t end, uint32_t blocks)
{
	gi_rows *r = &gi->rows;
	const uint32_t most = blocks ? (uint32_t)fmax(1, GI_POOL_PENDING_MAX / (double)blocks) : UINT32_MAX;
	for (; first < end; first += most < end - first ? most : end - first) {
		const uint32_t count = most < end - first ? most : end - first;
		gpu_buffer_clear(&gi->gpu, &r->entry_pool, sizeof(uint32_t) * GI_POOL_PENDING, sizeof(uint32_t), 0);
		gpu_buffer_clear(&gi->gpu, &r->link_pool, sizeof(uint32_t) * GI_POOL_PENDING, sizeof(uint32_t), 0);
		gpu_set_uint(&gi->gpu, r->renumber_program, 0, first);
		gpu_set_uint(&gi->gpu, r->renumber_program, 1, count);
		gpu_dispatch(&gi->gpu, r->renumber_program, count);
		if (blocks)
			rows_recycle(gi);
	}
}

static void bind_before(const gi_context *gi, const gi_rows *owner)
{
	OLD_ROWS_TABLES(BUFFER_BIND)
}

/* What became of objects and nodes, for the shader. */
typedef struct move_buffers {
	MOVE_BUFFERS(BUFFER_MEMBER)
} move_buffers;

static void bind_moves(const gi_context *gi, const move_buffers *owner)
{
	MOVE_BUFFERS(BUFFER_BIND)
}

static void free_moves(gi_context *gi, move_buffers *owner)
{
	MOVE_BUFFERS(BUFFER_FREE)
}

static gi_result upload_moves(gi_context *gi, const rows_moves *m, move_buffers *out)
{
	gi_result result =
	    gpu_buffer_allocate(&gi->gpu, &out->slots, buffer_labels.MOVES, sizeof *m->list * m->place_count, m->list);
	if (!result)
		result = gpu_buffer_allocate(&gi->gpu, &out->nodes, buffer_labels.NODE_MOVES,
					     sizeof *m->nodes * m->node_count, m->nodes);
	return result;
}

static void renumber_all(gi_context *gi, const gi_rows *before, const move_buffers *moves, const rows_moves *m)
{
	gi_rows *r = &gi->rows;
	/* What is seen in a mirror the row may have no other part of. */
	bool blockers = false, shifted = gi->specular_rows != NULL;
	uint32_t gone = 0; /* columns of the table of segments: sources that are none any more */
	bool lost = false;
	for (uint32_t slot = 0; slot < m->count; slot++) {
		gone += slot >= m->first_source && (went(m, slot) || m->list[slot].now.x < gi->scene.first_source);
		lost = lost || went(m, slot);
		shifted = shifted || (!went(m, slot) && m->list[slot].now.z);
		blockers = blockers || (m->list[slot].now.x != slot && m->list[slot].before.y > m->list[slot].before.x);
	}
	bind_rows(gi);
	bind_before(gi, before);
	bind_moves(gi, moves);
	gpu_set_uint(&gi->gpu, r->renumber_program, 2, m->count);
	gpu_set_uint(&gi->gpu, r->renumber_program, 3, gi->scene.slot_count);
	gpu_set_uint(&gi->gpu, r->renumber_program, 4, blockers);
	gpu_set_uint(&gi->gpu, r->renumber_program, 5, m->first_source);
	gpu_set_uint(&gi->gpu, r->renumber_program, 6, gi->scene.first_source);
	gpu_set_uint(&gi->gpu, r->renumber_program, 7, m->statics_slot);
	gpu_set_uint(&gi->gpu, r->renumber_program, 8,
		     gi->scene.statics_slot == GI_NONE ? 0 : gi->scene.object_data[gi->scene.statics_slot].nodes.y);
	gpu_set_uint(&gi->gpu, r->renumber_program, 9, shifted);
	gpu_set_uint(&gi->gpu, r->renumber_program, 10, m->place_count);
	for (uint32_t slot = 0, end; slot < m->place_count; slot = end) {
		for (end = slot + 1; end < m->place_count && went(m, end) == went(m, slot); end++)
			;
		renumber(gi, m->list[slot].before.x, m->list[end - 1].before.y, went(m, slot) ? m->count + 1 : gone);
	}
	r->lost = r->lost || lost || gone;
	for (uint32_t k = 0; k < gi->scene.object_count; k++)
		if (gi->scene.objects[k].committed && !object_is_alive(&gi->scene.objects[k]))
			object_include_box(&gi->scene.objects[k], &r->lost_lower, &r->lost_upper);
}

gi_result rows_keep(gi_context *gi, gi_rows *before, const rows_moves *m)
{
	gi_rows *r = &gi->rows;
	move_buffers moves = {0};
	bool larger = false;
	gi_result result = rows_allocate_tables(gi);
	if (!result)
		result = upload_moves(gi, m, &moves);
	if (!result)
		result = make_room(gi, before, m, &larger);
	if (!result) {
		if (larger)
			fill_room(gi, before);
		else
			take_pools(r, before);
		renumber_all(gi, before, &moves, m);
		r->kept = true;
	}
	free_moves(gi, &moves);
	return result;
}
