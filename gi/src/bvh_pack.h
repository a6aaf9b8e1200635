/* Bounding volume hierarchies as rays read them: a node in 16 bytes, bounds on a grid of 65,535 cells over the tree's
 * box (the layout is in gi_shared.h).
 */
#ifndef GI_BVH_PACK_H
#define GI_BVH_PACK_H

#include "gi_shared.h"

/* The grid over a box, a little larger so that flat boxes have cells too: where it begins, and cells per metre. */
void gi_pack_grid(const gi_vec4 *lower, const gi_vec4 *upper, gi_vec4 *grid, gi_vec4 *cells);

/* Bounds are rounded outward, by more than a ray loses when it is transformed to the grid. The bases are added to the
 * numbers of the skip node and of the primitive. */
gi_uvec4 gi_pack_node(const gi_bvh_node *node, gi_vec4 grid, gi_vec4 cells, uint32_t node_base,
		      uint32_t primitive_base);

#endif
