#define _POSIX_C_SOURCE 200809L
#include "player_internal.h"

#include "hdr.h"
#include "interrupt.h"
#include "figures.h"
#include "wall_clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- messages ------------------------------------------------------------------------------------------------------
 */

/* The library's line says more than its result: the first error is kept, warnings are shown at once. */
static void on_message(gi_result result, const char *message, void *user)
{
	player *p = user;
	if (result == GI_OK)
		options_say(p->o->program, "%s", message);
	else if (!p->message[0])
		snprintf(p->message, sizeof p->message, "%s", message);
}

static void on_progress(const char *what, uint32_t done, uint32_t total, void *user)
{
	player *p = user;
	progress_show(&p->progress, what, done, total);
}

/* ---- begin ---------------------------------------------------------------------------------------------------------
 */

static bool open_context(player *p)
{
	engine_context_def def = engine_context_def_default();
	def.kind = p->o->context;
	def.width = p->o->width;
	def.height = p->o->height;
	def.title = p->scene->title;
	p->context = engine_context_create(&def, p->message, sizeof p->message);
	return p->context != NULL;
}

/* Pictures that are kept are told from what they are off by; 64 leaves are little beside an update, and their noise
 * averages out over frames. */
static uint32_t estimate_leaves(const player *p)
{
	if (p->o->estimate_given)
		return p->o->estimate;
	if (!p->recording || !(p->o->images || p->scene->gallery))
		return 0;
	return p->frames < 4 ? 256 : 64;
}

static bool has_own_sky(const player *p)
{
	return p->scene->sky && !p->o->sky_given;
}

static bool open_gi(player *p)
{
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = engine_context_find_gl;
	def.get_proc_user = p->context;
	def.message = on_message;
	def.progress = on_progress;
	def.user = p;
	if (p->o->row_tolerance > 0)
		def.row_tolerance = p->o->row_tolerance;
	if (p->o->solve_tolerance > 0)
		def.solve_tolerance = p->o->solve_tolerance;
	def.shader_directory = p->o->shaders;
	def.pixel_lamps = p->o->pixel_lamps;
	if (p->o->photons_given)
		def.caustic_photons = p->o->photons;
	def.fine_shadows = p->o->fine_shadows;
	if (p->o->shadow_map)
		def.shadow_map_size = p->o->shadow_map;
	def.estimate_leaves = estimate_leaves(p);
	for (int c = 0; c < 3 && p->o->sky > 0; c++) {
		def.sky = GI_SKY_ON;
		def.sky_exitance[c] = p->o->sky;
	}
	if (p->o->sky_file || has_own_sky(p))
		def.sky = GI_SKY_ON;
	return player_succeeded(p, gi_context_create(&def, &p->gi));
}

static bool show_sky(player *p, const float *rgb, int width, int height)
{
	p->backdrop = engine_backdrop_create(rgb, width, height, p->message, sizeof p->message);
	return p->backdrop &&
	       player_succeeded(p, gi_set_sky_image(p->gi, rgb, (uint32_t)width, (uint32_t)height, NULL));
}

static bool open_sky(player *p)
{
	if (has_own_sky(p))
		return show_sky(p, p->scene->sky, (int)p->scene->sky_width, (int)p->scene->sky_height);
	if (!p->o->sky_file)
		return true;
	int width, height;
	size_t mended;
	float *rgb;
	if (!engine_panorama_read(p->o->sky_file, &width, &height, &rgb, &mended, p->message, sizeof p->message))
		return false;
	if (mended)
		options_say(p->o->program, "%s: %zu pixels are no radiance of 0 to 3e11 and are taken as the nearest",
			    p->o->sky_file, mended);
	const bool opened = show_sky(p, rgb, width, height);
	free(rgb);
	return opened;
}

static bool open_picture(player *p)
{
	p->target = engine_target_create(p->o->width, p->o->height, p->message, sizeof p->message);
	const size_t values = 3 * (size_t)p->o->width * (size_t)p->o->height;
	p->pixels = malloc(values);
	p->radiance = p->o->linear ? malloc(values * sizeof *p->radiance) : NULL;
	const bool has_memory = p->pixels && (p->radiance || !p->o->linear);
	if (p->target && !has_memory)
		snprintf(p->message, sizeof p->message, "out of memory for a picture");
	if (p->target && has_memory && engine_context_has_window(p->context))
		p->hud = engine_hud_create(p->message, sizeof p->message);
	return p->target && has_memory && (p->hud || !engine_context_has_window(p->context));
}

static void choose_frames(player *p)
{
	const bool window = engine_context_has_window(p->context);
	p->recording = p->o->frames > 0 || !window;
	p->frames = p->o->frames ? p->o->frames : window ? 0 : p->scene->frames;
}

