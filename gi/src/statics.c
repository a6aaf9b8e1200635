#include "statics.h"

#include "cells.h"
#include "frames.h"

#include <math.h>

/* Far above those of objects' nodes. */
static const uint32_t FIRST_TOP_ID = 0xC0000000u;

bool statics_hold(const gi_scene *s, gi_mobility mobility)
{
	return mobility == GI_MOBILITY_STATIC || (mobility == GI_MOBILITY_AUTOMATIC && s->automatic_static);
}

static bool are_many(const gi_scene *s)
{
	uint32_t count = 0;
	for (uint32_t k = 0; k < s->object_count; k++)
		count += object_is_alive(&s->objects[k]) && s->objects[k].mobility != GI_MOBILITY_MOVABLE;
	return count >= GI_AUTOMATIC_OBJECTS;
}

static bool is_held(const gi_scene *s, uint32_t k)
{
	return object_is_seen(&s->objects[k]) && statics_hold(s, s->objects[k].mobility);
}

/* In the order of before, the others behind them. */
static uint32_t list_statics(const gi_scene *s, const gi_scene *was, uint32_t *list)
{
	uint32_t count = 0;
	for (uint32_t slot = 0; slot < was->first_source; slot++)
		if (is_held(s, was->slots[slot]))
			list[count++] = was->slots[slot];
	for (uint32_t k = 0; k < s->object_count; k++)
		if (!s->objects[k].grouped && is_held(s, k))
			list[count++] = k;
	return count;
}

/* Slots, numbers and ids along the tree. A top's id is that of the first object below its second child, which no other
 * top has there. */
static void number_nodes(const gi_scene *s, const cells_node *cells, static_tree *t)
{
	uint32_t slot = 0, tops = 0;
	for (uint32_t k = 0; k < t->count; k++) {
		static_node *n = &t->nodes[k];
		*n = (static_node){.skip = cells[k].skip,
				   .first_slot = cells[k].first,
				   .end_slot = cells[k].end,
				   .node = t->node_count,
				   .top = cells[k].end - cells[k].first > 1};
		if (n->top)
			n->id = FIRST_TOP_ID + s->objects[t->objects[cells[cells[k + 1].skip].first]].node_id;
		n->number = n->top ? tops++ : 0;
		t->node_count += n->top ? 1 : s->objects[t->objects[slot++]].hierarchy.node_count;
	}
}

/* What is built of so many objects, and with. */
typedef struct workings {
	uint32_t *list;
	gi_vec4 *lower, *upper;
	cells_key *keys;
	cells_node *cells;
} workings;

static void lay_out(gi_arena *memory, uint32_t count, static_tree *t, workings *w)
{
	w->list = gi_arena_take(memory, count, sizeof *w->list);
	w->lower = gi_arena_take(memory, count, sizeof *w->lower);
	w->upper = gi_arena_take(memory, count, sizeof *w->upper);
	w->keys = gi_arena_take(memory, 2 * (size_t)count, sizeof *w->keys);
	w->cells = gi_arena_take(memory, 2 * (size_t)count, sizeof *w->cells);
	t->nodes = gi_arena_take(memory, 2 * (size_t)count, sizeof *t->nodes);
	t->objects = gi_arena_take(memory, count, sizeof *t->objects);
}

bool statics_build(gi_scene *s, const gi_scene *was, gi_arena *memory, static_tree *t)
{
	workings w;
	*t = (static_tree){0};
	s->automatic_static = are_many(s);
	gi_arena_measure(memory);
	lay_out(memory, s->object_count, t, &w);
	if (!gi_arena_reserve(memory))
		return false;
	lay_out(memory, s->object_count, t, &w);
	const uint32_t count = list_statics(s, was, w.list);
	if (count < 2)
		return true;
	for (uint32_t k = 0; k < count; k++) {
		w.lower[k] = s->objects[w.list[k]].world_lower;
		w.upper[k] = s->objects[w.list[k]].world_upper;
	}
	cells_build(w.lower, w.upper, w.list, count, w.keys, w.cells, t->objects);
	t->object_count = count;
	t->count = 2 * count - 1;
	for (uint32_t k = 0; k < count; k++)
		t->objects[k] = w.list[t->objects[k]];
	number_nodes(s, w.cells, t);
	return true;
}

/* ---- from commit to commit ---- */

/* Where a static object was among those of before, GI_NONE: it was not. */
static uint32_t slot_before(const gi_scene *now, const object_record *were, uint32_t slot)
{
	const uint32_t k = now->slots[slot];
	return were[k].committed && were[k].grouped && were[k].generation == now->objects[k].generation ? were[k].slot
													: GI_NONE;
}

