/* The tree of real-time ray tracing (tests/bench/ray_tree.h): every order visits what a ray meets, and nothing
 * twice. */
#include "../bench/ray_tree.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

enum { TRIANGLES = 3000 };

static float random_float(void)
{
	return (float)rand() / (float)RAND_MAX;
}

static void random_triangles(float *corners, uint32_t count, float size)
{
	srand(1);
	for (uint32_t t = 0; t < count; t++) {
		const float at[3] = {random_float(), random_float(), random_float()};
		for (int k = 0; k < 9; k++)
			corners[9 * t + (uint32_t)k] = at[k % 3] + size * (random_float() - 0.5f);
	}
}

/* Goes through an order from node `at` to `end`; counts how often each triangle comes up in a leaf, and sees that each
 * node holds what is below it. */
static uint32_t visit(const ray_tree *tree, const ray_tree_node *nodes, uint32_t at, const float *corners,
		      uint32_t *seen)
{
	const ray_tree_node *node = &nodes[at];
	assert_true(node->skip > at && node->skip <= tree->node_count);
	if (node->leaf) {
		const uint32_t first = node->leaf & 0x0fffffffu, count = node->leaf >> 28;
		assert_true(count >= 1 && count <= RAY_TREE_LEAF && first + count <= tree->triangle_count);
		assert_int_equal(node->skip, at + 1);
		for (uint32_t k = 0; k < count; k++) {
			seen[tree->triangles[first + k]]++;
			for (int c = 0; c < 9; c++) {
				const float x = corners[9 * (size_t)tree->triangles[first + k] + (size_t)c];
				assert_true(x >= node->lower[c % 3] && x <= node->upper[c % 3]);
			}
		}
		return at + 1;
	}
	uint32_t next = at + 1;
	while (next < node->skip) {
		for (int c = 0; c < 3; c++) {
			assert_true(nodes[next].lower[c] >= node->lower[c]);
			assert_true(nodes[next].upper[c] <= node->upper[c]);
		}
		next = visit(tree, nodes, next, corners, seen);
	}
	assert_int_equal(next, node->skip);
	return next;
}

static void check_tree(const float *corners, uint32_t count)
{
	ray_tree tree;
	assert_true(ray_tree_build(corners, count, &tree));
	assert_int_equal(tree.triangle_count, count);
	uint32_t *seen = malloc(sizeof *seen * count);
	assert_non_null(seen);
	for (uint32_t order = 0; order < RAY_TREE_ORDERS; order++) {
		memset(seen, 0, sizeof *seen * count);
		const ray_tree_node *nodes = tree.nodes + (size_t)order * tree.node_count;
		assert_int_equal(visit(&tree, nodes, 0, corners, seen), tree.node_count);
		for (uint32_t t = 0; t < count; t++)
			assert_int_equal(seen[t], 1);
	}
	free(seen);
	ray_tree_free(&tree);
}

static void test_random(void **state)
{
	(void)state;
	static float corners[9 * TRIANGLES];
	random_triangles(corners, TRIANGLES, 0.05f);
	check_tree(corners, TRIANGLES);
	check_tree(corners, 1);
	check_tree(corners, 5);
}

/* All in one place: no plane tells them apart. */
static void test_same_place(void **state)
{
	(void)state;
	static float corners[9 * 40];
	random_triangles(corners, 1, 1);
	for (int t = 1; t < 40; t++)
		memcpy(corners + 9 * t, corners, 9 * sizeof *corners);
	check_tree(corners, 40);
}

/* Along a row on x, rays towards +x come to lower triangles first, those towards -x to higher ones. */
static void test_orders(void **state)
{
	(void)state;
	static float corners[9 * 64];
	for (int t = 0; t < 64; t++) {
		const float at = (float)t;
		const float triangle[9] = {at, 0, 0, at + .1f, 1, 0, at, 0, 1};
		memcpy(corners + 9 * t, triangle, sizeof triangle);
	}
	ray_tree tree;
	assert_true(ray_tree_build(corners, 64, &tree));
	for (uint32_t order = 0; order < 2; order++) {
		const ray_tree_node *nodes = tree.nodes + (size_t)order * tree.node_count;
		float last = order ? 1000 : -1000;
		for (uint32_t n = 0; n < tree.node_count; n++)
			if (nodes[n].leaf) {
				assert_true(order ? nodes[n].lower[0] < last : nodes[n].lower[0] > last);
				last = nodes[n].lower[0];
			}
	}
	ray_tree_free(&tree);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_random),
	    cmocka_unit_test(test_same_place),
	    cmocka_unit_test(test_orders),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
