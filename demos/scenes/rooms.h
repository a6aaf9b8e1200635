/* One of the scenes of scenes.h. */
#ifndef SCENES_ROOMS_H
#define SCENES_ROOMS_H

#include "gi/gi.h"

gi_result rooms_create(gi_context *gi, gi_object *door);
gi_pose rooms_door_pose(float t);
void rooms_camera(float aspect, float view_from_world[16], float clip_from_view[16]);

#endif
