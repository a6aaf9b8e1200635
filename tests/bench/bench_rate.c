#include "bench_frames.h"
#include "frame_budget.h"

#include <stdio.h>
#include <stdlib.h>

/* Frames until the budget knows what drawing takes, and how many poses are compared with an exact update of them. */
enum { SETTLE = 20, COMPARED = 5 };

typedef struct rate_run {
	const bench_run *run;
	engine_target *target;
	frame_budget budget;
	gi_context *gi, *twin; /* the twin's updates are exact */
	cornell scene, twin_scene;
	gi_report report;
	samples asked, update, frame, waiting, stale, most, percent;
} rate_run;

/* Returns what it took, ms. */
static double frame(rate_run *r, gi_pose pose)
{
	const double began = now_ms();
	const gi_budget budget = frame_budget_next(&r->budget, true, began);
	check(gi_set_pose(r->gi, r->scene.buddha, pose));
	check(gi_update(r->gi, &budget));
	bench_draw(r->gi, r->target, r->run->size);
	check(gi_finish(r->gi));
	const double ms = now_ms() - began;
	check(gi_get_report(r->gi, &r->report));
	frame_budget_note(&r->budget, ms, &r->report);
	return ms;
}

static void collect(rate_run *r, double ms)
{
	samples_add(&r->asked, r->budget.asked_ms);
	samples_add(&r->update, frame_budget_update_ms(&r->report));
	samples_add(&r->frame, ms);
	samples_add(&r->waiting, 100.0 * (double)r->report.waiting_rows / r->report.leaves);
	samples_add(&r->stale, (double)r->report.stale_bound);
}

static void compare(rate_run *r, gi_pose pose)
{
	uint32_t count;
	check(gi_set_pose(r->twin, r->twin_scene.buddha, pose));
	bench_step(r->twin);
	gi_leaf *leaves = bench_leaves(r->gi, &count), *exact = bench_leaves(r->twin, &count);
	const bench_distance off = bench_leaves_distance(leaves, exact, count);
	samples_add(&r->most, off.most);
	samples_add(&r->percent, off.percent);
	free(leaves);
	free(exact);
}

void bench_rate_head(void)
{
	printf("| leaves | frames a second asked for | reached, median | worst | budget ms | update ms | frame ms | "
	       "rows that wait | stale bound reported, W/m2 | off an exact update, at most, W/m2 | off, RMS of B - E "
	       "|\n");
	printf("|---|---|---|---|---|---|---|---|---|---|---|\n");
}

static void print_line(const rate_run *r)
{
	printf("| %u | %g | %.1f | %.1f | %.1f | %.1f | %.1f | %.0f %% | %.3g | %.2g | %.1f %% |\n", r->report.leaves,
	       (double)r->run->fps, 1e3 / samples_median(&r->frame), 1e3 / samples_quantile(&r->frame, 1),
	       samples_median(&r->asked), samples_median(&r->update), samples_median(&r->frame),
	       samples_median(&r->waiting), samples_median(&r->stale), samples_quantile(&r->most, 1),
	       samples_median(&r->percent));
}

static gi_context *open_exact(const bench_run *run, cornell *scene)
{
	gi_context *gi = bench_open(run->context, &run->settings);
	*scene = bench_create(gi, run->settings.wall_levels);
	bench_step(gi);
	return gi;
}

void bench_rate(const bench_run *run)
{
	static rate_run r; /* samples are large */
	r = (rate_run){
	    .run = run, .target = bench_open_target(run->size), .budget = frame_budget_make((double)run->fps)};
	r.gi = open_exact(run, &r.scene);
	r.twin = open_exact(run, &r.twin_scene);
	const uint32_t every = (run->frames + COMPARED - 1) / COMPARED;
	for (uint32_t k = 0; k < run->frames + SETTLE; k++) {
		const gi_pose pose = cornell_buddha_pose((float)(k + 1) / run->fps);
		const double ms = frame(&r, pose);
		if (k < SETTLE)
			continue;
		collect(&r, ms);
		if ((k - SETTLE) % every == every - 1)
			compare(&r, pose);
	}
	print_line(&r);
	gi_context_destroy(r.gi);
	gi_context_destroy(r.twin);
	engine_target_destroy(r.target);
}
