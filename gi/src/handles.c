/* The list of a context's objects: places, handles and ids; how an object that was built, here or on another thread,
 * takes its place.
 */
#include "handles.h"

#include "context.h"
#include "host_memory.h"
#include "scene_limits.h"

/* Doubled when full: there is room for the next power of two. */
static bool add_place(gi_scene *s)
{
	if ((s->object_count & (s->object_count - 1)) == 0) {
		const size_t capacity = s->object_count ? 2 * (size_t)s->object_count : 1;
		object_record *grown = gi_realloc(s->objects, sizeof *grown * capacity);
		if (!grown)
			return false;
		s->objects = grown;
	}
	s->objects[s->object_count++] = (object_record){0};
	return true;
}

/* The lowest one. All below s->first_free are taken. */
static uint32_t free_place(gi_scene *s)
{
	for (; s->first_free < s->object_count; s->first_free++) {
		const object_record *o = &s->objects[s->first_free];
		if (!object_is_alive(o) && !o->committed)
			return s->first_free;
	}
	return add_place(s) ? s->first_free : GI_NONE;
}

void handles_free_place(gi_scene *s, object_record *o)
{
	const uint32_t place = (uint32_t)(o - s->objects);
	object_free(o);
	s->first_free = place < s->first_free ? place : s->first_free;
}

/* Where everything is created in a row and stays, they are the numbers of leaves and nodes. */
static void give_ids(gi_scene *s, const object_record *place, object_record *o)
{
	const uint32_t leaves = o->hierarchy.leaf_count, nodes = o->hierarchy.node_count;
	o->leaf_id = place->leaf_id;
	o->node_id = place->node_id;
	o->leaf_ids = place->leaf_ids;
	o->node_ids = place->node_ids;
	if (leaves > o->leaf_ids || nodes > o->node_ids) {
		o->leaf_id = s->next_leaf_id;
		o->node_id = s->next_node_id;
		s->next_leaf_id += o->leaf_ids = leaves;
		s->next_node_id += o->node_ids = nodes;
	}
}

/* On failure the prepared object stays as it is. */
static gi_result take_place(gi_context *gi, const object_record *built, gi_object *out)
{
	gi_scene *s = &gi->scene;
	const uint32_t place = free_place(s);
	if (place == GI_NONE)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "object '%s': out of memory", built->name);
	object_record made = *built;
	made.generation = s->objects[place].generation + 1; /* odd: alive */
	made.created = s->created_count++;
	give_ids(s, &s->objects[place], &made);
	s->objects[place] = made;
	s->first_free = place + 1;
	*out = handles_of(gi, place);
	return GI_OK;
}

gi_result handles_create(gi_context *gi, const gi_object_def *def, gi_object *out)
{
	object_record built;
	gi_result result = object_build(&(object_builder){&gi->gpu.log, &gi->gpu, gi->scene.object_count}, def, &built);
	if (result)
		return result;
	result = take_place(gi, &built, out);
	if (result)
		object_free(&built);
	return result;
}

gi_result handles_create_instance(gi_context *gi, const object_record *of, const gi_pose *pose, gi_object *out)
{
	object_record made;
	if (!object_share(of, &made))
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "object '%s': out of memory", of->name);
	made.pose = *pose;
	const gi_result result = take_place(gi, &made, out);
	if (result)
		object_free(&made);
	return result;
}

gi_result handles_prepare(const gi_log *log, const gi_object_def *def, gi_prepared_object **out)
{
	gi_prepared_object *made = gi_calloc(1, sizeof *made);
	if (!made)
		return gi_fail(log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	const gi_result result = object_build(&(object_builder){.log = log}, def, &made->object);
	if (result)
		gi_free(made);
	else
		*out = made;
	return result;
}

gi_result handles_create_prepared(gi_context *gi, gi_prepared_object *prepared, gi_object *out)
{
	const object_record *o = &prepared->object;
	if (!limits_can_hold(&gi->gpu, o->hierarchy.leaf_count, 1))
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_GEOMETRY,
			       "object '%s': %u leaves are more than this renderer holds: prepare it with a larger "
			       "leaf_size or fewer levels",
			       o->name, o->hierarchy.leaf_count);
	const gi_result result = take_place(gi, o, out);
	if (!result)
		gi_free(prepared);
	return result;
}

void gi_free_prepared_object(gi_prepared_object *prepared)
{
	if (prepared)
		object_free(&prepared->object);
	gi_free(prepared);
}

object_record *handles_find(const gi_context *gi, gi_object handle)
{
	if (handle.context != gi->number || handle.index1 == 0 || handle.index1 > gi->scene.object_count)
		return NULL;
	object_record *o = &gi->scene.objects[handle.index1 - 1];
	return (o->generation & 1) && o->generation == handle.generation ? o : NULL;
}

gi_object handles_of(const gi_context *gi, uint32_t index)
{
	return (gi_object){index + 1, gi->scene.objects[index].generation, gi->number};
}
