/* Trees over the scene's objects ("top-level"), made anew for every update: one over all, which rays to the sky and
 * path tracing walk, and one without the walls that enclose the scene, which lie between no two points of it.
 *
 *   tlas_gpu   | all objects: at most 2 n - 1 nodes | inner objects | unused
 *
 * Objects that are not seen are in neither.
 */
#include "tlas.h"

#include "bits.h"
#include "bvh_pack.h"
#include "context.h"
#include "frames.h"

#include <math.h>

/* What pokes through a plane by less, as a share of the coordinates involved, lies in it: rays' ends must lie farther
 * off to be behind it (PLANE_SLACK of segments.glsl is this). */
static const double HULL_SLACK = 2.5e-7;

/* Surfaces within so many times HULL_SLACK of the plane may count as in it for some ray: more than rounding adds in
 * another object's frame. */
static const double TOUCHING = 16;

/* Cosine between the normals of two planes that may be one. */
static const double PARALLEL = 0.999;

/* World boxes that share less than this of the smaller one's side only touch: tiles of one floor. */
static const float OVERLAPPING = 1e-3f;

/* How far an object's box reaches along a unit normal, from its centre: a turned box, not a world box about it. */
static double reach_along(const object_record *o, const gi_object_data *data, gi_vec4 n)
{
	const float turn[3][3] = {{data->row0.x, data->row0.y, data->row0.z},
				  {data->row1.x, data->row1.y, data->row1.z},
				  {data->row2.x, data->row2.y, data->row2.z}};
	double reach = 0;
	for (int k = 0; k < 3; k++) {
		const double half = 0.5 * ((double)(&o->hierarchy.upper.x)[k] - (&o->hierarchy.lower.x)[k]);
		reach += half * fabs((double)n.x * turn[0][k] + (double)n.y * turn[1][k] + (double)n.z * turn[2][k]);
	}
	return reach;
}

/* Do their boxes have more in common than an edge? */
static bool share_a_face(const object_record *a, const object_record *b)
{
	const float *al = &a->world_lower.x, *au = &a->world_upper.x, *bl = &b->world_lower.x, *bu = &b->world_upper.x;
	bool shared = true;
	for (int k = 0; k < 3; k++) {
		const float smaller = fminf(au[k] - al[k], bu[k] - bl[k]);
		shared = shared && fminf(au[k], bu[k]) - fmaxf(al[k], bl[k]) > OVERLAPPING * smaller;
	}
	return shared;
}

/* A plane in an object's rest frame: normal, height along it. */
typedef struct rest_plane {
	double normal[3], height;
} rest_plane;

static rest_plane plane_at_rest(gi_vec4 world, const gi_object_data *data)
{
	const gi_vec3d n = gi_vec3d_from(world), turned = gi_direction_to_rest(data, n);
	return (rest_plane){{turned.x, turned.y, turned.z},
			    world.w - n.x * data->row0.w - n.y * data->row1.w - n.z * data->row2.w};
}

static double off_plane(const rest_plane *p, const float x[3])
{
	return p->normal[0] * x[0] + p->normal[1] * x[1] + p->normal[2] * x[2] - p->height;
}

static bool box_meets(const gi_bvh_node *n, const rest_plane *p, double slack)
{
	float middle[3];
	double reach = slack;
	for (int k = 0; k < 3; k++) {
		const float lower = (&n->lower.x)[k], upper = (&n->upper.x)[k];
		middle[k] = 0.5f * lower + 0.5f * upper;
		reach += 0.5 * ((double)upper - lower) * fabs(p->normal[k]);
	}
	return fabs(off_plane(p, middle)) <= reach;
}

static bool lies_in(const gi_primitive *q, const rest_plane *p, double slack)
{
	const float *corners[4] = {&q->a.x, &q->b.x, &q->c.x, &q->d.x};
	for (int i = 0; i < 4; i++)
		if (!(fabs(off_plane(p, corners[i])) <= slack))
			return false;
	return true;
}

static bool has_face_in(const gi_bvh *bvh, const rest_plane *p, double slack)
{
	for (uint32_t n = 0; n < bvh->node_count;) {
		const uint32_t primitive = gi_bits_from_float(bvh->nodes[n].upper.w);
		const bool meets = box_meets(&bvh->nodes[n], p, slack);
		if (meets && primitive != GI_NONE && lies_in(&bvh->primitives[primitive], p, slack))
			return true;
		n = meets ? n + 1 : gi_bits_from_float(bvh->nodes[n].lower.w);
	}
	return false;
}

/* Does the other object have a surface in the plane of the flat one that the flat one hides from where all objects are
 * (rank.h)? Closed ones turn their backs to it. */
