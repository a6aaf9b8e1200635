/* Where in a texture what is drawn lies: of objects with texture coordinates.
 *
 * Coordinates belong to corners of triangles, so that a texture may have seams where the surface has none. Where
 * corners of one drawn vertex differ in them the vertex is drawn again, with the same place, normal and light.
 */
#ifndef GI_DRAWN_CHART_H
#define GI_DRAWN_CHART_H

#include "drawn_surface.h"

typedef struct gi_drawn_chart {
	uint32_t vertex_count; /* the surface's, and those that are drawn again */
	uint32_t *source;      /* of each beyond the surface's: which vertex of the surface it is */
	float (*uvs)[2];       /* of each vertex */
	uint32_t *indices;     /* the surface's triangles, material by material */
	uint32_t material_count;
	uint32_t *first; /* material_count + 1: where each material's triangles begin, in indices */
} gi_drawn_chart;

/* uvs: of each of the surface's indices. materials: of each triangle, below material_count; NULL: all 0. The order of
 * triangles of one material stays. False: out of memory. */
bool gi_drawn_chart_build(const gi_drawn_surface *drawn, const float (*uvs)[2], const uint32_t *materials,
			  uint32_t material_count, gi_drawn_chart *out);
void gi_drawn_chart_free(gi_drawn_chart *chart);

#endif
