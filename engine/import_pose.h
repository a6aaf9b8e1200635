/* Where objects and the camera of a scene are at a time. */
#ifndef ENGINE_IMPORT_POSE_H
#define ENGINE_IMPORT_POSE_H

#include "import_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The object's pose at time_s through its animated parents; times outside 0..duration_s show the first or last key
 * (loop in the caller). False, with *pose unchanged, where it has none: the scale is 0 (object->vanishes), or mirrors
 * other than at rest. Not for two threads at once: the scene keeps where its nodes are at the last time asked for.
 */
bool engine_scene_pose(const engine_scene *scene, uint32_t object, double time_s, engine_pose *pose);

/* The camera at time_s. False, with *camera unchanged, when the file has none or its pose is singular. */
bool engine_scene_camera_at(const engine_scene *scene, double time_s, engine_scene_camera *camera);

/* Where a light is at time_s, and the unit direction in which it shines. False, with both unchanged, where its pose is
 * singular: it is not there then. */
bool engine_scene_light_at(const engine_scene *scene, uint32_t light, double time_s, float position[3],
			   float direction[3]);

#ifdef __cplusplus
}
#endif

#endif