static bool may_cover(const gi_scene *s, uint32_t flat, uint32_t slot, double slack)
{
	const object_record *by = &s->objects[s->slots[flat]], *o = &s->objects[s->slots[slot]];
	const gi_object_data *data = &s->object_data[slot];
	const gi_vec4 n = s->object_data[flat].plane, m = data->plane;
	const double cosine = (double)n.x * m.x + (double)n.y * m.y + (double)n.z * m.z;
	if (o->plane)
		return (cosine < -PARALLEL || (cosine > PARALLEL && by->highest_rank > o->lowest_rank)) &&
		       share_a_face(by, o);
	const rest_plane p = plane_at_rest(n, data);
	return !(o->hierarchy.closed && o->hierarchy.volume > 0) && has_face_in(&o->bvh, &p, slack);
}

/* On which sides of a plane are receivers? Of their squares those that lie in it are on neither. */
static void find_receivers(const gi_context *gi, gi_vec4 plane, bool *front, bool *behind)
{
	static const double ALONG = 1 - 1e-6;
	const gi_scene *s = &gi->scene;
	for (uint32_t k = 0; k < s->set_count; k++) {
		const receiver_set *set = &gi->receivers.list[s->sets[k].set];
		const rest_plane p = plane_at_rest(plane, &s->object_data[s->slot_count + k]);
		for (uint32_t i = 0; i < set->count && !(*front && *behind); i++) {
			const receiver_point *point = &set->points[i];
			double off = -p.height, cosine = 0, far = fabs(p.height) + fabs((double)plane.w);
			for (int c = 0; c < 3; c++) {
				const double n = (double)point->normal[c], at = point->position[c] + n * set->offset;
				off += p.normal[c] * at;
				cosine += p.normal[c] * n;
				far += fabs(at);
			}
			const double reach =
			    fabs(cosine) < ALONG ? 0.5 * (double)set->size * sqrt(2 - 2 * cosine * cosine) : 0;
			*front = *front || off + reach > HULL_SLACK * far;
			*behind = *behind || off - reach < -HULL_SLACK * far;
		}
	}
}

/* Does the object lie in a plane with all others on one side of it and none in it, as a wall of a room does, and
 * receivers too? Then it hides only what is beyond all of them. */
static bool encloses(const gi_context *gi, uint32_t slot)
{
	const gi_scene *s = &gi->scene;
	const gi_vec4 plane = s->object_data[slot].plane;
	bool front = false, behind = false;
	for (uint32_t k = 0; k < s->slot_count && !(front && behind); k++) {
		if (k == slot || !scene_slot_is_seen(s, k))
			continue;
		const gi_object_data *data = &s->object_data[k];
		const gi_vec4 c = data->sphere;
		const double along = (double)plane.x * c.x + (double)plane.y * c.y + (double)plane.z * c.z;
		const double reach = reach_along(&s->objects[s->slots[k]], data, plane);
		const double slack = HULL_SLACK * (fabs(along) + reach + fabs((double)plane.w));
		front = front || along + reach - plane.w > slack;
		behind = behind || along - reach - plane.w < -slack;
		const double far = fabs((double)c.x) + fabs((double)c.y) + fabs((double)c.z) + c.w;
		const double near = TOUCHING * HULL_SLACK * far;
		if (fabs(along - plane.w) - reach <= near && may_cover(s, slot, k, near))
			return false;
	}
	if (!(front && behind))
		find_receivers(gi, plane, &front, &behind);
	return !(front && behind);
}

/* Puts a tree of its own at node `base` of a larger one, whose boxes are numbered on from `first`. */
static void shift_tree(gi_bvh_node *nodes, uint32_t count, uint32_t base, uint32_t first)
{
	for (uint32_t k = 0; k < count; k++) {
		const uint32_t primitive = gi_bits_from_float(nodes[k].upper.w);
		nodes[k].lower.w = gi_float_from_bits(gi_bits_from_float(nodes[k].lower.w) + base);
		if (primitive != GI_NONE)
			nodes[k].upper.w = gi_float_from_bits(primitive + first);
	}
}

/* The tree over boxes, of which `statics` come before the others, in its order too: what hides a segment is a static
 * object wherever one does, whatever moved before it. */
