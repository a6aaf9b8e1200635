/* Objects whose shape changes: the same steps when one is made, when it is given another shape, and for every part of
 * it, so that what an object is now is a function of its definition and the shape alone.
 */
#include "object_build.h"

#include "bits.h"
#include "hierarchy_quad.h"

#include <math.h>

void object_hide_backs(gi_hierarchy *h)
{
	for (uint32_t n = 0; n < h->node_count; n++)
		h->topology[n].range.w &= ~GI_NODE_BACK;
}

static bool is_near(gi_vec4 v)
{
	return object_all_within(&v.x, 3, OBJECT_MAX_LENGTH);
}

static gi_result refuse_face(const gi_log *log, const object_record *o, const char *name, uint32_t leaf)
{
	return gi_fail(log, GI_ERROR_INVALID_GEOMETRY,
		       "object '%s': face %u has collapsed: its leaves must keep areas of 1e-24 m2 and more", name,
		       o->deform->faces[leaf]);
}

/* Is what was tried a shape that can be lit? */
static gi_result check_trial(const gi_log *log, const object_record *o, const char *name)
{
	const gi_hierarchy *h = &o->hierarchy;
	const gi_vec4 *v = o->deform->trial;
	for (uint32_t k = 0; k < h->vertex_count; k++)
		if (!is_near(v[k]))
			return gi_fail(log, GI_ERROR_INVALID_GEOMETRY,
				       "object '%s': a vertex is not finite, or farther than 1e9 m from its origin",
				       name);
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++) {
		const gi_uvec4 c = h->topology[h->leaf_node[leaf]].corners;
		const quad q = {gi_vec3d_from(v[c.x]), gi_vec3d_from(v[c.y]), gi_vec3d_from(v[c.z]),
				gi_vec3d_from(v[c.w])};
		if (!((float)quad_area(&q) >= OBJECT_MIN_AREA))
			return refuse_face(log, o, name, leaf);
	}
	return GI_OK;
}

gi_result object_try_shape(const gi_log *log, object_record *o, const char *name, const gi_shape *shape)
{
	gi_deform_try(o->deform, shape);
	const gi_result result = check_trial(log, o, name);
	if (!result)
		gi_deform_take(o->deform, shape);
	return result;
}

/* The hierarchy by the shape that was set last. */
static void refit_hierarchy(object_record *o)
{
	gi_deform_settle(o->deform, &o->hierarchy);
	gi_hierarchy_refit(&o->hierarchy, o->deform->sums);
	if (o->deform->two_sided)
		object_hide_backs(&o->hierarchy);
}

gi_result object_make_shape(const gi_log *log, const gi_object_def *def, const char *name, gi_refined *refined,
			    object_record *o)
{
	o->deform = gi_deform_make(def, refined, &o->hierarchy);
	if (!o->deform)
		return gi_fail(log, GI_ERROR_OUT_OF_MEMORY, "object '%s': out of memory", name);
	const gi_result result = object_try_shape(log, o, name, &o->deform->next);
	if (!result)
		refit_hierarchy(o);
	return result;
}

void object_note_sizes(object_record *o)
{
	for (uint32_t k = 0; k < o->bvh.primitive_count; k++)
		o->deform->by_size[k] = gi_bits_from_float(o->bvh.primitives[o->by_size[k]].a.w);
}

/* Primitives change places with the tree, their order of size does not. */
static void rebuild_tree(object_record *o)
{
	const uint32_t leaves = o->hierarchy.leaf_count;
	gi_box *boxes = o->deform->scratch;
	uint32_t *order = (uint32_t *)(boxes + leaves), *place = order + leaves;
	gi_bvh_rebuild(&o->hierarchy, &o->bvh, boxes, order);
	for (uint32_t k = 0; k < leaves; k++)
		place[order[k]] = k;
	for (uint32_t k = 0; k < leaves; k++)
		o->by_size[k] = place[o->deform->by_size[k]];
}

void object_apply_shape(object_record *o)
{
	refit_hierarchy(o);
	rebuild_tree(o);
	o->reshapes = false;
}

bool object_refit_drawn(object_record *o)
{
	const bool late = o->deform && o->deform->drawn_is_late;
	if (late)
		gi_deform_draw(o->deform, &o->hierarchy, &o->drawn);
	return late;
}
