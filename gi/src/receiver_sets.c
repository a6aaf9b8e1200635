#include "receiver_sets.h"

#include "context.h"
#include "frames.h"
#include "handles.h"
#include "host_memory.h"
#include "vec3d.h"

#include <string.h>

/* A square's side over the coordinates of its point, at least: then rounding turns it by less than a milliradian. */
static const float LEAST_SIZE = 0x1p-12f, LEAST_LENGTH = 1e-6f;

/* Ids of receivers begin here, above those of leaves. */
static const uint32_t FIRST_ID = 0x80000000u;

/* What budgets take for a receiver's surface: of a change d of its light they make rho d / (1 - rho), which is d. */
static const float RHO = 0.5f;

enum { CORNERS = GI_RECEIVER_CORNERS };

/* ---- the list ---- */

bool receiver_set_is_alive(const receiver_set *set)
{
	return set->generation & 1;
}

receiver_set *receiver_sets_find(const gi_context *gi, gi_receivers handle)
{
	const gi_receiver_sets *s = &gi->receivers;
	if (handle.context != gi->number || handle.index1 == 0 || handle.index1 > s->count)
		return NULL;
	receiver_set *set = &s->list[handle.index1 - 1];
	return receiver_set_is_alive(set) && set->generation == handle.generation ? set : NULL;
}

static receiver_set *free_place(gi_receiver_sets *s)
{
	for (uint32_t k = 0; k < s->count; k++)
		if (!receiver_set_is_alive(&s->list[k]) && !s->list[k].committed)
			return &s->list[k];
	receiver_set *grown = gi_realloc(s->list, sizeof *grown * ((size_t)s->count + 1));
	if (!grown)
		return NULL;
	s->list = grown;
	s->list[s->count] = (receiver_set){0};
	return &s->list[s->count++];
}

static bool add(gi_context *gi, const receiver_set *made, gi_receivers *out)
{
	gi_receiver_sets *s = &gi->receivers;
	receiver_set *place = free_place(s);
	if (!place)
		return false;
	receiver_set set = *made;
	set.generation = place->generation + 1;
	set.id = place->id;
	set.ids = place->ids;
	if (set.count > set.ids) {
		set.id = FIRST_ID + s->next_id;
		s->next_id += set.ids = set.count;
	}
	*place = set;
	*out = (gi_receivers){(uint32_t)(place - s->list) + 1, place->generation, gi->number};
	return true;
}

/* Sets the k-th point; false: out of range. Either array may be NULL. */
static bool set_point(receiver_point *p, const float *positions, const float *normals, size_t k)
{
	double length = 0;
	for (size_t c = 0; c < 3; c++) {
		if (positions)
			p->position[c] = positions[3 * k + c];
		if (normals)
			length += (double)normals[3 * k + c] * (double)normals[3 * k + c];
		if (!(fabsf(p->position[c]) <= OBJECT_MAX_LENGTH))
			return false;
	}
	if (!normals)
		return true;
	length = sqrt(length);
	if (!(length > 0) || !isfinite(length))
		return false;
	for (size_t c = 0; c < 3; c++)
		p->normal[c] = (float)((double)normals[3 * k + c] / length);
	return true;
}

/* False: nothing was set. */
static bool set_points(const gi_context *gi, receiver_point *points, uint32_t count, const float *positions,
		       const float *normals)
{
	for (uint32_t k = 0; k < count; k++)
		if (!set_point(&points[k], positions, normals, k)) {
			gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT,
				"receivers: point %u is beyond 1e9 m of the origin, or its normal is 0 or not finite",
				k);
			return false;
		}
	return true;
}

gi_result receiver_sets_create(gi_context *gi, const gi_receivers_def *def, const receiver_grid *grid,
			       gi_receivers *out)
{
	receiver_set set = {.object = def->object,
			    .pose = def->pose,
			    .count = def->count,
			    .coefficients = (def->harmonics + 1) * (def->harmonics + 1),
			    .size = def->size,
			    .offset = def->offset};
	if (grid)
		set.grid = *grid;
	set.points = gi_calloc(def->count, sizeof *set.points);
	gi_result result = set.points ? GI_OK : GI_ERROR_OUT_OF_MEMORY;
	if (!result && !set_points(gi, set.points, set.count, def->positions, def->normals)) {
		gi_free(set.points);
		return GI_ERROR_INVALID_ARGUMENT;
	}
	if (!result && !add(gi, &set, out))
		result = GI_ERROR_OUT_OF_MEMORY;
	if (!result)
		return GI_OK;
	gi_free(set.points);
	return gi_fail(&gi->gpu.log, result, "receivers: out of memory");
}

