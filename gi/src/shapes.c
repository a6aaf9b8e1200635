/* The public functions about shapes that change (deform.h): arguments are checked here, objects take what was set in
 * the next update or commit (reshape.c, scene_upload.c).
 */
#include "context.h"
#include "handles.h"
#include "host_memory.h"

#include <float.h>
#include <string.h>

/* The object, where it is one that deforms. */
static gi_result find(const gi_context *gi, gi_object object, const char *function, object_record **out)
{
	*out = handles_find(gi, object);
	if (!*out)
		return gi_fail_stale(gi, function, "object");
	if (!(*out)->deform)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT,
			       "%s: object '%s' was created without gi_object_def.deforms", function, (*out)->name);
	return GI_OK;
}

static gi_result check_finite(const gi_context *gi, const object_record *o, const char *function, const float *values,
			      size_t count)
{
	for (size_t k = 0; k < count; k++)
		if (!(values[k] >= -FLT_MAX && values[k] <= FLT_MAX))
			return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_GEOMETRY,
				       "%s: object '%s': number %zu is not finite", function, o->name, k);
	return GI_OK;
}

/* `shape`: what was set last, with what is set now in its place. */
static gi_result set_shape(gi_context *gi, object_record *o, const gi_shape *shape)
{
	const gi_result result = object_try_shape(&gi->gpu.log, o, o->name, shape);
	if (!result)
		o->reshapes = o->reshaped = o->moved = true;
	return result;
}

/* Bit for bit: what was got may be set again at no cost. */
static bool is_same(const float *a, const float *b, size_t count)
{
	return memcmp(a, b, sizeof *a * count) == 0;
}

gi_result gi_set_positions(gi_context *gi, gi_object object, const float *positions)
{
	static const char name[] = "gi_set_positions";
	object_record *o;
	if (!gi || !positions)
		return gi_fail_null(gi, "gi_set_positions: positions");
	gi_result result = find(gi, object, name, &o);
	const size_t count = result ? 0 : 3 * (size_t)o->deform->vertex_count;
	if (!result)
		result = check_finite(gi, o, name, positions, count);
	if (result || is_same(positions, o->deform->next.positions, count))
		return result;
	gi_shape shape = o->deform->next;
	shape.positions = (float *)positions;
	return set_shape(gi, o, &shape);
}

gi_result gi_set_draw_positions(gi_context *gi, gi_object object, const float *positions)
{
	static const char name[] = "gi_set_draw_positions";
	object_record *o;
	if (!gi || !positions)
		return gi_fail_null(gi, "gi_set_draw_positions: positions");
	gi_result result = find(gi, object, name, &o);
	const size_t count = result ? 0 : 3 * (size_t)o->deform->draw_count;
	if (!result && !count)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT,
			       "gi_set_draw_positions: object '%s' has no mesh that is drawn in its place", o->name);
	if (!result)
		result = check_finite(gi, o, name, positions, count);
	if (result || is_same(positions, o->deform->next.draw_positions, count))
		return result;
	gi_shape shape = o->deform->next;
	shape.draw_positions = (float *)positions;
	return set_shape(gi, o, &shape);
}

gi_result gi_set_joints(gi_context *gi, gi_object object, const float *matrices, uint32_t count)
{
	static const char name[] = "gi_set_joints";
	object_record *o;
	if (!gi || !matrices)
		return gi_fail_null(gi, "gi_set_joints: matrices");
	gi_result result = find(gi, object, name, &o);
	if (!result && (!count || count != o->deform->joint_count))
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT,
			       "gi_set_joints: object '%s' has %u joints, not %u", o->name, o->deform->joint_count,
			       count);
	if (!result)
		result = check_finite(gi, o, name, matrices, 16 * (size_t)count);
	if (result || is_same(matrices, o->deform->next.joints, 16 * (size_t)count))
		return result;
	gi_shape shape = o->deform->next;
	shape.joints = (float *)matrices;
	return set_shape(gi, o, &shape);
}

gi_result gi_set_scale(gi_context *gi, gi_object object, const float scale[3])
{
	object_record *o;
	if (!gi || !scale)
		return gi_fail_null(gi, "gi_set_scale: scale");
	const gi_result result = find(gi, object, "gi_set_scale", &o);
	if (result)
		return result;
	for (int k = 0; k < 3; k++)
		if (!(scale[k] > 0.0f && scale[k] <= FLT_MAX))
			return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_GEOMETRY,
				       "gi_set_scale: object '%s': scale must be finite and above zero", o->name);
	if (is_same(scale, o->deform->next.scale, 3))
		return GI_OK;
	gi_shape shape = o->deform->next;
	memcpy(shape.scale, scale, sizeof shape.scale);
	return set_shape(gi, o, &shape);
}
