#include "scenes/cornell.h"

#include "scenes/body.h"
#include "scenes/buddha.h"
#include "scenes/shapes.h"

#include <cglm/cglm.h>

#include <math.h>
#include <string.h>

static const float HALF = 2.75f, HEIGHT = 5.5f;

/* The light: 1.3 x 1.05 m, flush in a hole of the ceiling as in the measured box, bright enough for a white floor of
 * about 1 W/m2/sr.
 */
static const float LIGHT_HALF_X = 0.65f, LIGHT_HALF_Z = 0.525f;
static const float LIGHT_EXITANCE[3] = {47.1f, 38.8f, 29.4f};

static const float BLACK[3] = {0, 0, 0};
const float cornell_white[3] = {.73f, .73f, .73f};
static const float RED[3] = {.63f, .065f, .05f}, GREEN[3] = {.14f, .45f, .091f};

/* The Buddha glides this far above the floor, metres. Where boxes of bodies overlap, each is asked whether it hides
 * rays of the other whenever one of them moves. */
static const float CLEARANCE = .003f;

/* Warm stone, not gold: gold is no diffuse colour. */
const float cornell_stone[3] = {.72f, .62f, .47f};

cornell_def cornell_def_default(void)
{
	return (cornell_def){.wall_faces = 3,
			     .wall_levels = 3,
			     .light_levels = 2,
			     .buddha = true,
			     .buddha_height = 2.8f,
			     .balls = true,
			     .ball_faces = 5};
}

void cornell_sides(cornell_side out[CORNELL_SIDES])
{
	const float w = 2 * HALF, x = LIGHT_HALF_X, z = LIGHT_HALF_Z;
	const cornell_side sides[CORNELL_SIDES] = {
	    {.name = "floor", .corner = {-HALF, 0, -HALF}, .u = {0, 0, w}, .v = {w, 0, 0}},
	    {.name = "back", .corner = {-HALF, 0, -HALF}, .u = {w, 0, 0}, .v = {0, HEIGHT, 0}},
	    {.name = "left", .corner = {-HALF, 0, -HALF}, .u = {0, HEIGHT, 0}, .v = {0, 0, w}},
	    {.name = "right", .corner = {HALF, 0, -HALF}, .u = {0, 0, w}, .v = {0, HEIGHT, 0}},
	    {.name = "light", .corner = {-x, HEIGHT, -z}, .u = {2 * x, 0, 0}, .v = {0, 0, 2 * z}},
	    {.name = "ceiling", .corner = {-HALF, HEIGHT, -HALF}, .u = {w, 0, 0}, .v = {0, 0, HALF - z}},
	    {.name = "ceiling", .corner = {-HALF, HEIGHT, z}, .u = {w, 0, 0}, .v = {0, 0, HALF - z}},
	    {.name = "ceiling", .corner = {-HALF, HEIGHT, -z}, .u = {HALF - x, 0, 0}, .v = {0, 0, 2 * z}},
	    {.name = "ceiling", .corner = {x, HEIGHT, -z}, .u = {HALF - x, 0, 0}, .v = {0, 0, 2 * z}},
	};
	for (int k = 0; k < CORNELL_SIDES; k++) {
		const float *rho = k == 2 ? RED : k == 3 ? GREEN : k == 4 ? BLACK : cornell_white;
		out[k] = sides[k];
		memcpy(out[k].rho, rho, sizeof out[k].rho);
		if (k == CORNELL_WALLS)
			memcpy(out[k].exitance, LIGHT_EXITANCE, sizeof LIGHT_EXITANCE);
	}
}

static gi_result add_walls(gi_context *gi, const cornell_def *def, cornell *out)
{
	gi_object *const objects[CORNELL_WALLS] = {&out->floor, &out->back, &out->left, &out->right};
	cornell_side sides[CORNELL_SIDES];
	cornell_sides(sides);
	gi_result result = GI_OK;
	for (int k = 0; !result && k < CORNELL_WALLS; k++) {
		const cornell_side *side = &sides[k];
		engine_mesh mesh;
		if (!shape_quad(side->corner, side->u, side->v, def->wall_faces, def->wall_faces, &mesh))
			return GI_ERROR_OUT_OF_MEMORY;
		const scene_body b = {
		    .name = side->name, .levels = def->wall_levels, .leaf_size = def->leaf_size, .rho = side->rho};
		result = scene_add_body(gi, &b, &mesh, objects[k]);
	}
	return result;
}

