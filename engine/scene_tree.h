/* A tree of boxes, for faces near a place of a plane: near-linear to build, whatever the boxes. */
#ifndef ENGINE_SCENE_TREE_H
#define ENGINE_SCENE_TREE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct scene_box {
	double lower[3], upper[3];
} scene_box;

scene_box scene_box_of_nothing(void);
void scene_box_widen(scene_box *box, const double point[3]);

/* A complete binary tree: node n has children 2 n and 2 n + 1, the root is 1, leaves are nodes [width, 2 width). */
typedef struct scene_tree {
	scene_box *nodes;
	uint32_t *items; /* by leaf: the number of its box */
	uint32_t width, count;
} scene_tree;

/* False: out of memory. */
bool scene_tree_build(scene_tree *tree, const scene_box *boxes, uint32_t count);
void scene_tree_free(scene_tree *tree);

/* Calls `found` with the numbers of the boxes that meet `box` and come within `margin` of the plane n.x = height, until
 * it returns false. */
void scene_tree_search(const scene_tree *tree, const scene_box *box, const double normal[3], double height,
		       double margin, bool (*found)(void *context, uint32_t number), void *context);

#endif
