#include "nearest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A leaf of the tree has so many triangles at most. */
enum { FEW = 4, DEEPEST = 64 };

typedef struct node {
	float lower[3], upper[3];
	uint32_t first,
	    count; /* of the order; count 0: two children, the second at `first`, the first behind the node */
} node;

struct engine_nearest {
	const engine_triangle *triangles;
	node *nodes;
	uint32_t *order, node_count;
	double farther; /* metres that one of another side must be nearer by */
};

/* ---- building ---- */

static void widen(node *n, const engine_triangle *t)
{
	for (int k = 0; k < 9; k++) {
		n->lower[k % 3] = fminf(n->lower[k % 3], t->corners[k / 3][k % 3]);
		n->upper[k % 3] = fmaxf(n->upper[k % 3], t->corners[k / 3][k % 3]);
	}
}

static float middle_of(const engine_triangle *t, int axis)
{
	return t->corners[0][axis] + t->corners[1][axis] + t->corners[2][axis];
}

static bool comes_before(const engine_nearest *n, uint32_t a, uint32_t b, int axis)
{
	const float x = middle_of(&n->triangles[a], axis), y = middle_of(&n->triangles[b], axis);
	return x < y || (x == y && a < b);
}

/* Puts the smaller half of a range first (Hoare's selection). */
static void halve(engine_nearest *n, uint32_t first, uint32_t count, int axis)
{
	uint32_t *order = n->order;
	int64_t low = first, high = (int64_t)first + count - 1, wanted = (int64_t)first + count / 2;
	while (low < high) {
		const uint32_t pivot = order[low + (high - low) / 2];
		int64_t i = low, j = high;
		while (i <= j) {
			while (comes_before(n, order[i], pivot, axis))
				i++;
			while (comes_before(n, pivot, order[j], axis))
				j--;
			if (i > j)
				break;
			const uint32_t kept = order[i];
			order[i++] = order[j];
			order[j--] = kept;
		}
		if (wanted <= j)
			high = j;
		else if (wanted >= i)
			low = i;
		else
			return;
	}
}

/* Halves have equal numbers, so that the tree is no deeper than the logarithm of all. */
static void build(engine_nearest *n, uint32_t first, uint32_t count)
{
	node *at = &n->nodes[n->node_count++];
	*at = (node){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, first, count};
	for (uint32_t k = 0; k < count; k++)
		widen(at, &n->triangles[n->order[first + k]]);
	if (count <= FEW)
		return;
	int axis = 0;
	for (int k = 1; k < 3; k++)
		if (at->upper[k] - at->lower[k] > at->upper[axis] - at->lower[axis])
			axis = k;
	halve(n, first, count, axis);
	build(n, first, count / 2);
	at->first = n->node_count;
	at->count = 0;
	build(n, first + count / 2, count - count / 2);
}

engine_nearest *engine_nearest_make(const engine_triangle *triangles, uint32_t count)
{
	engine_nearest *n = count ? calloc(1, sizeof *n) : NULL;
	if (!n)
		return NULL;
	n->triangles = triangles;
	n->nodes = malloc(sizeof *n->nodes * (size_t)count * 2);
	n->order = malloc(sizeof *n->order * count);
	if (!n->nodes || !n->order) {
		engine_nearest_free(n);
		return NULL;
	}
	for (uint32_t k = 0; k < count; k++)
		n->order[k] = k;
	build(n, 0, count);
	double squares = 0;
	for (int k = 0; k < 3; k++)
		squares += pow((double)n->nodes[0].upper[k] - n->nodes[0].lower[k], 2);
	n->farther = 0.02 * sqrt(squares);
	return n;
}

void engine_nearest_free(engine_nearest *nearest)
{
	if (!nearest)
		return;
	free(nearest->nodes);
	free(nearest->order);
	free(nearest);
}

