/* Light for hosts that draw for themselves: where their vertices have it from, and where it stands on the GPU. */
#include "context.h"
#include "drawn_build.h"
#include "drawn_locator.h"
#include "handles.h"
#include "host_memory.h"
#include "shader_source.h"

#include <math.h>
#include <string.h>

/* ---- vertices ---- */

static bool all_finite(const float *values, size_t count)
{
	for (size_t k = 0; k < count; k++)
		if (!isfinite(values[k]))
			return false;
	return true;
}

static gi_vec3d scaled(const float v[3], const float scale[3])
{
	return (gi_vec3d){(double)v[0] * scale[0], (double)v[1] * scale[1], (double)v[2] * scale[2]};
}

/* Normals go with the inverse: what is stretched along x shows x less. Only their signs count. */
static gi_vec3d normal_of(const float *normals, uint32_t vertex, const float scale[3])
{
	if (!normals)
		return (gi_vec3d){0, 0, 0};
	const float *n = normals + 3 * (size_t)vertex;
	return (gi_vec3d){(double)n[0] / scale[0], (double)n[1] / scale[1], (double)n[2] / scale[2]};
}

static gi_result map(const gi_log *log, const object_record *o, const float *positions, const float *normals,
		     uint32_t count, gi_vertex_light *out)
{
	if (!all_finite(positions, 3 * (size_t)count) || (normals && !all_finite(normals, 3 * (size_t)count)))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "object '%s': a vertex to map is not finite", o->name);
	/* A shape that changes is as the last update took it. */
	const float *scale = o->deform ? o->deform->now.scale : o->scale;
	gi_drawn_locator l;
	const bool enough = gi_drawn_locator_build(&o->hierarchy, true, &l);
	for (uint32_t k = 0, near = 0; enough && k < count; k++) {
		const gi_leaf_point at =
		    gi_drawn_locate(&l, scaled(positions + 3 * (size_t)k, scale), normal_of(normals, k, scale), near);
		out[k] = (gi_vertex_light){0};
		gi_drawn_light_at(&o->drawn, at.leaf, at.weight, out[k].light, out[k].weight);
		near = at.leaf;
	}
	gi_drawn_locator_free(&l);
	return enough ? GI_OK : gi_fail(log, GI_ERROR_OUT_OF_MEMORY, "object '%s': out of memory", o->name);
}

gi_result gi_map_vertices(const gi_context *gi, gi_object object, const float *positions, const float *normals,
			  uint32_t count, gi_vertex_light *out)
{
	if (!gi || (count && (!positions || !out)))
		return gi_fail_null(gi, "gi_map_vertices: positions and out");
	const object_record *o = handles_find(gi, object);
	if (!o)
		return gi_fail_stale(gi, "gi_map_vertices", "object");
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	const gi_result result = map(&gi->gpu.log, o, positions, normals, count, out);
	gi_memory_from(before);
	return result;
}

gi_result gi_map_prepared_vertices(const gi_prepared_object *prepared, const float *positions, const float *normals,
				   uint32_t count, gi_vertex_light *out, gi_message_fn *message, void *user)
{
	const gi_log log = {.message = message, .user = user};
	if (!prepared || (count && (!positions || !out)))
		return gi_fail(&log, GI_ERROR_INVALID_ARGUMENT,
			       "gi_map_prepared_vertices: prepared, positions and out must not be NULL");
	const gi_allocator *before = gi_memory_from(NULL);
	const gi_result result = map(&log, &prepared->object, positions, normals, count, out);
	gi_memory_from(before);
	return result;
}

/* ---- buffers ---- */

gi_result gi_get_buffers(gi_context *gi, gi_buffers *out)
{
	if (!gi || !out)
		return gi_fail_null(gi, "gi_get_buffers: out");
	if (!gi->scene.ever_committed)
		return gi_fail(&gi->gpu.log, GI_ERROR_NOT_COMMITTED, "call gi_commit() before gi_get_buffers()");
	const gi_solver *s = &gi->solver;
	*out = (gi_buffers){.leaf_radiosity = s->leaf_radiosity.name,
			    .leaf_indirect = s->leaf_indirect.name,
			    .light_indirect = s->light.name,
			    .leaf_radiosity_texture = s->leaf_radiosity.texture,
			    .leaf_indirect_texture = s->leaf_indirect.texture,
			    .light_indirect_texture = s->light.texture,
			    .leaf_count = gi->scene.leaf_count,
			    .light_count = gi->scene.light_count,
			    .layout = gi->layout};
	return GI_OK;
}

gi_result gi_get_object_range(const gi_context *gi, gi_object object, gi_object_range *out)
{
	if (!gi || !out)
		return gi_fail_null(gi, "gi_get_object_range: out");
	const object_record *o = handles_find(gi, object);
	if (!o)
		return gi_fail_stale(gi, "gi_get_object_range", "object");
	if (!o->committed)
		return gi_fail(&gi->gpu.log, GI_ERROR_NOT_COMMITTED,
			       "object '%s' has no place yet: call gi_commit() first", o->name);
	*out = (gi_object_range){.first_leaf = o->leaf_base,
				 .leaf_count = o->hierarchy.leaf_count,
				 .first_light = o->light_base,
				 .light_count = o->drawn.light_count};
	return GI_OK;
}

/* ---- shaders ---- */

const char *gi_glsl(const char *name)
{
	static const char *const files[] = {"gi_light.glsl", "gi_probe.glsl"};
	for (size_t k = 0; name && k < sizeof files / sizeof *files; k++)
		for (const gi_shader_source *s = gi_shader_sources; strcmp(name, files[k]) == 0 && s->name; s++)
			if (strcmp(s->name, name) == 0)
				return s->text;
	return NULL;
}
