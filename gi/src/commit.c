/* A commit: the scene of now takes the place of the one before, with its rows and its light, or all stays as it was.
 *
 * New buffers are made beside the old ones, which go when nothing can fail any more. Rows and light of objects that
 * stay are carried over. */
#include "commit.h"

#include "caustics.h"
#include "context.h"
#include "handles.h"
#include "host_memory.h"
#include "probes.h"
#include "programs.h"
#include "receive.h"
#include "receiver_sets.h"
#include "scene_upload.h"
#include "specular.h"
#include "statics.h"

#include <string.h>

/* Everything of a context that a commit makes anew. */
typedef struct committed {
	gi_scene scene;
	gi_solver solver;
	gi_rows rows;
	gi_lamps lamps;
	object_record *objects; /* with their places */
} committed;

/* ---- light ---- */

/* One part of a buffer of nodes' or leaves' light: elements [from, from + count) go to `to`. */
static void carry_part(const gpu *g, gpu_buffer *before, uint64_t from, gpu_buffer *now, uint64_t to, uint64_t count)
{
	const uint64_t vec = sizeof(gi_vec4);
	gpu_buffer_copy(g, before, vec * from, now, vec * to, vec * count);
}

/* The light of objects that stay moves from the old buffers, those of `scene`, to the new ones, as many objects at once
 * as lie in a row in both, with the tops between them; new objects start from E (solver.c). */
static void carry_radiosity(gi_context *gi, gi_solver *before, const gi_scene *scene, const carried *old,
			    uint32_t old_count)
{
	static const uint32_t leaf_parts[] = {GI_LEAF_B, GI_LEAF_R, GI_LEAF_BEFORE};
	const gi_scene *s = &gi->scene;
	for (uint32_t k = 0, next; k < old_count; k = next) {
		const object_record *o = &s->objects[old[k].index];
		uint64_t nodes = o->hierarchy.node_count, leaves = o->hierarchy.leaf_count;
		for (next = k + 1; next < old_count; next++) {
			const object_record *also = &s->objects[old[next].index];
			const uint32_t apart = also->node_base - o->node_base;
			if (old[next].node_base - old[k].node_base != apart ||
			    old[next].leaf_base != old[k].leaf_base + leaves ||
			    also->leaf_base != o->leaf_base + leaves)
				break;
			nodes = (uint64_t)apart + also->hierarchy.node_count;
			leaves += also->hierarchy.leaf_count;
		}
		for (uint64_t p = 0; p < GI_NODE_PARTS; p++)
			carry_part(&gi->gpu, &before->radiosity, p * scene->node_count + old[k].node_base,
				   &gi->solver.radiosity, p * s->node_count + o->node_base, nodes);
		for (size_t part = 0; part < sizeof leaf_parts / sizeof *leaf_parts; part++) {
			const uint64_t p = leaf_parts[part];
			carry_part(&gi->gpu, &before->leaf_radiosity, p * scene->leaf_count + old[k].leaf_base,
				   &gi->solver.leaf_radiosity, p * s->leaf_count + o->leaf_base, leaves);
		}
	}
}

/* ---- rows ---- */

/* Nodes of objects that stay, and tops with the same objects below them. */
static void follow_nodes(const gi_scene *old, const gi_scene *now, rows_moves *m)
{
	for (uint32_t n = 0; n < m->node_count; n++)
		m->nodes[n] = GI_NONE;
	for (uint32_t slot = 0; slot < m->count; slot++) {
		const gi_move *move = &m->list[slot];
		if (slot == old->statics_slot || move->now.x == GI_NONE)
			continue;
		for (uint32_t n = move->before.z; n < move->before.w; n++)
			m->nodes[n] = n + move->now.z;
	}
	for (uint32_t k = 0; k < now->top_count; k++)
		if (now->tops[k].before != GI_NONE)
			m->nodes[now->tops[k].before] = now->tops[k].node;
}

