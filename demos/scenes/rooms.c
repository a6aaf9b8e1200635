/* Two rooms side by side and a doorway in the wall between them, whose door swings. The lamp is on the lit room's side
 * of that wall, above the door, and looks away from it: whatever arrives in the other room was reflected at least once.
 *
 *      +-----------+|+-----------+    4.1 x 4 m and 2.7 m high each; the doorway is 1.5 m wide, 2.1 m high.
 *      |           |||           |
 *      |   lit      \|    dim    |
 *      |  room     ^    room     |    z
 *      |         lamp            |    |
 *      +-----------+|+-----------+    +-- x
 */
#include "scenes/rooms.h"

#include "scenes/body.h"
#include "scenes/look_at.h"
#include "scenes/shapes.h"

#include <cglm/cglm.h>

#include <math.h>

static const float END = 4.2f, WALL = .1f, DEPTH = 2, HEIGHT = 2.7f; /* half widths of rooms and wall, metres */
static const float DOOR_HALF = .75f, DOOR_HEIGHT = 2.1f;

static const float CELL = 1; /* base faces; two levels make leaves of a quarter of a metre */

static const float WOOD[3] = {.52f, .38f, .25f}, WHITE[3] = {.80f, .78f, .74f}, BLUE[3] = {.30f, .45f, .58f},
		   RED[3] = {.62f, .22f, .14f}, PAINT[3] = {.70f, .66f, .56f}, BLACK[3] = {0};
static const float LAMP_EXITANCE[3] = {92, 82, 69};

/* A rectangle: its corner, and its sides u and v; it faces u x v. */
typedef struct rectangle {
	float corner[3], u[3], v[3];
} rectangle;

typedef struct part {
	const char *name;
	const float *rho, *exitance;
	uint32_t levels, count;
	const rectangle *rectangles;
} part;

static gi_result add_part(gi_context *gi, const part *p)
{
	engine_mesh mesh = {0};
	for (uint32_t k = 0; k < p->count; k++) {
		const rectangle *r = &p->rectangles[k];
		if (!shape_append_quad(&mesh, r->corner, r->u, r->v, CELL))
			return GI_ERROR_OUT_OF_MEMORY;
	}
	gi_object object;
	const scene_body b = {.name = p->name, .levels = p->levels, .rho = p->rho, .exitance = p->exitance};
	return scene_add_body(gi, &b, &mesh, &object);
}

static gi_result add_rooms(gi_context *gi)
{
	const float width = END - WALL, depth = 2 * DEPTH, side = DEPTH - DOOR_HALF, opening = 2 * DOOR_HALF,
		    lintel = HEIGHT - DOOR_HEIGHT;
	const rectangle floors[] = {{{-END, 0, -DEPTH}, {0, 0, depth}, {width, 0, 0}},
				    {{WALL, 0, -DEPTH}, {0, 0, depth}, {width, 0, 0}},
				    {{-WALL, 0, -DOOR_HALF}, {0, 0, opening}, {2 * WALL, 0, 0}}};
	const rectangle lit[] = {{{-END, HEIGHT, -DEPTH}, {width, 0, 0}, {0, 0, depth}},
				 {{-END, 0, -DEPTH}, {0, HEIGHT, 0}, {0, 0, depth}},
				 {{-END, 0, DEPTH}, {0, HEIGHT, 0}, {width, 0, 0}},
				 {{-WALL, 0, -DEPTH}, {0, 0, side}, {0, HEIGHT, 0}},
				 {{-WALL, 0, DOOR_HALF}, {0, 0, side}, {0, HEIGHT, 0}},
				 {{-WALL, DOOR_HEIGHT, -DOOR_HALF}, {0, 0, opening}, {0, lintel, 0}}};
	const rectangle back[] = {{{-END, 0, -DEPTH}, {width, 0, 0}, {0, HEIGHT, 0}}};
	const rectangle dim[] = {{{WALL, HEIGHT, -DEPTH}, {width, 0, 0}, {0, 0, depth}},
				 {{WALL, 0, -DEPTH}, {width, 0, 0}, {0, HEIGHT, 0}},
				 {{WALL, 0, DEPTH}, {0, HEIGHT, 0}, {width, 0, 0}},
				 {{WALL, 0, -DEPTH}, {0, HEIGHT, 0}, {0, 0, side}},
				 {{WALL, 0, DOOR_HALF}, {0, HEIGHT, 0}, {0, 0, side}},
				 {{WALL, DOOR_HEIGHT, -DOOR_HALF}, {0, lintel, 0}, {0, 0, opening}}};
	const rectangle right[] = {{{END, 0, -DEPTH}, {0, 0, depth}, {0, HEIGHT, 0}}};
	const rectangle frame[] = {{{-WALL, 0, -DOOR_HALF}, {2 * WALL, 0, 0}, {0, DOOR_HEIGHT, 0}},
				   {{-WALL, 0, DOOR_HALF}, {0, DOOR_HEIGHT, 0}, {2 * WALL, 0, 0}},
				   {{-WALL, DOOR_HEIGHT, -DOOR_HALF}, {2 * WALL, 0, 0}, {0, 0, opening}}};
	const rectangle lamp[] = {{{-WALL - .02f, 2.25f, -.9f}, {0, 0, 1.8f}, {0, .3f, 0}}};
	const part parts[] = {{"floors", WOOD, NULL, 2, 3, floors},      {"lit room", WHITE, NULL, 2, 6, lit},
			      {"blue wall", BLUE, NULL, 2, 1, back},     {"dim room", WHITE, NULL, 2, 6, dim},
			      {"red wall", RED, NULL, 2, 1, right},      {"door frame", PAINT, NULL, 2, 3, frame},
			      {"lamp", BLACK, LAMP_EXITANCE, 2, 1, lamp}};
	gi_result result = GI_OK;
	for (size_t k = 0; !result && k < sizeof parts / sizeof *parts; k++)
		result = add_part(gi, &parts[k]);
	return result;
}

