#define _XOPEN_SOURCE 700 /* mkdtemp */
#include "fuzz_scene.h"

#include "engine/import_file.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[] = "/tmp/relume-fuzz-XXXXXX";

static void path_of(const char *name, char path[512])
{
	snprintf(path, 512, "%s/%s", folder, name);
}

static void remove_folder(void)
{
	char path[512];
	DIR *files = opendir(folder);
	for (const struct dirent *entry; files && (entry = readdir(files));) {
		path_of(entry->d_name, path);
		unlink(path);
	}
	if (files)
		closedir(files);
	rmdir(folder);
}

static void make_folder(void)
{
	static int made;
	if (made)
		return;
	made = 1;
	if (!mkdtemp(folder)) {
		perror(folder);
		exit(EXIT_FAILURE);
	}
	atexit(remove_folder);
}

void fuzz_write(const char *name, const uint8_t *bytes, size_t size)
{
	char path[512];
	make_folder();
	path_of(name, path);
	FILE *file = size > 0 ? fopen(path, "wb") : NULL;
	if (size == 0)
		unlink(path);
	else if (!file || fwrite(bytes, 1, size, file) != size || fclose(file) != 0)
		exit(EXIT_FAILURE);
}

const char *fuzz_path(const char *name)
{
	static char path[512];
	path_of(name, path);
	return path;
}

static void require(bool holds, const char *what)
{
	if (holds)
		return;
	fprintf(stderr, "broken promise: %s\n", what);
	abort();
}

static void check_material(const engine_scene_material *material)
{
	for (int c = 0; material->used && c < 3; c++) {
		require(material->rho[c] >= 0 && material->rho[c] < 1, "rho in [0, 1)");
		require(material->rho_factor[c] >= 0 && material->radiance_factor[c] >= 0, "factors are 0 and above");
		require(material->radiance[c] >= 0 && material->radiance[c] < 1e31f, "radiance in [0, 1e30]");
	}
}

static void check_mesh(const engine_scene *scene, const engine_mesh *mesh)
{
	size_t corners = 0;
	require(mesh->face_count > 0, "an object has faces");
	for (uint32_t f = 0; f < mesh->face_count; f++) {
		corners += mesh->face_counts[f];
		require(mesh->face_counts[f] >= 3, "a face has three corners");
		require(mesh->face_materials[f] < scene->material_count, "a face has a material");
	}
	require(corners == mesh->index_count, "corners add up");
	for (uint32_t i = 0; i < mesh->index_count; i++)
		require(mesh->indices[i] < mesh->vertex_count, "a corner is a vertex");
	for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++)
		require(isfinite(mesh->positions[i]), "positions are finite");
	for (size_t i = 0; mesh->uvs && i < 2 * (size_t)mesh->index_count; i++)
		require(isfinite(mesh->uvs[i]), "texture coordinates are finite");
	for (size_t i = 0; mesh->colors && i < 4 * (size_t)mesh->index_count; i++)
		require(mesh->colors[i] == ENGINE_NO_COLOR || mesh->colors[i] >= 0, "colours are 0 and above, or none");
}

static void check_pose(const engine_pose *pose)
{
	float length = 0;
	for (int c = 0; c < 3; c++)
		require(isfinite(pose->translation[c]) && pose->scale[c] > 0 && isfinite(pose->scale[c]),
			"a pose is finite and its scale above 0");
	for (int c = 0; c < 4; c++)
		length += pose->rotation[c] * pose->rotation[c];
	require(fabsf(length - 1) < 1e-3f, "a rotation is a unit quaternion");
}

static void check_object(const engine_scene *scene, uint32_t number)
{
	const engine_scene_object *object = &scene->objects[number];
	engine_pose pose;
	require(object->name && object->name[0] && !strchr(object->name, '\n'), "an object has a name of one line");
	check_mesh(scene, &object->mesh);
	check_pose(&object->rest);
	for (int k = 0; k < 3; k++) {
		if (engine_scene_pose(scene, number, scene->duration_s * 0.4 * k, &pose))
			check_pose(&pose);
	}
}

static void check_scene(const engine_scene *scene)
{
	engine_scene_camera camera;
	engine_mesh merged;
	char message[256];
	require(!strchr(scene->warning, '\n'), "a warning is one line");
	for (size_t i = 0; scene->sky.radiance && i < 3 * (size_t)scene->sky.width * scene->sky.height; i++)
		require(scene->sky.radiance[i] >= 0 && scene->sky.radiance[i] <= 3e11f, "the sky is radiance");
	for (uint32_t m = 0; m < scene->material_count; m++)
		check_material(&scene->materials[m]);
	for (uint32_t o = 0; o < scene->object_count; o++)
		check_object(scene, o);
	if (engine_scene_camera_at(scene, 0.3 * scene->duration_s, &camera))
		require(isfinite(camera.eye[0]) && camera.vertical_fov > 0, "a camera is somewhere");
	if (engine_scene_merge(scene, &merged, message, sizeof message))
		engine_mesh_free(&merged);
}

void fuzz_load(const char *name)
{
	engine_scene scene;
	char path[512], message[512] = "";
	path_of(name, path);
	if (!engine_scene_load(path, &scene, message, sizeof message)) {
		require(strncmp(message, path, strlen(path)) == 0 && !strchr(message, '\n'),
			"a refusal is a line that begins with the path");
		return;
	}
	check_scene(&scene);
	engine_scene_free(&scene);
}
