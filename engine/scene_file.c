#include "mesh_clean.h"
#include "scene_internal.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Messages are one line whatever a file's names contain. */
static void replace_control_characters(char *text)
{
	for (; *text; text++) {
		if ((unsigned char)*text < 32 || *text == 127)
			*text = ' ';
	}
}

bool scene_fail(scene_loader *loader, const char *format, ...)
{
	char text[384];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	snprintf(loader->message, loader->message_size, "%s: %s", loader->path, text);
	if (loader->message_size)
		replace_control_characters(loader->message);
	return false;
}

void scene_warn(scene_loader *loader, const char *format, ...)
{
	char *warning = loader->scene->warning;
	size_t used = strlen(warning), size = sizeof loader->scene->warning;
	if (used + 2 >= size) /* full: the first lines say enough */
		return;
	if (used > 0)
		used += (size_t)snprintf(warning + used, size - used, "; ");
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(warning + used, size - used, format, arguments);
	va_end(arguments);
	replace_control_characters(warning);
}

char *scene_copy_name(const char *name, const char *fallback, uint32_t number)
{
	size_t size = (name && name[0] ? strlen(name) : strlen(fallback) + 10) + 1;
	char *copy = malloc(size);
	if (!copy)
		return NULL;
	if (name && name[0])
		memcpy(copy, name, size);
	else
		snprintf(copy, size, "%s%u", fallback, number);
	replace_control_characters(copy);
	return copy;
}

/* ---- materials --------------------------------------------------------------------------------------------------- */

engine_scene_material *scene_add_material(scene_loader *loader, const char *name)
{
	engine_scene *scene = loader->scene;
	engine_scene_material *grown =
	    realloc(scene->materials, (scene->material_count + 1) * sizeof *scene->materials);
	char *copy = grown ? scene_copy_name(name, "material", scene->material_count) : NULL;
	if (grown)
		scene->materials = grown;
	if (!copy) {
		scene_fail(loader, "out of memory for materials");
		return NULL;
	}
	engine_scene_material *material = &scene->materials[scene->material_count++];
	*material = (engine_scene_material){.name = copy, .rho = {0.5f, 0.5f, 0.5f}};
	return material;
}

/* rho 1 - 1e-6 is 1 as far as sums of floats can tell. */
bool scene_check_material(scene_loader *loader, const engine_scene_material *material)
{
	const float *rho = material->rho, *radiance = material->radiance;
	for (int c = 0; c < 3; c++) {
		if (!(rho[c] >= 0 && rho[c] <= 1 - 1e-6f))
			return scene_fail(
			    loader,
			    "material \"%.80s\" has reflectance %g %g %g, each must be at least 0 and below 1; "
			    "use at most 0.98 (nothing gives back all light)",
			    material->name, (double)rho[0], (double)rho[1], (double)rho[2]);
		if (!(radiance[c] >= 0 && radiance[c] < 1e30f))
			return scene_fail(
			    loader, "material \"%.80s\" emits %g %g %g, each must be 0 or more and finite",
			    material->name, (double)radiance[0], (double)radiance[1], (double)radiance[2]);
	}
	return true;
}

bool scene_default_material(scene_loader *loader, uint32_t *number)
{
	engine_scene *scene = loader->scene;
	/* Only ever the last one: files' own materials are all there before the first face asks. */
	if (scene->material_count > 0 && strcmp(scene->materials[scene->material_count - 1].name, "(default)") == 0) {
		*number = scene->material_count - 1;
		return true;
	}
	*number = scene->material_count;
	return scene_add_material(loader, "(default)") != NULL;
}

/* ---- objects ----------------------------------------------------------------------------------------------------- */

static const char *const pose_faults[] = {"", "is singular (a scale is zero or not finite)",
					  "is sheared; apply the scale of its parents in the modeller", "is mirrored",
					  "goes beyond 1e15 m"};

/* Fronts stay fronts: a mirrored face turns over, so its corners run the other way. */
static void mirror_mesh(engine_mesh *mesh)
{
	for (size_t v = 0; v < mesh->vertex_count; v++)
		mesh->positions[3 * v] = -mesh->positions[3 * v];
	uint32_t *corners = mesh->indices;
	for (uint32_t f = 0; f < mesh->face_count; corners += mesh->face_counts[f++]) {
		for (uint32_t a = 0, b = mesh->face_counts[f] - 1; a < b; a++, b--) {
			uint32_t kept = corners[a];
			corners[a] = corners[b];
			corners[b] = kept;
		}
	}
}

static bool rest_pose(scene_loader *loader, engine_scene_object *object)
{
	engine_scene_graph *graph = loader->scene->graph;
	scene_pose_result result = scene_node_pose(graph, object->node, NULL, false, &object->rest);
	if (result == SCENE_POSE_MIRRORED) {
		object->mirrored = true;
		mirror_mesh(&object->mesh);
		result = scene_node_pose(graph, object->node, NULL, true, &object->rest);
	}
	return result == SCENE_POSE_OK ||
	       scene_fail(loader, "the transform of object \"%.80s\" %s", object->name, pose_faults[result]);
}

static bool same_scale(const engine_pose *a, const engine_pose *b)
{
	for (int c = 0; c < 3; c++) {
		if (fabsf(a->scale[c] - b->scale[c]) > 1e-4f * a->scale[c]) /* rounding of a chain of parents */
			return false;
	}
	return true;
}

