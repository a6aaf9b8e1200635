#include "file_cage.h"

#include "file_surface.h"
#include "file_textures.h"
#include "nearest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Pieces of a triangle, a side; of one that would take more, larger ones. */
enum { MOST_PIECES = 32 };

typedef struct leaf_sum {
	double rho[3], exitance[3], area;
} leaf_sum;

typedef struct cage_leaves {
	engine_triangle *halves; /* of all leaves: their triangles a b c and a c d */
	uint32_t *leaf;          /* of each half */
	uint32_t half_count, count;
	float spacing; /* about half a leaf, metres */
	leaf_sum *sums;
	engine_nearest *nearest;
} cage_leaves;

/* ---- where leaves are ---- */

static void place_of(const engine_mesh *cage, size_t first, uint32_t count, const float uv[2], float out[3])
{
	size_t corners[3] = {first, first, first};
	float weights[3] = {1, 0, 0};
	file_textures_locate(cage, first, count, uv, corners, weights);
	const float *p = cage->positions;
	const uint32_t *v = cage->indices;
	file_surface_blend(weights, p + 3 * (size_t)v[corners[0]], p + 3 * (size_t)v[corners[1]],
			   p + 3 * (size_t)v[corners[2]], 3, out);
}

static double normal_of(const float a[3], const float b[3], const float c[3], float normal[3])
{
	double sum = 0;
	for (int k = 0; k < 3; k++) {
		const int i = (k + 1) % 3, j = (k + 2) % 3;
		const double n =
		    ((double)b[i] - a[i]) * ((double)c[j] - a[j]) - ((double)b[j] - a[j]) * ((double)c[i] - a[i]);
		normal[k] = (float)n;
		sum += n * n;
	}
	return 0.5 * sqrt(sum);
}

static void add_half(cage_leaves *l, uint32_t leaf, const float a[3], const float b[3], const float c[3])
{
	engine_triangle *to = &l->halves[l->half_count];
	l->leaf[l->half_count++] = leaf;
	memcpy(to->corners[0], a, sizeof to->corners[0]);
	memcpy(to->corners[1], b, sizeof to->corners[1]);
	memcpy(to->corners[2], c, sizeof to->corners[2]);
}

static void place_leaves(cage_leaves *l, const engine_mesh *cage, const size_t *first, const gi_leaf_uvs *leaves)
{
	double area = 0;
	float corners[4][3], normal[3];
	for (uint32_t k = 0; k < l->count; k++) {
		const uint32_t face = leaves[k].face;
		for (int c = 0; c < 4; c++)
			place_of(cage, first[face], cage->face_counts[face], leaves[k].uvs[c], corners[c]);
		const double second = normal_of(corners[0], corners[2], corners[3], normal);
		area += normal_of(corners[0], corners[1], corners[2], normal) + second;
		add_half(l, k, corners[0], corners[1], corners[2]);
		if (second > 0)
			add_half(l, k, corners[0], corners[2], corners[3]);
	}
	l->spacing = (float)(0.5 * sqrt(area / fmax(l->count, 1)));
}

static gi_result make_leaves(cage_leaves *l, const engine_mesh *cage, gi_context *gi, gi_object object)
{
	gi_leaf_uvs *leaves;
	gi_result result = file_textures_leaves(gi, object, &leaves, &l->count);
	size_t *first = file_textures_first_corners(cage);
	l->halves = malloc(sizeof *l->halves * (2 * (size_t)l->count + 1));
	l->leaf = malloc(sizeof *l->leaf * (2 * (size_t)l->count + 1));
	l->sums = calloc((size_t)l->count + 1, sizeof *l->sums);
	if (!result && l->halves && l->leaf && l->sums && first) {
		place_leaves(l, cage, first, leaves);
		l->nearest = engine_nearest_make(l->halves, l->half_count);
	}
	free(leaves);
	free(first);
	return result || l->nearest ? result : GI_ERROR_OUT_OF_MEMORY;
}

