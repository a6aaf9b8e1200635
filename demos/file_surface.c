#include "file_surface.h"

#include <math.h>
#include <string.h>

static const float PI = 3.14159265f;

/* Of white texels; what materials of files get (import_material.c). */
static const float MOST_REFLECTED = 0.98f;

/* Where texture and colours both change: a side's pieces that each have the mean of one times the mean of the other. */
enum { PIECES = 4 };

bool file_surface_has_texture(const engine_scene_material *material)
{
	return material->rho_texture.number || material->radiance_texture.number;
}

void file_surface_corner(const engine_mesh *mesh, size_t corner, float uv[2], float color[3])
{
	for (size_t k = 0; k < 2; k++)
		uv[k] = mesh->uvs ? mesh->uvs[2 * corner + k] : ENGINE_NO_UV;
	for (size_t k = 0; k < 3; k++)
		color[k] = mesh->colors ? mesh->colors[4 * corner + k] : ENGINE_NO_COLOR;
}

void file_surface_blend(const float weights[3], const float *a, const float *b, const float *c, uint32_t size,
			float *out)
{
	for (uint32_t k = 0; k < size; k++)
		out[k] = weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k];
}

/* Rows from the side of the second and third corner to the first: row r has 2 (side - r) - 1, upright ones and those
 * between them in turn. */
void file_surface_piece(uint32_t side, uint32_t piece, float weights[3][3])
{
	uint32_t row = 0;
	while (piece >= 2 * (side - row) - 1)
		piece -= 2 * (side - row++) - 1;
	const uint32_t column = piece / 2, between = piece % 2;
	/* corners by their rows and columns, in units of 1 / side */
	const uint32_t upright[3][2] = {{row + 1, column}, {row, column}, {row, column + 1}};
	const uint32_t turned[3][2] = {{row, column + 1}, {row + 1, column + 1}, {row + 1, column}};
	for (int k = 0; k < 3; k++) {
		const uint32_t *at = between ? turned[k] : upright[k];
		weights[k][0] = (float)at[0] / (float)side;
		weights[k][2] = (float)at[1] / (float)side;
		weights[k][1] = (float)(side - at[0] - at[1]) / (float)side;
	}
}

static void texture_mean(const engine_scene *scene, const engine_texture_use *use, const float uvs[3][2], float mean[4])
{
	const engine_texture *texture = &scene->textures[use->number - 1];
	if (uvs[0][0] == ENGINE_NO_UV || uvs[1][0] == ENGINE_NO_UV || uvs[2][0] == ENGINE_NO_UV)
		memcpy(mean, texture->mean, sizeof texture->mean);
	else
		engine_texture_mean(texture, use, uvs, mean);
}

static void mean_color(const file_surface_triangle *t, float out[3])
{
	static const float thirds[3] = {1.0f / 3, 1.0f / 3, 1.0f / 3};
	file_surface_blend(thirds, t->colors[0], t->colors[1], t->colors[2], 3, out);
}

/* Of a material with a texture and a mesh with colours. */
static void product_mean(const engine_scene *scene, const file_surface_triangle *t, float out[3])
{
	memset(out, 0, 3 * sizeof *out);
	for (uint32_t piece = 0; piece < PIECES * PIECES; piece++) {
		file_surface_triangle part;
		float weights[3][3], texels[4], color[3];
		file_surface_piece(PIECES, piece, weights);
		for (int k = 0; k < 3; k++) {
			file_surface_blend(weights[k], t->uvs[0], t->uvs[1], t->uvs[2], 2, part.uvs[k]);
			file_surface_blend(weights[k], t->colors[0], t->colors[1], t->colors[2], 3, part.colors[k]);
		}
		texture_mean(scene, &t->material->rho_texture, part.uvs, texels);
		mean_color(&part, color);
		for (int c = 0; c < 3; c++)
			out[c] += texels[c] * color[c] / (PIECES * PIECES);
	}
}

static void mean_rho(const engine_scene *scene, const file_surface_triangle *t, float rho[3])
{
	const engine_scene_material *m = t->material;
	const bool textured = m->rho_texture.number, colored = t->colors[0][0] >= 0;
	float mean[4];
	memcpy(rho, m->rho, sizeof m->rho);
	if (!textured && !colored)
		return;
	if (textured && colored && t->uvs[0][0] != ENGINE_NO_UV) {
		product_mean(scene, t, mean);
	} else {
		float color[3] = {1, 1, 1};
		for (int c = 0; c < 4; c++)
			mean[c] = 1;
		if (textured)
			texture_mean(scene, &m->rho_texture, t->uvs, mean);
		if (colored)
			mean_color(t, color);
		for (int c = 0; c < 3; c++)
			mean[c] *= color[c];
	}
	for (int c = 0; c < 3; c++)
		rho[c] = fmaxf(0, fminf(m->rho_factor[c] * mean[c], MOST_REFLECTED));
}

gi_material file_surface_mean(const engine_scene *scene, const file_surface_triangle *t)
{
	const engine_scene_material *m = t->material;
	gi_material out;
	float mean[4];
	mean_rho(scene, t, out.rho);
	for (int c = 0; c < 3; c++)
		out.exitance[c] = PI * m->radiance[c];
	if (!m->radiance_texture.number)
		return out;
	texture_mean(scene, &m->radiance_texture, t->uvs, mean);
	for (int c = 0; c < 3; c++)
		out.exitance[c] = fmaxf(0, fminf(PI * m->radiance_factor[c] * mean[c], 9e11f));
	return out;
}
