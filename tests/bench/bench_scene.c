#define _GNU_SOURCE /* program_invocation_short_name */
#include "bench_scene.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

bench_settings bench_settings_coarse(void)
{
	return (bench_settings){
	    .row_tolerance = 0.1f, .emitter_refinement = 4, .near_samples = 1, .pixel_lamps = 32, .wall_levels = 3};
}

bench_settings bench_settings_fine(void)
{
	const gi_context_def def = gi_context_def_default();
	return (bench_settings){.row_tolerance = def.row_tolerance,
				.emitter_refinement = def.emitter_refinement,
				.near_samples = def.near_samples,
				.pixel_lamps = def.pixel_lamps,
				.wall_levels = 3};
}

void fail(const char *what)
{
	fprintf(stderr, "%s: %s\n", program_invocation_short_name, what);
	exit(EXIT_FAILURE);
}

void check(gi_result result)
{
	if (result)
		fail(gi_result_text(result));
}

engine_context *bench_open_window(engine_context_kind kind, int size)
{
	engine_context_def def = engine_context_def_default();
	def.kind = kind;
	def.width = def.height = size;
	def.hidden = true;
	def.vsync = false;
	char message[512];
	engine_context *context = engine_context_create(&def, message, sizeof message);
	if (!context)
		fail(message);
	return context;
}

engine_target *bench_open_target(int size)
{
	char message[256];
	engine_target *target = engine_target_create(size, size, message, sizeof message);
	if (!target)
		fail(message);
	return target;
}

gi_context *bench_open(engine_context *context, const bench_settings *s)
{
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = engine_context_find_gl;
	def.get_proc_user = context;
	def.row_tolerance = s->row_tolerance;
	def.emitter_refinement = s->emitter_refinement;
	def.near_samples = s->near_samples;
	def.pixel_lamps = s->pixel_lamps;
	gi_context *gi;
	check(gi_context_create(&def, &gi));
	return gi;
}

cornell bench_create(gi_context *gi, uint32_t wall_levels)
{
	cornell_def def = cornell_def_default();
	def.wall_levels = wall_levels;
	cornell scene;
	check(cornell_create(gi, &def, &scene));
	check(gi_commit(gi));
	return scene;
}

gi_report bench_step(gi_context *gi)
{
	gi_report report;
	check(gi_update(gi, NULL));
	check(gi_finish(gi));
	check(gi_get_report(gi, &report));
	return report;
}

void bench_draw(gi_context *gi, engine_target *target, int size)
{
	gi_view view = gi_view_default();
	view.width = view.height = (uint32_t)size;
	cornell_camera(1, view.view_from_world, view.clip_from_view);
	engine_target_begin(target);
	check(gi_draw(gi, &view));
	engine_target_tonemap(target, 0.35f);
}
