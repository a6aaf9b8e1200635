#define _POSIX_C_SOURCE 200809L /* unsetenv */
#include "harness.h"
#include "scenes/body.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static engine_context *context;
static char last_message[1024];

int harness_open(void **state)
{
	(void)state;
	engine_context_def def = engine_context_def_default();
	const char *name = getenv("RELUME_CONTEXT");
	if (name && !engine_context_kind_from_name(name, &def.kind))
		fprintf(stderr, "RELUME_CONTEXT=%s is not a kind of context\n", name);
	if (!name) { /* headless: no window without a display */
		unsetenv("DISPLAY");
		unsetenv("WAYLAND_DISPLAY");
	}
	def.width = def.height = 64;
	def.hidden = true;
	char message[256];
	context = engine_context_create(&def, message, sizeof message);
	if (context)
		printf("context: %s\n", engine_context_describe(context));
	else
		printf("skipped, no OpenGL context: %s\n", message);
	return 0;
}

int harness_close(void **state)
{
	(void)state;
	engine_context_destroy(context);
	context = NULL;
	return 0;
}

void harness_require_context(void)
{
	if (!context)
		skip();
}

static void keep_message(gi_result result, const char *message, void *user)
{
	(void)result;
	(void)user;
	snprintf(last_message, sizeof last_message, "%s", message);
}

const char *harness_last_message(void)
{
	return last_message;
}

gi_context_def harness_def(void)
{
	harness_require_context();
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = engine_context_find_gl;
	def.get_proc_user = context;
	def.message = keep_message;
	def.shader_directory = getenv("RELUME_SHADERS");
	last_message[0] = 0;
	return def;
}

gi_context *harness_context(const gi_context_def *def)
{
	gi_context *gi = NULL;
	const gi_result result = gi_context_create(def, &gi);
	if (result)
		fail_msg("gi_context_create: %s", last_message);
	return gi;
}

gi_object harness_add(gi_context *gi, const harness_object *o, engine_mesh *mesh)
{
	gi_material material;
	memcpy(material.rho, o->rho, sizeof material.rho);
	memcpy(material.exitance, o->exitance, sizeof material.exitance);
	gi_object_def def = scene_mesh_def(mesh);
	def.name = o->name;
	def.scheme = o->scheme;
	def.levels = o->levels;
	def.materials = &material;
	def.material_count = 1;
	def.double_sided = o->double_sided;
	memcpy(def.pose.position, o->position, sizeof def.pose.position);
	gi_object object;
	if (gi_create_object(gi, &def, &object))
		fail_msg("gi_create_object: %s", last_message);
	engine_mesh_free(mesh);
	return object;
}

gi_report harness_update(gi_context *gi)
{
	gi_report report = {0};
	if (gi_update(gi, NULL) || gi_finish(gi) || gi_get_report(gi, &report))
		fail_msg("update: %s", last_message);
	return report;
}

bool harness_is_long(void)
{
	return getenv("RELUME_LONG") != NULL;
}

uint32_t harness_paths(uint32_t all)
{
	return harness_is_long() ? all : all / 4;
}

void harness_cut_quads(engine_mesh *mesh)
{
	uint32_t *indices = calloc(6 * (size_t)mesh->face_count, sizeof *indices);
	uint32_t *counts = calloc(2 * (size_t)mesh->face_count, sizeof *counts);
	assert_true(indices && counts);
	for (uint32_t f = 0; f < mesh->face_count; f++) {
		const uint32_t *q = mesh->indices + 4 * (size_t)f, corners[6] = {q[0], q[1], q[2], q[0], q[2], q[3]};
		memcpy(indices + 6 * (size_t)f, corners, sizeof corners);
		counts[2 * f] = counts[2 * f + 1] = 3;
	}
	free(mesh->indices);
	free(mesh->face_counts);
	mesh->indices = indices;
	mesh->face_counts = counts;
	mesh->index_count = 6 * mesh->face_count;
	mesh->face_count *= 2;
}