/* Cell edges from -HALF to HALF: `sides` cells on either side of the hole, whose edges are at -hole and hole. */
static void ceiling_lines(uint32_t sides, float hole, float *lines)
{
	for (uint32_t k = 0; k <= sides; k++) {
		const float at = hole + (HALF - hole) * (float)k / (float)sides;
		lines[sides - k] = -at;
		lines[sides + 1 + k] = at;
	}
}

enum { MAX_CEILING_SIDES = 16 };

/* A grid of quads facing down, without the one in the middle. */
static bool ceiling_cage(uint32_t wall_faces, engine_mesh *out)
{
	uint32_t sides = wall_faces / 3;
	sides = sides < 1 ? 1 : sides > MAX_CEILING_SIDES ? MAX_CEILING_SIDES : sides;
	const uint32_t n = 2 * sides + 1;
	float x[2 * MAX_CEILING_SIDES + 2], z[2 * MAX_CEILING_SIDES + 2];
	ceiling_lines(sides, LIGHT_HALF_X, x);
	ceiling_lines(sides, LIGHT_HALF_Z, z);
	if (!shape_quad((float[]){0, HEIGHT, 0}, (float[]){1, 0, 0}, (float[]){0, 0, 1}, n, n, out))
		return false;
	for (uint32_t k = 0; k < out->vertex_count; k++) {
		out->positions[3 * k] = x[k % (n + 1)];
		out->positions[3 * k + 2] = z[k / (n + 1)];
	}
	/* The last face goes where the middle one was. */
	const uint32_t middle = n * sides + sides, last = n * n - 1;
	memcpy(out->indices + 4 * middle, out->indices + 4 * last, 4 * sizeof *out->indices);
	out->face_count--;
	out->index_count -= 4;
	return true;
}

static gi_result add_ceiling(gi_context *gi, const cornell_def *def, cornell *out)
{
	engine_mesh mesh;
	if (!ceiling_cage(def->wall_faces, &mesh))
		return GI_ERROR_OUT_OF_MEMORY;
	const scene_body b = {.name = "ceiling", .levels = def->wall_levels, .rho = cornell_white};
	return scene_add_body(gi, &b, &mesh, &out->ceiling);
}

static gi_result add_light(gi_context *gi, const cornell_def *def, cornell *out)
{
	static const float black[3] = {0};
	engine_mesh mesh;
	const float corner[3] = {-LIGHT_HALF_X, 0, -LIGHT_HALF_Z};
	const float u[3] = {2 * LIGHT_HALF_X, 0, 0}, v[3] = {0, 0, 2 * LIGHT_HALF_Z};
	if (!shape_quad(corner, u, v, 1, 1, &mesh))
		return GI_ERROR_OUT_OF_MEMORY;
	const scene_body b = {.name = "light",
			      .levels = def->light_levels,
			      .leaf_size = def->leaf_size,
			      .rho = black,
			      .exitance = LIGHT_EXITANCE,
			      .position = {0, HEIGHT, 0}};
	return scene_add_body(gi, &b, &mesh, &out->light);
}

/* Moves and scales a mesh so that it stands on y = 0, centred, with the given height. */
static bool fit(const engine_mesh *bounds_of, const engine_mesh *in, float height, engine_mesh *out)
{
	float lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
	for (uint32_t k = 0; k < 3 * bounds_of->vertex_count; k++) {
		lower[k % 3] = fminf(lower[k % 3], bounds_of->positions[k]);
		upper[k % 3] = fmaxf(upper[k % 3], bounds_of->positions[k]);
	}
	const float scale = height / (upper[1] - lower[1]);
	const float origin[3] = {.5f * (lower[0] + upper[0]), lower[1], .5f * (lower[2] + upper[2])};
	if (!engine_mesh_copy(in, out))
		return false;
	for (uint32_t k = 0; k < 3 * out->vertex_count; k++)
		out->positions[k] = (out->positions[k] - origin[k % 3]) * scale;
	return true;
}

static gi_result add_figure(gi_context *gi, const cornell_def *def, cornell *out)
{
	engine_mesh cage, drawn;
	if (!fit(def->figure, def->figure_cage, def->buddha_height, &cage))
		return GI_ERROR_OUT_OF_MEMORY;
	if (!fit(def->figure, def->figure, def->buddha_height, &drawn)) {
		engine_mesh_free(&cage);
		return GI_ERROR_OUT_OF_MEMORY;
	}
	const scene_body b = {
	    .name = "figure", .moves = true, .leaf_size = def->leaf_size, .rho = cornell_stone, .draw = &drawn};
	const gi_result result = scene_add_body(gi, &b, &cage, &out->buddha);
	engine_mesh_free(&drawn);
	return result;
}

