#include "costs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Few rays that nothing waits behind tell the price of dispatches, not of rays: no more than an upper bound. */
static const uint64_t RAYS_TO_LEARN = 2000;

/* Of the time: what sweeps and the look at rows may take. */
static const float SWEEP_SHARE = 0.3f, ASSESS_SHARE = 0.1f;

static const double LEAST_ROWS = 32;

void gi_price_add(gi_price *price, float ms)
{
	if (ms > 0 && isfinite(ms))
		price->seen[price->count++ % GI_PRICE_SEEN] = ms;
}

static int compare(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

float gi_price_of(const gi_price *price)
{
	float sorted[GI_PRICE_SEEN];
	const uint32_t count = price->count < GI_PRICE_SEEN ? price->count : GI_PRICE_SEEN;
	memcpy(sorted, price->seen, sizeof sorted);
	qsort(sorted, count, sizeof *sorted, compare);
	return count ? sorted[(count - 1) / 2] : 0;
}

void gi_costs_learn(gi_costs *c, const gi_spent *s)
{
	if (s->rays) {
		const float ray = s->by_ray / (float)s->rays;
		if (s->rays >= RAYS_TO_LEARN || s->late || ray < gi_price_of(&c->ray))
			gi_price_add(&c->ray, ray);
	}
	if (s->sweeps)
		gi_price_add(&c->sweep, s->by_sweep / (float)s->sweeps);
	if (s->rows) {
		gi_price_add(&c->row, s->by_row / (float)s->rows);
		gi_price_add(&c->fixed, s->fixed);
	}
}

/* How often a price goes into so much time; one that is not known yet, not at all. */
static double fits(float ms, const gi_price *price)
{
	const float each = gi_price_of(price);
	return each > 0 ? (double)(ms / each) : 0;
}

double gi_costs_rays(const gi_costs *c, float ms)
{
	return fits(fmaxf(GI_COSTS_LEAST_SHARE * ms, ms - gi_price_of(&c->fixed)), &c->ray);
}

double gi_costs_rows(const gi_costs *c, float ms)
{
	return fmax(LEAST_ROWS, fits(ASSESS_SHARE * ms, &c->row));
}

double gi_costs_sweeps(const gi_costs *c, float ms)
{
	return fmax(1, fits(SWEEP_SHARE * ms, &c->sweep));
}