static void free_leaves(cage_leaves *l)
{
	engine_nearest_free(l->nearest);
	free(l->halves);
	free(l->leaf);
	free(l->sums);
}

/* ---- what lies next to them ---- */

/* A triangle of a face's fan. */
typedef struct part {
	file_surface_triangle surface;
	float places[3][3];
} part;

static part part_of(const engine_scene *scene, const engine_mesh *full, uint32_t face, const size_t corners[3])
{
	part p = {.surface.material = &scene->materials[full->face_materials[face]]};
	for (int k = 0; k < 3; k++) {
		file_surface_corner(full, corners[k], p.surface.uvs[k], p.surface.colors[k]);
		memcpy(p.places[k], full->positions + 3 * (size_t)full->indices[corners[k]], sizeof p.places[k]);
	}
	return p;
}

static part piece_of(const part *whole, uint32_t side, uint32_t piece)
{
	part p = {.surface.material = whole->surface.material};
	const file_surface_triangle *s = &whole->surface;
	float weights[3][3];
	file_surface_piece(side, piece, weights);
	for (int k = 0; k < 3; k++) {
		file_surface_blend(weights[k], s->uvs[0], s->uvs[1], s->uvs[2], 2, p.surface.uvs[k]);
		file_surface_blend(weights[k], s->colors[0], s->colors[1], s->colors[2], 3, p.surface.colors[k]);
		file_surface_blend(weights[k], whole->places[0], whole->places[1], whole->places[2], 3, p.places[k]);
		if (s->uvs[0][0] == ENGINE_NO_UV) /* not what weights make of it */
			p.surface.uvs[k][0] = ENGINE_NO_UV;
	}
	return p;
}

static double longest_edge(const part *p)
{
	double longest = 0;
	for (int k = 0; k < 3; k++) {
		double length = 0;
		for (int c = 0; c < 3; c++)
			length += pow((double)p->places[k][c] - (double)p->places[(k + 1) % 3][c], 2);
		longest = fmax(longest, length);
	}
	return sqrt(longest);
}

static void count_for(cage_leaves *l, const float middle[3], const float normal[3], double area, const gi_material *m)
{
	leaf_sum *sum = &l->sums[l->leaf[engine_nearest_find(l->nearest, middle, normal)]];
	for (int c = 0; c < 3; c++) {
		sum->rho[c] += area * (double)m->rho[c];
		sum->exitance[c] += area * (double)m->exitance[c];
	}
	sum->area += area;
}

static void count_part(const engine_scene *scene, cage_leaves *l, const part *whole, bool both_sides)
{
	static const float thirds[3] = {1.0f / 3, 1.0f / 3, 1.0f / 3};
	const uint32_t side = (uint32_t)fmin(ceil(longest_edge(whole) / fmax(l->spacing, 1e-30f) + 1e-6), MOST_PIECES);
	for (uint32_t piece = 0; piece < side * side; piece++) {
		const part p = side > 1 ? piece_of(whole, side, piece) : *whole;
		float middle[3], normal[3];
		const double area = normal_of(p.places[0], p.places[1], p.places[2], normal);
		const gi_material m = file_surface_mean(scene, &p.surface);
		file_surface_blend(thirds, p.places[0], p.places[1], p.places[2], 3, middle);
		count_for(l, middle, normal, area, &m);
		for (int c = 0; c < 3; c++)
			normal[c] = -normal[c];
		if (both_sides)
			count_for(l, middle, normal, area, &m);
	}
}

/* Calls count_part() of all; with `at`, writes which triangles there are instead. */
static uint32_t count_all(const engine_scene *scene, const engine_mesh *full, cage_leaves *l, bool both_sides, part *at)
{
	uint32_t count = 0;
	size_t first = 0;
	for (uint32_t f = 0; f < full->face_count; first += full->face_counts[f++])
		for (uint32_t k = 1; k + 1 < full->face_counts[f]; k++, count++) {
			const part p = part_of(scene, full, f, (const size_t[3]){first, first + k, first + k + 1});
			if (at)
				at[count] = p;
			else
				count_part(scene, l, &p, both_sides);
		}
	return count;
}