static void build_in_order(const gi_box *boxes, uint32_t count, uint32_t statics, gi_bvh_node *nodes, uint32_t *order)
{
	if (statics == 0 || statics == count) {
		gi_bvh_build_boxes(boxes, count, nodes, order);
		return;
	}
	const uint32_t others = count - statics, behind = 2 * statics;
	gi_bvh_build_boxes(boxes, statics, nodes + 1, order);
	gi_bvh_build_boxes(boxes + statics, others, nodes + behind, order + statics);
	shift_tree(nodes + 1, 2 * statics - 1, 1, 0);
	shift_tree(nodes + behind, 2 * others - 1, behind, statics);
	for (uint32_t k = statics; k < count; k++)
		order[k] += statics;
	for (int k = 0; k < 3; k++) {
		(&nodes->lower.x)[k] = fminf((&nodes[1].lower.x)[k], (&nodes[behind].lower.x)[k]);
		(&nodes->upper.x)[k] = fmaxf((&nodes[1].upper.x)[k], (&nodes[behind].upper.x)[k]);
	}
	nodes->lower.w = gi_float_from_bits(2 * count - 1);
	nodes->upper.w = gi_float_from_bits(GI_NONE);
}

/* What building takes: of each slot its number, its box and its place in a tree, and a tree's nodes. */
typedef struct room {
	uint32_t *slots, *order;
	gi_box *boxes;
	gi_bvh_node *nodes;
} room;

/* The tree over the first `count` of r->slots, in ascending order, behind the nodes that are there. */
static void build(gi_scene *s, const room *r, uint32_t count, uint32_t base, gi_bvh_node *nodes)
{
	uint32_t statics = 0;
	for (uint32_t k = 0; k < count; k++) {
		const object_record *o = &s->objects[s->slots[r->slots[k]]];
		r->boxes[k] = (gi_box){{o->world_lower.x, o->world_lower.y, o->world_lower.z},
				       {o->world_upper.x, o->world_upper.y, o->world_upper.z}};
		statics += r->slots[k] < s->first_source;
	}
	build_in_order(r->boxes, count, statics, nodes, r->order);
	if (base == 0 && count)
		gi_pack_grid(&(gi_vec4){nodes[0].lower.x, nodes[0].lower.y, nodes[0].lower.z, 0},
			     &(gi_vec4){nodes[0].upper.x, nodes[0].upper.y, nodes[0].upper.z, 0}, &s->tlas_grid,
			     &s->tlas_cells);
	for (uint32_t k = 0; count && k < 2 * count - 1; k++) {
		gi_uvec4 *packed = &s->tlas_packed[base + k];
		*packed = gi_pack_node(&nodes[k], s->tlas_grid, s->tlas_cells, base, 0);
		/* Leaves of the tree name slots directly. */
		if (packed->w & GI_PACKED_LEAF)
			packed->w = GI_PACKED_LEAF | r->slots[r->order[packed->w & ~GI_PACKED_LEAF]];
	}
}

static void build_both(gi_context *gi, const room *r)
{
	gi_scene *s = &gi->scene;
	uint32_t count = 0, inner = 0;
	for (uint32_t slot = 0; slot < s->slot_count; slot++)
		if (scene_slot_is_seen(s, slot))
			r->slots[count++] = slot;
	s->tlas_all = count ? 2 * count - 1 : 0;
	build(s, r, count, 0, s->tlas);
	for (uint32_t k = 0; k < count; k++)
		if (!s->objects[s->slots[r->slots[k]]].plane || !encloses(gi, r->slots[k]))
			r->slots[inner++] = r->slots[k];
	/* Mostly all of them: then one tree is both. */
	s->tlas_inner = inner && inner < count ? 2 * inner - 1 : 0;
	s->tlas_inner_first = inner < count ? s->tlas_count : 0;
	s->tlas_inner_end = inner < count ? s->tlas_count + s->tlas_inner : s->tlas_all;
	if (inner < count)
		build(s, r, inner, s->tlas_count, r->nodes);
}

static room take_room(const gi_scene *s, gi_arena *a)
{
	const size_t count = s->slot_count;
	return (room){.slots = gi_arena_take(a, count, sizeof(uint32_t)),
		      .order = gi_arena_take(a, count, sizeof(uint32_t)),
		      .boxes = gi_arena_take(a, count, sizeof(gi_box)),
		      .nodes = gi_arena_take(a, s->tlas_count, sizeof(gi_bvh_node))};
}

gi_result tlas_upload(gi_context *gi)
{
	gi_scene *s = &gi->scene;
	gi_arena_measure(&gi->tree_arena);
	take_room(s, &gi->tree_arena);
	if (!gi_arena_reserve(&gi->tree_arena))
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	const room r = take_room(s, &gi->tree_arena);
	build_both(gi, &r);
	gpu_buffer_upload(&gi->gpu, &s->tlas_gpu, 0, sizeof *s->tlas_packed * (s->tlas_count + s->tlas_inner),
			  s->tlas_packed);
	return GI_OK;
}
