/* Materials of a scene: made as files state them, brought into the ranges that have a solution. */
#include "import_build.h"

#include <math.h>
#include <stdlib.h>

/* White paper and plaster reach 0.9, barium sulphate 0.98. */
static const float MOST_REFLECTED = 0.98f;

engine_scene_material *import_add_material(import_loader *loader, const char *name)
{
	engine_scene *scene = loader->scene;
	size_t count = scene->material_count;
	bool full = (count & (count - 1)) == 0; /* the room doubles at 1, 2, 4, ... of them */
	engine_scene_material *grown =
	    full ? realloc(scene->materials, (count ? 2 * count : 1) * sizeof *grown) : scene->materials;
	char *copy = grown ? import_copy_name(name, "material", scene->material_count) : NULL;
	if (grown)
		scene->materials = grown;
	if (!copy) {
		import_fail(loader, "out of memory for materials");
		return NULL;
	}
	engine_scene_material *material = &scene->materials[scene->material_count++];
	*material = (engine_scene_material){
	    .name = copy, .rho = {0.5f, 0.5f, 0.5f}, .rho_factor = {1, 1, 1}, .alpha_factor = 1};
	return material;
}

bool import_add_texture(import_loader *loader, engine_texture *texture, uint32_t *number)
{
	engine_scene *scene = loader->scene;
	const size_t count = scene->texture_count;
	engine_texture *grown = (count & (count - 1)) == 0
				    ? realloc(scene->textures, (count ? 2 * count : 1) * sizeof *grown)
				    : scene->textures;
	if (!grown) {
		free(texture->pixels.rgba);
		return false;
	}
	scene->textures = grown;
	scene->textures[scene->texture_count++] = *texture;
	*number = scene->texture_count;
	return true;
}

bool import_default_material(import_loader *loader, uint32_t *number)
{
	if (loader->default_material == 0) {
		if (!import_add_material(loader, "(default)"))
			return false;
		loader->default_material = loader->scene->material_count;
	}
	*number = loader->default_material - 1;
	return true;
}

/* ---- ranges ------------------------------------------------------------------------------------------------------ */

static void mark_used(engine_scene *scene)
{
	for (uint32_t o = 0; o < scene->object_count; o++) {
		const engine_mesh *mesh = &scene->objects[o].mesh;
		for (uint32_t f = 0; f < mesh->face_count; f++)
			scene->materials[mesh->face_materials[f]].used = true;
	}
}

/* What floats tell from 1. */
static const float WHITE = 1 - 1e-6f;

/* What a reflectance becomes, and which fault it had. */
typedef enum fault { FAULT_NONE, FAULT_WHITE, FAULT_OUT_OF_RANGE } fault;

static fault mend_reflectance(float rho[3])
{
	fault worst = FAULT_NONE;
	for (int c = 0; c < 3; c++) {
		if (rho[c] >= 0 && rho[c] <= WHITE)
			continue;
		if (rho[c] > 0 && worst == FAULT_NONE)
			worst = FAULT_WHITE;
		else if (!(rho[c] > 0))
			worst = FAULT_OUT_OF_RANGE;
		rho[c] = rho[c] > 0 ? MOST_REFLECTED : 0;
	}
	return worst;
}

static fault mend_radiance(float radiance[3])
{
	fault worst = FAULT_NONE;
	for (int c = 0; c < 3; c++) {
		if (radiance[c] >= 0 && radiance[c] <= IMPORT_MOST_RADIANCE)
			continue;
		radiance[c] = radiance[c] > 0 && isfinite(radiance[c]) ? IMPORT_MOST_RADIANCE : 0;
		worst = FAULT_OUT_OF_RANGE;
	}
	return worst;
}

static const char *const TOO_WHITE =
    "materials with a reflectance of 1 or more get 0.98 (nothing gives back all light)";

/* Whether some corner of the mesh is white. One whose material has a texture is as its texels are. */
static bool has_white_corner(const engine_scene *scene, const engine_mesh *mesh)
{
	const float *color = mesh->colors;
	for (uint32_t f = 0; color && f < mesh->face_count; f++) {
		const engine_scene_material *m = &scene->materials[mesh->face_materials[f]];
		for (uint32_t k = 0; k < mesh->face_counts[f]; k++, color += 4)
			for (int c = 0; c < 3; c++)
				if (m->rho_factor[c] * color[c] > WHITE && !m->rho_texture.number)
					return true;
	}
	return false;
}

/* Such are made less white where they are used (demos/file_textures.c). */
static void note_white_corners(import_loader *loader)
{
	const engine_scene *scene = loader->scene;
	for (uint32_t o = 0; o < scene->object_count; o++)
		if (has_white_corner(scene, &scene->objects[o].mesh))
			import_note(loader, scene->objects[o].name, "%s", TOO_WHITE);
}

void import_settle_materials(import_loader *loader)
{
	engine_scene *scene = loader->scene;
	mark_used(scene);
	note_white_corners(loader);
	for (uint32_t m = 0; m < scene->material_count; m++) {
		engine_scene_material *material = &scene->materials[m];
		fault reflects = mend_reflectance(material->rho), emits = mend_radiance(material->radiance);
		if (material->used && reflects == FAULT_WHITE)
			import_note(loader, material->name, "%s", TOO_WHITE);
		if (material->used && reflects == FAULT_OUT_OF_RANGE)
			import_note(loader, material->name,
				    "materials with a reflectance that is negative or no number get 0 for it");
		if (material->used && emits != FAULT_NONE)
			import_note(
			    loader, material->name,
			    "materials that emit what is no radiance of 0 to 3e11 W/(m2 sr) emit the nearest, or none");
	}
}
