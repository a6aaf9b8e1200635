/* Where leaves of different sizes meet: corners that hang on an edge of a larger neighbour (T-junctions).
 *
 * The neighbour is drawn with light that goes evenly from end to end of that edge. A light vertex of a corner that
 * hangs there is the mean of those at the ends, by its place between them, so that light has no step along the edge.
 */
#ifndef GI_DRAWN_HANGING_H
#define GI_DRAWN_HANGING_H

#include "drawn_surface.h"

/* Of an edge's length: what is nearer lies on it. Positions are rounded to floats. */
#define GI_ON_EDGE 1e-5

/* An edge of a leaf: it goes from the vertex of `corner` (leaf * 4 + k) to that of the leaf's next corner. */
typedef struct gi_leaf_edge {
	uint32_t low, high; /* its vertices in order of number */
	uint32_t corner;
} gi_leaf_edge;

typedef struct gi_hanging {
	uint32_t corner, ends[2]; /* the latter of another leaf */
	float share;              /* of ends[1], within (0, 1) */
} gi_hanging;

typedef struct gi_hanging_list {
	gi_hanging *items;
	uint32_t count, capacity;
} gi_hanging_list;

/* Of `edges` in order of low, then high: has another leaf an edge of the same ends? */
bool gi_drawn_has_partner(const gi_leaf_edge *edges, uint32_t count, uint32_t k);

/* Finds the corners that hang, and calls `join` for corners of edges that overlap which lie in one place; not across
 * edges that part light (`parted` as gi_refined has it; NULL: none) nor between leaves whose normals are farther apart
 * than the cosine. `edges` in order of low, then high; those with a partner of the same ends take no part. False: out
 * of memory. */
bool gi_drawn_find_hanging(const gi_hierarchy *h, const uint8_t *parted, const gi_leaf_edge *edges, uint32_t count,
			   double least_cosine, void (*join)(uint32_t *group, uint32_t a, uint32_t b), uint32_t *group,
			   gi_hanging_list *out);

/* Makes the light vertices of such corners; `light` is by corner. False: out of memory. */
bool gi_drawn_hang_lights(const gi_hanging_list *list, const uint32_t *light, uint32_t leaf_count,
			  gi_drawn_surface *drawn);

#endif