/* Tops of before lie in the order of their first objects, larger ones first. */
static const scene_top *find_top(const gi_scene *was, uint32_t first, uint32_t end)
{
	uint32_t low = 0, high = was->top_count;
	while (low < high) {
		const uint32_t middle = low + (high - low) / 2;
		const scene_top *t = &was->tops[middle];
		if (t->first_slot < first || (t->first_slot == first && t->end_slot > end))
			low = middle + 1;
		else
			high = middle;
	}
	const scene_top *t = &was->tops[low];
	return low < was->top_count && t->first_slot == first && t->end_slot == end ? t : NULL;
}

/* One that was moved, and is to be static all the same, may leave the order as it is and the tree another. */
bool statics_are_same(const gi_scene *old, const gi_scene *now)
{
	if (old->statics_slot == GI_NONE || now->statics_slot == GI_NONE || old->first_source != now->first_source)
		return false;
	for (uint32_t slot = 0; slot < old->first_source; slot++)
		if (old->slots[slot] != now->slots[slot] || !now->objects[now->slots[slot]].committed)
			return false;
	for (uint32_t k = 0; k < old->top_count; k++)
		if (old->tops[k].first_slot != now->tops[k].first_slot ||
		    old->tops[k].end_slot != now->tops[k].end_slot)
			return false;
	return true;
}

void statics_follow(gi_scene *now, const gi_scene *was, const object_record *were, uint32_t update)
{
	uint32_t *begins = now->changed_slots, *last = NULL; /* of runs of objects that lay side by side before, too */
	for (uint32_t slot = 0; slot < now->first_source; slot++) {
		const uint32_t before = slot_before(now, were, slot);
		const bool goes_on = last && before != GI_NONE && slot_before(now, were, slot - 1) + 1 == before;
		begins[slot] = goes_on ? *last : slot;
		last = before == GI_NONE ? NULL : &begins[slot];
	}
	for (uint32_t k = 0; k < now->top_count; k++) {
		scene_top *top = &now->tops[k];
		const uint32_t first = slot_before(now, were, top->first_slot);
		const bool same = begins[top->end_slot - 1] <= top->first_slot;
		const scene_top *before = same ? find_top(was, first, first + (top->end_slot - top->first_slot)) : NULL;
		if (before)
			now->sums[k] = was->sums[before - was->tops];
		now->sums[k].known = before;
		top->before = before ? before->node : GI_NONE;
		top->changed = before ? before->changed : update;
	}
}

/* ---- tops ---- */

static const double ANY = 3.14159265358979323846;

/* R T R' of a symmetric matrix. */
static void turn_spread(const double m[3][3], const gi_node_spread *s, double out[6])
{
	const double t[3][3] = {{s->diagonal.x, s->mixed.x, s->mixed.z},
				{s->mixed.x, s->diagonal.y, s->mixed.y},
				{s->mixed.z, s->mixed.y, s->diagonal.z}};
	static const int places[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};
	for (int k = 0; k < 6; k++) {
		out[k] = 0;
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++)
				out[k] += m[places[k][0]][i] * t[i][j] * m[places[k][1]][j];
	}
}

static static_sum sum_object(const gi_object_data *d, const gi_node_geometry *g, const gi_node_spread *spread,
			     const gi_node_topology *t)
{
	const double m[3][3] = {
	    {d->row0.x, d->row0.y, d->row0.z}, {d->row1.x, d->row1.y, d->row1.z}, {d->row2.x, d->row2.y, d->row2.z}};
	static_sum s = {.centre = gi_point_to_world(d, gi_vec3d_from(g->sphere)),
			.moment = gi_direction_to_world(d, gi_vec3d_from(g->moment)),
			.axis = gi_direction_to_world(d, gi_vec3d_from(g->axis)),
			.radius = g->sphere.w,
			.area = g->moment.w,
			.shape = (double)spread->mixed.w * g->moment.w,
			.cone = g->axis.w < 0 ? ANY : acos(fmin(1, (double)g->axis.w)),
			.first_leaf = t->range.y,
			.leaf_count = t->range.z,
			.back = t->range.w & GI_NODE_BACK};
	turn_spread(m, spread, s.spread);
	return s;
}

