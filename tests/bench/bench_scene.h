/* The moving Buddha as the benchmarks measure it: contexts, updates that are waited for, the picture.
 *
 * scripts/bench against COMMIT compiles this against that commit's library and scenes too: it uses nothing of gi.h that
 * it can do without.
 */
#ifndef TESTS_BENCH_BENCH_SCENE_H
#define TESTS_BENCH_BENCH_SCENE_H

#include "context.h"
#include "gi/gi.h"
#include "samples.h"
#include "scenes/cornell.h"
#include "tonemap.h"

#include <stdbool.h>
#include <stdint.h>

/* How fine. */
typedef struct bench_settings {
	float row_tolerance;
	float emitter_refinement;
	uint32_t near_samples;
	uint32_t pixel_lamps;
	uint32_t wall_levels; /* of the scene: 3 are 4,124 leaves in all */
} bench_settings;

/* What the frame rates are measured with: row tolerance 0.1, emitters four times finer, one ray an indirect entry. */
bench_settings bench_settings_coarse(void);

/* The library's defaults. */
bench_settings bench_settings_fine(void);

/* Ends the program with one line on stderr, check() unless the result is GI_OK. */
#if defined(__GNUC__)
__attribute__((noreturn))
#endif
void fail(const char *what);
void check(gi_result result);

/* A window is hidden. */
engine_context *bench_open_window(engine_context_kind kind, int size);
engine_target *bench_open_target(int size);

gi_context *bench_open(engine_context *context, const bench_settings *s);

/* Creates the objects and commits. */
cornell bench_create(gi_context *gi, uint32_t wall_levels);

/* An exact update, waited for. */
gi_report bench_step(gi_context *gi);

/* Issues the picture: the box as the demo shows it, size x size pixels, tone-mapped. */
void bench_draw(gi_context *gi, engine_target *target, int size);

#endif
