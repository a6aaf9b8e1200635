/* The point of an object's leaves that is closest to a given one. */
#ifndef GI_DRAWN_LOCATOR_H
#define GI_DRAWN_LOCATOR_H

#include "bvh.h"
#include "vec3d.h"

typedef struct gi_drawn_locator {
	const gi_hierarchy *h;
	gi_bvh_node *nodes;
	uint32_t *order;
	double farther;   /* how much farther a leaf that faces the right way may be, metres */
	bool from_middle; /* leaves of four corners are four triangles round their middle, not two */
} gi_drawn_locator;

typedef struct gi_leaf_point {
	double distance2; /* INFINITY: none found */
	uint32_t leaf;
	float weight[4]; /* of the leaf's corners */
} gi_leaf_point;

/* False: out of memory. Either way it is to be freed. The hierarchy has leaves, and stays while the locator is used. */
bool gi_drawn_locator_build(const gi_hierarchy *h, bool from_middle, gi_drawn_locator *out);
void gi_drawn_locator_free(gi_drawn_locator *locator);

/* The closest point of a leaf that faces as `normal` does, within 90 degrees, else of any; a normal of length 0 agrees
 * with all. `near` is a leaf that is likely close: with it found first most of the tree is never entered. */
gi_leaf_point gi_drawn_locate(const gi_drawn_locator *locator, gi_vec3d point, gi_vec3d normal, uint32_t near);

#endif