static bool begin(player *p)
{
	if (!player_check_files(p))
		return false;
	progress_show(&p->progress, "opening a context", 0, 0);
	if (!open_context(p))
		return false;
	p->message[0] = '\0'; /* "auto" may have tried a kind in vain */
	if (!open_picture(p))
		return false;
	p->progress.context = p->context;
	p->progress.hud = p->hud;
	choose_frames(p);
	if (!open_gi(p) || !open_sky(p))
		return false;
	if (!p->scene->create(p->scene->user, p->gi, p->message, sizeof p->message) ||
	    !player_succeeded(p, gi_commit(p->gi)))
		return false;
	p->last_clock_ms = wall_clock_ms();
	return player_budget_open(p) && player_open_files(p);
}

static void end(player *p)
{
	char unused[PLAYER_MESSAGE];
	video_close(&p->video, false, unused, sizeof unused);
	report_free(&p->report);
	gi_context_destroy(p->gi);
	engine_backdrop_destroy(p->backdrop);
	engine_hud_destroy(p->hud);
	engine_target_destroy(p->target);
	engine_context_destroy(p->context);
	free(p->pixels);
	free(p->radiance);
	free(p->poses);
}

/* ---- frame ---------------------------------------------------------------------------------------------------------
 */

/* Files need the light of this frame, a window is content with the newest. */
static bool waits(const player *p)
{
	return p->recording || player_wants_picture(p) || p->o->report || p->o->field;
}

static bool light(player *p)
{
	if (!player_succeeded(p, p->scene->animate(p->scene->user, p->gi, p->time_s)))
		return false;
	if (p->rebuild) {
		gi_invalidate(p->gi);
		gi_reset_radiosity(p->gi);
	}
	gi_budget budget = player_budget_next(p);
	const gi_view view = player_view(p);
	budget.view = &view;
	return player_succeeded(p, gi_update(p->gi, &budget)) && (!waits(p) || player_succeeded(p, gi_finish(p->gi)));
}

static void show(player *p, const gi_report *report)
{
	char setting[128];
	const figures shown = {.title = p->scene->title,
			       .renderer = engine_context_describe(p->context),
			       .report = *report,
			       .mode = p->mode,
			       .layer = p->layer,
			       .setting = player_setting_text(p, setting, sizeof setting),
			       .fps = p->interval_ms > 0 ? 1e3 / p->interval_ms : 0,
			       .update_ms = p->update_ms,
			       .frame_ms = p->frame_ms,
			       .budget_ms = (double)p->budget.ms,
			       .target_fps = p->rate.target_ms > 0 ? 1e3 / p->rate.target_ms : 0,
			       .paused = p->paused,
			       .rebuild = p->rebuild,
			       .help = p->help,
			       .can_move = p->scene->move != NULL,
			       .has_receivers = p->scene->receiver_radius > 0,
			       .keys = p->scene->keys,
			       .key_count = p->scene->key_count};
	figures_text(p->hud, &shown, engine_target_height(p->target));
	engine_hud_draw(p->hud, engine_target_width(p->target), engine_target_height(p->target));
	engine_target_present(p->target, engine_context_width(p->context), engine_context_height(p->context));
	engine_context_swap(p->context);
}

/* A window that plays decides the size of the picture; recorded ones keep what was asked for. */
static bool fit_window(player *p)
{
	const int width = engine_context_width(p->context), height = engine_context_height(p->context);
	if (p->recording || p->o->images || p->o->linear || p->o->video || width < 1 || height < 1)
		return true;
	return engine_target_resize(p->target, width, height, p->message, sizeof p->message);
}

/* The picture of a frame nobody sees is not drawn, unless its time is part of the report. */
static bool is_seen(const player *p)
{
	return p->hud || player_wants_picture(p) || p->scene->gallery;
}

static bool draw(player *p, double began, gi_report *report)
{
	if (is_seen(p) && (!fit_window(p) || !player_draw(p, p->mode)))
		return false;
	if (waits(p) && is_seen(p) && !player_succeeded(p, gi_finish(p->gi)))
		return false;
	p->frame_ms = wall_clock_ms() - began;
	return player_succeeded(p, gi_get_report(p->gi, report));
}

static bool record(player *p, const gi_report *report)
{
	if (waits(p) && report->outcome < 0) {
		p->failed_frames++;
		p->failure = report->outcome;
	}
	const report_frame frame = {.number = p->frame,
				    .time_s = p->time_s,
				    .update_ms = p->update_ms,
				    .frame_ms = p->frame_ms,
				    .budget_ms = (double)p->budget.ms,
				    .shown_ms = p->shown_ms,
				    .gi = *report};
	return !waits(p) || report_add(&p->report, &frame, p->message, sizeof p->message);
}

