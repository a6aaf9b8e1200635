/* One of the scenes of scenes.h. */
#ifndef SCENES_CORRIDOR_H
#define SCENES_CORRIDOR_H

#include "gi/gi.h"

gi_result corridor_create(gi_context *gi, gi_object *ball);
gi_pose corridor_ball_pose(float t);
void corridor_camera(float aspect, float view_from_world[16], float clip_from_view[16]);

#endif