/* The ball about two. */
static void include_ball(static_sum *to, const static_sum *a, const static_sum *b)
{
	const gi_vec3d ab = gi_vec3d_sub(b->centre, a->centre);
	const double d = gi_vec3d_length(ab);
	if (d + b->radius <= a->radius || d + a->radius <= b->radius) {
		const static_sum *larger = a->radius > b->radius ? a : b;
		to->centre = larger->centre;
		to->radius = larger->radius;
		return;
	}
	to->radius = .5 * (d + a->radius + b->radius);
	to->centre = gi_vec3d_add(a->centre, gi_vec3d_scale(ab, (to->radius - a->radius) / d));
}

static double angle_to(gi_vec3d axis, const static_sum *s)
{
	return s->cone >= ANY ? ANY : s->cone + acos(fmax(-1, fmin(1, gi_vec3d_dot(axis, s->axis))));
}

static static_sum join(const static_sum *a, const static_sum *b)
{
	static_sum s = {.moment = gi_vec3d_add(a->moment, b->moment),
			.area = a->area + b->area,
			.shape = a->shape + b->shape,
			.axis = {0, 0, 1},
			.cone = ANY,
			.first_leaf = a->first_leaf,
			.leaf_count = a->leaf_count + b->leaf_count,
			.back = a->back | b->back};
	for (int k = 0; k < 6; k++)
		s.spread[k] = a->spread[k] + b->spread[k];
	include_ball(&s, a, b);
	const double length = gi_vec3d_length(s.moment);
	if (length > 1e-6 * s.area) {
		s.axis = gi_vec3d_scale(s.moment, 1 / length);
		s.cone = fmax(angle_to(s.axis, a), angle_to(s.axis, b));
	}
	return s;
}

/* Balls and cones a hair wider than rounding needs; from a right angle on any direction goes. */
static void store(const static_sum *s, uint32_t end, const scene_top *top, gi_node_geometry *g, gi_node_spread *spread,
		  gi_node_topology *t)
{
	const double cosine = cos(s->cone) - 1e-6;
	g->sphere = (gi_vec4){(float)s->centre.x, (float)s->centre.y, (float)s->centre.z,
			      (float)(s->radius * (1 + 1e-6) + 1e-6 * gi_vec3d_length(s->centre))};
	g->axis = (gi_vec4){(float)s->axis.x, (float)s->axis.y, (float)s->axis.z,
			    s->cone < ANY / 2 && cosine > 0 ? (float)cosine : -1};
	g->moment = (gi_vec4){(float)s->moment.x, (float)s->moment.y, (float)s->moment.z, (float)s->area};
	spread->diagonal = (gi_vec4){(float)s->spread[0], (float)s->spread[1], (float)s->spread[2], 0};
	spread->mixed =
	    (gi_vec4){(float)s->spread[3], (float)s->spread[4], (float)s->spread[5], (float)(s->shape / s->area)};
	t->range = (gi_uvec4){end, s->first_leaf, s->leaf_count,
			      GI_NODE_TOP | s->back | GI_NODE_THICKNESS_STEPS << GI_NODE_THICKNESS_SHIFT};
	t->corners = (gi_uvec4){top->id, top->changed, GI_NONE, GI_NONE};
}

/* Of what is below a node. */
static static_sum sum_of(const static_node *n, const gi_scene *s, const gi_node_geometry *rest,
			 const gi_node_spread *spread, const gi_node_topology *topology)
{
	return n->top
		   ? s->sums[n->number]
		   : sum_object(&s->object_data[n->first_slot], &rest[n->node], &spread[n->node], &topology[n->node]);
}

static bool is_known(const static_node *n, const gi_scene *s)
{
	const object_record *o = &s->objects[s->slots[n->first_slot]];
	return n->top ? s->sums[n->number].known : o->committed && !o->moved;
}

void statics_place(const static_tree *t, gi_scene *s, gi_node_geometry *rest, gi_node_spread *spread,
		   gi_node_topology *topology)
{
	for (uint32_t k = t->count; k-- > 0;) {
		const static_node *n = &t->nodes[k];
		if (!n->top)
			continue;
		const static_node *first = &t->nodes[k + 1], *second = &t->nodes[first->skip];
		static_sum *sum = &s->sums[n->number];
		if (sum->known && is_known(first, s) && is_known(second, s)) {
			sum->first_leaf = s->objects[s->slots[n->first_slot]].leaf_base;
		} else {
			const static_sum a = sum_of(first, s, rest, spread, topology),
					 b = sum_of(second, s, rest, spread, topology);
			*sum = join(&a, &b);
		}
		const uint32_t end = n->skip < t->count ? t->nodes[n->skip].node : t->node_count;
		store(sum, end, &s->tops[n->number], &rest[n->node], &spread[n->node], &topology[n->node]);
	}
}
