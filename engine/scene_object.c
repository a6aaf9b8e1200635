/* Objects of a scene: their meshes cleaned, their poses found. */
#include "mesh_clean.h"
#include "scene_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- meshes ------------------------------------------------------------------------------------------------------ */

typedef struct bounds {
	double lower[3], upper[3];
} bounds;

static const bounds nothing = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void widen(bounds *b, const double point[3])
{
	for (int c = 0; c < 3; c++) {
		b->lower[c] = fmin(b->lower[c], point[c]);
		b->upper[c] = fmax(b->upper[c], point[c]);
	}
}

static bounds mesh_bounds(const engine_mesh *mesh)
{
	bounds b = nothing;
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		const float *p = mesh->positions + 3 * v;
		widen(&b, (const double[3]){p[0], p[1], p[2]});
	}
	return b;
}

/* The middle in whole metres where floats, of 24 bits, are too coarse for what lies there: farther off than 4096 times
 * the extent, or 64 times it and a kilometre. Else zero.
 */
static bool far_middle(const bounds *b, double middle[3])
{
	double extent = 0, farthest = 0;
	for (int c = 0; c < 3; c++) {
		middle[c] = round(0.5 * (b->lower[c] + b->upper[c]));
		extent = fmax(extent, b->upper[c] - b->lower[c]);
		farthest = fmax(farthest, fabs(middle[c]));
	}
	if (farthest < HUGE_VAL && (farthest > 4096 * extent || (farthest > 64 * extent && farthest >= 1000)))
		return true;
	memset(middle, 0, 3 * sizeof *middle);
	return false;
}

/* Moves the mesh to its own middle; what is left of a float there is exact. */
static void recentre(engine_scene_object *object)
{
	double middle[3];
	bounds b = mesh_bounds(&object->mesh);
	if (object->mesh.vertex_count == 0 || !far_middle(&b, middle))
		return;
	for (size_t i = 0; i < 3 * (size_t)object->mesh.vertex_count; i++)
		object->mesh.positions[i] = (float)(object->mesh.positions[i] - middle[i % 3]);
	for (int c = 0; c < 3; c++)
		object->offset[c] += middle[c];
}

typedef struct painted {
	const engine_scene_material *materials;
	const engine_mesh *mesh;
} painted;

static bool is_opaque(const void *context, uint32_t face, const uint32_t *corners)
{
	const painted *p = context;
	(void)corners;
	return !p->materials[p->mesh->face_materials[face]].clear;
}

/* Drops the faces whose material lets light through. */
static void drop_clear_faces(scene_loader *loader, engine_scene_object *object)
{
	const painted p = {loader->scene->materials, &object->mesh};
	scene_note_many(loader, engine_mesh_keep_faces(&object->mesh, is_opaque, &p), object->name,
			"faces that let light through (alpha below a half) are left out");
}

static bool clean(scene_loader *loader, engine_scene_object *object, bool pair_triangles)
{
	char fault[256];
	engine_clean_report report;
	recentre(object);
	drop_clear_faces(loader, object);
	bool had_faces = object->mesh.face_count > 0;
	if (!engine_mesh_clean(&object->mesh, &report, fault, sizeof fault))
		return scene_fail(loader, "object \"%.80s\": %s", object->name, fault);
	scene_note_many(loader, report.degenerate_faces, object->name, "faces without area are dropped");
	scene_note_many(loader, report.duplicate_faces, object->name,
			"faces with the corners of another one are dropped");
	scene_note_many(loader, report.too_large, object->name,
			"faces that are not convex and have thousands of corners are left out");
	if (had_faces && object->mesh.face_count == 0)
		scene_note(loader, object->name, "objects have no face with an area");
	if (pair_triangles)
		engine_mesh_pair_triangles(&object->mesh);
	for (uint32_t f = 0; f < object->mesh.face_count; f++) {
		if (loader->scene->materials[object->mesh.face_materials[f]].double_sided)
			object->double_sided = true;
	}
	return true;
}

static void free_object(engine_scene_object *object)
{
	engine_mesh_free(&object->mesh);
	free(object->name);
}

/* For one more object: the room doubles at 1, 2, 4, ... of them. */
static bool make_room(engine_scene *scene)
{
	size_t count = scene->object_count;
	if ((count & (count - 1)) != 0)
		return true;
	engine_scene_object *grown = realloc(scene->objects, (count ? 2 * count : 1) * sizeof *grown);
	if (grown)
		scene->objects = grown;
	return grown != NULL;
}

/* Appends or drops. Takes the object in either case. */
static bool store_object(scene_loader *loader, engine_scene_object *object)
{
	engine_scene *scene = loader->scene;
	if (object->mesh.face_count == 0) {
		free_object(object);
		return true;
	}
	if (!make_room(scene) || !scene_take_name(&loader->names, object->name)) {
		free_object(object);
		return scene_fail(loader, "out of memory for objects");
	}
	scene->objects[scene->object_count++] = *object;
	return true;
}

