#include "scenes/scenes.h"

#include "scenes/cornell.h"
#include "scenes/corridor.h"
#include "scenes/furnace.h"
#include "scenes/rooms.h"

#include <string.h>

static gi_result cornell_create_kind(gi_context *gi, gi_object *mover)
{
	const cornell_def def = cornell_def_default();
	cornell made;
	const gi_result result = cornell_create(gi, &def, &made);
	*mover = made.buddha;
	return result;
}

const scene_kind scene_kinds[SCENE_KINDS] = {
    {.name = "cornell",
     .title = "Cornell box, the Buddha moves",
     .exposure = 1.6f,
     .create = cornell_create_kind,
     .pose = cornell_buddha_pose,
     .camera = cornell_camera},
    {.name = "rooms",
     .title = "Two rooms, one lit, a door between them moves",
     .sky = GI_SKY_OFF,
     .exposure = 2,
     .create = rooms_create,
     .pose = rooms_door_pose,
     .camera = rooms_camera},
    {.name = "corridor",
     .title = "Corridor with 28 lamps, a ball rolls",
     .sky = GI_SKY_OFF,
     .exposure = 1.2f,
     .create = corridor_create,
     .pose = corridor_ball_pose,
     .camera = corridor_camera},
    {.name = "furnace",
     .title = "Furnace, a Buddha of the walls' rho and E moves",
     .exposure = 0.6f,
     .exact_irradiance = 2.5f,
     .create = furnace_create,
     .pose = cornell_buddha_pose,
     .camera = furnace_camera},
};

const scene_kind *scene_kind_find(const char *name)
{
	for (int k = 0; k < SCENE_KINDS; k++)
		if (strcmp(scene_kinds[k].name, name) == 0)
			return &scene_kinds[k];
	return NULL;
}
