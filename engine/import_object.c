/* Objects of a scene as the reader finds them: their meshes moved to where floats tell them apart, cleaned, appended.
 */
#include "mesh_clean.h"
#include "import_bounds.h"
#include "import_build.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Moves the mesh to its own middle; what is left of a float there is exact. */
static void recentre(engine_scene_object *object)
{
	double middle[3];
	import_bounds b = import_bounds_of_mesh(&object->mesh);
	if (object->mesh.vertex_count == 0 || !import_bounds_far_middle(&b, middle))
		return;
	for (size_t i = 0; i < 3 * (size_t)object->mesh.vertex_count; i++)
		object->mesh.positions[i] = (float)(object->mesh.positions[i] - middle[i % 3]);
	for (int c = 0; c < 3; c++)
		object->offset[c] += middle[c];
}

/* Of the file's digits, or of the floats that the positions are. */
static double rounding_of(const engine_mesh *mesh, double digits)
{
	float largest = 0;
	for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++)
		largest = fmaxf(largest, fabsf(mesh->positions[i]));
	return fmax(digits, ldexp((double)largest, -24));
}

typedef struct painted {
	const engine_scene_material *materials;
	const engine_texture *textures;
	const engine_mesh *mesh;
} painted;

/* Mean alpha of a texture on a triangle; uvs: of its corners, NULL: none. */
static float alpha_of_texture(const engine_texture *texture, const engine_texture_use *use, const float *const uvs[3])
{
	float mean[4], at[3][2];
	if (!uvs[0])
		return texture->mean[3];
	for (int k = 0; k < 3; k++)
		memcpy(at[k], uvs[k], sizeof at[k]);
	engine_texture_mean(texture, use, at, mean);
	return mean[3];
}

/* Mean alpha of a face's fan of triangles, alike by number: those of a face are of about one size. */
static float coverage(const painted *p, const engine_scene_material *m, size_t first, uint32_t count)
{
	const float *uvs = p->mesh->uvs ? p->mesh->uvs + 2 * first : NULL;
	const float *colors = p->mesh->colors ? p->mesh->colors + 4 * first : NULL;
	float sum = 0;
	for (uint32_t k = 1; k + 1 < count; k++) {
		float alpha = m->alpha_factor;
		if (m->alpha_texture.number)
			alpha *= alpha_of_texture(
			    &p->textures[m->alpha_texture.number - 1], &m->alpha_texture,
			    (const float *const[]){uvs, uvs ? uvs + 2 * k : NULL, uvs ? uvs + 2 * k + 2 : NULL});
		if (colors && colors[0] >= 0)
			alpha *= (colors[3] + colors[4 * k + 3] + colors[4 * k + 7]) / 3;
		sum += alpha;
	}
	return sum / (float)(count - 2);
}

static bool is_opaque(const void *context, uint32_t face, const uint32_t *corners)
{
	const painted *p = context;
	const engine_scene_material *m = &p->materials[p->mesh->face_materials[face]];
	return !(m->cutoff > 0) ||
	       coverage(p, m, (size_t)(corners - p->mesh->indices), p->mesh->face_counts[face]) >= m->cutoff;
}

/* Drops the faces whose material lets light through. */
static void drop_clear_faces(import_loader *loader, engine_scene_object *object)
{
	const painted p = {loader->scene->materials, loader->scene->textures, &object->mesh};
	import_note_many(loader, engine_mesh_keep_faces(&object->mesh, is_opaque, &p), object->name,
			 "faces that let light through (alpha below a half) are left out");
}

static bool clean(import_loader *loader, engine_scene_object *object, bool pair_triangles)
{
	char fault[256];
	engine_clean_report report;
	recentre(object);
	drop_clear_faces(loader, object);
	bool had_faces = object->mesh.face_count > 0;
	if (!engine_mesh_clean(&object->mesh, &report, fault, sizeof fault))
		return import_fail(loader, "object \"%.80s\": %s", object->name, fault);
	import_note_many(loader, report.degenerate_faces, object->name, "faces without area are dropped");
	import_note_many(loader, report.duplicate_faces, object->name,
			 "faces with the corners of another one are dropped");
	import_note_many(loader, report.too_large, object->name,
			 "faces that are not convex and have thousands of corners are left out");
	if (had_faces && object->mesh.face_count == 0)
		import_note(loader, object->name, "objects have no face with an area");
	if (pair_triangles)
		engine_mesh_pair_triangles(&object->mesh);
	for (uint32_t f = 0; f < object->mesh.face_count; f++) {
		if (loader->scene->materials[object->mesh.face_materials[f]].double_sided)
			object->double_sided = true;
	}
	return true;
}

void import_free_shape(import_shape *shape)
{
	if (!shape)
		return;
	free(shape->rest);
	free(shape->bind);
	free(shape->joints);
	free(shape->weights);
	free(shape->deltas);
	free(shape->nodes);
	free(shape->inverse);
	free(shape->matrices);
	free(shape);
}

void import_release_object(engine_scene_object *object)
{
	engine_mesh_free(&object->mesh);
	import_free_shape(object->shape);
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
static bool store_object(import_loader *loader, engine_scene_object *object)
{
	engine_scene *scene = loader->scene;
	if (object->mesh.face_count == 0) {
		import_release_object(object);
		return true;
	}
	if (!make_room(scene) || !import_take_name(&loader->names, object->name)) {
		import_release_object(object);
		return import_fail(loader, "out of memory for objects");
	}
	scene->objects[scene->object_count++] = *object;
	return true;
}

bool import_add_object(import_loader *loader, const import_object_def *def, engine_mesh *mesh)
{
	char *wish = import_copy_name(def->name, "object", loader->scene->object_count);
	engine_scene_object object = {.name = import_unique_name(&loader->names, wish),
				      .mesh = *mesh,
				      .scheme = def->scheme,
				      .levels = def->levels,
				      .node = def->node,
				      .deforms = def->shape != NULL,
				      .shape = def->shape,
				      .rounding = rounding_of(mesh, def->rounding)};
	memcpy(object.offset, def->offset, sizeof object.offset);
	loader->faces_seen += mesh->face_count;
	*mesh = (engine_mesh){0};
	if (!object.name)
		import_fail(loader, "out of memory for names");
	else if (clean(loader, &object, def->pair_triangles))
		return store_object(loader, &object);
	import_release_object(&object);
	return false;
}