/* Leaves that nothing is next to: finer than the mesh, or across a crevice that the cage has not. */
static gi_result fill_empty(const engine_scene *scene, const engine_mesh *full, cage_leaves *l)
{
	static const float thirds[3] = {1.0f / 3, 1.0f / 3, 1.0f / 3};
	const size_t most = (size_t)full->index_count + 1;
	uint32_t empty = 0;
	for (uint32_t k = 0; k < l->count; k++)
		empty += !(l->sums[k].area > 0);
	if (!empty)
		return GI_OK;
	part *parts = malloc(sizeof *parts * most);
	engine_triangle *triangles = malloc(sizeof *triangles * most);
	const uint32_t count = parts ? count_all(scene, full, l, false, parts) : 0;
	for (uint32_t k = 0; triangles && k < count; k++)
		memcpy(triangles[k].corners, parts[k].places, sizeof parts[k].places);
	engine_nearest *nearest = triangles ? engine_nearest_make(triangles, count) : NULL;
	for (uint32_t h = 0; nearest && h < l->half_count; h++) {
		const engine_triangle *half = &l->halves[h];
		float middle[3], normal[3];
		if (l->sums[l->leaf[h]].area > 0)
			continue;
		normal_of(half->corners[0], half->corners[1], half->corners[2], normal);
		file_surface_blend(thirds, half->corners[0], half->corners[1], half->corners[2], 3, middle);
		const gi_material m =
		    file_surface_mean(scene, &parts[engine_nearest_find(nearest, middle, normal)].surface);
		leaf_sum *sum = &l->sums[l->leaf[h]];
		for (int c = 0; c < 3; c++) {
			sum->rho[c] = (double)m.rho[c];
			sum->exitance[c] = (double)m.exitance[c];
		}
		sum->area = 1;
	}
	const bool filled = nearest != NULL;
	engine_nearest_free(nearest);
	free(triangles);
	free(parts);
	return filled ? GI_OK : GI_ERROR_OUT_OF_MEMORY;
}

/* What a mirror or glass leaves for rho. */
static float most_of(const gi_specular *specular, int channel)
{
	return fmaxf(0, 0.98f - specular->reflectance[channel] - specular->transmittance[channel]);
}

static gi_result set_leaves(const cage_leaves *l, gi_context *gi, gi_object object)
{
	gi_result result = GI_OK;
	gi_material *values = calloc((size_t)l->count + 1, sizeof *values);
	if (!values)
		return GI_ERROR_OUT_OF_MEMORY;
	for (uint32_t k = 0; !result && k < l->count; k++) {
		const leaf_sum *sum = &l->sums[k];
		gi_specular specular = {0};
		result = gi_get_specular(gi, object, k, &specular);
		for (int c = 0; c < 3; c++) {
			values[k].rho[c] = fminf((float)(sum->rho[c] / sum->area), most_of(&specular, c));
			values[k].exitance[c] = (float)(sum->exitance[c] / sum->area);
		}
	}
	if (!result)
		result = gi_set_leaf_materials(gi, object, 0, l->count, values);
	free(values);
	return result;
}

gi_result file_cage_set(const engine_scene *scene, const engine_mesh *full, const engine_mesh *cage, bool both_sides,
			gi_context *gi, gi_object object)
{
	cage_leaves l = {0};
	gi_result result = make_leaves(&l, cage, gi, object);
	if (!result) {
		count_all(scene, full, &l, both_sides, NULL);
		result = fill_empty(scene, full, &l);
	}
	if (!result)
		result = set_leaves(&l, gi, object);
	free_leaves(&l);
	return result;
}
