/* The public functions about receivers: arguments are checked here. */
#include "context.h"
#include "handles.h"
#include "host_memory.h"

#include <math.h>
#include <string.h>

static const uint32_t RECEIVERS_COOKIE = 0x47495231u;

/* What entries can name (gi_shared.h), long before what memory holds. */
static const uint32_t MOST_POINTS = GI_ENTRY_LEAF_MASK;

gi_receivers_def gi_receivers_def_default(void)
{
	return (gi_receivers_def){.pose.rotation = {0, 0, 0, 1}, .internal = RECEIVERS_COOKIE};
}

static bool is_length(float value)
{
	return fabsf(value) <= OBJECT_MAX_LENGTH;
}

static gi_result check_def(const gi_context *gi, const gi_receivers_def *def)
{
	const gi_log *log = &gi->gpu.log;
	if (!def->positions || def->count < 1 || def->count > MOST_POINTS)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT,
			       "receivers: positions and a count from 1 to %u are needed", MOST_POINTS);
	if (def->harmonics > 2 || (!def->normals && !def->harmonics))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT,
			       "receivers: harmonics %u is outside 0..2, or 0 without normals", def->harmonics);
	if (!(def->size >= 0) || !is_length(def->size) || !is_length(def->offset))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT,
			       "receivers: size is below 0, or it or offset beyond 1e9 m");
	return GI_OK;
}

gi_result gi_create_receivers(gi_context *gi, const gi_receivers_def *def, gi_receivers *out)
{
	if (out)
		*out = (gi_receivers){0};
	if (!gi || !def || !out)
		return gi_fail_null(gi, "gi_create_receivers: def and out");
	if (def->internal != RECEIVERS_COOKIE)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_DEF, "start from gi_receivers_def_default()");
	if (check_def(gi, def))
		return GI_ERROR_INVALID_ARGUMENT;
	const object_record *o = def->object.index1 ? handles_find(gi, def->object) : NULL;
	if (def->object.index1 && !o)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_HANDLE, "receivers: their object is stale");
	gi_receivers_def checked = *def;
	if (o)
		checked.pose = o->pose;
	if (!object_normalise_pose(&gi->gpu.log, &checked.pose, "receivers"))
		return GI_ERROR_INVALID_POSE;
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	const gi_result result = receiver_sets_create(gi, &checked, NULL, out);
	gi_memory_from(before);
	return result;
}

gi_result gi_destroy_receivers(gi_context *gi, gi_receivers receivers)
{
	if (!gi)
		return gi_fail_null(gi, "");
	receiver_set *set = receiver_sets_find(gi, receivers);
	if (!set)
		return gi_fail_stale(gi, "gi_destroy_receivers", "set of receivers");
	receiver_sets_remove(set);
	return GI_OK;
}

bool gi_receivers_are_valid(const gi_context *gi, gi_receivers receivers)
{
	return gi && receiver_sets_find(gi, receivers);
}

gi_result gi_set_receivers_pose(gi_context *gi, gi_receivers receivers, gi_pose pose)
{
	if (!gi)
		return gi_fail_null(gi, "");
	receiver_set *set = receiver_sets_find(gi, receivers);
	if (!set)
		return gi_fail_stale(gi, "gi_set_receivers_pose", "set of receivers");
	if (set->object.index1 || set->grid.spacing > 0)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT,
			       "gi_set_receivers_pose: these are fixed to an object and move with it, or probes");
	if (!object_normalise_pose(&gi->gpu.log, &pose, "receivers"))
		return GI_ERROR_INVALID_POSE;
	set->moved = set->moved || memcmp(&pose, &set->pose, sizeof pose) != 0;
	set->pose = pose;
	return GI_OK;
}

gi_result gi_set_receivers(gi_context *gi, gi_receivers receivers, const float *positions, const float *normals)
{
	if (!gi)
		return gi_fail_null(gi, "");
	receiver_set *set = receiver_sets_find(gi, receivers);
	if (!set)
		return gi_fail_stale(gi, "gi_set_receivers", "set of receivers");
	if (set->grid.spacing > 0)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT, "gi_set_receivers: probes stay on their grid");
	return receiver_set_reshape(gi, set, positions, normals);
}

gi_result gi_get_receiver_buffer(const gi_context *gi, gi_receivers receivers, gi_receiver_buffer *out)
{
	if (!gi || !out)
		return gi_fail_null(gi, "gi_get_receiver_buffer: out");
	const receiver_set *set = receiver_sets_find(gi, receivers);
	if (!set)
		return gi_fail_stale(gi, "gi_get_receiver_buffer", "set of receivers");
	const receiver_place *place = receive_place(gi, set);
	if (!place)
		return gi_fail(&gi->gpu.log, GI_ERROR_NOT_COMMITTED,
			       "gi_get_receiver_buffer: call gi_commit() and gi_update() first");
	*out = (gi_receiver_buffer){gi->receive->light.name, place->light, set->count, set->coefficients};
	return GI_OK;
}

gi_result gi_read_receivers(gi_context *gi, gi_receivers receivers, float *light, uint32_t capacity, uint32_t *count)
{
	gi_receiver_buffer where;
	if (count)
		*count = 0;
	if (!gi || !count)
		return gi_fail_null(gi, "gi_read_receivers: count");
	gi_result result = gi_finish(gi);
	if (!result)
		result = gi_get_receiver_buffer(gi, receivers, &where);
	if (result)
		return result;
	*count = where.count * where.stride;
	const uint64_t wanted = capacity < *count ? capacity : *count;
	if (light && wanted)
		gpu_buffer_read(&gi->gpu, &gi->receive->light, sizeof(gi_vec4) * where.first, sizeof(gi_vec4) * wanted,
				light);
	return GI_OK;
}
