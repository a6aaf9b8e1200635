#include "file_textures.h"

#include "file_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A face of more than three corners is looked at in so many pieces a side of either half of a leaf: its colours are
 * linear in parts. */
enum { PIECES = 4 };

bool file_textures_are_used(const engine_scene *scene, const engine_mesh *mesh)
{
	bool used = mesh->colors != NULL;
	for (uint32_t f = 0; mesh->uvs && f < mesh->face_count && !used; f++)
		used = file_surface_has_texture(&scene->materials[mesh->face_materials[f]]);
	return used;
}

size_t *file_textures_first_corners(const engine_mesh *mesh)
{
	size_t *first = malloc(sizeof *first * ((size_t)mesh->face_count + 1)), corner = 0;
	for (uint32_t f = 0; first && f < mesh->face_count; corner += mesh->face_counts[f++])
		first[f] = corner;
	return first;
}

/* ---- coordinates ---- */

static const float *position_of(const engine_mesh *mesh, size_t corner)
{
	return mesh->positions + 3 * (size_t)mesh->indices[corner];
}

/* Two axes across the face's normal, as long as its longest edge from the first corner is short. */
static void axes_of(const engine_mesh *mesh, size_t first, uint32_t count, double u[3], double v[3])
{
	double normal[3], longest = 0;
	engine_mesh_face_normal(mesh, mesh->indices + first, count, normal);
	const double size = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
	for (uint32_t k = 1; k < count; k++) {
		const float *a = position_of(mesh, first), *b = position_of(mesh, first + k);
		double along[3], length = 0;
		for (int c = 0; c < 3; c++) {
			along[c] = (double)b[c] - (double)a[c];
			length += along[c] * along[c];
		}
		if (!(length > longest))
			continue;
		longest = length;
		for (int c = 0; c < 3; c++)
			u[c] = along[c] / length;
	}
	for (int c = 0; c < 3; c++)
		v[c] =
		    size > 0 ? (normal[(c + 1) % 3] * u[(c + 2) % 3] - normal[(c + 2) % 3] * u[(c + 1) % 3]) / size : 0;
}

static void lay_flat(engine_mesh *mesh, size_t first, uint32_t count)
{
	double u[3] = {0}, v[3] = {0};
	axes_of(mesh, first, count, u, v);
	for (uint32_t k = 0; k < count; k++) {
		const float *a = position_of(mesh, first), *b = position_of(mesh, first + k);
		double at[2] = {0, 0};
		for (int c = 0; c < 3; c++) {
			at[0] += u[c] * ((double)b[c] - (double)a[c]);
			at[1] += v[c] * ((double)b[c] - (double)a[c]);
		}
		mesh->uvs[2 * (first + k)] = (float)at[0];
		mesh->uvs[2 * (first + k) + 1] = (float)at[1];
	}
}

bool file_textures_prepare(const engine_scene *scene, engine_mesh *mesh, bool all)
{
	if (!all && !mesh->colors)
		return true; /* textures alone know their coordinates */
	if (!mesh->uvs)
		mesh->uvs = malloc(sizeof *mesh->uvs * 2 * ((size_t)mesh->index_count + 1));
	if (!mesh->uvs)
		return false;
	size_t first = 0;
	for (uint32_t f = 0; f < mesh->face_count; first += mesh->face_counts[f++])
		if (all || !file_surface_has_texture(&scene->materials[mesh->face_materials[f]]))
			lay_flat(mesh, first, mesh->face_counts[f]);
	return true;
}

/* Twice the signed area. */
static double area_of(const float *a, const float *b, const float *c)
{
	return ((double)b[0] - a[0]) * ((double)c[1] - a[1]) - ((double)c[0] - a[0]) * ((double)b[1] - a[1]);
}

/* In the triangle of the face's fan that the place is in, or least outside of. */
bool file_textures_locate(const engine_mesh *mesh, size_t first, uint32_t count, const float uv[2], size_t corners[3],
			  float weights[3])
{
	double best = -HUGE_VAL;
	for (uint32_t k = 1; k + 1 < count; k++) {
		const size_t at[3] = {first, first + k, first + k + 1};
		const float *a = mesh->uvs + 2 * at[0], *b = mesh->uvs + 2 * at[1], *c = mesh->uvs + 2 * at[2];
		const double area = area_of(a, b, c);
		const double w[3] = {area_of(uv, b, c) / area, area_of(a, uv, c) / area, area_of(a, b, uv) / area};
		const double least = fmin(w[0], fmin(w[1], w[2]));
		if (!(least > best) || !isfinite(least))
			continue;
		best = least;
		memcpy(corners, at, sizeof at);
		for (int i = 0; i < 3; i++)
			weights[i] = (float)w[i];
	}
	return best > -HUGE_VAL;
}

