#include "bench_frames.h"

#include <stdio.h>
#include <stdlib.h>

/* Updates that learn what things take, those that count at most, and exact ones; the mover's steps are a demo's. */
enum { SETTLE = 30, EXACT = 4 };

static const float DEMO_FPS = 24;

/* Kept: within this much of what was asked for. */
static const double WITHIN = 1.5;

typedef struct budget_run {
	const scene_kind *kind;
	gi_context *gi;
	gi_object mover;
	uint32_t step; /* of the animation */
	samples exact, update, choose, rows, solve, light, refreshed, assessed, rays, waiting;
	uint32_t settled; /* the first update under the budget that was within it */
	gi_report report;
} budget_run;

static gi_context *open_default(engine_context *context, const scene_kind *kind)
{
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = engine_context_find_gl;
	def.get_proc_user = context;
	def.sky = kind->sky;
	gi_context *gi;
	check(gi_context_create(&def, &gi));
	return gi;
}

/* All that gi_update issues, waited for, ms. */
static double update(budget_run *r, const gi_budget *budget)
{
	check(gi_set_pose(r->gi, r->mover, r->kind->pose((float)++r->step / DEMO_FPS)));
	const double began = now_ms();
	check(gi_update(r->gi, budget));
	check(gi_finish(r->gi));
	const double ms = now_ms() - began;
	check(gi_get_report(r->gi, &r->report));
	return ms;
}

static double sum_of(const gi_report *report, gi_pass first, gi_pass last)
{
	double sum = 0;
	for (gi_pass k = first; k <= last; k++)
		sum += (double)report->pass_ms[k];
	return sum;
}

static void collect(budget_run *r, double ms)
{
	const gi_report *report = &r->report;
	samples_add(&r->update, ms);
	samples_add(&r->choose, (double)report->pass_ms[GI_PASS_CHOOSE]);
	samples_add(&r->rows, sum_of(report, GI_PASS_CUT, GI_PASS_CLOSE));
	samples_add(&r->solve, (double)report->pass_ms[GI_PASS_SOLVE]);
	samples_add(&r->light, (double)report->pass_ms[GI_PASS_LIGHT]);
	samples_add(&r->refreshed, (double)report->dirty_rows);
	samples_add(&r->assessed, report->assessed_rows);
	samples_add(&r->rays, (double)report->rays);
	samples_add(&r->waiting, 100.0 * (double)report->waiting_rows / report->leaves);
}

/* Of the last update: B against an exact one's of the same pose. */
static bench_distance distance_from_exact(gi_context *gi)
{
	uint32_t count;
	gi_leaf *under = bench_leaves(gi, &count);
	bench_step(gi);
	gi_leaf *exact = bench_leaves(gi, &count);
	const bench_distance off = bench_leaves_distance(under, exact, count);
	free(under);
	free(exact);
	return off;
}

static void print_line(budget_run *r, double ms)
{
	const gi_report last = r->report;
	const bench_distance off = distance_from_exact(r->gi);
	printf("| %s | %u | %.1f | %g | %.2f | %.2f | %u | %.2f | %.2f | %.2f | %.2f | %.0f | %.0f | %.0f | %.0f %% | "
	       "%.0f %% | %.1f %% | %.2f W/m2 | %.1f %% |\n",
	       r->kind->name, last.leaves, samples_median(&r->exact), ms, samples_median(&r->update),
	       samples_quantile(&r->update, .9), r->settled, samples_median(&r->choose), samples_median(&r->rows),
	       samples_median(&r->solve), samples_median(&r->light), samples_median(&r->assessed),
	       samples_median(&r->refreshed), samples_median(&r->rays), samples_median(&r->waiting),
	       100 * (double)last.stale_relative, 100 * (double)last.solve_relative, off.most, off.percent);
}

void bench_budget_head(void)
{
	printf("| scene | leaves | exact update ms | budget ms | update ms, median | 9 of 10 below | first within 1.5 "
	       "times | choose | cut to close | solve | light | rows assessed | refreshed | rays | rows that wait | "
	       "stale bound, of the largest R | solve bound | off an exact update, at most | off, RMS of B - E |\n");
	printf("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
}

void bench_budget(engine_context *context, const scene_kind *kind, float ms, uint32_t frames)
{
	static budget_run r; /* samples are large */
	r = (budget_run){.kind = kind, .gi = open_default(context, kind)};
	check(kind->create(r.gi, &r.mover));
	check(gi_commit(r.gi));
	for (uint32_t k = 0; k <= EXACT; k++) {
		const double taken = update(&r, NULL);
		if (k > 0) /* the first builds the rows */
			samples_add(&r.exact, taken);
	}
	const gi_budget budget = {.ms = ms};
	for (uint32_t k = 1; k <= frames + SETTLE; k++) {
		const double taken = update(&r, &budget);
		if (!r.settled && taken <= WITHIN * (double)ms)
			r.settled = k;
		if (k > SETTLE)
			collect(&r, taken);
	}
	print_line(&r, (double)ms);
	gi_context_destroy(r.gi);
}
