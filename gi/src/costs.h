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
	gi_price ray; /* ms of cut, factor, flag, trace and close together, over the rays traced */
	gi_price row; /* ms of a row that is assessed */
	gi_price sweep;
	/* ms of what no number of rays changes: other passes and, on a software renderer, what lies between them. */
	gi_price fixed;
} gi_costs;

/* One finished update, ms. */
typedef struct gi_spent {
	uint64_t rays;
	uint32_t rows, sweeps; /* rows: assessed; 0: no budget chose any */
	bool late;             /* rows waited for lack of budget alone */
	float by_ray, by_row, by_sweep, fixed;
} gi_spent;

void gi_costs_learn(gi_costs *costs, const gi_spent *spent);

/* Share of a budget that is always left for refreshing rows, whatever other things took. */
#define GI_COSTS_LEAST_SHARE 0.1f

/* How many rays, rows to assess or sweeps fit into a budget of `ms` milliseconds. Rows and sweeps have fixed shares of
 * it, 32 rows and one sweep at least; rays get what is left. 0 rays where their price is not known yet. */
double gi_costs_rays(const gi_costs *costs, float ms);
double gi_costs_rows(const gi_costs *costs, float ms);
double gi_costs_sweeps(const gi_costs *costs, float ms);

#endif
