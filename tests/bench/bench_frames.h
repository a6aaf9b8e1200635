/* Frames of the moving Buddha, measured and printed as Markdown. */
#ifndef TESTS_BENCH_BENCH_FRAMES_H
#define TESTS_BENCH_BENCH_FRAMES_H

#include "bench_leaves.h"
#include "bench_scene.h"
#include "scenes/scenes.h"

typedef struct bench_run {
	engine_context *context;
	bench_settings settings;
	uint32_t frames;
	int size;
	float fps;        /* of the animation */
	gi_budget budget; /* of every update */
} bench_run;

/* Every pass of a frame, what an update does, the scene at rest; with a budget also what waits and how wrong that is.
 */
void bench_frames(const bench_run *run);

/* A line of a table for each call: every update gets the time that keeps run->fps frames a second, the animation goes
 * on by as much. run->budget is not looked at. */
void bench_rate_head(void);
void bench_rate(const bench_run *run);

/* A line of a table for each call: the scene at the library's defaults, moving, every update given so many
 * milliseconds; after it is known what things take, and without a picture. */
void bench_budget_head(void);
void bench_budget(engine_context *context, const scene_kind *kind, float ms, uint32_t frames);

#endif