static void show_progress(const player *p, const gi_report *r)
{
	if (!p->frames || !isatty(STDERR_FILENO))
		return;
	fprintf(stderr, "\rframe %u of %u  %.0f ms, %.1f %% of %llu entries dirty, %u sweeps \033[K", p->frame + 1,
		p->frames, p->frame_ms, r->entries ? 100 * (double)r->dirty_entries / (double)r->entries : 0,
		(unsigned long long)r->entries, r->sweeps);
	if (p->frame + 1 == p->frames)
		fputs("\r\033[K", stderr);
	fflush(stderr);
}

static bool play_frame(player *p)
{
	player_input(p);
	if (p->recording)
		p->time_s = p->frame / p->o->fps;
	if (!p->camera_taken)
		p->scene->view(p->scene->user, p->time_s, &p->camera);
	const double began = wall_clock_ms();
	if (!light(p))
		return false;
	p->update_ms = wall_clock_ms() - began;
	if (p->frame == 0)
		player_choose_exposure(p);
	if (p->frame == 0)
		progress_show(&p->progress, "first picture", 0, 0);
	const double drawing = wall_clock_ms();
	gi_report report;
	if (!draw(p, drawing - p->update_ms, &report))
		return false;
	progress_end(&p->progress); /* shaders for what is wanted later are compiled later */
	if (p->frame == 0)
		p->report.start_ms = wall_clock_ms() - p->o->began_ms;
	if (!player_write_frame(p))
		return false;
	if (p->hud)
		show(p, &report);
	p->shown_ms = p->recording ? p->frame_ms : wall_clock_ms() - began;
	player_budget_note(p, &report);
	if (!record(p, &report))
		return false;
	show_progress(p, &report);
	p->frame++;
	return true;
}

/* What was put off is made good, then a frame moves on as all before did and nothing is put off. */
static bool measure_exact_frame(player *p)
{
	for (int k = 0; k < 2; k++) {
		p->time_s += 1 / p->o->fps;
		const double began = wall_clock_ms();
		if (!player_succeeded(p, p->scene->animate(p->scene->user, p->gi, p->time_s)) ||
		    !player_succeeded(p, gi_update(p->gi, NULL)) || !player_draw(p, p->mode) ||
		    !player_succeeded(p, gi_finish(p->gi)))
			return false;
		p->exact_ms = wall_clock_ms() - began;
	}
	return true;
}

static bool play(player *p)
{
	while ((!p->frames || p->frame < p->frames) && !engine_context_should_close(p->context)) {
		if (interrupt_came()) {
			snprintf(p->message, sizeof p->message, "stopped after %u frames", p->frame);
			return false;
		}
		if (!play_frame(p))
			return false;
	}
	if (p->recording && p->scene->exact_frame && p->budget.ms > 0 && !measure_exact_frame(p))
		return false;
	return player_close_files(p);
}

static void warn_of_error(const player *p)
{
	static const double MUCH = 10;
	const double percent = report_estimate_percent(&p->report);
	if (percent > MUCH)
		options_say(
		    p->o->program,
		    "the light is off by %.0f %% of its mean, as estimated: a smaller --row-tolerance or --leaf-size "
		    "lowers that",
		    percent);
}

int player_run(const options *o, const player_scene *scene)
{
	player *p = calloc(1, sizeof *p);
	if (!p) {
		options_say(o->program, "out of memory");
		return EXIT_FAILURE;
	}
	p->o = o;
	p->scene = scene;
	p->mode = o->mode;
	p->layer = o->overlay;
	p->leaf = p->depth = o->overlay_number;
	p->rebuild = o->rebuild;
	p->progress.program = o->program;
	interrupt_begin(o->program);
	const bool played = begin(p) && play(p);
	progress_end(&p->progress);
	if (played)
		player_print_end(p);
	else {
		if (p->frame && isatty(STDERR_FILENO))
			fputc('\n', stderr);
		options_say(o->program, "%s", p->message);
	}
	if (played)
		warn_of_error(p);
	const bool sound = p->failed_frames == 0;
	if (played && !sound)
		options_say(o->program, "the light of %u of %u frames is wrong: %s", p->failed_frames, p->frame,
			    report_outcome_name(p->failure));
	report_abandon(&p->report);
	interrupt_end(); /* files are whole; the context takes its time to go */
	end(p);
	free(p);
	return played && sound ? EXIT_SUCCESS : EXIT_FAILURE;
}
