#include "import_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cells are so many distances wide: a point's neighbours are mostly in its own. */
static const double WIDTH = 8;

/* Points that others were welded to, by hashes of their cells: lists through `next`. No more than so many of a list are
 * looked at, whatever a file makes of hashes. */
enum { MOST_LOOKED_AT = 64 };
static const uint32_t NO_POINT = UINT32_MAX;

typedef struct cells {
	const double *points;
	double distance, width; /* of a cell */
	uint32_t *heads, *next;
	uint32_t mask;
} cells;

static uint32_t hash_of(const cells *c, const double cell[3])
{
	uint64_t hash = 0;
	for (int k = 0; k < 3; k++) {
		const double number = cell[k] + 0.0; /* no -0 */
		uint64_t bits;
		memcpy(&bits, &number, sizeof bits);
		hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
		hash ^= hash >> 29;
	}
	return (uint32_t)(hash >> 20) & c->mask;
}

static uint32_t find_in(const cells *c, const double cell[3], const double *p)
{
	uint32_t at = c->heads[hash_of(c, cell)];
	for (uint32_t k = 0; k < MOST_LOOKED_AT && at != NO_POINT; k++, at = c->next[at]) {
		const double *q = c->points + 3 * (size_t)at;
		if (fabs(p[0] - q[0]) <= c->distance && fabs(p[1] - q[1]) <= c->distance &&
		    fabs(p[2] - q[2]) <= c->distance)
			return at;
	}
	return NO_POINT;
}

/* In all cells that come within the distance: one to eight. */
static uint32_t find_near(const cells *c, const double *p)
{
	double low[3], high[3], cell[3];
	for (int k = 0; k < 3; k++) {
		low[k] = floor((p[k] - c->distance) / c->width);
		high[k] = floor((p[k] + c->distance) / c->width);
	}
	for (int corner = 0; corner < 8; corner++) {
		bool again = false;
		for (int k = 0; k < 3; k++) {
			cell[k] = corner >> k & 1 ? high[k] : low[k];
			again = again || ((corner >> k & 1) && high[k] == low[k]);
		}
		const uint32_t found = again ? NO_POINT : find_in(c, cell, p);
		if (found != NO_POINT)
			return found;
	}
	return NO_POINT;
}

static void add(cells *c, uint32_t number)
{
	const double *p = c->points + 3 * (size_t)number;
	double cell[3];
	for (int k = 0; k < 3; k++)
		cell[k] = floor(p[k] / c->width);
	const uint32_t hash = hash_of(c, cell);
	c->next[number] = c->heads[hash];
	c->heads[hash] = number;
}

bool import_points_weld(const double *points, uint32_t count, double distance, uint32_t *first)
{
	cells c = {.points = points, .distance = distance, .width = distance > 0 ? WIDTH * distance : 1, .mask = 1};
	while (c.mask < count)
		c.mask = 2 * c.mask + 1;
	c.heads = malloc(((size_t)c.mask + 1) * sizeof *c.heads);
	c.next = malloc(((size_t)count + 1) * sizeof *c.next);
	const bool has = c.heads && c.next;
	for (size_t k = 0; has && k <= c.mask; k++)
		c.heads[k] = NO_POINT;
	for (uint32_t k = 0; has && k < count; k++) {
		const uint32_t found = find_near(&c, points + 3 * (size_t)k);
		first[k] = found != NO_POINT ? found : k;
		if (found == NO_POINT)
			add(&c, k);
	}
	free(c.heads);
	free(c.next);
	return has;
}
