/* The tree over boxes on fixed cells: a node is a function of the boxes below it. So one box more or less leaves all
 * nodes without it as they were, wherever they come in the list, and the order of the others. Boxes of many sizes, also
 * some in one place, at several scales and far away.
 */
#include "cells.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 300 };

typedef struct boxes {
	gi_vec4 lower[MOST], upper[MOST];
	uint32_t ties[MOST]; /* names */
	uint32_t count;
} boxes;

typedef struct tree {
	cells_node nodes[2 * MOST];
	uint32_t order[MOST], names[MOST];
	uint32_t count;
} tree;

static uint32_t random_state = 1;

static float unit_random(void)
{
	random_state = random_state * 1664525u + 1013904223u; /* Numerical Recipes */
	return (float)(random_state >> 8) * (1.0f / 16777216.0f);
}

static void add_box(boxes *b, uint32_t name, float scale, const float origin[3])
{
	const uint32_t k = b->count++;
	const bool copy = k > 0 && unit_random() < .1f;
	for (int c = 0; c < 3; c++) {
		const float size = scale * powf(unit_random(), 4), at = origin[c] + scale * (3 * unit_random() - 1.5f);
		(&b->lower[k].x)[c] = copy ? (&b->lower[k - 1].x)[c] : at - size;
		(&b->upper[k].x)[c] = copy ? (&b->upper[k - 1].x)[c] : at + size;
	}
	b->ties[k] = name;
}

static void build(const boxes *b, tree *t)
{
	static cells_key keys[2 * MOST];
	cells_build(b->lower, b->upper, b->ties, b->count, keys, t->nodes, t->order);
	t->count = b->count ? 2 * b->count - 1 : 0;
	for (uint32_t k = 0; k < b->count; k++)
		t->names[k] = b->ties[t->order[k]];
}

/* Every node is there, its children part it, and each box is a leaf. */
static void check_shape(const boxes *b, const tree *t)
{
	uint32_t leaves = 0;
	assert_int_equal(t->nodes[0].first, 0);
	assert_int_equal(t->nodes[0].end, b->count);
	for (uint32_t k = 0; k < t->count; k++) {
		const cells_node *n = &t->nodes[k];
		if (n->end - n->first == 1) {
			assert_int_equal(n->skip, k + 1);
			assert_int_equal(n->first, leaves++);
			continue;
		}
		const cells_node *one = &t->nodes[k + 1], *other = &t->nodes[one->skip];
		assert_int_equal(one->first, n->first);
		assert_int_equal(one->end, other->first);
		assert_int_equal(other->end, n->end);
		assert_int_equal(other->skip, n->skip);
	}
	assert_int_equal(leaves, b->count);
}

static bool is_node(const tree *t, const uint32_t *names, uint32_t count)
{
	for (uint32_t k = 0; k < t->count; k++)
		if (t->nodes[k].end - t->nodes[k].first == count &&
		    !memcmp(t->names + t->nodes[k].first, names, sizeof *names * count))
			return true;
	return false;
}

static bool remove_name(uint32_t *names, uint32_t *count, uint32_t name)
{
	uint32_t left = 0;
	for (uint32_t k = 0; k < *count; k++)
		if (names[k] != name)
			names[left++] = names[k];
	const bool found = left < *count;
	*count = left;
	return found;
}

/* Returns how many nodes the box `name` changed. */
static uint32_t expect_one_more(const tree *without, const tree *with, uint32_t name)
{
	uint32_t changed = 0, added = 0;
	for (uint32_t k = 0; k < with->count; k++) {
		uint32_t names[MOST], count = with->nodes[k].end - with->nodes[k].first;
		memcpy(names, with->names + with->nodes[k].first, sizeof *names * count);
		const bool holds = remove_name(names, &count, name);
		changed += holds;
		if (count == 0 || (holds && !is_node(without, names, count)))
			added++;
		else
			assert_true(is_node(without, names, count));
	}
	assert_true(added == 1); /* its own; its parent has what its brother has, but for it */
	return changed;
}

static void one_more_changes_its_ancestors(void **state)
{
	(void)state;
	static const struct {
		float scale, origin[3];
	} places[] = {{1, {0, 0, 0}}, {30, {100.3f, -7, 12}}, {1e-3f, {.5f, .5f, .5f}}, {1e4f, {9e8f, -9e8f, 3e7f}}};
	static boxes all, less;
	static tree with, without;
	double sum = 0;
	uint32_t trials = 0, most = 0;
	for (size_t p = 0; p < sizeof places / sizeof *places; p++) {
		for (uint32_t count = 2; count <= MOST; count = count * 3 / 2 + 1) {
			all.count = 0;
			for (uint32_t k = 0; k < count; k++)
				add_box(&all, 7 * k + 3, places[p].scale, places[p].origin);
			build(&all, &with);
			check_shape(&all, &with);
			const uint32_t out = (uint32_t)(unit_random() * (float)count);
			/* The others in another order. */
			less.count = 0;
			for (uint32_t k = count; k-- > 0;) {
				if (k == out)
					continue;
				less.lower[less.count] = all.lower[k];
				less.upper[less.count] = all.upper[k];
				less.ties[less.count++] = all.ties[k];
			}
			build(&less, &without);
			check_shape(&less, &without);
			const uint32_t changed = expect_one_more(&without, &with, all.ties[out]);
			sum += changed;
			most = changed > most ? changed : most;
			trials++;
		}
	}
	printf("  one box changes %.1f nodes on the mean, %u at most\n", sum / trials, most);
	assert_true(sum / trials < 20);
}

static void nothing_and_one(void **state)
{
	(void)state;
	static boxes b;
	static tree t;
	b.count = 0;
	build(&b, &t);
	add_box(&b, 5, 1, (float[]){0, 0, 0});
	build(&b, &t);
	check_shape(&b, &t);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(one_more_changes_its_ancestors),
	    cmocka_unit_test(nothing_and_one),
	};
	return cmocka_run_group_tests_name("cells", tests, NULL, NULL);
}
