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
	*material = (engine_scene_material){.name = copy, .rho = {0.5f, 0.5f, 0.5f}};
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

/* ---- tints ------------------------------------------------------------------------------------------------------- */

/* The slot of the key, or the empty one where it would go; the table is never full. */
static import_tint *find_tint(const import_tints *tints, uint64_t key)
{
	size_t slot = (size_t)(key * 0x9e3779b97f4a7c15u >> 32) & (tints->capacity - 1);
	while (tints->slots[slot].number != 0 && tints->slots[slot].key != key)
		slot = (slot + 1) & (tints->capacity - 1);
	return &tints->slots[slot];
}

/* At most half full. */
static bool make_room(import_tints *tints)
{
	if (2 * (tints->count + 1) <= tints->capacity)
		return true;
	import_tints grown = {.capacity = tints->capacity ? 2 * tints->capacity : 64, .count = tints->count};
	grown.slots = calloc(grown.capacity, sizeof *grown.slots);
	if (!grown.slots)
		return false;
	for (size_t i = 0; i < tints->capacity; i++) {
		if (tints->slots[i].number != 0)
			*find_tint(&grown, tints->slots[i].key) = tints->slots[i];
	}
	free(tints->slots);
	*tints = grown;
	return true;
}

/* Square roots, as eyes and display values go: 31 steps in the dark as well. */
static uint32_t step_of(float value)
{
	return value > 0 ? (uint32_t)lrintf(31 * sqrtf(fminf(value, 1))) : 0;
}

static bool add_tint(import_loader *loader, uint32_t base, const float color[3])
{
	engine_scene_material *made = import_add_material(loader, loader->scene->materials[base].name);
	if (!made)
		return false;
	const engine_scene_material *from = &loader->scene->materials[base];
	char *name = made->name;
	*made = *from;
	made->name = name;
	for (int c = 0; c < 3; c++) {
		made->rho[c] *= color[c];
		made->rho_factor[c] *= color[c];
	}
	return true;
}

bool import_tinted_material(import_loader *loader, uint32_t base, const float color[3], uint32_t *number)
{
	uint32_t steps[3] = {step_of(color[0]), step_of(color[1]), step_of(color[2])};
	*number = base;
	if (steps[0] + steps[1] + steps[2] == 3 * 31) /* white */
		return true;
	uint64_t key = (uint64_t)base << 15 | steps[0] << 10 | steps[1] << 5 | steps[2];
	if (!make_room(&loader->tints))
		return import_fail(loader, "out of memory for materials");
	import_tint *tint = find_tint(&loader->tints, key);
	if (tint->number == 0) {
		if (!add_tint(loader, base, color))
			return false;
		*tint = (import_tint){key, loader->scene->material_count};
		loader->tints.count++;
	}
	*number = tint->number - 1;
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

/* What a reflectance becomes, and which fault it had. rho 1 - 1e-6 is 1 as far as sums of floats can tell. */
typedef enum fault { FAULT_NONE, FAULT_WHITE, FAULT_OUT_OF_RANGE } fault;

static fault mend_reflectance(float rho[3])
{
	fault worst = FAULT_NONE;
	for (int c = 0; c < 3; c++) {
		if (rho[c] >= 0 && rho[c] <= 1 - 1e-6f)
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

void import_settle_materials(import_loader *loader)
{
	engine_scene *scene = loader->scene;
	mark_used(scene);
	for (uint32_t m = 0; m < scene->material_count; m++) {
		engine_scene_material *material = &scene->materials[m];
		fault reflects = mend_reflectance(material->rho), emits = mend_radiance(material->radiance);
		if (material->used && reflects == FAULT_WHITE)
			import_note(
			    loader, material->name,
			    "materials with a reflectance of 1 or more get 0.98 (nothing gives back all light)");
		if (material->used && reflects == FAULT_OUT_OF_RANGE)
			import_note(loader, material->name,
				    "materials with a reflectance that is negative or no number get 0 for it");
		if (material->used && emits != FAULT_NONE)
			import_note(
			    loader, material->name,
			    "materials that emit what is no radiance of 0 to 3e11 W/(m2 sr) emit the nearest, or none");
	}
}