/* Tries the object's pose at every key of a channel. */
static bool check_keys(scene_loader *loader, engine_scene_object *object, const scene_channel *channel)
{
	for (uint32_t key = 0; key < channel->key_count; key++) {
		double time_s = channel->times[key];
		engine_pose pose;
		scene_pose_result result =
		    scene_node_pose(loader->scene->graph, object->node, &time_s, object->mirrored, &pose);
		if (result != SCENE_POSE_OK)
			return scene_fail(loader, "at %g s the transform of object \"%.80s\" %s", time_s, object->name,
					  pose_faults[result]);
		object->scale_animated = object->scale_animated || !same_scale(&object->rest, &pose);
	}
	return true;
}

static bool animated_poses(scene_loader *loader, engine_scene_object *object)
{
	const engine_scene_graph *graph = loader->scene->graph;
	for (int32_t n = (int32_t)object->node; n >= 0; n = graph->nodes[n].parent) {
		for (int property = 0; property < SCENE_PROPERTIES; property++) {
			int32_t channel = graph->nodes[n].channels[property];
			if (channel < 0)
				continue;
			object->animated = true;
			if (!check_keys(loader, object, &graph->channels[channel]))
				return false;
		}
	}
	return true;
}

static bool finish_object(scene_loader *loader, engine_scene_object *object, bool pair_triangles)
{
	char fault[256];
	engine_clean_report report;
	if (!engine_mesh_clean(&object->mesh, &report, fault, sizeof fault))
		return scene_fail(loader, "object \"%.80s\": %s", object->name, fault);
	loader->degenerate_faces += report.degenerate_faces;
	if (pair_triangles)
		engine_mesh_pair_triangles(&object->mesh);
	for (uint32_t f = 0; f < object->mesh.face_count; f++) {
		if (loader->scene->materials[object->mesh.face_materials[f]].double_sided)
			object->double_sided = true;
	}
	return rest_pose(loader, object) && animated_poses(loader, object);
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
		scene_warn(loader, "object \"%.80s\" has no face with an area", object->name);
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
	*mesh = (engine_mesh){0};
	if (!object.name)
		scene_fail(loader, "out of memory for names");
	else if (finish_object(loader, &object, def->pair_triangles))
		return store_object(loader, &object);
	free_object(&object);
	return false;
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

static void free_graph(engine_scene_graph *graph)
{
	if (!graph)
		return;
	for (uint32_t i = 0; i < graph->channel_count; i++) {
		free(graph->channels[i].times);
		free(graph->channels[i].values);
	}
	free(graph->channels);
	free(graph->nodes);
	free(graph);
}

void engine_scene_free(engine_scene *scene)
{
	for (uint32_t i = 0; i < scene->material_count; i++)
		free(scene->materials[i].name);
	for (uint32_t i = 0; i < scene->object_count; i++)
		free_object(&scene->objects[i]);
	free(scene->materials);
	free(scene->objects);
	free_graph(scene->graph);
	memset(scene, 0, sizeof *scene);
}

static bool has_extension(const char *path, const char *extension)
{
	const char *dot = strrchr(path, '.');
	return dot && strcasecmp(dot, extension) == 0;
}

/* Readers guess less well what is wrong with a file than this does. */
static bool check_readable(scene_loader *loader)
{
	FILE *file = fopen(loader->path, "rb");
	if (!file)
		return scene_fail(loader, "the file cannot be opened");
	bool has_bytes = fgetc(file) != EOF; /* false for a folder too */
	fclose(file);
	return has_bytes || scene_fail(loader, "the file is empty or cannot be read");
}

static bool read_by_extension(scene_loader *loader)
{
	if (has_extension(loader->path, ".gltf") || has_extension(loader->path, ".glb"))
		return scene_read_gltf(loader);
	if (has_extension(loader->path, ".obj") || has_extension(loader->path, ".ply"))
		return scene_read_assimp(loader);
	return scene_fail(loader, "is no scene file this program reads; use .gltf, .glb, .obj or .ply");
}

static bool check_something_is_left(scene_loader *loader)
{
	if (loader->degenerate_faces == 0)
		return true;
	if (loader->scene->object_count == 0)
		return scene_fail(loader, "none of its %u faces has an area", loader->degenerate_faces);
	scene_warn(loader, "%u faces without area were dropped", loader->degenerate_faces);
	return true;
}

bool engine_scene_load(const char *path, engine_scene *scene, char *message, size_t message_size)
{
	*scene = (engine_scene){0};
	scene_loader loader = {.path = path, .scene = scene, .message = message, .message_size = message_size};
	scene->graph = calloc(1, sizeof *scene->graph);
	bool loaded = scene->graph || scene_fail(&loader, "out of memory");
	loaded = loaded && check_readable(&loader) && read_by_extension(&loader) && check_something_is_left(&loader);
	free(loader.names.slots);
	if (!loaded)
		engine_scene_free(scene);
	return loaded;
}

/* ---- merging ----------------------------------------------------------------------------------------------------- */

static bool append_in_world(engine_mesh *out, const engine_scene_object *object)
{
	uint32_t first = out->vertex_count;
	if (!engine_mesh_append(out, &object->mesh, 0))
		return false;
	for (size_t v = first; v < out->vertex_count; v++)
		scene_transform_point(&object->rest, out->positions + 3 * v, out->positions + 3 * v);
	return true;
}

bool engine_scene_merge(const engine_scene *scene, engine_mesh *out, char *message, size_t message_size)
{
	*out = (engine_mesh){0};
	bool appended = true;
	for (uint32_t i = 0; i < scene->object_count && appended; i++)
		appended = append_in_world(out, &scene->objects[i]);
	engine_clean_report report;
	if (!appended)
		snprintf(message, message_size, "out of memory for merging %u objects", scene->object_count);
	else if (engine_mesh_clean(out, &report, message, message_size))
		return true;
	engine_mesh_free(out);
	return false;
}
