#include "polygon.h"

#include <math.h>
#include <string.h>

static void cross_at(const double *origin, const double *a, const double *b, double out[3])
{
	double u[3], v[3];
	for (int k = 0; k < 3; k++) {
		u[k] = a[k] - origin[k];
		v[k] = b[k] - origin[k];
	}
	for (int k = 0; k < 3; k++)
		out[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Twice the area of a b c along the normal: positive where it turns left. */
static double turn(const double *a, const double *b, const double *c, const double normal[3])
{
	double n[3];
	cross_at(a, b, c, n);
	return dot(n, normal);
}

/* Newell's method; its length is twice the area. */
static void mean_normal(const double (*points)[3], uint32_t count, double normal[3])
{
	double part[3];
	memset(normal, 0, 3 * sizeof *normal);
	for (uint32_t i = 1; i + 1 < count; i++) {
		cross_at(points[0], points[i], points[i + 1], part);
		for (int k = 0; k < 3; k++)
			normal[k] += part[k];
	}
}

bool gi_polygon_is_convex(const double (*points)[3], uint32_t count)
{
	double normal[3];
	mean_normal(points, count, normal);
	const double least = -1e-6 * dot(normal, normal);
	for (uint32_t i = 0; i < count; i++)
		if (turn(points[i], points[(i + 1) % count], points[(i + 2) % count], normal) < least ||
		    turn(points[0], points[i], points[(i + 1) % count], normal) < least)
			return false;
	return true;
}

/* Whether the edges a b and c d cross between their ends. */
static bool edges_cross(const double *a, const double *b, const double *c, const double *d, const double normal[3])
{
	return turn(a, b, c, normal) * turn(a, b, d, normal) < 0 && turn(c, d, a, normal) * turn(c, d, b, normal) < 0;
}

static bool crosses_itself(const double (*points)[3], uint32_t count, const double normal[3])
{
	for (uint32_t i = 0; i + 2 < count; i++)
		for (uint32_t k = i + 2; k < count; k++)
			if (edges_cross(points[i], points[i + 1], points[k], points[(k + 1) % count], normal))
				return true;
	return false;
}

/* Whether p lies in the triangle or on its rim. */
static bool covers(const double *a, const double *b, const double *c, const double *p, const double normal[3])
{
	return turn(a, b, p, normal) >= 0 && turn(b, c, p, normal) >= 0 && turn(c, a, p, normal) >= 0;
}

/* Whether the corner at place i of the ring can be cut off: it turns left and no other corner is in the way. */
static bool is_ear(const double (*points)[3], const uint32_t *ring, uint32_t left, uint32_t i, const double normal[3])
{
	const uint32_t before = (i + left - 1) % left, after = (i + 1) % left;
	const double *a = points[ring[before]], *b = points[ring[i]], *c = points[ring[after]];
	if (turn(a, b, c, normal) <= 1e-12 * dot(normal, normal))
		return false;
	for (uint32_t k = 0; k < left; k++)
		if (k != before && k != i && k != after && covers(a, b, c, points[ring[k]], normal))
			return false;
	return true;
}

uint32_t gi_polygon_cut(const double (*points)[3], uint32_t count, uint32_t (*triangles)[3])
{
	uint32_t ring[GI_POLYGON_MAX_CORNERS], left = count, made = 0;
	double normal[3];
	if (count < 3 || count > GI_POLYGON_MAX_CORNERS)
		return 0;
	mean_normal(points, count, normal);
	if (crosses_itself(points, count, normal))
		return 0;
	for (uint32_t i = 0; i < count; i++)
		ring[i] = i;
	while (left > 3) {
		uint32_t ear = 0;
		while (ear < left && !is_ear(points, ring, left, ear, normal))
			ear++;
		if (ear == left)
			return 0;
		triangles[made][0] = ring[(ear + left - 1) % left];
		triangles[made][1] = ring[ear];
		triangles[made++][2] = ring[(ear + 1) % left];
		memmove(ring + ear, ring + ear + 1, (--left - ear) * sizeof *ring);
	}
	memcpy(triangles[made++], ring, 3 * sizeof *ring);
	return made;
}
