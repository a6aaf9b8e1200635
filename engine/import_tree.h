/* A tree of boxes, for faces near a place of a plane: near-linear to build, whatever the boxes. */
#ifndef ENGINE_IMPORT_TREE_H
#define ENGINE_IMPORT_TREE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct import_box {
	double lower[3], upper[3];
} import_box;

import_box import_box_of_nothing(void);
void import_box_widen(import_box *box, const double point[3]);

/* A complete binary tree: node n has children 2 n and 2 n + 1, the root is 1, leaves are nodes [width, 2 width). */
typedef struct import_tree {
	import_box *nodes;
	uint32_t *items; /* by leaf: the number of its box */
	uint32_t width, count;
} import_tree;

/* False: out of memory. */
bool import_tree_build(import_tree *tree, const import_box *boxes, uint32_t count);
void import_tree_free(import_tree *tree);

/* Calls `found` with the numbers of the boxes that meet `box` and come within `margin` of the plane n.x = height, until
 * it returns false. */
void import_tree_search(const import_tree *tree, const import_box *box, const double normal[3], double height,
			double margin, bool (*found)(void *context, uint32_t number), void *context);

#endif
