/* What rays meet of one object: its quads and the bounding volume hierarchy over them, in the rest frame.
 *
 * A flat node stands for all its leaves (a wall of 400 leaves is two triangles to a ray): the geometry is the same and
 * rays get cheaper by what the scene does not need.
 */
#ifndef GI_BVH_H
#define GI_BVH_H

#include "hierarchy.h"

typedef struct gi_bvh {
	uint32_t node_count;
	gi_bvh_node *nodes;
	uint32_t primitive_count;
	gi_primitive *primitives; /* in the order of the BVH's leaves; leaf numbers local to the object */
} gi_bvh;

/* Binned surface-area heuristic, one primitive a leaf, the larger-area child first. False when memory ran out. */
bool gi_bvh_build(const gi_hierarchy *hierarchy, gi_bvh *out);

typedef struct gi_box {
	float lower[4], upper[4]; /* the fourth are 0: they make vectors of them */
} gi_box;

/* Of a hierarchy that deforms each leaf is a primitive, for what is flat may bend. The same tree as gi_bvh_build makes,
 * where there is one already; `order` then has the leaf of each primitive. Room for one of each leaf in both. */
void gi_bvh_rebuild(const gi_hierarchy *hierarchy, gi_bvh *bvh, gi_box *boxes, uint32_t *order);

/* The same over boxes alone (the scene's objects): order[k] is the box of BVH leaf k, nodes' primitive numbers index
 * `order`. `nodes` holds 2 * count - 1, `order` count. Takes no memory; count 0 gives no nodes. */
void gi_bvh_build_boxes(const gi_box *boxes, uint32_t count, gi_bvh_node *nodes, uint32_t *order);

void gi_bvh_free(gi_bvh *bvh);

/* The numbers of an object's primitives in order of area, the largest first. The caller frees them. NULL: out of
 * memory. */
uint32_t *gi_bvh_by_size(const gi_bvh *bvh);

#endif
