#include "import_tree.h"

#include <math.h>
#include <stdlib.h>

import_box import_box_of_nothing(void)
{
	return (import_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

void import_box_widen(import_box *box, const double point[3])
{
	for (int c = 0; c < 3; c++) {
		box->lower[c] = fmin(box->lower[c], point[c]);
		box->upper[c] = fmax(box->upper[c], point[c]);
	}
}

typedef struct place {
	uint64_t code; /* Morton's, of the middle in 20 bits an axis */
	uint32_t number;
} place;

static uint64_t interleaved(const import_box *all, const import_box *box)
{
	uint64_t code = 0, cells[3];
	for (int c = 0; c < 3; c++) {
		const double size = all->upper[c] - all->lower[c];
		const double share = size > 0 ? (.5 * (box->lower[c] + box->upper[c]) - all->lower[c]) / size : 0;
		cells[c] = (uint64_t)(share * ((1 << 20) - 1));
	}
	for (int bit = 19; bit >= 0; bit--)
		for (int c = 0; c < 3; c++)
			code = code << 1 | (cells[c] >> bit & 1);
	return code;
}

static int compare_places(const void *a, const void *b)
{
	const place *x = a, *y = b;
	const int by_code = (x->code > y->code) - (x->code < y->code);
	return by_code ? by_code : (x->number > y->number) - (x->number < y->number);
}

static void fill(import_tree *tree, const import_box *boxes, const place *places)
{
	for (uint32_t k = 0; k < tree->width; k++) {
		tree->items[k] = k < tree->count ? places[k].number : 0;
		tree->nodes[tree->width + k] = k < tree->count ? boxes[places[k].number] : import_box_of_nothing();
	}
	for (uint32_t n = tree->width - 1; n > 0; n--) {
		tree->nodes[n] = tree->nodes[2 * n];
		if (tree->nodes[2 * n + 1].lower[0] <=
		    tree->nodes[2 * n + 1].upper[0]) { /* not empty, as the last are */
			import_box_widen(&tree->nodes[n], tree->nodes[2 * n + 1].lower);
			import_box_widen(&tree->nodes[n], tree->nodes[2 * n + 1].upper);
		}
	}
}

bool import_tree_build(import_tree *tree, const import_box *boxes, uint32_t count)
{
	import_box all = import_box_of_nothing();
	*tree = (import_tree){.width = 1, .count = count};
	while (tree->width < count)
		tree->width *= 2;
	place *places = malloc(((size_t)count + 1) * sizeof *places);
	tree->nodes = malloc(2 * (size_t)tree->width * sizeof *tree->nodes);
	tree->items = malloc((size_t)tree->width * sizeof *tree->items);
	if (places && tree->nodes && tree->items) {
		for (uint32_t k = 0; k < count; k++) {
			import_box_widen(&all, boxes[k].lower);
			import_box_widen(&all, boxes[k].upper);
		}
		for (uint32_t k = 0; k < count; k++)
			places[k] = (place){interleaved(&all, &boxes[k]), k};
		qsort(places, count, sizeof *places, compare_places);
		fill(tree, boxes, places);
		free(places);
		return true;
	}
	free(places);
	import_tree_free(tree);
	return false;
}

void import_tree_free(import_tree *tree)
{
	free(tree->nodes);
	free(tree->items);
	*tree = (import_tree){0};
}

static bool boxes_meet(const import_box *a, const import_box *b)
{
	for (int c = 0; c < 3; c++)
		if (!(a->lower[c] <= b->upper[c] && b->lower[c] <= a->upper[c]))
			return false;
	return true;
}

static bool meets_plane(const import_box *box, const double normal[3], double height, double margin)
{
	double middle = -height, reach = margin;
	for (int c = 0; c < 3; c++) {
		middle += normal[c] * .5 * (box->lower[c] + box->upper[c]);
		reach += fabs(normal[c]) * .5 * (box->upper[c] - box->lower[c]);
	}
	return fabs(middle) <= reach;
}

void import_tree_search(const import_tree *tree, const import_box *box, const double normal[3], double height,
			double margin, bool (*found)(void *context, uint32_t number), void *context)
{
	uint32_t stack[64], depth = 0;
	if (tree->count > 0)
		stack[depth++] = 1;
	while (depth > 0) {
		const uint32_t n = stack[--depth];
		if (!boxes_meet(&tree->nodes[n], box) || !meets_plane(&tree->nodes[n], normal, height, margin))
			continue;
		if (n >= tree->width) {
			if (!found(context, tree->items[n - tree->width]))
				return;
			continue;
		}
		stack[depth++] = 2 * n + 1;
		stack[depth++] = 2 * n;
	}
}
