/* One of the scenes of scenes.h. */
#ifndef SCENES_FURNACE_H
#define SCENES_FURNACE_H

#include "gi/gi.h"

gi_result furnace_create(gi_context *gi, gi_object *buddha);
void furnace_camera(float aspect, float view_from_world[16], float clip_from_view[16]);

#endif