/* Where the k-th set of receivers of before is now. */
static gi_uvec4 follow_set(const gi_context *gi, const gi_scene *old, uint32_t k, gi_uvec4 nodes)
{
	const gi_scene *now = &gi->scene;
	for (uint32_t n = 0; n < now->set_count; n++)
		if (now->sets[n].set == old->sets[k].set) {
			const uint32_t place = now->slot_count + n;
			const gi_uvec4 next = now->object_data[place].nodes;
			return (gi_uvec4){place, next.z - nodes.z, next.x - nodes.x, 0};
		}
	return (gi_uvec4){GI_NONE, 0, 0, 0};
}

static void follow_sets(const gi_context *gi, const gi_scene *old, rows_moves *m)
{
	for (uint32_t k = 0; k < old->set_count; k++) {
		const gi_uvec4 nodes = old->object_data[old->slot_count + k].nodes;
		m->list[old->slot_count + k] =
		    (gi_move){{nodes.z, nodes.w, nodes.x, nodes.y}, follow_set(gi, old, k, nodes)};
	}
}

/* What became of the old scene's objects. False: out of memory. */
static bool follow_objects(const gi_context *gi, const gi_scene *old, rows_moves *m)
{
	const gi_scene *now = &gi->scene;
	*m = (rows_moves){.list = gi_calloc((size_t)scene_place_count(old) + 1, sizeof *m->list),
			  .count = old->slot_count,
			  .place_count = scene_place_count(old),
			  .row_count = scene_row_count(old),
			  .first_source = old->first_source,
			  .nodes = gi_calloc((size_t)old->node_count + 1, sizeof *m->nodes),
			  .node_count = old->node_count,
			  .statics_slot = statics_are_same(old, now) ? GI_NONE : old->statics_slot};
	if (!m->list || !m->nodes)
		return false;
	for (uint32_t slot = 0; slot < m->count; slot++) {
		const gi_uvec4 nodes = old->object_data[slot].nodes;
		const object_record *o = old->slots[slot] == GI_NONE ? NULL : &now->objects[old->slots[slot]];
		uint32_t to = o ? (object_is_alive(o) ? o->slot : GI_NONE) : now->sky_slot;
		gi_move *move = &m->list[slot];
		*move = (gi_move){{nodes.z, nodes.w, nodes.x, nodes.y}, {GI_NONE, 0, 0, 0}};
		if (slot == old->statics_slot) {
			to = now->statics_slot;
			move->before.x = nodes.w; /* leaves are their objects' */
		}
		if (to == GI_NONE)
			continue;
		const gi_uvec4 next = now->object_data[to].nodes;
		move->now = (gi_uvec4){to, o ? next.z - nodes.z : 0, next.x - nodes.x, 0};
	}
	follow_nodes(old, now, m);
	follow_sets(gi, old, m);
	return true;
}

/* Where little stays, building all rows at once, in pools made for them, is less work. */
static bool much_stays(const rows_moves *m, const gi_scene *now)
{
	uint64_t stay = 0;
	for (uint32_t slot = 0; slot < m->count; slot++)
		if (m->list[slot].now.x != GI_NONE)
			stay += m->list[slot].before.y - m->list[slot].before.x;
	return stay && 2 * stay >= now->leaf_count;
}

static gi_result renew_rows(gi_context *gi, gi_scene *old, gi_rows *rows)
{
	const gi_scene *now = &gi->scene;
	const bool usable = rows->fitted && !rows->rebuild && !gi->truncated && sky_is_same(old, now);
	rows_moves m = {0};
	if (usable && !follow_objects(gi, old, &m)) {
		gi_free(m.list);
		gi_free(m.nodes);
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	}
	const gi_result result = usable && much_stays(&m, now) ? rows_keep(gi, rows, &m) : rows_allocate(gi);
	gi_free(m.list);
	gi_free(m.nodes);
	return result;
}

/* ---- all of it ---- */

static void put_back(gi_context *gi, const committed *before)
{
	scene_release(gi, &gi->scene);
	solver_release(gi, &gi->solver);
	rows_release(gi, &gi->rows);
	gi->scene = before->scene;
	gi->solver = before->solver;
	gi->rows = before->rows;
	gi->lamps = before->lamps;
	memcpy(gi->scene.objects, before->objects, sizeof *before->objects * gi->scene.object_count);
}

