/* Shapes of the pieces, and how one is parted: along a line, at two corners, into rows of cells. */
#include "split_pieces.h"

/* Of two edges. */
#define ALIKE 0.5
/* Lines are for shapes this flat: heights over the longest edge. */
#define FLAT 1e-4

gi_vec3d split_corner(const splitter *s, const polygon *p, uint32_t k)
{
	return s->points[p->v[k % p->count]];
}

double split_edge_length(const splitter *s, const polygon *p, uint32_t k)
{
	return gi_vec3d_length(gi_vec3d_sub(split_corner(s, p, k + 1), split_corner(s, p, k)));
}

/* To the inside of edge k, in the plane. */
gi_vec3d split_inward(const splitter *s, const polygon *p, uint32_t k)
{
	return gi_vec3d_unit(gi_vec3d_cross(s->normal, gi_vec3d_sub(split_corner(s, p, k + 1), split_corner(s, p, k))));
}

gi_vec3d split_normal(const splitter *s, const polygon *p)
{
	const gi_vec3d sum = gi_vec3d_triangle(split_corner(s, p, 0), split_corner(s, p, 1), split_corner(s, p, 2));
	return gi_vec3d_unit(p->count == 3
				 ? sum
				 : gi_vec3d_add(sum, gi_vec3d_triangle(split_corner(s, p, 0), split_corner(s, p, 2),
								       split_corner(s, p, 3))));
}

/* Flat, and turning left at every corner as seen against s->normal. */
bool split_is_flat_and_convex(const splitter *s, const polygon *p)
{
	double longest = 0;
	for (uint32_t k = 0; k < p->count; k++)
		longest = fmax(longest, split_edge_length(s, p, k));
	for (uint32_t k = 0; k < p->count; k++) {
		const gi_vec3d from = gi_vec3d_sub(split_corner(s, p, k), split_corner(s, p, 0));
		const gi_vec3d next = gi_vec3d_sub(split_corner(s, p, k + 2), split_corner(s, p, k));
		if (fabs(gi_vec3d_dot(from, s->normal)) > FLAT * longest ||
		    gi_vec3d_dot(split_inward(s, p, k), next) <= FLAT * longest)
			return false;
	}
	return true;
}

/* How many cells of the size lie along edges k and k + 2 of a quad. */
static double cells(const splitter *s, const polygon *p, uint32_t k)
{
	const double length = (split_edge_length(s, p, k) + split_edge_length(s, p, k + 2)) / 2;
	return fmax(1, ceil(length / (SPLIT_SIZE_SLACK * s->size) - 1e-9));
}

uint32_t split_longest_edge(const splitter *s, const polygon *p)
{
	uint32_t longest = 0;
	for (uint32_t k = 1; k < p->count; k++)
		if (split_edge_length(s, p, k) > (1 + GI_TIE) * split_edge_length(s, p, longest))
			longest = k;
	return longest;
}

bool split_is_larger_than_leaf(const splitter *s, const polygon *p)
{
	if (p->count == 3)
		return split_edge_length(s, p, split_longest_edge(s, p)) >
		       SPLIT_TRIANGLE_EDGE * SPLIT_SIZE_SLACK * s->size;
	return cells(s, p, 0) > 1 || cells(s, p, 1) > 1;
}

static void add_corner(polygon *p, uint32_t v)
{
	if (p->count < SPLIT_MAX_CORNERS)
		p->v[p->count++] = v;
}

/* The two sides of a straight line; false where one of them has no area. */
bool split_part_along(splitter *s, const polygon *p, const line *l, polygon sides[2])
{
	const gi_vec3d side = gi_vec3d_unit(gi_vec3d_cross(s->normal, gi_vec3d_sub(l->to, l->from)));
	double height[SPLIT_MAX_CORNERS];
	for (uint32_t k = 0; k < p->count; k++) {
		height[k] = gi_vec3d_dot(side, gi_vec3d_sub(split_corner(s, p, k), l->from));
		height[k] = fabs(height[k]) <= SPLIT_SNAP * s->size ? 0 : height[k];
	}
	sides[0].count = sides[1].count = 0;
	for (uint32_t k = 0; k < p->count; k++) {
		const uint32_t next = (k + 1) % p->count;
		if (height[k] >= 0)
			add_corner(&sides[0], p->v[k]);
		if (height[k] <= 0)
			add_corner(&sides[1], p->v[k]);
		if (height[k] * height[next] < 0) {
			const uint32_t v =
			    split_point_between(s, p->v[k], p->v[next], fabs(height[next]), fabs(height[k]));
			add_corner(&sides[0], v);
			add_corner(&sides[1], v);
		}
	}
	return sides[0].count >= 3 && sides[1].count >= 3;
}

void split_part_in_two(const polygon *p, uint32_t from, uint32_t to, polygon parts[2])
{
	parts[0].count = parts[1].count = 0;
	for (uint32_t k = from; k <= to; k++)
		add_corner(&parts[0], p->v[k]);
	for (uint32_t k = to; k <= from + p->count; k++)
		add_corner(&parts[1], p->v[k % p->count]);
}

/* Halves a triangle at the middle of its longest edge. */
uint32_t split_part_triangle(splitter *s, const polygon *p, polygon parts[4])
{
	const uint32_t k = split_longest_edge(s, p), a = p->v[k], b = p->v[(k + 1) % 3], c = p->v[(k + 2) % 3];
	const uint32_t middle = split_point_between(s, a, b, 1, 1);
	parts[0] = (polygon){3, {a, middle, c}};
	parts[1] = (polygon){3, {middle, b, c}};
	return 2;
}

/* Between rows of cells near the middle, in both directions where there is more than one. */
uint32_t split_part_quad(splitter *s, const polygon *p, polygon parts[4])
{
	const uint32_t a = p->v[0], b = p->v[1], c = p->v[2], d = p->v[3];
	const double n = cells(s, p, 0), m = cells(s, p, 1), i = floor(n / 2), j = floor(m / 2);
	if (m == 1) {
		const uint32_t ab = split_point_between(s, a, b, n - i, i), dc = split_point_between(s, d, c, n - i, i);
		parts[0] = (polygon){4, {a, ab, dc, d}};
		parts[1] = (polygon){4, {ab, b, c, dc}};
		return 2;
	}
	const uint32_t ad = split_point_between(s, a, d, m - j, j), bc = split_point_between(s, b, c, m - j, j);
	if (n == 1) {
		parts[0] = (polygon){4, {a, b, bc, ad}};
		parts[1] = (polygon){4, {ad, bc, c, d}};
		return 2;
	}
	const uint32_t ab = split_point_between(s, a, b, n - i, i), dc = split_point_between(s, d, c, n - i, i),
		       middle = split_point_between(s, ad, bc, n - i, i);
	parts[0] = (polygon){4, {a, ab, middle, ad}};
	parts[1] = (polygon){4, {ab, b, bc, middle}};
	parts[2] = (polygon){4, {middle, bc, c, dc}};
	parts[3] = (polygon){4, {ad, middle, dc, d}};
	return 4;
}

/* Opposite edges are alike: a grid of cells suits it. */
bool split_suits_grid(const splitter *s, const polygon *p)
{
	for (uint32_t k = 0; k < 2; k++) {
		const double a = split_edge_length(s, p, k), b = split_edge_length(s, p, k + 2);
		if (fmin(a, b) < ALIKE * fmax(a, b))
			return false;
	}
	return p->count == 4;
}