/* ---- looking ---- */

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void subtract(const float a[3], const float b[3], double out[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = (double)a[k] - (double)b[k];
}

/* Squared distance to a segment. */
static double to_segment(const float p[3], const float a[3], const float b[3])
{
	double ab[3], ap[3], rest[3];
	subtract(b, a, ab);
	subtract(p, a, ap);
	const double length = dot(ab, ab), t = length > 0 ? fmin(fmax(dot(ap, ab) / length, 0), 1) : 0;
	for (int k = 0; k < 3; k++)
		rest[k] = ap[k] - t * ab[k];
	return dot(rest, rest);
}

static void normal_of(const engine_triangle *t, double out[3])
{
	double u[3], v[3];
	subtract(t->corners[1], t->corners[0], u);
	subtract(t->corners[2], t->corners[0], v);
	for (int k = 0; k < 3; k++)
		out[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
}

/* Squared distance: to the plane above the inside, else to the nearest edge. */
static double to_triangle(const float p[3], const engine_triangle *t, const double normal[3])
{
	double nearest = HUGE_VAL, from[3], along[3];
	bool inside = dot(normal, normal) > 0;
	for (int k = 0; k < 3; k++) {
		const float *a = t->corners[k], *b = t->corners[(k + 1) % 3];
		double side[3];
		subtract(b, a, along);
		subtract(p, a, from);
		for (int c = 0; c < 3; c++)
			side[c] = along[(c + 1) % 3] * from[(c + 2) % 3] - along[(c + 2) % 3] * from[(c + 1) % 3];
		inside = inside && dot(side, normal) >= 0;
		nearest = fmin(nearest, to_segment(p, a, b));
	}
	if (!inside)
		return nearest;
	const double height = dot(from, normal);
	return fmin(nearest, height * height / dot(normal, normal));
}

static double to_box(const float p[3], const node *n)
{
	double sum = 0;
	for (int k = 0; k < 3; k++) {
		const double off = fmax(fmax((double)n->lower[k] - p[k], (double)p[k] - n->upper[k]), 0);
		sum += off * off;
	}
	return sum;
}

typedef struct search {
	const float *point;
	double normal[3];
	double facing, any; /* squared distances of the nearest so far */
	uint32_t facing_triangle, any_triangle;
} search;

/* Whether the first is to be taken: nearer, or of equal ones that of the smaller number. */
static bool is_better(double distance, uint32_t triangle, double than, uint32_t than_triangle)
{
	return distance < than || (distance == than && triangle < than_triangle);
}

static void try_triangle(const engine_nearest *n, uint32_t number, search *s)
{
	double normal[3];
	normal_of(&n->triangles[number], normal);
	const double distance = to_triangle(s->point, &n->triangles[number], normal);
	if (is_better(distance, number, s->any, s->any_triangle)) {
		s->any = distance;
		s->any_triangle = number;
	}
	if (dot(normal, s->normal) > 0 && is_better(distance, number, s->facing, s->facing_triangle)) {
		s->facing = distance;
		s->facing_triangle = number;
	}
}

uint32_t engine_nearest_find(const engine_nearest *n, const float point[3], const float normal[3])
{
	search s = {point, {normal[0], normal[1], normal[2]}, HUGE_VAL, HUGE_VAL, UINT32_MAX, UINT32_MAX};
	uint32_t stack[DEEPEST], depth = 0;
	stack[depth++] = 0;
	while (depth > 0) {
		const uint32_t number = stack[--depth];
		const node *at = &n->nodes[number];
		if (to_box(point, at) > fmax(s.facing, s.any))
			continue;
		for (uint32_t k = 0; k < at->count; k++)
			try_triangle(n, n->order[at->first + k], &s);
		if (at->count > 0)
			continue;
		/* The nearer of both is looked into first. */
		const bool second = to_box(point, &n->nodes[at->first]) < to_box(point, at + 1);
		stack[depth++] = second ? number + 1 : at->first;
		stack[depth++] = second ? at->first : number + 1;
	}
	const bool facing =
	    s.facing_triangle != UINT32_MAX && !(16 * s.any < s.facing && sqrt(s.any) + n->farther < sqrt(s.facing));
	return facing ? s.facing_triangle : s.any_triangle;
}
