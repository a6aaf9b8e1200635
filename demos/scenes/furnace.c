/* A closed room and a Buddha in it, all of one reflectance and one exitance: nothing can be told from anything else,
 * and H = E / (1 - rho) everywhere, wherever the Buddha is. */
#include "scenes/furnace.h"

#include "scenes/body.h"
#include "scenes/buddha.h"
#include "scenes/cornell.h"
#include "scenes/look_at.h"
#include "scenes/shapes.h"

/* scene_kind.exact_irradiance is E / (1 - rho) = 2.5. */
static const float RHO[3] = {.6f, .6f, .6f}, EXITANCE[3] = {1, 1, 1};

gi_result furnace_create(gi_context *gi, gi_object *buddha)
{
	engine_mesh mesh;
	gi_object room;
	if (!shape_box((float[]){-2.5f, 0, -2.5f}, (float[]){2.5f, 3.4f, 2.5f}, 4, true, &mesh))
		return GI_ERROR_OUT_OF_MEMORY;
	const scene_body walls = {.name = "room", .levels = 2, .rho = RHO, .exitance = EXITANCE};
	gi_result result = scene_add_body(gi, &walls, &mesh, &room);
	if (result)
		return result;
	if (!buddha_cage(&mesh))
		return GI_ERROR_OUT_OF_MEMORY;
	const scene_body figure = {.name = "buddha",
				   .moves = true,
				   .scheme = GI_SCHEME_CATMULL_CLARK,
				   .rho = RHO,
				   .exitance = EXITANCE,
				   .scale = 1.9f};
	result = scene_add_body(gi, &figure, &mesh, buddha);
	return result ? result : gi_set_pose(gi, *buddha, cornell_buddha_pose(0));
}

void furnace_camera(float aspect, float view_from_world[16], float clip_from_view[16])
{
	look_at((float[]){0, 1.7f, 8.5f}, (float[]){0, 1.7f, 0}, 36, aspect, view_from_world, clip_from_view);
}
