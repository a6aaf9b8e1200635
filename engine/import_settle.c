/* The objects of a scene once all are there: the origin near them, their poses at rest, what animation does to them. */
#include "import_settle.h"

#include "mesh_clean.h"
#include "import_bounds.h"
#include "import_level.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const pose_faults[IMPORT_POSE_RESULTS] = {
    [IMPORT_POSE_OK] = "",
    [IMPORT_POSE_SINGULAR] = "objects whose scale is 0 (or whose transform is singular) are left out",
    [IMPORT_POSE_SHEARED] = "objects whose transform is no matrix of finite numbers are left out",
    [IMPORT_POSE_MIRRORED] = "objects whose transform is no matrix of finite numbers are left out",
    [IMPORT_POSE_FAR] = "objects beyond 1e9 m are left out",
    [IMPORT_POSE_TINY] = "objects of faces below 1e-23 m2 are left out",
};

static bool is_animated(const engine_scene_graph *graph, const engine_scene_object *object)
{
	return graph->nodes[object->node].moves;
}

/* The corners of an object's bounds, in the world of the file. */
static void widen_by_object(import_bounds *all, const engine_scene_graph *graph, const engine_scene_object *object)
{
	const double *m = graph->world + 16 * (size_t)object->node;
	import_bounds b = import_bounds_of_mesh(&object->mesh);
	for (int corner = 0; corner < 8; corner++) {
		double p[3], world[3];
		bool near = true;
		for (int c = 0; c < 3; c++)
			p[c] = (corner >> c & 1 ? b.upper : b.lower)[c] + object->offset[c];
		for (int row = 0; row < 3; row++) {
			world[row] = m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row];
			near = near && fabs(world[row]) <= ENGINE_MESH_FARTHEST;
		}
		if (near)
			import_bounds_widen(all, world);
	}
}

/* Map coordinates: a metre has two or three bits left there as a float. */
static void move_to_middle(import_loader *loader)
{
	engine_scene *scene = loader->scene;
	import_bounds all = import_bounds_of_nothing();
	for (uint32_t o = 0; o < scene->object_count; o++)
		widen_by_object(&all, scene->graph, &scene->objects[o]);
	if (scene->object_count == 0 || !import_bounds_far_middle(&all, scene->origin))
		return;
	memcpy(scene->graph->origin, scene->origin, sizeof scene->origin);
	import_note(loader, NULL, "the scene lies far from the origin and is moved by %.0f %.0f %.0f m",
		    -scene->origin[0], -scene->origin[1], -scene->origin[2]);
}

static bool same_scale(const engine_scene_object *object, const engine_pose *pose, const double stretch[9])
{
	for (int c = 0; c < 3; c++) {
		if (fabsf(object->rest.scale[c] - pose->scale[c]) > 1e-4f * pose->scale[c]) /* rounding of parents */
			return false;
	}
	for (int k = 0; object->baked && k < 9; k++) {
		if (fabs(object->stretch[k] - stretch[k]) > 1e-4 * object->stretch[k / 4 * 4])
			return false;
	}
	return true;
}

/* What the pose of now says about the object's animation. */
static void look_at_motion(const engine_scene_graph *graph, engine_scene_object *object)
{
	engine_pose pose;
	double stretch[9];
	import_pose_result result = import_object_pose(graph, object, &pose, object->baked ? stretch : NULL);
	if (result == IMPORT_POSE_SINGULAR)
		object->vanishes = true;
	else if (result == IMPORT_POSE_SHEARED || (result == IMPORT_POSE_OK && !same_scale(object, &pose, stretch)))
		object->scale_animated = true;
}

/* How many times may be looked at: a fixed number of nodes in all. */
static uint32_t most_samples(const engine_scene_graph *graph)
{
	uint32_t moving = 1;
	for (uint32_t k = 0; k < graph->order_count; k++)
		moving += graph->nodes[graph->order[k]].moves;
	uint32_t samples = (1u << 19) / moving;
	return samples < 4 ? 4 : samples > 200 ? 200 : samples;
}

/* An object that is not there at rest may be later: a scale of 0 hides it until then. */
static void look_at_time(import_loader *loader, double time_s, bool *placed)
{
	engine_scene *scene = loader->scene;
	import_pose_graph(scene->graph, &time_s);
	for (uint32_t o = 0; o < scene->object_count; o++) {
		engine_scene_object *object = &scene->objects[o];
		if (!object->animated)
			continue;
		if (placed[o])
			look_at_motion(scene->graph, object);
		else
			placed[o] = object->vanishes = import_stand_object(loader, object) == IMPORT_POSE_OK;
	}
}

/* At the keys, or halfway to the next ones; at every n-th where there are many. */
static void look_at_keys(import_loader *loader, bool halfway, bool *placed)
{
	const engine_scene_graph *graph = loader->scene->graph;
	uint64_t keys = 0, key = 0;
	for (uint32_t c = 0; c < graph->channel_count; c++)
		keys += graph->channels[c].key_count;
	uint64_t step = keys / most_samples(graph) + 1;
	for (uint32_t c = 0; c < graph->channel_count; key -= graph->channels[c++].key_count) {
		const import_channel *channel = &graph->channels[c];
		for (; key < channel->key_count; key += step) {
			double time_s = (double)channel->times[key];
			if (halfway && key + 1 < channel->key_count)
				time_s = 0.5 * (time_s + (double)channel->times[key + 1]);
			look_at_time(loader, time_s, placed);
		}
	}
}

/* Animations are at their most at the keys; what shrinks to nothing from one to the next is told apart from what is
 * gone at once by what lies between.
 */
static void look_at_animation(import_loader *loader, bool *placed)
{
	look_at_keys(loader, false, placed);
	look_at_keys(loader, true, placed);
}

static void drop_unplaced(import_loader *loader, const bool *placed, const import_pose_result *results)
{
	engine_scene *scene = loader->scene;
	uint32_t kept = 0;
	for (uint32_t o = 0; o < scene->object_count; o++) {
		if (placed[o]) {
			scene->objects[kept++] = scene->objects[o];
			continue;
		}
		import_note(loader, scene->objects[o].name, "%s", pose_faults[results[o]]);
		import_release_object(&scene->objects[o]);
	}
	scene->object_count = kept;
}

bool import_settle_objects(import_loader *loader)
{
	engine_scene *scene = loader->scene;
	bool *placed = calloc(scene->object_count + 1, sizeof *placed);
	import_pose_result *results = calloc(scene->object_count + 1, sizeof *results);
	if (placed && results) {
		import_mark_moving(scene->graph);
		import_pose_graph(scene->graph, NULL);
		move_to_middle(loader);
		for (uint32_t o = 0; o < scene->object_count; o++) {
			results[o] = import_stand_object(loader, &scene->objects[o]);
			placed[o] = results[o] == IMPORT_POSE_OK;
			scene->objects[o].animated = is_animated(scene->graph, &scene->objects[o]);
		}
		import_level_planes(loader);
		look_at_animation(loader, placed);
		drop_unplaced(loader, placed, results);
	}
	bool settled = (placed && results) || import_fail(loader, "out of memory for objects");
	free(placed);
	free(results);
	return settled;
}
