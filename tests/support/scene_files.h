/* For tests of the readers of scene files: a temporary folder, files in it, and what loading them should give. */
#ifndef TESTS_UNIT_SCENE_FILES_H
#define TESTS_UNIT_SCENE_FILES_H

#ifndef _XOPEN_SOURCE
#define _XOPEN_SOURCE 700 /* mkdtemp */
#endif

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "engine/mesh_clean.h"
#include "engine/import_file.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Not every test has a use for it. */
#define SOME_TESTS __attribute__((unused))

static char folder[64];
static char message[512];

/* Path of a file in the temporary folder; two may be in use at once. */
static const char *path_of(const char *name)
{
	static char paths[2][384];
	static int turn;
	char *path = paths[turn ^= 1];
	snprintf(path, sizeof paths[0], "%s/%s", folder, name);
	return path;
}

static const char *write_file(const char *name, const void *bytes, size_t size)
{
	const char *path = path_of(name);
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	assert_int_equal(fwrite(bytes, 1, size, file), size);
	fclose(file);
	return path;
}

static const char *write_text(const char *name, const char *text)
{
	return write_file(name, text, strlen(text));
}

static engine_scene load(const char *path)
{
	engine_scene scene;
	message[0] = '\0';
	if (!engine_scene_load(path, &scene, message, sizeof message))
		fail_msg("%s", message);
	return scene;
}

/* The file is refused with one line that has these words in it, and nothing is left in the scene. */
SOME_TESTS static void check_refused(const char *path, const char *words)
{
	engine_scene scene;
	memset(&scene, 0xff, sizeof scene);
	message[0] = '\0';
	assert_false(engine_scene_load(path, &scene, message, sizeof message));
	if (!strstr(message, words))
		fail_msg("\"%s\" does not say \"%s\"", message, words);
	assert_null(strchr(message, '\n'));
	assert_ptr_equal(strstr(message, path), message);
	assert_null(scene.objects);
	assert_int_equal(scene.object_count, 0);
}

/* Loads, with these words in the warning; "" for no warning. */
SOME_TESTS static void check_told(const char *path, const char *words)
{
	engine_scene scene = load(path);
	if (!strstr(scene.warning, words) || (!words[0] && scene.warning[0]))
		fail_msg("\"%s\" is not \"%s\"", scene.warning, words);
	engine_scene_free(&scene);
}

SOME_TESTS static void check_floats(const float *values, const float *expected, int count, float tolerance)
{
	for (int i = 0; i < count; i++) {
		if (!(fabsf(values[i] - expected[i]) <= tolerance))
			fail_msg("value %d is %.9g, not %.9g", i, (double)values[i], (double)expected[i]);
	}
}

#define CHECK3(values, x, y, z) check_floats(values, (const float[3]){x, y, z}, 3, 1e-5f)

/* What a face with colours reflects: the mean of its corners times its material's factor. */
SOME_TESTS static void face_rho(const engine_scene *scene, uint32_t object, uint32_t face, float rho[3])
{
	const engine_mesh *mesh = &scene->objects[object].mesh;
	const engine_scene_material *m = &scene->materials[mesh->face_materials[face]];
	size_t first = 0;
	for (uint32_t f = 0; f < face; f++)
		first += mesh->face_counts[f];
	assert_non_null(mesh->colors);
	for (int c = 0; c < 3; c++) {
		rho[c] = 0;
		for (uint32_t k = 0; k < mesh->face_counts[face]; k++)
			rho[c] += m->rho_factor[c] * mesh->colors[4 * (first + k) + (size_t)c];
		rho[c] /= (float)mesh->face_counts[face];
	}
}

#define CHECK_FACE(scene, face, x, y, z)                                                                               \
	do {                                                                                                           \
		float rho_of_face[3];                                                                                  \
		face_rho(scene, 0, face, rho_of_face);                                                                 \
		CHECK3(rho_of_face, x, y, z);                                                                          \
	} while (0)

/* Sum of the areas of an object's faces. */
SOME_TESTS static double area_of(const engine_scene_object *object)
{
	const engine_mesh *mesh = &object->mesh;
	const uint32_t *corners = mesh->indices;
	double area = 0;
	for (uint32_t f = 0; f < mesh->face_count; corners += mesh->face_counts[f++]) {
		double n[3];
		engine_mesh_face_normal(mesh, corners, mesh->face_counts[f], n);
		area += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	}
	return area;
}

/* ---- damage at random -------------------------------------------------------------------------------------------- */

static uint32_t random_state = 20240607;

/* xorshift32 (Marsaglia 2003): the same damage on every machine. */
static uint32_t next_random(void)
{
	random_state ^= random_state << 13;
	random_state ^= random_state >> 17;
	random_state ^= random_state << 5;
	return random_state;
}

/* Loading may fail or not; what loads must be sound. */
static void load_damaged(const char *name, const uint8_t *bytes, size_t size)
{
	engine_scene scene;
	message[0] = '\0';
	if (!engine_scene_load(write_file(name, bytes, size), &scene, message, sizeof message)) {
		assert_true(message[0] != '\0' && !strchr(message, '\n'));
		return;
	}
	for (uint32_t i = 0; i < scene.object_count; i++) {
		const engine_mesh *mesh = &scene.objects[i].mesh;
		for (uint32_t k = 0; k < mesh->index_count; k++)
			assert_true(mesh->indices[k] < mesh->vertex_count);
		for (uint32_t f = 0; f < mesh->face_count; f++)
			assert_true(mesh->face_materials[f] < scene.material_count);
	}
	engine_scene_free(&scene);
}

/* Cuts a file at a hundred places, and turns over up to four of its bits many times. */
SOME_TESTS static void damage(const char *name, const uint8_t *bytes, size_t size, int flips)
{
	uint8_t *copy = malloc(size);
	assert_non_null(copy);
	for (size_t cut = 1; cut < size; cut += 1 + size / 97)
		load_damaged(name, bytes, cut);
	for (int i = 0; i < flips; i++) {
		memcpy(copy, bytes, size);
		for (uint32_t k = next_random() % 4 + 1; k > 0; k--)
			copy[next_random() % size] ^= (uint8_t)(1u << next_random() % 8);
		load_damaged(name, copy, size);
	}
	free(copy);
}

/* ---- the folder -------------------------------------------------------------------------------------------------- */

static int make_folder(void **state)
{
	(void)state;
	strcpy(folder, "/tmp/relume-scene-XXXXXX");
	return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
	(void)state;
	DIR *files = opendir(folder);
	for (const struct dirent *entry; files && (entry = readdir(files));)
		unlink(path_of(entry->d_name));
	if (files)
		closedir(files);
	return rmdir(folder);
}

#endif
