/* A corridor of 2.4 x 16 m, 2.6 m high, under two rows of 14 small lamps; a ball rolls along it. */
#include "scenes/corridor.h"

#include "scenes/body.h"
#include "scenes/look_at.h"
#include "scenes/shapes.h"

#include <cglm/cglm.h>

#include <math.h>

static const float HALF = 1.2f, END = 8, HEIGHT = 2.6f; /* metres */

/* Base faces; two levels make leaves of 0.3 m. */
static const float CELL = 1.2f;

enum { LAMPS_A_ROW = 14 };

static const float LAMP_SIZE = .3f, LAMP_X = .6f, LAMP_STEP = 1.14f, LAMP_BELOW = .01f;
static const float WARM_EXITANCE[3] = {52, 40, 27}, COOL_EXITANCE[3] = {34, 41, 48};

static const float STONE[3] = {.42f, .40f, .37f}, WHITE[3] = {.76f, .75f, .73f}, OCHRE[3] = {.66f, .47f, .22f},
		   SAGE[3] = {.38f, .52f, .40f}, RUST[3] = {.62f, .20f, .10f}, BLACK[3] = {0};

static const float BALL_RADIUS = .5f, CLEARANCE = .003f;

static gi_result add_walls(gi_context *gi)
{
	const float width = 2 * HALF, length = 2 * END;
	const struct {
		const char *name;
		const float *rho;
		float corner[3], u[3], v[3];
	} walls[] = {
	    {"floor", STONE, {-HALF, 0, -END}, {0, 0, length}, {width, 0, 0}},
	    {"ceiling", WHITE, {-HALF, HEIGHT, -END}, {width, 0, 0}, {0, 0, length}},
	    {"left", OCHRE, {-HALF, 0, -END}, {0, HEIGHT, 0}, {0, 0, length}},
	    {"right", SAGE, {HALF, 0, -END}, {0, 0, length}, {0, HEIGHT, 0}},
	    {"far end", WHITE, {-HALF, 0, -END}, {width, 0, 0}, {0, HEIGHT, 0}},
	    {"near end", WHITE, {-HALF, 0, END}, {0, HEIGHT, 0}, {width, 0, 0}},
	};
	gi_result result = GI_OK;
	for (size_t k = 0; !result && k < sizeof walls / sizeof *walls; k++) {
		engine_mesh mesh = {0};
		gi_object object;
		if (!shape_append_quad(&mesh, walls[k].corner, walls[k].u, walls[k].v, CELL))
			return GI_ERROR_OUT_OF_MEMORY;
		const scene_body b = {.name = walls[k].name, .levels = 2, .rho = walls[k].rho};
		result = scene_add_body(gi, &b, &mesh, &object);
	}
	return result;
}

/* One row is one object. */
static gi_result add_lamps(gi_context *gi, const char *name, float x, const float *exitance)
{
	engine_mesh mesh = {0};
	for (int k = 0; k < LAMPS_A_ROW; k++) {
		const float z = LAMP_STEP * ((float)k - .5f * (LAMPS_A_ROW - 1));
		const float corner[3] = {x - .5f * LAMP_SIZE, HEIGHT - LAMP_BELOW, z - .5f * LAMP_SIZE};
		if (!shape_append_quad(&mesh, corner, (float[]){LAMP_SIZE, 0, 0}, (float[]){0, 0, LAMP_SIZE},
				       LAMP_SIZE))
			return GI_ERROR_OUT_OF_MEMORY;
	}
	gi_object object;
	const scene_body b = {.name = name, .rho = BLACK, .exitance = exitance};
	return scene_add_body(gi, &b, &mesh, &object);
}

static gi_result add_ball(gi_context *gi, gi_object *ball)
{
	engine_mesh mesh;
	if (!shape_sphere(BALL_RADIUS, 7, &mesh))
		return GI_ERROR_OUT_OF_MEMORY;
	const scene_body b = {.name = "ball", .moves = true, .scheme = GI_SCHEME_CATMULL_CLARK, .rho = RUST};
	const gi_result result = scene_add_body(gi, &b, &mesh, ball);
	return result ? result : gi_set_pose(gi, *ball, corridor_ball_pose(0));
}

gi_result corridor_create(gi_context *gi, gi_object *ball)
{
	gi_result result = add_walls(gi);
	if (!result)
		result = add_lamps(gi, "warm lamps", -LAMP_X, WARM_EXITANCE);
	if (!result)
		result = add_lamps(gi, "cool lamps", LAMP_X, COOL_EXITANCE);
	return result ? result : add_ball(gi, ball);
}

gi_pose corridor_ball_pose(float t)
{
	const float phase = t * (2 * GLM_PIf / 8), z = 1 + 3.5f * cosf(phase), turn = z / BALL_RADIUS;
	return (gi_pose){.position = {.35f * sinf(phase), BALL_RADIUS + CLEARANCE, z},
			 .rotation = {sinf(.5f * turn), 0, 0, cosf(.5f * turn)}};
}

void corridor_camera(float aspect, float view_from_world[16], float clip_from_view[16])
{
	look_at((float[]){.25f, 1.5f, 7.9f}, (float[]){0, 1.2f, 0}, 52, aspect, view_from_world, clip_from_view);
}
