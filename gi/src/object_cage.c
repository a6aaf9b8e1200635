/* The cage of a definition: as the caller has it, or with a second side; how fine it is to be refined. */
#include "object_build.h"

#include "faces.h"
#include "host_memory.h"

#include <math.h>
#include <string.h>

void object_cage_free(object_cage *own)
{
	gi_free(own->positions);
	gi_free(own->face_counts);
	gi_free(own->indices);
	gi_free(own->face_materials);
	gi_free(own->crease_vertices);
	gi_free(own->crease_sharpness);
	gi_free(own->uvs);
}

bool object_make_two_sided(const gi_object_def *def, gi_refine_cage *cage, object_cage *own)
{
	const uint32_t n = def->vertex_count, f = def->face_count, i = def->index_count, c = def->crease_count;
	own->positions = gi_malloc(sizeof(float) * 6 * n);
	own->face_counts = gi_malloc(sizeof(uint32_t) * 2 * f);
	own->indices = gi_malloc(sizeof(uint32_t) * 2 * i);
	own->face_materials = gi_calloc(2 * (size_t)f, sizeof(uint32_t));
	own->crease_vertices = gi_malloc(sizeof(uint32_t) * 4 * (c + 1));
	own->crease_sharpness = gi_malloc(sizeof(float) * 2 * (c + 1));
	own->uvs = cage->uvs ? gi_malloc(sizeof(float) * 4 * i) : NULL;
	if (!own->positions || !own->face_counts || !own->indices || !own->face_materials || !own->crease_vertices ||
	    !own->crease_sharpness || (cage->uvs && !own->uvs))
		return false;
	memcpy(own->positions, def->positions, sizeof(float) * 3 * n);
	memcpy(own->positions + 3 * n, def->positions, sizeof(float) * 3 * n);
	memcpy(own->indices, def->indices, sizeof(uint32_t) * i);
	if (own->uvs)
		memcpy(own->uvs, cage->uvs, sizeof(float) * 2 * i);
	for (uint32_t face = 0, first = 0; face < f; face++) {
		const uint32_t corners = gi_corner_count(def->face_counts, face);
		own->face_counts[face] = own->face_counts[f + face] = corners;
		if (def->face_materials)
			own->face_materials[face] = own->face_materials[f + face] = def->face_materials[face];
		for (uint32_t k = 0; k < corners; k++) {
			const uint32_t from = first + corners - 1 - k;
			own->indices[i + first + k] = n + def->indices[from];
			if (own->uvs)
				memcpy(own->uvs + 2 * ((size_t)i + first + k), cage->uvs + 2 * (size_t)from,
				       2 * sizeof(float));
		}
		first += corners;
	}
	for (uint32_t k = 0; k < 2 * c; k++) {
		own->crease_vertices[k] = def->crease_vertices[k];
		own->crease_vertices[2 * c + k] = n + def->crease_vertices[k];
	}
	for (uint32_t k = 0; k < c; k++)
		own->crease_sharpness[k] = own->crease_sharpness[c + k] = def->crease_sharpness[k];
	cage->positions = own->positions;
	cage->face_counts = own->face_counts;
	cage->indices = own->indices;
	cage->face_materials = own->face_materials;
	cage->crease_vertices = own->crease_vertices;
	cage->crease_sharpness = own->crease_sharpness;
	cage->uvs = own->uvs;
	cage->vertex_count = 2 * n;
	cage->face_count = 2 * f;
	cage->index_count = 2 * i;
	cage->crease_count = 2 * c;
	return true;
}

gi_refine_cage object_cage_of(const gi_object_def *def)
{
	static const gi_refine_scheme schemes[] = {GI_REFINE_BILINEAR, GI_REFINE_CATMULL_CLARK, GI_REFINE_LOOP};
	gi_refine_cage cage = {
	    .positions = def->positions,
	    .face_counts = def->face_counts,
	    .indices = def->indices,
	    .face_materials = def->face_materials,
	    .crease_vertices = def->crease_vertices,
	    .crease_sharpness = def->crease_sharpness,
	    .vertex_count = def->vertex_count,
	    .face_count = def->face_count,
	    .index_count = def->index_count,
	    .crease_count = def->crease_count,
	    .scheme = schemes[def->scheme],
	    .boundary = def->boundary == GI_BOUNDARY_EDGE_ONLY ? GI_REFINE_BOUNDARY_EDGE_ONLY
							       : GI_REFINE_BOUNDARY_EDGE_AND_CORNER,
	    .stencils = def->deforms,
	    .numbered = def->uvs || def->leaf_materials,
	    .uvs = def->scheme == GI_SCHEME_BILINEAR ? NULL : def->uvs,
	};
	memcpy(cage.scale, def->scale, sizeof cage.scale);
	return cage;
}

/* Mean edge of the base faces: the side of a square of their mean area, fan triangles from the first corner. */
static double mean_edge(const gi_object_def *def)
{
	double area = 0;
	for (uint32_t face = 0, first = 0; face < def->face_count; face++) {
		const uint32_t corners = gi_corner_count(def->face_counts, face);
		for (uint32_t k = 1; k + 1 < corners; k++) {
			float p[3][3];
			const uint32_t v[3] = {def->indices[first], def->indices[first + k],
					       def->indices[first + k + 1]};
			for (int a = 0; a < 3; a++)
				for (int c = 0; c < 3; c++)
					p[a][c] = def->positions[3 * v[a] + c] * def->scale[c];
			area += gi_quad_area(p[0], p[1], p[2], p[2]);
		}
		first += corners;
	}
	return sqrt(area / def->face_count);
}

bool object_is_split(const gi_object_def *def)
{
	return def->leaf_size > 0.0f && def->scheme == GI_SCHEME_BILINEAR;
}

uint32_t object_levels(const gi_object_def *def)
{
	if (!(def->leaf_size > 0.0f))
		return def->levels;
	uint32_t levels = 0;
	/* A hundredth more than asked is not worth four times the leaves. */
	for (double edge = mean_edge(def); edge > 1.01 * def->leaf_size && levels < OBJECT_MAX_LEVELS; edge *= 0.5)
		levels++;
	return levels;
}