/* Things stand this far above the floor: surfaces in one place cannot say which of them is seen. */
static const float CLEARANCE = .003f;

static gi_result add_things(gi_context *gi)
{
	engine_mesh mesh;
	gi_object object;
	if (!shape_box((float[]){-.45f, CLEARANCE, -.45f}, (float[]){.45f, .8f, .45f}, 1, false, &mesh))
		return GI_ERROR_OUT_OF_MEMORY;
	const scene_body block = {.name = "block", .levels = 2, .rho = PAINT, .position = {-2.7f, 0, -.9f}};
	const gi_result result = scene_add_body(gi, &block, &mesh, &object);
	if (result)
		return result;
	if (!shape_sphere(.5f, 5, &mesh))
		return GI_ERROR_OUT_OF_MEMORY;
	const scene_body ball = {.name = "ball", .rho = WHITE, .position = {2.2f, .5f + CLEARANCE, -.7f}};
	return scene_add_body(gi, &ball, &mesh, &object);
}

/* Its hinge at x = z = 0, closed along +z. */
static gi_result add_door(gi_context *gi, gi_object *door)
{
	engine_mesh mesh;
	if (!shape_box((float[]){-.02f, .012f, .02f}, (float[]){.02f, 2.07f, 1.44f}, 2, false, &mesh))
		return GI_ERROR_OUT_OF_MEMORY;
	const scene_body b = {.name = "door", .moves = true, .levels = 1, .rho = PAINT};
	const gi_result result = scene_add_body(gi, &b, &mesh, door);
	return result ? result : gi_set_pose(gi, *door, rooms_door_pose(0));
}

gi_result rooms_create(gi_context *gi, gi_object *door)
{
	gi_result result = add_rooms(gi);
	if (!result)
		result = add_things(gi);
	return result ? result : add_door(gi, door);
}

gi_pose rooms_door_pose(float t)
{
	/* 30 to 110 degrees open, into the lit room. */
	const float angle = -(glm_rad(70) + glm_rad(40) * sinf(t * (2 * GLM_PIf / 8)));
	return (gi_pose){.position = {-WALL - .03f, 0, -DOOR_HALF + .02f},
			 .rotation = {0, sinf(.5f * angle), 0, cosf(.5f * angle)}};
}

void rooms_camera(float aspect, float view_from_world[16], float clip_from_view[16])
{
	look_at((float[]){1.3f, 2, 8.6f}, (float[]){.05f, 1.3f, 0}, 34, aspect, view_from_world, clip_from_view);
}
