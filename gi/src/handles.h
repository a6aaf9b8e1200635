/* The list of a context's objects: places, handles and ids; how an object that was built, here or on another thread,
 * takes its place. */
#ifndef GI_HANDLES_H
#define GI_HANDLES_H

#include "scene.h"

struct gi_prepared_object {
	object_record object;
};

gi_result handles_create(gi_context *gi, const gi_object_def *def, gi_object *out);
/* Of the shape of one that is alive; the pose is normalised. */
gi_result handles_create_instance(gi_context *gi, const object_record *of, const gi_pose *pose, gi_object *out);
/* On any thread. */
gi_result handles_prepare(const gi_log *log, const gi_object_def *def, gi_prepared_object **out);
/* Takes a prepared object; it is freed where all went well. */
gi_result handles_create_prepared(gi_context *gi, gi_prepared_object *prepared, gi_object *out);
void handles_free_place(gi_scene *scene, object_record *object); /* the object too */
object_record *handles_find(const gi_context *gi, gi_object handle);
gi_object handles_of(const gi_context *gi, uint32_t index);

#endif
