#include "trace_box.h"

#include "limit_surface.h"
#include "scenes/buddha.h"
#include "scenes/cornell.h"
#include "scenes/shapes.h"

#include <stdlib.h>
#include <string.h>

/* Finer than a pixel shows: 2 * 8^2 triangles of each face of a ball, of which there are 150 or 864. */
enum { BALL_FINENESS = 8 };

bool trace_box_walls(trace_scene *scene)
{
	cornell_side sides[CORNELL_SIDES];
	cornell_sides(sides);
	for (int k = 0; k < CORNELL_SIDES; k++) {
		trace_object *o = trace_scene_add_quad(scene, sides[k].corner, sides[k].u, sides[k].v);
		if (!o)
			return false;
		memcpy(o->rho, sides[k].rho, sizeof o->rho);
		memcpy(o->exitance, sides[k].exitance, sizeof o->exitance);
	}
	return true;
}

static trace_object *add_ball(trace_scene *scene, int k, uint32_t faces)
{
	engine_mesh cage, ball;
	float centre[3], *normals;
	if (!shape_sphere(cornell_ball(k, centre), faces, &cage))
		return NULL;
	const bool made = limit_surface(&cage, BALL_FINENESS, &ball, &normals);
	trace_object *o = made ? trace_scene_add_mesh(scene, &ball, normals) : NULL;
	if (o)
		glm_vec3_copy(centre, o->world[3]);
	engine_mesh_free(&cage);
	engine_mesh_free(&ball);
	return o;
}

static bool buddha_surface(uint32_t fineness, engine_mesh *out, float **normals)
{
	engine_mesh cage;
	*out = (engine_mesh){0};
	*normals = NULL;
	if (!buddha_cage(&cage))
		return false;
	const bool made = limit_surface(&cage, fineness, out, normals);
	engine_mesh_free(&cage);
	const float height = cornell_def_default().buddha_height;
	for (size_t k = 0; made && k < 3 * (size_t)out->vertex_count; k++)
		out->positions[k] *= height;
	return made;
}

bool trace_box_figure(uint32_t fineness, engine_mesh *out)
{
	float *normals;
	const bool made = buddha_surface(fineness, out, &normals);
	free(normals);
	return made;
}

static trace_object *add_buddha(trace_scene *scene, uint32_t fineness)
{
	engine_mesh mesh;
	float *normals;
	trace_object *o =
	    buddha_surface(fineness, &mesh, &normals) ? trace_scene_add_mesh(scene, &mesh, normals) : NULL;
	engine_mesh_free(&mesh);
	return o;
}

bool trace_box_buddha(trace_scene *scene, uint32_t fineness, const engine_mesh *figure)
{
	if (!trace_box_walls(scene))
		return false;
	trace_object *buddha = figure ? trace_scene_add_mesh(scene, figure, NULL) : add_buddha(scene, fineness);
	if (!buddha)
		return false;
	buddha->moves = true;
	memcpy(buddha->rho, cornell_stone, sizeof buddha->rho);
	for (int k = 0; k < 2; k++) {
		trace_object *ball = add_ball(scene, k, cornell_def_default().ball_faces);
		if (!ball)
			return false;
		memcpy(ball->rho, cornell_white, sizeof ball->rho);
	}
	trace_box_buddha_at(scene, 0);
	return true;
}

bool trace_box_balls(trace_scene *scene)
{
	if (!trace_box_walls(scene))
		return false;
	for (int k = 0; k < 2; k++) {
		trace_object *ball = add_ball(scene, k, CORNELL_SMOOTH_BALL_FACES);
		if (!ball)
			return false;
		ball->moves = true;
		ball->specular = cornell_mirror_and_glass[k];
	}
	trace_box_balls_at(scene, 0);
	return true;
}

void trace_box_buddha_at(trace_scene *scene, float t)
{
	trace_object_set_pose(&scene->objects[CORNELL_SIDES], cornell_buddha_pose(t));
}

void trace_box_balls_at(trace_scene *scene, float t)
{
	for (int k = 0; k < 2; k++)
		trace_object_set_pose(&scene->objects[CORNELL_SIDES + k], cornell_rolling_ball_pose(k, t));
}
