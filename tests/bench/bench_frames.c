#include "bench_frames.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SETTLE = 3 }; /* frames before those that count: pools grow */

typedef struct frame_figures {
	samples total, passes[GI_PASS_COUNT], sweeps, rays, new_share, flagged_share, waiting, stale;
} frame_figures;

static void collect(frame_figures *f, const gi_report *r)
{
	for (int k = 0; k < GI_PASS_COUNT; k++)
		samples_add(&f->passes[k], r->pass_ms[k]);
	samples_add(&f->sweeps, r->sweeps);
	samples_add(&f->rays, (double)r->rays);
	samples_add(&f->new_share, (double)r->new_entries / (double)r->entries);
	samples_add(&f->flagged_share, (double)r->flagged_entries / (double)r->entries);
	samples_add(&f->waiting, (double)r->waiting_rows / r->leaves);
	samples_add(&f->stale, (double)r->stale_bound);
}

static void print_frames(const frame_figures *f, const gi_report *r)
{
	printf("| leaves | entries per leaf | links per leaf | entries cut anew | flagged | rays | sweeps | GPU memory "
	       "|\n");
	printf("|---|---|---|---|---|---|---|---|\n");
	printf("| %u | %.1f | %.1f | %.1f %% | %.1f %% | %.0f | %.0f | %.1f MB |\n\n", r->leaves,
	       (double)r->entries / r->leaves, (double)r->links / r->leaves, 100 * samples_median(&f->new_share),
	       100 * samples_median(&f->flagged_share), samples_median(&f->rays), samples_median(&f->sweeps),
	       1e-6 * (double)r->gpu_bytes);
	printf("| pass |");
	for (int k = 0; k < GI_PASS_COUNT; k++)
		printf(" %s |", gi_pass_name((gi_pass)k));
	printf(" frame |\n|---|");
	for (int k = 0; k <= GI_PASS_COUNT; k++)
		printf("---|");
	printf("\n| median ms |");
	for (int k = 0; k < GI_PASS_COUNT; k++)
		printf(" %.2f |", samples_median(&f->passes[k]));
	printf(" %.1f |\n\n", samples_median(&f->total));
	printf("frames a second: median %.1f, best %.1f, worst %.1f\n\n", 1e3 / samples_median(&f->total),
	       1e3 / samples_quantile(&f->total, 0), 1e3 / samples_quantile(&f->total, 1));
}

/* What the budget left of the last frame, against an exact update of the same pose. */
static void print_waiting(gi_context *gi, const frame_figures *f, const gi_report *last)
{
	uint32_t count;
	gi_leaf *under = bench_leaves(gi, &count);
	bench_step(gi);
	gi_leaf *exact = bench_leaves(gi, &count);
	const bench_distance off = bench_leaves_distance(under, exact, count);
	printf("rows that wait: median %.1f %%; reported stale bound: median %.3g W/m2, of the last frame %.3g; "
	       "measured against an "
	       "exact update of it: %.3g W/m2 at most, %.2f %% of B - E (RMS); largest B %.3g\n\n",
	       100 * samples_median(&f->waiting), samples_median(&f->stale), (double)last->stale_bound, off.most,
	       off.percent, (double)last->radiosity_max);
	free(under);
	free(exact);
}

static void print_rest(gi_context *gi)
{
	bench_step(gi);
	const gi_report report = bench_step(gi);
	printf("at rest: outcome %d, %u dispatches, %llu bytes uploaded, gi_update %.3f ms\n\n", report.outcome,
	       report.dispatches, (unsigned long long)report.uploaded_bytes, (double)report.update_ms);
}

void bench_frames(const bench_run *run)
{
	engine_target *target = bench_open_target(run->size);
	gi_context *gi = bench_open(run->context, &run->settings);
	const cornell scene = bench_create(gi, run->settings.wall_levels);
	static frame_figures f;
	gi_report report = bench_step(gi);
	bench_draw(gi, target, run->size); /* shaders compile */
	for (uint32_t k = 0; k < run->frames + SETTLE; k++) {
		const double began = now_ms();
		check(gi_set_pose(gi, scene.buddha, cornell_buddha_pose((float)(k + 1) / run->fps)));
		check(gi_update(gi, &run->budget));
		bench_draw(gi, target, run->size);
		check(gi_finish(gi));
		const double ms = now_ms() - began;
		check(gi_get_report(gi, &report));
		if (k < SETTLE)
			continue;
		samples_add(&f.total, ms);
		collect(&f, &report);
	}
	printf("## Moving Buddha, %d x %d, row tolerance %g, emitter refinement %g, one ray an indirect entry\n\n",
	       run->size, run->size, (double)run->settings.row_tolerance, (double)run->settings.emitter_refinement);
	print_frames(&f, &report);
	if (report.waiting_rows)
		print_waiting(gi, &f, &report);
	print_rest(gi);
	gi_context_destroy(gi);
	engine_target_destroy(target);
}
