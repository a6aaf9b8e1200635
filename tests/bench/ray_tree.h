/* A bounding volume hierarchy over triangles, for shaders that keep no stack: its nodes lie in the order in which they
 * are visited, each with the place to go on at where the ray misses it, in six orders, one for each side that a ray may
 * mostly come from (threaded trees: Smits, "Efficiency issues for ray tracing", 1998; Hachisuka's multiple-threaded
 * BVH, 2015).
 *
 * node, 8 words:  lower x y z | order's node to skip to || upper x y z | leaf: count << 28 | first triangle, else 0
 */
#ifndef TESTS_BENCH_RAY_TREE_H
#define TESTS_BENCH_RAY_TREE_H

#include <stdbool.h>
#include <stdint.h>

enum { RAY_TREE_ORDERS = 6, RAY_TREE_LEAF = 4 };

typedef struct ray_tree_node {
	float lower[3];
	uint32_t skip; /* counted within the order */
	float upper[3];
	uint32_t leaf;
} ray_tree_node;

typedef struct ray_tree {
	ray_tree_node
	    *nodes; /* RAY_TREE_ORDERS * node_count; order 2 axis + 1: for rays that go towards lower values */
	uint32_t node_count;
	uint32_t *triangles; /* the number that each triangle of a leaf had */
	uint32_t triangle_count;
} ray_tree;

/* corners: 9 floats a triangle, 1 to 2^28 - 1 of them. Split by the surface area heuristic in bins (Wald, "On fast
 * construction of SAH-based bounding volume hierarchies", 2007). False when out of memory. */
bool ray_tree_build(const float *corners, uint32_t triangle_count, ray_tree *out);
void ray_tree_free(ray_tree *tree);

#endif
