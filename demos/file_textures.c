#include "file_textures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float PI = 3.14159265f;

/* Of white texels; what materials of files get (import_material.c). */
static const float MOST_REFLECTED = 0.98f;

bool file_textures_are_used(const engine_scene *scene, const engine_mesh *mesh)
{
	bool used = false;
	for (uint32_t f = 0; mesh->uvs && f < mesh->face_count && !used; f++) {
		const engine_scene_material *m = &scene->materials[mesh->face_materials[f]];
		used = m->rho_texture.number || m->radiance_texture.number;
	}
	return used;
}

static float triangle_area(const float t[3][2])
{
	return fabsf((t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) - (t[2][0] - t[0][0]) * (t[1][1] - t[0][1]));
}

/* Over both triangles of a leaf, by their areas in the texture. */
static void leaf_mean(const engine_scene *scene, const engine_texture_use *use, const gi_leaf_uvs *leaf, float out[4])
{
	const float(*c)[2] = leaf->uvs;
	const float halves[2][3][2] = {{{c[0][0], c[0][1]}, {c[1][0], c[1][1]}, {c[2][0], c[2][1]}},
				       {{c[0][0], c[0][1]}, {c[2][0], c[2][1]}, {c[3][0], c[3][1]}}};
	const float first = triangle_area(halves[0]), second = triangle_area(halves[1]);
	float other[4];
	engine_texture_mean(&scene->textures[use->number - 1], use, halves[0], out);
	if (!(second > 0))
		return;
	engine_texture_mean(&scene->textures[use->number - 1], use, halves[1], other);
	for (int k = 0; k < 4; k++)
		out[k] = (first * out[k] + second * other[k]) / (first + second);
}

static gi_material material_of(const engine_scene *scene, const engine_scene_material *m, const gi_leaf_uvs *leaf)
{
	gi_material out;
	float mean[4];
	memcpy(out.rho, m->rho, sizeof out.rho);
	for (int c = 0; c < 3; c++)
		out.exitance[c] = PI * m->radiance[c];
	if (m->rho_texture.number) {
		leaf_mean(scene, &m->rho_texture, leaf, mean);
		for (int c = 0; c < 3; c++)
			out.rho[c] = fmaxf(0, fminf(m->rho_factor[c] * mean[c], MOST_REFLECTED));
	}
	if (m->radiance_texture.number) {
		leaf_mean(scene, &m->radiance_texture, leaf, mean);
		for (int c = 0; c < 3; c++)
			out.exitance[c] = fmaxf(0, fminf(PI * m->radiance_factor[c] * mean[c], 9e11f));
	}
	return out;
}

gi_result file_textures_set(const engine_scene *scene, const uint32_t *face_materials, gi_context *gi, gi_object object)
{
	uint32_t count;
	gi_result result = gi_get_leaf_uvs(gi, object, NULL, 0, &count);
	gi_leaf_uvs *leaves = malloc(sizeof *leaves * ((size_t)count + 1));
	gi_material *values = malloc(sizeof *values * ((size_t)count + 1));
	if (!result && (!leaves || !values))
		result = GI_ERROR_OUT_OF_MEMORY;
	if (!result)
		result = gi_get_leaf_uvs(gi, object, leaves, count, &count);
	for (uint32_t k = 0; !result && k < count; k++)
		values[k] = material_of(scene, &scene->materials[face_materials[leaves[k].face]], &leaves[k]);
	if (!result)
		result = gi_set_leaf_materials(gi, object, 0, count, values);
	free(leaves);
	free(values);
	return result;
}