gi_result receiver_set_reshape(gi_context *gi, receiver_set *set, const float *positions, const float *normals)
{
	for (uint32_t k = 0; k < set->count; k++) {
		receiver_point scratch = set->points[k];
		if (!set_points(gi, &scratch, 1, positions ? positions + 3 * (size_t)k : NULL,
				normals ? normals + 3 * (size_t)k : NULL))
			return GI_ERROR_INVALID_ARGUMENT;
	}
	for (uint32_t k = 0; k < set->count; k++)
		set_point(&set->points[k], positions, normals, k);
	set->moved = set->reshaped = true;
	return GI_OK;
}

static void free_points(receiver_set *set)
{
	gi_free(set->points);
	*set = (receiver_set){.generation = set->generation, .id = set->id, .ids = set->ids};
}

/* Its rows are there until the next commit. */
void receiver_sets_remove(receiver_set *set)
{
	set->generation++;
	if (!set->committed)
		free_points(set);
}

bool receiver_set_is_round(const receiver_set *set)
{
	return set->coefficients > 1;
}

/* ---- in the scene ---- */

static const receiver_set *set_of(const gi_context *gi, const receiver_place *place)
{
	return &gi->receivers.list[place->set];
}

void receiver_sets_count(const gi_context *gi, gi_scene *next)
{
	for (uint32_t k = 0; k < gi->receivers.count; k++) {
		const receiver_set *set = &gi->receivers.list[k];
		if (!receiver_set_is_alive(set))
			continue;
		next->set_count++;
		next->receiver_count += set->count;
		next->light_words += set->count * set->coefficients;
	}
}

/* Those with normals first: others have programs of their own. */
static void order_sets(const gi_context *gi, gi_scene *next)
{
	uint32_t place = 0, first = 0, light = 0;
	for (int round = 0; round < 2; round++)
		for (uint32_t k = 0; k < gi->receivers.count; k++) {
			const receiver_set *set = &gi->receivers.list[k];
			if (!receiver_set_is_alive(set) || receiver_set_is_round(set) != round)
				continue;
			next->sets[place++] = (receiver_place){k, first, set->count, light};
			first += set->count;
			light += set->count * set->coefficients;
		}
}

float receiver_point_size(const receiver_set *set, const receiver_point *point)
{
	float reach = 0;
	for (int k = 0; k < 3; k++)
		reach = fmaxf(reach, fabsf(point->position[k]));
	return fmaxf(fmaxf(set->size, LEAST_SIZE * reach), LEAST_LENGTH);
}

/* Two directions across a unit normal; the first, the second and the normal are a right-handed frame. */
static void tangents_of(gi_vec3d n, gi_vec3d *first, gi_vec3d *second)
{
	const double x = fabs(n.x), y = fabs(n.y), z = fabs(n.z);
	const gi_vec3d least = x <= y && x <= z ? (gi_vec3d){1, 0, 0}
			       : y <= z         ? (gi_vec3d){0, 1, 0}
						: (gi_vec3d){0, 0, 1};
	*first = gi_vec3d_unit(gi_vec3d_cross(least, n));
	*second = gi_vec3d_cross(n, *first);
}

static gi_vec4 stored(gi_vec3d v, float w)
{
	return (gi_vec4){(float)v.x, (float)v.y, (float)v.z, w};
}

