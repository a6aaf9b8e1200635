/* A binary tree over boxes on fixed cells: halves of power-of-two cubes at whole multiples of their size, wherever the
 * boxes are. A box belongs to the smallest cell that is no smaller than it and holds its centre; cells with nothing to
 * part are left out. So any node is a function of the boxes below it alone: one box more adds one node and changes that
 * one's ancestors, nothing else, and the order of the others stays.
 *
 * (The trie of Morton 1966, compressed as by Morrison 1968; on a GPU: Karras 2012.)
 */
#ifndef GI_CELLS_H
#define GI_CELLS_H

#include "gi_shared.h"

#include <stdint.h>

/* Depth-first: the children of an inner node are the next node and the first one's skip. */
typedef struct cells_node {
	uint32_t skip;       /* the node after its subtree */
	uint32_t first, end; /* of its boxes, in `order` */
} cells_node;

/* A box's way through the cells, which the tree is sorted by; private to cells.c. */
typedef struct cells_key {
	uint64_t word[4];
	uint32_t box;
} cells_key;

/* Room for 2 count - 1 nodes, for count places in `order`, which box comes when, and for 2 count keys. `ties` are
 * numbers of the boxes, all different, that order those in one place. Boxes that come in the order of a tree before,
 * new ones behind them, take the least time. */
void cells_build(const gi_vec4 *lower, const gi_vec4 *upper, const uint32_t *ties, uint32_t count, cells_key *keys,
		 cells_node *nodes, uint32_t *order);

#endif