static gi_result add_buddha(gi_context *gi, const cornell_def *def, cornell *out)
{
	engine_mesh mesh;
	if (!buddha_cage(&mesh))
		return GI_ERROR_OUT_OF_MEMORY;
	const scene_body b = {.name = "buddha",
			      .moves = true,
			      .scheme = GI_SCHEME_CATMULL_CLARK,
			      .levels = def->smooth_levels,
			      .leaf_size = def->leaf_size,
			      .rho = cornell_stone,
			      .scale = def->buddha_height};
	return scene_add_body(gi, &b, &mesh, &out->buddha);
}

float cornell_ball(int k, float centre[3])
{
	static const float places[2][3] = {{-1.75f, .55f, -1.55f}, {1.85f, .4f, .9f}};
	memcpy(centre, places[k], sizeof places[k]);
	return centre[1];
}

static gi_result add_balls(gi_context *gi, const cornell_def *def, cornell *out)
{
	gi_result result = GI_OK;
	for (int k = 0; !result && k < 2; k++) {
		engine_mesh mesh;
		float at[3];
		if (!shape_sphere(cornell_ball(k, at), def->ball_faces, &mesh))
			return GI_ERROR_OUT_OF_MEMORY;
		const scene_body b = {.name = k ? "small ball" : "ball",
				      .scheme = GI_SCHEME_CATMULL_CLARK,
				      .levels = def->smooth_levels,
				      .leaf_size = def->leaf_size,
				      .rho = def->ball_specular ? BLACK : cornell_white,
				      .position = {at[0], at[1], at[2]}};
		result = scene_add_body(gi, &b, &mesh, &out->balls[k]);
		if (!result && def->ball_specular)
			result = gi_set_specular(gi, out->balls[k], 0, def->ball_specular[k]);
	}
	return result;
}

gi_result cornell_create(gi_context *gi, const cornell_def *def, cornell *out)
{
	*out = (cornell){0};
	gi_result result = add_walls(gi, def, out);
	if (!result)
		result = add_ceiling(gi, def, out);
	if (!result)
		result = add_light(gi, def, out);
	if (!result && def->figure)
		result = add_figure(gi, def, out);
	else if (!result && def->buddha)
		result = add_buddha(gi, def, out);
	if (!result && def->balls)
		result = add_balls(gi, def, out);
	if (!result && (def->figure || def->buddha))
		result = gi_set_pose(gi, out->buddha, cornell_buddha_pose(0));
	return result;
}

gi_pose cornell_buddha_pose(float t)
{
	const float angle = t * (2 * GLM_PIf / 8), turn = .5f * sinf(angle);
	return (gi_pose){.position = {.8f * sinf(angle), CLEARANCE, -.25f + .45f * cosf(angle)},
			 .rotation = {0, sinf(.5f * turn), 0, cosf(.5f * turn)}};
}

const gi_specular cornell_mirror_and_glass[2] = {{.reflectance = {.92f, .92f, .92f}},
						 {.transmittance = {1, 1, 1}, .index = 1.5f}};

/* The glass ball rolls round the middle, the mirror opposite. */
gi_pose cornell_rolling_ball_pose(int k, float t)
{
	const float angle = t * (2 * GLM_PIf / 8), heights[2] = {.95f, .8f}, radius[2] = {1.3f, 1.25f};
	const float turn = angle + (k ? .25f * GLM_PIf : 1.25f * GLM_PIf);
	gi_pose pose = gi_pose_identity();
	pose.position[0] = radius[k] * sinf(turn);
	pose.position[1] = heights[k];
	pose.position[2] = radius[k] * cosf(turn);
	return pose;
}

void cornell_camera(float aspect, float view_from_world[16], float clip_from_view[16])
{
	mat4 view, clip;
	glm_lookat((vec3){0, HALF, 10.4f}, (vec3){0, HALF, 0}, (vec3){0, 1, 0}, view);
	glm_perspective(glm_rad(40), aspect, .1f, 100, clip);
	memcpy(view_from_world, view, sizeof view);
	memcpy(clip_from_view, clip, sizeof clip);
}
