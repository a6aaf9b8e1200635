/* Public functions about single leaves of an object: what each is made of, and where in a texture it lies. */
#include "context.h"
#include "handles.h"

#include <string.h>

static object_record *find(const gi_context *gi, gi_object object, const char *function, gi_result *result)
{
	object_record *o = handles_find(gi, object);
	*result = o ? GI_OK : gi_fail_stale(gi, function, "object");
	return o;
}

static bool reflects(const gi_material *m)
{
	return m->rho[0] + m->rho[1] + m->rho[2] > 0;
}

static gi_result check_values(const gi_context *gi, const object_record *o, uint32_t first, uint32_t count,
			      const gi_material *values)
{
	static const gi_specular none;
	const gi_log *log = &gi->gpu.log;
	if (!o->leaf_materials)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT,
			       "object '%s' was not made with gi_object_def.leaf_materials", o->name);
	if (first > o->material_count || count > o->material_count - first)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "object '%s' has %u leaves, and %u from %u on are set",
			       o->name, o->material_count, count, first);
	for (uint32_t k = 0; k < count; k++)
		if (!material_is_valid(log, &values[k], o->name, first + k) ||
		    !material_specular_is_valid(log, o->specular ? &o->specular[first + k] : &none, &values[k], o->name,
						first + k))
			return GI_ERROR_INVALID_MATERIAL;
	return GI_OK;
}

gi_result gi_set_leaf_materials(gi_context *gi, gi_object object, uint32_t first, uint32_t count,
				const gi_material *values)
{
	gi_result result;
	if (!gi || (count && !values))
		return gi_fail_null(gi, "gi_set_leaf_materials: values");
	object_record *o = find(gi, object, "gi_set_leaf_materials", &result);
	if (!o)
		return result;
	result = check_values(gi, o, first, count, values);
	if (result)
		return result;
	for (uint32_t k = 0; k < count; k++) {
		gi_material value = values[k], *m = &o->materials[first + k];
		object_take_albedo(o, &value);
		if (memcmp(m, &value, sizeof value) == 0)
			continue;
		o->relit = o->relit || material_emits(m) != material_emits(&value) || reflects(m) != reflects(&value);
		o->material_changed = true;
		*m = value;
	}
	return GI_OK;
}

gi_result gi_get_leaf_uvs(const gi_context *gi, gi_object object, gi_leaf_uvs *uvs, uint32_t capacity, uint32_t *count)
{
	gi_result result;
	if (!gi || !count)
		return gi_fail_null(gi, "gi_get_leaf_uvs: count");
	*count = 0;
	const object_record *o = find(gi, object, "gi_get_leaf_uvs", &result);
	if (!o)
		return result;
	if (!o->leaf_uvs)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT,
			       "object '%s' was made neither with uvs nor with leaf_materials", o->name);
	*count = o->hierarchy.leaf_count;
	if (uvs)
		memcpy(uvs, o->leaf_uvs, sizeof *uvs * (capacity < *count ? capacity : *count));
	return GI_OK;
}