/* Where a point is in its frame, as what a leaf is: its node and four corners. */
static void shape_point(const receiver_set *set, const receiver_point *p, double leaf_area, gi_node_geometry *node,
			gi_vec4 corners[CORNERS])
{
	const gi_vec3d n = gi_vec3d_load(p->normal);
	const gi_vec3d at = gi_vec3d_add(gi_vec3d_load(p->position), gi_vec3d_scale(n, set->offset));
	const double half = 0.5 * (double)receiver_point_size(set, p);
	const bool round = receiver_set_is_round(set);
	*node = (gi_node_geometry){.sphere = stored(at, (float)(1.0001 * sqrt(2) * half)),
				   .axis = round ? (gi_vec4){0, 0, 0, -1} : stored(n, 1),
				   /* Budgets weigh rows by area: as a leaf's. */
				   .moment = stored(gi_vec3d_scale(n, round ? 0 : leaf_area), (float)leaf_area)};
	if (round) {
		for (int c = 0; c < CORNERS; c++)
			corners[c] = stored(at, 0);
		return;
	}
	gi_vec3d right, up;
	tangents_of(n, &right, &up);
	const double sides[CORNERS][2] = {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
	for (int c = 0; c < CORNERS; c++)
		corners[c] = stored(
		    gi_vec3d_add(at, gi_vec3d_add(gi_vec3d_scale(right, sides[c][0]), gi_vec3d_scale(up, sides[c][1]))),
		    0);
}

static void bound_points(const receiver_set *set, gi_object_data *data)
{
	gi_vec3d middle = {0, 0, 0};
	float *lower = &data->lower.x, *upper = &data->upper.x;
	double radius = 0;
	for (int k = 0; k < 3; k++) {
		lower[k] = INFINITY;
		upper[k] = -INFINITY;
		for (uint32_t i = 0; i < set->count; i++) {
			const float reach = receiver_point_size(set, &set->points[i]) + fabsf(set->offset);
			lower[k] = fminf(lower[k], set->points[i].position[k] - reach);
			upper[k] = fmaxf(upper[k], set->points[i].position[k] + reach);
		}
		(&middle.x)[k] = 0.5 * ((double)lower[k] + upper[k]);
		radius += ((double)upper[k] - lower[k]) * ((double)upper[k] - lower[k]);
	}
	data->sphere = stored(gi_point_to_world(data, middle), (float)(0.50001 * sqrt(radius)));
}

/* Turned to where it is. */
static void place_set(const receiver_set *set, gi_object_data *data)
{
	object_place_rows(&set->pose, data);
	bound_points(set, data);
}

static void gather_set(const gi_context *gi, gi_scene *next, uint32_t number, const receiver_arrays *to)
{
	const receiver_place *place = &next->sets[number];
	const receiver_set *set = set_of(gi, place);
	const uint32_t slot = next->slot_count + number, leaf = next->leaf_count + place->first,
		       node = next->node_count + place->first, vertex = next->vertex_count + CORNERS * place->first;
	const uint32_t thick = receiver_set_is_round(set) ? GI_NODE_THICKNESS_STEPS << GI_NODE_THICKNESS_SHIFT : 0;
	for (uint32_t k = 0; k < set->count; k++) {
		gi_vec4 *corners = to->vertices + vertex + CORNERS * (size_t)k;
		const uint32_t first = vertex + CORNERS * k;
		shape_point(set, &set->points[k], next->mean_area, &to->rest[node + k], corners);
		next->topology[node + k] = (gi_node_topology){{node + k + 1, leaf + k, 1, GI_NODE_LEAF | thick},
							      {first, first + 1, first + 2, first + 3}};
		memcpy(to->leaf_quads + CORNERS * (size_t)(leaf + k), corners, sizeof *corners * CORNERS);
		/* No ray ends on it: it has no rank. */
		to->leaves[leaf + k] = (gi_uvec4){node + k, slot, to->material_number, GI_NONE};
	}
	gi_object_data *data = &next->object_data[slot];
	data->nodes = (gi_uvec4){node, node + set->count, leaf, leaf + set->count};
	data->bvh = (gi_uvec4){0}; /* no tree: a set hides nothing */
	data->extra = (gi_uvec4){0, vertex, vertex + CORNERS * set->count, 0};
	data->ids = (gi_uvec4){set->id - leaf, 0, place->light, set->coefficients};
	place_set(set, data);
}

void receiver_sets_gather(const gi_context *gi, gi_scene *next, const receiver_arrays *to)
{
	order_sets(gi, next);
	for (uint32_t k = 0; k < next->set_count; k++)
		gather_set(gi, next, k, to);
	if (next->set_count)
		*to->material = (gi_material_data){.rho = {RHO, RHO, RHO, 0}};
}

void receiver_sets_committed(gi_context *gi, bool kept)
{
	for (uint32_t k = 0; k < gi->receivers.count; k++) {
		receiver_set *set = &gi->receivers.list[k];
		if (receiver_set_is_alive(set))
			set->moved = kept && (set->moved || !set->committed);
		else if (set->committed)
			free_points(set);
		set->committed = receiver_set_is_alive(set);
		set->reshaped = false;
	}
	for (uint32_t k = 0; k < gi->scene.set_count; k++)
		gi->receivers.list[gi->scene.sets[k].set].place = k;
}

/* ---- what moves ---- */

/* Takes the pose of the object that the set is fixed to; where that went it stays where it is. */
static void follow_object(const gi_context *gi, receiver_set *set)
{
	const object_record *o = set->object.index1 ? handles_find(gi, set->object) : NULL;
	if (!o || memcmp(&o->pose, &set->pose, sizeof set->pose) == 0)
		return;
	set->pose = o->pose;
	set->moved = true;
}

bool receiver_sets_changed(gi_context *gi)
{
	bool changed = false;
	for (uint32_t k = 0; k < gi->receivers.count; k++) {
		receiver_set *set = &gi->receivers.list[k];
		if (!receiver_set_is_alive(set))
			continue;
		follow_object(gi, set);
		changed = changed || (set->committed && set->moved);
	}
	return changed;
}

/* Its points, which are others than they were. */
static gi_result upload_points(gi_context *gi, const receiver_place *place, const receiver_set *set)
{
	gi_scene *s = &gi->scene;
	const uint64_t node = s->node_count + place->first, vertex = s->vertex_count + CORNERS * (uint64_t)place->first,
		       quad = CORNERS * ((uint64_t)s->leaf_count + place->first);
	const uint64_t node_bytes = sizeof(gi_node_geometry), corner_bytes = sizeof(gi_vec4);
	gi_node_geometry *nodes = gi_malloc(node_bytes * set->count);
	gi_vec4 *corners = gi_malloc(corner_bytes * CORNERS * set->count);
	const bool ok = nodes && corners;
	for (uint32_t k = 0; ok && k < set->count; k++)
		shape_point(set, &set->points[k], s->mean_area, &nodes[k], corners + CORNERS * (size_t)k);
	if (ok) {
		gpu_buffer_upload(&gi->gpu, &s->rest_gpu, node_bytes * node, node_bytes * set->count, nodes);
		gpu_buffer_upload(&gi->gpu, &s->vertices_rest_gpu, corner_bytes * vertex,
				  corner_bytes * CORNERS * set->count, corners);
		gpu_buffer_upload(&gi->gpu, &s->leaf_quads_gpu, corner_bytes * quad,
				  corner_bytes * CORNERS * set->count, corners);
	}
	gi_free(nodes);
	gi_free(corners);
	return ok ? GI_OK : gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
}

gi_result receiver_sets_upload(gi_context *gi)
{
	gi_scene *s = &gi->scene;
	gi_result result = GI_OK;
	for (uint32_t k = 0; k < s->set_count && !result; k++) {
		receiver_set *set = &gi->receivers.list[s->sets[k].set];
		if (!receiver_set_is_alive(set) || !set->moved)
			continue;
		if (set->reshaped)
			result = upload_points(gi, &s->sets[k], set);
		place_set(set, &s->object_data[s->slot_count + k]);
		set->reshaped = set->reshaped && result;
	}
	return result;
}

void receiver_sets_number(gi_context *gi, uint32_t update)
{
	gi_scene *s = &gi->scene;
	for (uint32_t k = 0; k < s->set_count; k++) {
		receiver_set *set = &gi->receivers.list[s->sets[k].set];
		set->moved_update = set->moved ? update : set->moved_update;
		s->object_data[s->slot_count + k].changed = (gi_uvec4){set->moved_update, 0, 0, 0};
	}
}

void receiver_sets_done(gi_context *gi)
{
	for (uint32_t k = 0; k < gi->receivers.count; k++)
		gi->receivers.list[k].moved = false;
}

void receiver_sets_free(gi_context *gi)
{
	for (uint32_t k = 0; k < gi->receivers.count; k++)
		gi_free(gi->receivers.list[k].points);
	gi_free(gi->receivers.list);
}
