/* OpenSubdiv behind a C interface: a control cage in, the faces of every refinement level with limit positions and
 * normals out. The implementation (refine.cpp) is the one C++ file of gi/; no exception leaves it.
 */
#ifndef GI_REFINE_H
#define GI_REFINE_H

#include "stencils.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum gi_refine_scheme {
	GI_REFINE_BILINEAR,
	GI_REFINE_CATMULL_CLARK,
	GI_REFINE_LOOP,
} gi_refine_scheme;

typedef enum gi_refine_boundary {
	GI_REFINE_BOUNDARY_EDGE_AND_CORNER, /* boundary edges and corners are sharp (default) */
	GI_REFINE_BOUNDARY_EDGE_ONLY,       /* boundary edges are sharp, corners are rounded */
} gi_refine_boundary;

/* A control cage; all arrays are the caller's and only read. */
typedef struct gi_refine_cage {
	const float *positions;          /* 3 * vertex_count */
	const uint32_t *face_counts;     /* face_count; NULL: every face has four corners */
	const uint32_t *indices;         /* index_count */
	const uint32_t *face_materials;  /* face_count; NULL: all 0 */
	const uint32_t *crease_vertices; /* 2 * crease_count */
	const float *crease_sharpness;   /* crease_count */
	uint32_t vertex_count, face_count, index_count, crease_count;
	gi_refine_scheme scheme;
	gi_refine_boundary boundary;
	float scale[3];   /* applied to the positions before anything else */
	bool stencils;    /* the refined has what it takes to be evaluated at other positions */
	bool numbered;    /* and says which of the faces each of its own lies in; with stencils too */
	const float *uvs; /* 2 * index_count: texture coordinates of the corners of faces, for its own; NULL: none */
} gi_refine_cage;

/* The faces of one level. Corner numbers are vertices of the FINEST level: the descendant of a coarse vertex has the
 * same limit position. A face has four corners; a triangle repeats its third. A level-0 face of more than four corners
 * has no corners (all UINT32_MAX): it is a face of the hierarchy only through its children. */
typedef struct gi_refine_level {
	uint32_t face_count;
	uint32_t (*corners)[4];
	uint32_t *parent;   /* face number in the level above; NULL at level 0 */
	uint32_t *material; /* of the base face */
} gi_refine_level;

typedef struct gi_refined {
	uint32_t level_count; /* levels + 1 */
	gi_refine_level *levels;
	uint32_t vertex_count; /* of the finest level */
	float (*positions)[3]; /* on the limit surface (bilinear: the refined positions) */
	float (*normals)[3];   /* unit limit normals; zero where the surface has none (bilinear, on a sharp crease) */
	uint8_t *parted;       /* a face of the finest level: bit k, edge k parts the light on its sides; NULL: none */
	bool closed;           /* no boundary: faces walk every edge of the cage as often one way as the other */
	bool out_of_memory;    /* why gi_refine failed; all else is zero then */

	/* Where stencils were asked for: positions, and two tangents across each normal, as sums of the cage's vertices
	 * with its scale applied. Tangents without terms are no normal; a bilinear cage has none at all. */
	gi_stencils points, tangents[2];
	uint32_t *faces; /* a face of the finest level: number of the cage's face that it lies in; where asked for */
	/* Of a face of the finest level, at its corners: in each face of the cage linear between that one's, whatever
	 * shape these give it. NULL: none were given */
	float (*uvs)[4][2];
} gi_refined;

/* Refines `levels` times (0..8), uniformly. Levels is raised to 1 where a base face has more than four corners, and for
 * Loop every base face must be a triangle. Returns false, fills `message` with one line and leaves `out` zeroed when
 * the cage is not valid (index out of range, fewer than three corners, not finite, too many faces) or memory ran out.
 */
bool gi_refine(const gi_refine_cage *cage, uint32_t levels, gi_refined *out, char *message, size_t message_size);

void gi_refined_free(gi_refined *refined);

#ifdef __cplusplus
}
#endif

#endif
