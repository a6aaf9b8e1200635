#include "file_shape.h"

#include <stdlib.h>

bool file_shape_make(const engine_scene *scene, uint32_t number, const engine_mesh *cage, const engine_mesh *drawn,
		     file_shape *out)
{
	const engine_scene_object *object = scene->objects + number;
	/* A matrix that shears is in the mesh, as it is at rest: no scale can take it back out. */
	*out = (file_shape){.bends = object->deforms, .scales = object->scale_animated && !object->baked};
	if (!out->bends)
		return true;
	const size_t most = cage->vertex_count > drawn->vertex_count ? cage->vertex_count : drawn->vertex_count;
	out->points = malloc(sizeof *out->points * 3 * (most + 1));
	return out->points && engine_scene_follow(scene, number, cage->positions, cage->vertex_count, &out->cage) &&
	       engine_scene_follow(scene, number, drawn->positions, drawn->vertex_count, &out->drawn);
}

void file_shape_free(file_shape *shape)
{
	engine_followers_free(&shape->cage);
	engine_followers_free(&shape->drawn);
	free(shape->points);
	*shape = (file_shape){0};
}

/* A face that collapses for a while is no reason to stop. */
static gi_result unless_refused(gi_result result)
{
	return result == GI_ERROR_INVALID_GEOMETRY ? GI_OK : result;
}

gi_result file_shape_set(const engine_scene *scene, uint32_t number, file_shape *shape, gi_context *gi,
			 gi_object handle, double time_s, const engine_pose *pose)
{
	gi_result result = GI_OK;
	if (shape->scales)
		result = unless_refused(gi_set_scale(gi, handle, pose->scale));
	if (result || !shape->bends)
		return result;
	engine_scene_shape(scene, number, &shape->cage, time_s, shape->points);
	result = unless_refused(gi_set_positions(gi, handle, shape->points));
	if (result || !shape->drawn.count)
		return result;
	engine_scene_shape(scene, number, &shape->drawn, time_s, shape->points);
	return unless_refused(gi_set_draw_positions(gi, handle, shape->points));
}
