#include "ray_tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BINS = 16 };

typedef struct box {
	float lower[3], upper[3];
} box;

/* A node of the tree that orders are made of; children behind each other. */
typedef struct plain_node {
	box bounds;
	uint32_t child; /* the first of two; 0: a leaf */
	uint32_t first, count;
	uint32_t axis; /* that it is split along: the first child lies lower */
} plain_node;

typedef struct builder {
	box *boxes;     /* of triangles */
	float *centres; /* 3 a triangle */
	uint32_t *order;
	plain_node *nodes;
	uint32_t node_count;
} builder;

static box empty_box(void)
{
	return (box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static void grow(box *b, const box *by)
{
	for (int c = 0; c < 3; c++) {
		b->lower[c] = fminf(b->lower[c], by->lower[c]);
		b->upper[c] = fmaxf(b->upper[c], by->upper[c]);
	}
}

static float half_area(const box *b)
{
	const float x = b->upper[0] - b->lower[0], y = b->upper[1] - b->lower[1], z = b->upper[2] - b->lower[2];
	return x >= 0 ? x * y + y * z + z * x : 0;
}

/* Where a node may be split: a plane between bins of centres along one axis. */
typedef struct split {
	float cost;
	uint32_t axis, bin;
} split;

static uint32_t bin_of(const builder *b, uint32_t triangle, uint32_t axis, const box *centres)
{
	const float span = centres->upper[axis] - centres->lower[axis];
	const float at = (b->centres[3 * (size_t)triangle + axis] - centres->lower[axis]) / span * BINS;
	return at < BINS - 1 ? (uint32_t)at : BINS - 1;
}

static void try_axis(const builder *b, const plain_node *node, const box *centres, uint32_t axis, split *best)
{
	box bounds[BINS], right[BINS];
	uint32_t counts[BINS] = {0}, rest = 0;
	if (!(centres->upper[axis] > centres->lower[axis]))
		return;
	for (int k = 0; k < BINS; k++)
		bounds[k] = empty_box();
	for (uint32_t k = node->first; k < node->first + node->count; k++) {
		const uint32_t bin = bin_of(b, b->order[k], axis, centres);
		counts[bin]++;
		grow(&bounds[bin], &b->boxes[b->order[k]]);
	}
	right[BINS - 1] = bounds[BINS - 1];
	for (int k = BINS - 2; k > 0; k--) {
		right[k] = right[k + 1];
		grow(&right[k], &bounds[k]);
	}
	box left = empty_box();
	for (uint32_t k = 0; k + 1 < BINS; k++) {
		grow(&left, &bounds[k]);
		rest += counts[k];
		const float cost =
		    half_area(&left) * (float)rest + half_area(&right[k + 1]) * (float)(node->count - rest);
		if (rest > 0 && rest < node->count && cost < best->cost)
			*best = (split){cost, axis, k};
	}
}

/* Puts what lies in bins up to the split's first; how many those are. */
static uint32_t partition(const builder *b, const plain_node *node, const box *centres, const split *s)
{
	uint32_t low = node->first, high = node->first + node->count;
	while (low < high) {
		const uint32_t triangle = b->order[low];
		if (bin_of(b, triangle, s->axis, centres) <= s->bin) {
			low++;
		} else {
			b->order[low] = b->order[--high];
			b->order[high] = triangle;
		}
	}
	return low - node->first;
}

static void measure(const builder *b, plain_node *node, box *centres)
{
	node->bounds = *centres = empty_box();
	for (uint32_t k = node->first; k < node->first + node->count; k++) {
		const float *at = b->centres + 3 * (size_t)b->order[k];
		const box centre = {{at[0], at[1], at[2]}, {at[0], at[1], at[2]}};
		grow(&node->bounds, &b->boxes[b->order[k]]);
		grow(centres, &centre);
	}
}

/* Nodes are worked off in the order in which they came: children lie behind their parents. */
static void split_node(builder *b, uint32_t number)
{
	plain_node *node = &b->nodes[number];
	box centres;
	measure(b, node, &centres);
	/* A step down costs as much as a triangle. */
	const float whole =
	    node->count > RAY_TREE_LEAF ? INFINITY : half_area(&node->bounds) * (float)(node->count - 1);
	split best = {.cost = whole};
	for (uint32_t axis = 0; axis < 3; axis++)
		try_axis(b, node, &centres, axis, &best);
	uint32_t left = 0;
	if (best.cost < whole)
		left = partition(b, node, &centres, &best);
	else if (node->count > RAY_TREE_LEAF)
		left = node->count / 2; /* all in one place */
	if (!left)
		return;
	node->axis = best.axis;
	node->child = b->node_count;
	b->nodes[b->node_count++] = (plain_node){.first = node->first, .count = left};
	b->nodes[b->node_count++] = (plain_node){.first = node->first + left, .count = node->count - left};
}

/* ---- orders ---- */

/* Writes a node and all below it from place `at` on; returns the place after them. The child that a ray of that order
 * comes to first is the first one. */
static uint32_t write_order(const builder *b, uint32_t number, uint32_t order, ray_tree_node *out, uint32_t at)
{
	const plain_node *node = &b->nodes[number];
	ray_tree_node *to = &out[at];
	memcpy(to->lower, node->bounds.lower, sizeof to->lower);
	memcpy(to->upper, node->bounds.upper, sizeof to->upper);
	to->leaf = node->child ? 0 : node->count << 28 | node->first;
	at++;
	if (node->child) {
		const uint32_t high_first = node->axis == order / 2 && order % 2;
		at = write_order(b, node->child + high_first, order, out, at);
		at = write_order(b, node->child + 1 - high_first, order, out, at);
	}
	to->skip = at;
	return at;
}

static void find_boxes(const builder *b, const float *corners, uint32_t triangle_count)
{
	for (uint32_t t = 0; t < triangle_count; t++) {
		b->boxes[t] = empty_box();
		b->order[t] = t;
		for (int k = 0; k < 3; k++) {
			const float *p = corners + 9 * (size_t)t + 3 * k;
			const box point = {{p[0], p[1], p[2]}, {p[0], p[1], p[2]}};
			grow(&b->boxes[t], &point);
		}
		for (int c = 0; c < 3; c++)
			b->centres[3 * (size_t)t + (size_t)c] = 0.5f * (b->boxes[t].lower[c] + b->boxes[t].upper[c]);
	}
}

bool ray_tree_build(const float *corners, uint32_t triangle_count, ray_tree *out)
{
	*out = (ray_tree){.triangle_count = triangle_count};
	builder b = {.boxes = malloc(sizeof *b.boxes * triangle_count),
		     .centres = malloc(3 * sizeof *b.centres * triangle_count),
		     .order = malloc(sizeof *b.order * triangle_count),
		     .nodes = malloc(2 * sizeof *b.nodes * triangle_count)};
	bool ok = b.boxes && b.centres && b.order && b.nodes;
	if (ok) {
		find_boxes(&b, corners, triangle_count);
		b.nodes[b.node_count++] = (plain_node){.count = triangle_count};
		for (uint32_t k = 0; k < b.node_count; k++)
			split_node(&b, k);
		out->node_count = b.node_count;
		out->nodes = malloc(RAY_TREE_ORDERS * sizeof *out->nodes * b.node_count);
		ok = out->nodes != NULL;
	}
	for (uint32_t order = 0; ok && order < RAY_TREE_ORDERS; order++)
		write_order(&b, 0, order, out->nodes + (size_t)order * b.node_count, 0);
	free(b.boxes);
	free(b.centres);
	free(b.nodes);
	if (ok)
		out->triangles = b.order;
	else
		free(b.order);
	return ok;
}

void ray_tree_free(ray_tree *tree)
{
	free(tree->nodes);
	free(tree->triangles);
	*tree = (ray_tree){0};
}
