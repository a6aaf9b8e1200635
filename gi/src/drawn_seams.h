/* Corners of leaves that lie within an edge of another leaf (T-junctions): flat leaves are drawn with them, so that
 * triangles of both sides meet in the same points and no pixel between them is left out.
 */
#ifndef GI_DRAWN_SEAMS_H
#define GI_DRAWN_SEAMS_H

#include "drawn_hanging.h"

typedef struct gi_seam_point {
	uint32_t corner; /* whose edge it lies on: leaf * 4 + k, of the edge to the leaf's next corner */
	uint32_t vertex;
	float share; /* of the way along that edge, within (0, 1) */
} gi_seam_point;

/* In order of corner, then of share; of vertices in one place one. */
typedef struct gi_seams {
	gi_seam_point *points;
	uint32_t count, capacity;
} gi_seams;

/* `edges` as in gi_drawn_find_hanging. False: out of memory. */
bool gi_drawn_find_seams(const gi_hierarchy *h, const gi_leaf_edge *edges, uint32_t count, gi_seams *out);

#endif
