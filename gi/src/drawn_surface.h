/* How the light of the leaves reaches what is drawn.
 *
 *   leaf irradiance --(light vertices: weighted mean of adjacent leaves)--> light vertex --(up to 4, weights)--> draw
 *   vertex
 *
 * Light vertices are the corners of the leaves, split where the surface has an edge (the leaves' normals differ by more
 * than 40 degrees, or one side is not connected to the other) or another surface stands on it (gi_refined.parted):
 * light does not bleed round a corner of a box, nor under a wall.
 */
#ifndef GI_DRAWN_SURFACE_H
#define GI_DRAWN_SURFACE_H

#include "hierarchy.h"

#include "gi/gi.h"

/* Light is not shared across an edge where the leaves' normals are farther apart than this: 40 degrees. */
#define GI_LIGHT_EDGE_COSINE 0.766
/* A simplified cage has edges that the scan it stands for has not: there only 70 degrees are taken for an edge of the
 * scan. */
#define GI_LIGHT_CAGE_EDGE_COSINE 0.342

typedef struct gi_draw_vertex {
	float position[3]; /* rest frame */
	float normal[3];   /* unit */
	uint32_t leaf;     /* gives the material; local to the object */
	uint32_t light[4]; /* light vertices */
	float weight[4];   /* >= 0, sum 1 */
} gi_draw_vertex;

/* What a drawn vertex of a shape that changes hangs on (gi_hierarchy.deforms). */
typedef struct gi_draw_bond {
	uint32_t place;  /* vertex of the surface that is drawn; GI_NONE: the middle of its leaf */
	uint32_t facing; /* vertex whose limit normal it has; GI_NONE: none */
	uint32_t face;   /* then face of the surface that is drawn, whose normal it has; GI_NONE: its leaf's */
} gi_draw_bond;

typedef struct gi_drawn_surface {
	uint32_t light_count;
	uint32_t *light_first;  /* light_count + 1 offsets into the two arrays below */
	uint32_t *light_leaf;   /* leaves, local to the object */
	float *light_weight;    /* sum 1 for each light vertex */
	uint32_t *corner_light; /* 4 a leaf: the light vertices at its corners */
	uint32_t vertex_count;
	gi_draw_vertex *vertices;
	uint32_t index_count; /* three a triangle, counter-clockwise */
	uint32_t *indices;
	float (*uvs)[2];      /* of each index, while an object with texture coordinates is built; NULL: none */
	gi_draw_bond *bonds;  /* of each vertex; NULL: it stays as it is, or is a mesh's */
	uint32_t (*faces)[4]; /* corners of the surface that is drawn, where there are bonds */
} gi_drawn_surface;

/* Draws the surface itself. `fine` is the same cage refined as far as the hierarchy's or further; how much further its
 * levels say themselves: a cage of n-gons is refined once whatever was asked for. Flat leaves are drawn as triangles
 * round their centre, so that interpolation has no diagonal, with the corners of other leaves that lie on their edges,
 * so that nothing is seen between them; curved ones as the quads of the finer level on the limit surface with limit
 * normals. Light vertices are shared between leaves whose normals have at least the cosine `least_cosine`. uvs: texture
 * coordinates of the leaves; NULL: none. */
bool gi_drawn_from_cage(const gi_hierarchy *hierarchy, const gi_refined *coarse, const gi_refined *fine,
			const gi_leaf_uvs *uvs, double least_cosine, gi_drawn_surface *out);

/* Draws nothing: light vertices alone, for hosts that draw for themselves. */
bool gi_drawn_from_nothing(const gi_hierarchy *hierarchy, const gi_refined *coarse, double least_cosine,
			   gi_drawn_surface *out);

/* Draws a detailed mesh lit through the hierarchy (a scan and its cage): each vertex takes the light of the closest
 * point of a leaf whose normal agrees with its own (within 90 degrees; else the closest at all). positions 3 *
 * vertex_count in the rest frame, indices three a triangle. Normals are area weighted over the mesh. 100,000 triangles
 * take about a second. */
bool gi_drawn_from_mesh(const gi_hierarchy *hierarchy, const float *positions, uint32_t vertex_count,
			const uint32_t *indices, uint32_t index_count, double least_cosine, gi_drawn_surface *out);

/* Of a shape that changes, whose hierarchy is refitted: positions and normals anew. `points` and `tangents`: of the
 * surface that is drawn, as sums of the cage; points of none: the hierarchy's vertices. */
void gi_drawn_refit(const gi_hierarchy *hierarchy, const gi_stencils *points, const gi_stencils tangents[2],
		    const double (*cage)[3], gi_drawn_surface *drawn);

/* The same of a mesh, of its vertex positions in the rest frame; normals: room for as many. */
void gi_drawn_refit_mesh(const gi_hierarchy *hierarchy, const double (*positions)[3], double (*normals)[3],
			 gi_drawn_surface *drawn);

void gi_drawn_free(gi_drawn_surface *drawn);

#endif
