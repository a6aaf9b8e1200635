#include "loans.h"

#include "bits.h"
#include "context.h"
#include "frames.h"
#include "host_memory.h"

#include <math.h>

/* Searches of one update, shared out to the objects: leaves below one node ask together where there are more. Each
 * takes some microseconds. */
enum { MOST_SEARCHES = 2048, LEAST_SEARCHES = 6 };

/* Cosine between normals that face the same way. */
static const double ALIKE = 0.5;

static bool is_new(const gi_scene *s, uint32_t slot)
{
	return s->slots[slot] != GI_NONE && s->objects[s->slots[slot]].arrives &&
	       object_is_seen(&s->objects[s->slots[slot]]);
}

/* ---- the nearest leaf ---- */

/* What looks for one, in the world; and the best so far. */
typedef struct search {
	gi_vec3d place, normal;
	double nearest; /* squared distance, more where normals differ */
	uint32_t leaf;
} search;

static double squared(gi_vec3d v)
{
	return gi_vec3d_dot(v, v);
}

/* Does no leaf below the node face the way of n? */
static bool faces_elsewhere(const gi_node_geometry *g, gi_vec3d n)
{
	if (g->axis.w < 0)
		return false;
	const double apart = acos(fmax(-1, fmin(1, gi_vec3d_dot(gi_vec3d_from(g->axis), n))));
	return apart - acos(fmin(1, (double)g->axis.w)) > acos(ALIKE);
}

static void search_object(const object_record *o, const gi_object_data *d, search *s)
{
	const gi_hierarchy *h = &o->hierarchy;
	const gi_vec3d place = gi_point_to_rest(d, s->place), normal = gi_direction_to_rest(d, s->normal);
	for (uint32_t n = 0; n < h->node_count;) {
		const gi_node_geometry *g = &h->geometry[n];
		const gi_uvec4 range = h->topology[n].range;
		const double distance = sqrt(squared(gi_vec3d_sub(gi_vec3d_from(g->sphere), place)));
		const double least = fmax(0, distance - g->sphere.w);
		if (least * least >= s->nearest || faces_elsewhere(g, normal)) {
			n = range.x;
			continue;
		}
		n++;
		if (!(range.w & GI_NODE_LEAF))
			continue;
		const double cosine = gi_vec3d_dot(gi_vec3d_from(g->axis), normal);
		const double far = distance * distance / (cosine * cosine);
		if (cosine >= ALIKE && far < s->nearest) {
			s->nearest = far;
			s->leaf = o->leaf_base + range.y;
		}
	}
}

static double distance_to_box(const gi_bvh_node *n, gi_vec3d p)
{
	const double at[3] = {p.x, p.y, p.z};
	double sum = 0;
	for (int k = 0; k < 3; k++) {
		const double off = fmax(0, fmax((&n->lower.x)[k] - at[k], at[k] - (&n->upper.x)[k]));
		sum += off * off;
	}
	return sum;
}

/* GI_NONE: nothing faces that way. */
static uint32_t lender(const gi_scene *s, gi_vec3d place, gi_vec3d normal)
{
	search found = {place, normal, INFINITY, GI_NONE};
	for (uint32_t n = 0; n < s->tlas_all;) {
		const bool leaf = s->tlas_packed[n].w & GI_PACKED_LEAF;
		if (distance_to_box(&s->tlas[n], place) >= found.nearest) {
			n = leaf ? n + 1 : gi_bits_from_float(s->tlas[n].lower.w);
			continue;
		}
		const uint32_t slot = s->tlas_packed[n++].w & ~GI_PACKED_LEAF;
		if (leaf && !is_new(s, slot))
			search_object(&s->objects[s->slots[slot]], &s->object_data[slot], &found);
	}
	return found.leaf;
}

/* ---- the list ---- */

/* Nodes of at most so many leaves ask for all of them. Returns how many pairs there are. */
static uint32_t list_object(const gi_scene *s, uint32_t slot, uint32_t searches, uint32_t *list)
{
	const object_record *o = &s->objects[s->slots[slot]];
	const gi_hierarchy *h = &o->hierarchy;
	const gi_object_data *d = &s->object_data[slot];
	const uint32_t together = h->leaf_count / searches;
	uint32_t count = 0;
	for (uint32_t n = 0; n < h->node_count;) {
		const gi_uvec4 range = h->topology[n].range;
		if (range.z > together && !(range.w & GI_NODE_LEAF)) {
			n++;
			continue;
		}
		n = range.x;
		const gi_node_geometry *g = &h->geometry[h->leaf_node[range.y + range.z / 2]];
		const uint32_t from = lender(s, gi_point_to_world(d, gi_vec3d_from(g->sphere)),
					     gi_direction_to_world(d, gi_vec3d_from(g->axis)));
		for (uint32_t k = 0; from != GI_NONE && k < range.z; k++, count++) {
			list[2 * count] = o->leaf_base + range.y + k;
			list[2 * count + 1] = from;
		}
	}
	return count;
}

gi_result loans_find(gi_context *gi, loans *out)
{
	const gi_scene *s = &gi->scene;
	uint64_t leaves = 0;
	uint32_t objects = 0;
	*out = (loans){0};
	for (uint32_t slot = 0; slot < s->slot_count; slot++)
		if (is_new(s, slot)) {
			objects++;
			leaves += s->objects[s->slots[slot]].hierarchy.leaf_count;
		}
	if (!objects || leaves == s->leaf_count)
		return GI_OK;
	uint32_t *list = gi_malloc(2 * sizeof *list * leaves);
	if (!list)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	const uint32_t share = MOST_SEARCHES / objects, searches = share > LEAST_SEARCHES ? share : LEAST_SEARCHES;
	for (uint32_t slot = 0; slot < s->slot_count; slot++)
		if (is_new(s, slot))
			out->count += list_object(s, slot, searches, list + 2 * (size_t)out->count);
	gi_result result = GI_OK;
	if (out->count)
		result =
		    gpu_buffer_allocate(&gi->gpu, &out->list, buffer_labels.LOANS, 2 * sizeof *list * out->count, list);
	gi_free(list);
	return result;
}

void loans_give(gi_context *gi, loans *owner)
{
	if (!owner->count)
		return;
	const uint32_t program = gi->budget.lend_program;
	LOAN_BUFFERS(BUFFER_BIND)
	gpu_set_uint(&gi->gpu, program, 0, owner->count);
	gpu_dispatch(&gi->gpu, program, owner->count);
	gpu_bind(&gi->gpu, GI_BIND_LOANS, &gi->scene.large_nodes_gpu);
	loans_free(gi, owner);
}

void loans_free(gi_context *gi, loans *owner)
{
	LOAN_BUFFERS(BUFFER_FREE)
	owner->count = 0;
}