bool scene_add_object(scene_loader *loader, const scene_object_def *def, engine_mesh *mesh)
{
	char *wish = scene_copy_name(def->name, "object", loader->scene->object_count);
	engine_scene_object object = {.name = scene_unique_name(&loader->names, wish),
				      .mesh = *mesh,
				      .scheme = def->scheme,
				      .levels = def->levels,
				      .node = def->node};
	memcpy(object.offset, def->offset, sizeof object.offset);
	loader->faces_seen += mesh->face_count;
	*mesh = (engine_mesh){0};
	if (!object.name)
		scene_fail(loader, "out of memory for names");
	else if (clean(loader, &object, def->pair_triangles))
		return store_object(loader, &object);
	free_object(&object);
	return false;
}

/* ---- poses ------------------------------------------------------------------------------------------------------- */

/* Fronts stay fronts: a mirrored face turns over, so its corners run the other way. */
static void mirror_mesh(engine_scene_object *object)
{
	engine_mesh *mesh = &object->mesh;
	for (size_t v = 0; v < mesh->vertex_count; v++)
		mesh->positions[3 * v] = -mesh->positions[3 * v];
	object->offset[0] = -object->offset[0];
	uint32_t *corners = mesh->indices;
	for (uint32_t f = 0; f < mesh->face_count; corners += mesh->face_counts[f++])
		engine_mesh_turn_face(corners, mesh->face_counts[f]);
}

static void stretch_mesh(engine_scene_object *object)
{
	const double *s = object->stretch;
	for (size_t v = 0; v < object->mesh.vertex_count; v++) {
		float *p = object->mesh.positions + 3 * v;
		double q[3];
		for (int row = 0; row < 3; row++)
			q[row] = s[3 * row] * p[0] + s[3 * row + 1] * p[1] + s[3 * row + 2] * p[2];
		for (int row = 0; row < 3; row++)
			p[row] = (float)q[row];
	}
}

static bool reaches_too_far(const engine_scene_object *object)
{
	for (size_t i = 0; i < 3 * (size_t)object->mesh.vertex_count; i++) {
		if (fabs((double)object->mesh.positions[i] * (double)object->rest.scale[i % 3]) > SCENE_FARTHEST)
			return true;
	}
	return false;
}

/* Area in the world at rest, by Newell's method relative to the first corner. */
static double world_area(const engine_scene_object *object, const uint32_t *corners, uint32_t count)
{
	const float *scale = object->rest.scale;
	double n[3], area2 = 0;
	engine_mesh_face_normal(&object->mesh, corners, count, n);
	for (int k = 0; k < 3; k++) {
		double part = n[k] * (double)scale[(k + 1) % 3] * (double)scale[(k + 2) % 3];
		area2 += part * part;
	}
	return sqrt(area2);
}

/* Whether the library would not find the leaves of a face too small. */
static bool is_large_enough(const void *context, uint32_t face, const uint32_t *corners)
{
	const engine_scene_object *object = context;
	return world_area(object, corners, object->mesh.face_counts[face]) >
	       ldexp(SCENE_LEAST_AREA, 2 * (int)object->levels);
}

/* Finds the pose as graph->world has it; where the matrix mirrors or shears, the mesh takes that part. */
static scene_pose_result find_pose(const engine_scene_graph *graph, engine_scene_object *object)
{
	scene_pose_result result = scene_object_pose(graph, object, &object->rest, NULL);
	if (result == SCENE_POSE_MIRRORED) {
		object->mirrored = true;
		mirror_mesh(object);
		result = scene_object_pose(graph, object, &object->rest, NULL);
	}
	if (result != SCENE_POSE_SHEARED)
		return result;
	object->baked = true;
	result = scene_object_pose(graph, object, &object->rest, object->stretch);
	if (result == SCENE_POSE_MIRRORED) {
		object->mirrored = true;
		mirror_mesh(object);
		result = scene_object_pose(graph, object, &object->rest, object->stretch);
	}
	if (result == SCENE_POSE_OK)
		stretch_mesh(object);
	return result;
}

static scene_pose_result place(const engine_scene_graph *graph, engine_scene_object *object)
{
	scene_pose_result result = find_pose(graph, object);
	if (result == SCENE_POSE_OK && reaches_too_far(object))
		return SCENE_POSE_FAR;
	if (result != SCENE_POSE_OK)
		return result;
	engine_mesh_keep_faces(&object->mesh, is_large_enough, object);
	return object->mesh.face_count > 0 ? SCENE_POSE_OK : SCENE_POSE_TINY;
}

