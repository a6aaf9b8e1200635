/* What updates under a budget of time are seen to take, and how much of each thing so fits into the next one.
 *
 * A price is the median of the last few measurements: a stalled frame, or two in a row, is an outlier and changes
 * nothing, and what really got slower or faster is believed three updates later.
 */
#ifndef GI_COSTS_H
#define GI_COSTS_H

#include <stdbool.h>
#include <stdint.h>

enum { GI_PRICE_SEEN = 5 };

typedef struct gi_price {
	float seen[GI_PRICE_SEEN]; /* a ring, ms */
	uint32_t count;            /* of all measurements */
} gi_price;

/* Measurements that are no times, not above 0 or not finite, are ignored. */
void gi_price_add(gi_price *price, float ms);

/* The median; of one or two measurements the least; 0: not known yet. */
float gi_price_of(const gi_price *price);

typedef struct gi_costs {
	gi_price ray; /* of cut, factor, flag, trace and close together */
	gi_price row; /* that is assessed */
	gi_price sweep;
	gi_price
	    fixed; /* what no number of rays changes: the other passes, on a software renderer what lies between too */
} gi_costs;

/* One finished update, ms. */
typedef struct gi_spent {
	uint64_t rays;
	uint32_t rows, sweeps; /* rows: assessed; 0: no budget chose any */
	bool late;             /* rows waited for lack of budget alone */
	float by_ray, by_row, by_sweep, fixed;
} gi_spent;

void gi_costs_learn(gi_costs *costs, const gi_spent *spent);

/* However little time is left, some rows are refreshed: of a budget this much is, whatever came before. */
#define GI_COSTS_LEAST_SHARE 0.1f

/* How many fit into `ms` milliseconds: rays all but what the rest takes, rows to assess and sweeps their
 * shares, 32 rows and one sweep at least. 0 rays where their price is not known yet. */
double gi_costs_rays(const gi_costs *costs, float ms);
double gi_costs_rows(const gi_costs *costs, float ms);
double gi_costs_sweeps(const gi_costs *costs, float ms);

#endif