/* ---- leaves ---- */

typedef struct surface {
	const engine_scene *scene;
	const engine_mesh *mesh;
	const uint32_t *face_materials;
	const size_t *first; /* corner of each face */
} surface;

static void color_at(const surface *s, uint32_t face, const float uv[2], float color[3])
{
	const uint32_t count = s->mesh->face_counts[face];
	const float *colors = s->mesh->colors + 4 * s->first[face];
	size_t corners[3];
	float weights[3];
	memset(color, 0, 3 * sizeof *color);
	if (colors[0] < 0) { /* none */
		color[0] = ENGINE_NO_COLOR;
	} else if (file_textures_locate(s->mesh, s->first[face], count, uv, corners, weights)) {
		const float *all = s->mesh->colors;
		file_surface_blend(weights, all + 4 * corners[0], all + 4 * corners[1], all + 4 * corners[2], 3, color);
		for (int c = 0; c < 3; c++)
			color[c] = fmaxf(color[c], 0);
	} else {
		for (uint32_t k = 0; k < 3 * count; k++)
			color[k % 3] += colors[4 * (k / 3) + k % 3] / (float)count;
	}
}

static void add_part(const surface *s, uint32_t face, const float uvs[3][2], double area, gi_material *sum)
{
	file_surface_triangle t = {.material = &s->scene->materials[s->face_materials[face]],
				   .colors = {{ENGINE_NO_COLOR}}};
	memcpy(t.uvs, uvs, sizeof t.uvs);
	for (int k = 0; s->mesh->colors && k < 3; k++)
		color_at(s, face, uvs[k], t.colors[k]);
	const gi_material part = file_surface_mean(s->scene, &t);
	for (int c = 0; c < 3; c++) {
		sum->rho[c] += (float)area * part.rho[c];
		sum->exitance[c] += (float)area * part.exitance[c];
	}
}

/* One of a leaf's two triangles; area: its share of the leaf. */
static void add_half(const surface *s, uint32_t face, const float uvs[3][2], double area, gi_material *sum)
{
	const uint32_t side = s->mesh->colors && s->mesh->face_counts[face] > 3 ? PIECES : 1;
	for (uint32_t piece = 0; piece < side * side; piece++) {
		float weights[3][3], part[3][2];
		file_surface_piece(side, piece, weights);
		for (int k = 0; k < 3; k++)
			file_surface_blend(weights[k], uvs[0], uvs[1], uvs[2], 2, part[k]);
		add_part(s, face, part, area / (side * side), sum);
	}
}

/* Over both triangles of a leaf, by their areas in the texture. */
static gi_material leaf_mean(const surface *s, const gi_leaf_uvs *leaf)
{
	const float(*c)[2] = leaf->uvs;
	const float halves[2][3][2] = {{{c[0][0], c[0][1]}, {c[1][0], c[1][1]}, {c[2][0], c[2][1]}},
				       {{c[0][0], c[0][1]}, {c[2][0], c[2][1]}, {c[3][0], c[3][1]}}};
	const double first = fabs(area_of(c[0], c[1], c[2])), second = fabs(area_of(c[0], c[2], c[3]));
	const double share = second > 0 ? first / (first + second) : 1;
	gi_material sum = {0};
	if (share > 0)
		add_half(s, leaf->face, halves[0], share, &sum);
	if (share < 1)
		add_half(s, leaf->face, halves[1], 1 - share, &sum);
	return sum;
}

gi_result file_textures_leaves(gi_context *gi, gi_object object, gi_leaf_uvs **leaves, uint32_t *count)
{
	gi_result result = gi_get_leaf_uvs(gi, object, NULL, 0, count);
	*leaves = malloc(sizeof **leaves * ((size_t)*count + 1));
	if (!result)
		result = *leaves ? gi_get_leaf_uvs(gi, object, *leaves, *count, count) : GI_ERROR_OUT_OF_MEMORY;
	return result;
}

gi_result file_textures_set(const engine_scene *scene, const engine_mesh *mesh, const uint32_t *face_materials,
			    gi_context *gi, gi_object object)
{
	gi_leaf_uvs *leaves;
	uint32_t count;
	gi_result result = file_textures_leaves(gi, object, &leaves, &count);
	gi_material *values = malloc(sizeof *values * ((size_t)count + 1));
	size_t *first = file_textures_first_corners(mesh);
	const surface s = {scene, mesh, face_materials, first};
	if (!result && (!values || !first))
		result = GI_ERROR_OUT_OF_MEMORY;
	for (uint32_t k = 0; !result && k < count; k++)
		values[k] = leaf_mean(&s, &leaves[k]);
	if (!result)
		result = gi_set_leaf_materials(gi, object, 0, count, values);
	free(first);
	free(leaves);
	free(values);
	return result;
}