static const char *const pose_faults[SCENE_POSE_RESULTS] = {
    [SCENE_POSE_OK] = "",
    [SCENE_POSE_SINGULAR] = "objects whose scale is 0 (or whose transform is singular) are left out",
    [SCENE_POSE_SHEARED] = "objects whose transform is no matrix of finite numbers are left out",
    [SCENE_POSE_MIRRORED] = "objects whose transform is no matrix of finite numbers are left out",
    [SCENE_POSE_FAR] = "objects beyond 1e9 m are left out",
    [SCENE_POSE_TINY] = "objects of faces below 1e-23 m2 are left out",
};

static bool is_animated(const engine_scene_graph *graph, const engine_scene_object *object)
{
	return graph->nodes[object->node].moves;
}

/* The corners of an object's bounds, in the world of the file. */
static void widen_by_object(bounds *all, const engine_scene_graph *graph, const engine_scene_object *object)
{
	const double *m = graph->world + 16 * (size_t)object->node;
	bounds b = mesh_bounds(&object->mesh);
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
			widen(all, world);
	}
}

/* Map coordinates: a metre has two or three bits left there as a float. */
static void move_to_middle(scene_loader *loader)
{
	engine_scene *scene = loader->scene;
	bounds all = nothing;
	for (uint32_t o = 0; o < scene->object_count; o++)
		widen_by_object(&all, scene->graph, &scene->objects[o]);
	if (scene->object_count == 0 || !far_middle(&all, scene->origin))
		return;
	memcpy(scene->graph->origin, scene->origin, sizeof scene->origin);
	scene_note(loader, NULL, "the scene lies far from the origin and is moved by %.0f %.0f %.0f m",
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
	scene_pose_result result = scene_object_pose(graph, object, &pose, object->baked ? stretch : NULL);
	if (result == SCENE_POSE_SINGULAR)
		object->vanishes = true;
	else if (result == SCENE_POSE_SHEARED || (result == SCENE_POSE_OK && !same_scale(object, &pose, stretch)))
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
static void look_at_time(engine_scene *scene, double time_s, bool *placed)
{
	scene_pose_graph(scene->graph, &time_s);
	for (uint32_t o = 0; o < scene->object_count; o++) {
		engine_scene_object *object = &scene->objects[o];
		if (!object->animated)
			continue;
		if (placed[o])
			look_at_motion(scene->graph, object);
		else
			placed[o] = object->vanishes = place(scene->graph, object) == SCENE_POSE_OK;
	}
}

/* At the keys, or halfway to the next ones; at every n-th where there are many. */
static void look_at_keys(engine_scene *scene, bool halfway, bool *placed)
{
	const engine_scene_graph *graph = scene->graph;
	uint64_t keys = 0, key = 0;
	for (uint32_t c = 0; c < graph->channel_count; c++)
		keys += graph->channels[c].key_count;
	uint64_t step = keys / most_samples(graph) + 1;
	for (uint32_t c = 0; c < graph->channel_count; key -= graph->channels[c++].key_count) {
		const scene_channel *channel = &graph->channels[c];
		for (; key < channel->key_count; key += step) {
			double time_s = (double)channel->times[key];
			if (halfway && key + 1 < channel->key_count)
				time_s = 0.5 * (time_s + (double)channel->times[key + 1]);
			look_at_time(scene, time_s, placed);
		}
	}
}

/* Animations are at their most at the keys; what shrinks to nothing from one to the next is told apart from what is
 * gone at once by what lies between.
 */
static void look_at_animation(engine_scene *scene, bool *placed)
{
	look_at_keys(scene, false, placed);
	look_at_keys(scene, true, placed);
}

static void drop_unplaced(scene_loader *loader, const bool *placed, const scene_pose_result *results)
{
	engine_scene *scene = loader->scene;
	uint32_t kept = 0;
	for (uint32_t o = 0; o < scene->object_count; o++) {
		if (placed[o]) {
			scene->objects[kept++] = scene->objects[o];
			continue;
		}
		scene_note(loader, scene->objects[o].name, "%s", pose_faults[results[o]]);
		free_object(&scene->objects[o]);
	}
	scene->object_count = kept;
}

bool scene_settle_objects(scene_loader *loader)
{
	engine_scene *scene = loader->scene;
	bool *placed = calloc(scene->object_count + 1, sizeof *placed);
	scene_pose_result *results = calloc(scene->object_count + 1, sizeof *results);
	if (placed && results) {
		scene_mark_moving(scene->graph);
		scene_pose_graph(scene->graph, NULL);
		move_to_middle(loader);
		for (uint32_t o = 0; o < scene->object_count; o++) {
			results[o] = place(scene->graph, &scene->objects[o]);
			placed[o] = results[o] == SCENE_POSE_OK;
			scene->objects[o].animated = is_animated(scene->graph, &scene->objects[o]);
		}
		look_at_animation(scene, placed);
		drop_unplaced(loader, placed, results);
	}
	bool settled = (placed && results) || scene_fail(loader, "out of memory for objects");
	free(placed);
	free(results);
	return settled;
}
