#include "file_shown.h"

#include "file_surface.h"
#include "texture_gl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float PI = 3.14159265f;

/* ---- which materials ---- */

/* Does every corner of a face have a place in the texture? */
static bool has_place(const engine_mesh *mesh, size_t first, uint32_t count)
{
	bool known = mesh->uvs != NULL;
	for (size_t k = 2 * first; known && k < 2 * (first + count); k++)
		known = fabsf(mesh->uvs[k]) < 1e6f;
	return known;
}

/* Are there colours that the library, which knows the texture alone, would not show? */
static bool is_tinted(const engine_mesh *mesh, size_t first, uint32_t count)
{
	bool tinted = false;
	for (size_t k = 4 * first; mesh->colors && k < 4 * (first + count) && !tinted; k++)
		tinted = k % 4 < 3 && mesh->colors[4 * first] >= 0 && mesh->colors[k] != 1;
	return tinted;
}

static bool is_shown(const engine_scene *scene, const engine_mesh *mesh, uint32_t material, size_t first,
		     uint32_t count)
{
	return file_surface_has_texture(&scene->materials[material]) && has_place(mesh, first, count) &&
	       !is_tinted(mesh, first, count);
}

bool file_shown_is_used(const engine_scene *scene, const engine_mesh *mesh)
{
	bool used = false;
	size_t first = 0;
	for (uint32_t f = 0; mesh->uvs && f < mesh->face_count && !used; first += mesh->face_counts[f++])
		used = is_shown(scene, mesh, mesh->face_materials[f], first, mesh->face_counts[f]);
	return used;
}

/* The number of a textured material in the definition; `numbers`: of the scene's, from 1, those that have one. */
static uint32_t number_of(file_shown *out, uint32_t *numbers, uint32_t material)
{
	if (!numbers[material]) {
		out->sources[out->count++] = material;
		numbers[material] = out->count;
	}
	return out->first + numbers[material] - 1;
}

static void add_triangle(file_shown *out, const engine_mesh *mesh, size_t first, uint32_t k, uint32_t triangle,
			 uint32_t number)
{
	const size_t corners[3] = {first, first + k - 1, first + k};
	out->numbers[triangle] = number;
	for (size_t i = 0; i < 3 && mesh->uvs; i++)
		memcpy(out->uvs + 2 * (3 * (size_t)triangle + i), mesh->uvs + 2 * corners[i], 2 * sizeof *out->uvs);
}

static void fill(const engine_scene *scene, const engine_mesh *mesh, const uint32_t *face_materials,
		 const uint32_t *plain, uint32_t *numbers, file_shown *out)
{
	size_t first = 0;
	uint32_t triangle = 0;
	for (uint32_t f = 0; f < mesh->face_count; first += mesh->face_counts[f++]) {
		const uint32_t material = face_materials[f], count = mesh->face_counts[f];
		const bool shown = is_shown(scene, mesh, material, first, count);
		const uint32_t number = shown ? number_of(out, numbers, material) : plain ? plain[f] : 0;
		if (plain)
			out->numbers[f] = number;
		for (uint32_t k = 2; k < count && !plain; k++)
			add_triangle(out, mesh, first, k, triangle++, number);
	}
}

bool file_shown_make(const engine_scene *scene, const engine_mesh *mesh, const uint32_t *face_materials,
		     const uint32_t *plain, uint32_t first, file_shown *out)
{
	const size_t triangles = (size_t)mesh->index_count - 2 * (size_t)mesh->face_count;
	const size_t faces = plain ? mesh->face_count : triangles;
	uint32_t *numbers = calloc((size_t)scene->material_count + 1, sizeof *numbers);
	*out = (file_shown){.numbers = malloc(sizeof *out->numbers * (faces + 1)),
			    .sources = malloc(sizeof *out->sources * ((size_t)scene->material_count + 1)),
			    .uvs = plain ? NULL : calloc(6 * triangles + 1, sizeof *out->uvs),
			    .first = first};
	const bool enough = numbers && out->numbers && out->sources && (plain || out->uvs);
	if (enough)
		fill(scene, mesh, face_materials, plain, numbers, out);
	free(numbers);
	return enough;
}

void file_shown_free(file_shown *shown)
{
	free(shown->numbers);
	free(shown->sources);
	free(shown->uvs);
	*shown = (file_shown){.numbers = NULL};
}

/* ---- OpenGL ---- */

static uint32_t upload(const engine_scene *scene, file_uploads *u, uint32_t number)
{
	uint32_t *name = &u->textures[number - 1];
	if (!*name)
		*name = engine_texture_upload(&scene->textures[number - 1]);
	return *name;
}

static uint32_t sampler_of(file_uploads *u, const engine_texture_use *use)
{
	uint32_t *name = &u->samplers[use->squares][use->wrap[0]][use->wrap[1]];
	if (!*name)
		*name = engine_texture_sampler(use);
	return *name;
}

static gi_textures textures_of(const engine_scene *scene, const engine_scene_material *m, file_uploads *u)
{
	gi_textures t = gi_textures_default();
	if (m->rho_texture.number) {
		t.base_color = upload(scene, u, m->rho_texture.number);
		t.base_color_sampler = sampler_of(u, &m->rho_texture);
		for (int c = 0; c < 3; c++)
			t.base_color_factor[c] = fmaxf(0, fminf(m->rho_factor[c], 1));
		memcpy(t.base_color_transform, m->rho_texture.transform, sizeof t.base_color_transform);
		if (m->alpha_texture.number == m->rho_texture.number)
			t.alpha_cutoff = fminf(m->cutoff / fmaxf(m->alpha_factor, 1e-9f), 1e9f);
	}
	if (m->radiance_texture.number) {
		t.emissive = upload(scene, u, m->radiance_texture.number);
		t.emissive_sampler = sampler_of(u, &m->radiance_texture);
		for (int c = 0; c < 3; c++)
			t.emissive_factor[c] = fmaxf(0, fminf(PI * m->radiance_factor[c], 9e11f));
		memcpy(t.emissive_transform, m->radiance_texture.transform, sizeof t.emissive_transform);
	}
	return t;
}

gi_result file_shown_set(const engine_scene *scene, const file_shown *shown, file_uploads *u, gi_context *gi,
			 gi_object object)
{
	gi_result result = GI_OK;
	if (shown->count && !u->textures)
		u->textures = calloc(scene->texture_count, sizeof *u->textures);
	if (shown->count && !u->textures)
		return GI_ERROR_OUT_OF_MEMORY;
	for (uint32_t k = 0; !result && k < shown->count; k++) {
		const gi_textures t = textures_of(scene, &scene->materials[shown->sources[k]], u);
		result = gi_set_textures(gi, object, shown->first + k, &t);
	}
	return result;
}

void file_uploads_free(file_uploads *uploads)
{
	free(uploads->textures);
	*uploads = (file_uploads){.textures = NULL};
}
