#include "import_file.h"
#include "mesh_clean.h"
#include "import_build.h"
#include "import_gltf.h"
#include "import_obj.h"
#include "import_path.h"
#include "import_ply.h"
#include "import_settle.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

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
	free(graph->order);
	free(graph->world);
	free(graph);
}

void engine_scene_free(engine_scene *scene)
{
	for (uint32_t i = 0; i < scene->material_count; i++)
		free(scene->materials[i].name);
	for (uint32_t i = 0; i < scene->object_count; i++) {
		import_release_object(&scene->objects[i]);
	}
	for (uint32_t i = 0; i < scene->light_count; i++)
		free(scene->lights[i].name);
	free(scene->materials);
	for (uint32_t i = 0; i < scene->texture_count; i++)
		free(scene->textures[i].pixels.rgba);
	free(scene->textures);
	free(scene->sky.radiance);
	free(scene->objects);
	free(scene->lights);
	free_graph(scene->graph);
	memset(scene, 0, sizeof *scene);
}

static bool has_extension(const char *path, const char *extension)
{
	const char *dot = strrchr(path, '.');
	return dot && strcasecmp(dot, extension) == 0;
}

/* A folder, or what is not there, is told as that. */
static bool fail_unknown(import_loader *loader)
{
	char why[128];
	FILE *file = import_open(loader->path, why, sizeof why);
	if (!file)
		return import_fail(loader, "%s", why);
	fclose(file);
	return import_fail(loader, "is no scene file this program reads; use .gltf, .glb, .obj or .ply");
}

static bool read_by_extension(import_loader *loader)
{
	if (has_extension(loader->path, ".gltf") || has_extension(loader->path, ".glb"))
		return import_read_gltf(loader);
	if (has_extension(loader->path, ".obj"))
		return import_read_obj(loader);
	if (has_extension(loader->path, ".ply"))
		return import_read_ply(loader);
	return fail_unknown(loader);
}

/* A file without any mesh is an empty scene; one of which nothing can be used is refused. */
static bool check_something_is_left(import_loader *loader)
{
	if (loader->scene->object_count > 0)
		return true;
	import_write_warning(loader);
	if (loader->faces_seen > 0)
		return import_fail(loader, "none of its %u faces can be used: %s", loader->faces_seen,
				   loader->scene->warning);
	if (loader->meshes_broken)
		return import_fail(loader, "holds no faces that can be used: %s", loader->scene->warning);
	import_note(loader, NULL, "the file holds no faces");
	return true;
}

static bool read_scene(import_loader *loader)
{
	if (!read_by_extension(loader) || !import_settle_objects(loader))
		return false;
	import_settle_materials(loader);
	if (!check_something_is_left(loader))
		return false;
	import_write_warning(loader);
	return true;
}

bool engine_scene_load(const char *path, engine_scene *scene, char *message, size_t message_size)
{
	*scene = (engine_scene){0};
	import_loader loader = {.path = path, .scene = scene, .message = message, .message_size = message_size};
	scene->graph = calloc(1, sizeof *scene->graph);
	bool loaded = scene->graph ? read_scene(&loader) : import_fail(&loader, "out of memory");
	free(loader.names.slots);
	free(loader.kinds);
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
		import_transform_point(&object->rest, out->positions + 3 * v, out->positions + 3 * v);
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