static void let_go(gi_context *gi, committed *before)
{
	scene_retire(gi, &before->scene);
	solver_retire(gi, &before->solver);
	rows_retire(gi, &before->rows);
}

static gi_result replace_scene(gi_context *gi)
{
	uint32_t old_count = 0;
	committed before = {gi->scene, gi->solver, gi->rows, gi->lamps, NULL};
	const uint32_t places = gi->scene.object_count;
	gi_arena_measure(&gi->undo);
	gi_arena_take(&gi->undo, places, sizeof(carried));
	gi_arena_take(&gi->undo, places, sizeof(object_record));
	if (!gi_arena_reserve(&gi->undo))
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	carried *old = gi_arena_take(&gi->undo, places, sizeof *old);
	before.objects = gi_arena_take(&gi->undo, places, sizeof *before.objects);
	if (places)
		memcpy(before.objects, gi->scene.objects, sizeof *before.objects * places);
	gi->scene = (gi_scene){0};
	scene_keep_objects(&before.scene, &gi->scene);
	solver_forget(&gi->solver);
	rows_forget(&gi->rows);
	gi_result result = scene_upload(gi, &(scene_before){&before.scene, before.objects}, old, &old_count);
	if (!result)
		result = solver_allocate(gi);
	if (!result)
		result = renew_rows(gi, &before.scene, &before.rows);
	if (result) {
		put_back(gi, &before);
	} else {
		carry_radiosity(gi, &before.solver, &before.scene, old, old_count);
		gi->solver.cold = gi->solver.cold || !old_count;
		let_go(gi, &before);
	}
	return result;
}

/* Has some material begun or ceased to emit since surfaces in one place were ranked? Then ranks change (rank.h). */
static bool ranks_otherwise(object_record *o)
{
	bool changed = false;
	for (uint32_t m = 0; m < o->material_count; m++) {
		changed = changed || o->emission[m].ranked != material_emits(&o->materials[m]);
		o->emission[m].ranked = material_emits(&o->materials[m]);
	}
	return changed;
}

/* What the rows that were kept have not seen. Where they are made anew nothing is left to be seen. */
static void note_changes(gi_context *gi)
{
	const bool kept = gi->rows.kept;
	for (uint32_t k = 0; k < gi->scene.object_count; k++) {
		object_record *o = &gi->scene.objects[k];
		const bool alive = object_is_alive(o), came = alive && !o->committed;
		const bool other = alive && (ranks_otherwise(o) || o->grouped != o->was_grouped);
		o->was_grouped = o->grouped;
		o->committed = alive;
		o->arrives = kept && (o->arrives || came);
		o->came = kept && (o->came || came);
		o->moved = kept && (o->moved || other || came);
		o->relit = kept && (o->relit || other || came);
		o->reshaped = kept && o->reshaped;
		o->material_changed = kept && (o->material_changed || came);
	}
}

static void forget_dead_objects(gi_context *gi)
{
	for (uint32_t k = 0; k < gi->scene.object_count; k++) {
		object_record *o = &gi->scene.objects[k];
		if (!(o->generation & 1) && o->committed)
			handles_free_place(&gi->scene, o);
	}
}

gi_result commit_objects(gi_context *gi)
{
	gi_result result = programs_for_commit(gi);
	if (result)
		return result;
	gi_progress(&gi->gpu.log, 0, 0, "joining objects");
	result = replace_scene(gi);
	if (result)
		return result;
	shade_invalidate(gi);
	estimate_invalidate(gi);
	specular_invalidate(gi);
	caustics_invalidate(gi);
	punctual_invalidate(gi);
	diffusion_invalidate(gi);
	gi->layout++;
	receive_invalidate(gi);
	probes_invalidate(gi);
	gi->commit_frame = gi->frame_number;
	if (!gi->rows.kept) {
		gi->truncated = false;
		gi->rows_frame = gi->frame_number;
	}
	forget_dead_objects(gi);
	note_changes(gi);
	receiver_sets_committed(gi, gi->rows.kept);
	sky_take(gi);
	gi->scene.regroup = false;
	gi->scene.ever_committed = true;
	return GI_OK;
}
