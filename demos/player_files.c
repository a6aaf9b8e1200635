#define _POSIX_C_SOURCE 200809L
#include "player_internal.h"

#include "image.h"
#include "output.h"
#include "pfm.h"
#include "video.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- places --------------------------------------------------------------------------------------------------------
 */

static bool make_folders(player *p, const char *path)
{
	char part[PLAYER_PATH];
	if (strlen(path) >= sizeof part) {
		snprintf(p->message, sizeof p->message, "the name of the folder %.60s... is too long", path);
		return false;
	}
	strcpy(part, path);
	for (char *c = part + 1;; c++) {
		if (*c && *c != '/')
			continue;
		const char kept = *c;
		*c = '\0';
		if (mkdir(part, 0777) != 0 && errno != EEXIST) {
			snprintf(p->message, sizeof p->message, "cannot make the folder %s: %s", part, strerror(errno));
			return false;
		}
		*c = kept;
		if (!kept)
			return true;
	}
}

static bool name_frame(player *p, const char *pattern, uint32_t frame, char name[PLAYER_PATH])
{
	if (engine_frame_pattern_name(pattern, (int)frame, name, PLAYER_PATH))
		return true;
	snprintf(p->message, sizeof p->message, "the name of a frame is too long: %.200s", pattern);
	return false;
}

/* A name that one of the frames will have. */
static bool can_write_frame(player *p, const char *pattern, uint32_t frame)
{
	char name[PLAYER_PATH];
	return name_frame(p, pattern, frame, name) && engine_output_check(name, p->message, sizeof p->message);
}

/* The first and the last of so many frames, whose name may be longer. */
static bool can_write_frames(player *p, const char *pattern)
{
	return !pattern ||
	       (can_write_frame(p, pattern, 0) && (p->o->frames < 2 || can_write_frame(p, pattern, p->o->frames - 1)));
}

static bool can_write(player *p, const char *name)
{
	return !name || engine_output_check(name, p->message, sizeof p->message);
}

/* Pictures that have no name of their own. */
static bool can_write_in(player *p, const char *folder)
{
	char name[PLAYER_PATH];
	const int length = snprintf(name, sizeof name, "%s/frame_0000_global.png", folder);
	if (length < (int)sizeof name)
		return can_write(p, name);
	snprintf(p->message, sizeof p->message, "the name of the folder %.200s is too long", folder);
	return false;
}

bool player_check_files(player *p)
{
	const options *o = p->o;
	return can_write_frames(p, o->images) && can_write_frames(p, o->linear) && can_write_frames(p, o->field) &&
	       can_write(p, o->form_factors) && can_write(p, o->report) && can_write(p, o->video) &&
	       (!o->video || video_check(p->message, sizeof p->message));
}

static bool uses_out(const player *p)
{
	return (p->scene->gallery && !p->o->images && p->recording) ||
	       (p->scene->report && !p->o->report && p->recording);
}

/* The report's own name, or one in the folder of the run, or none. */
static const char *report_name(player *p)
{
	if (p->o->report || !p->scene->report || !p->recording)
		return p->o->report;
	const int length = snprintf(p->report_path, sizeof p->report_path, "%s/%s", p->o->out, p->scene->report);
	return length < (int)sizeof p->report_path ? p->report_path : NULL;
}

bool player_open_files(player *p)
{
	if (uses_out(p) && (!make_folders(p, p->o->out) || !can_write_in(p, p->o->out)))
		return false;
	if (p->o->video &&
	    !video_open(&p->video, p->o->video, p->o->width, p->o->height, p->o->fps, p->message, sizeof p->message))
		return false;
	return report_open(&p->report, report_name(p), p->message, sizeof p->message);
}

/* ---- frames --------------------------------------------------------------------------------------------------------
 */

static bool is_gallery_frame(const player *p)
{
	return p->scene->gallery && !p->o->images && p->recording && p->frame % PLAYER_GALLERY_STEP == 0;
}

bool player_wants_picture(const player *p)
{
	return p->o->images || p->o->linear || p->o->video || is_gallery_frame(p);
}

/* The picture that was read. */
static bool write_picture(player *p, const char *name)
{
	if (!engine_image_write_png(name, engine_target_width(p->target), engine_target_height(p->target), p->pixels,
				    p->message, sizeof p->message))
		return false;
	p->pictures++;
	return true;
}

/* One frame in all three modes, as figure 4 of Song et al. (README) compares them; the player's own mode last, for the
 * window. */
static bool write_gallery(player *p)
{
	bool written = true;
	for (int k = 1; written && k <= 3; k++) {
		const gi_mode mode = (gi_mode)(((int)p->mode + k) % 3);
		char name[PLAYER_PATH];
		const int length =
		    snprintf(name, sizeof name, "%s/frame_%04u_%s.png", p->o->out, p->frame, options_mode_name(mode));
		if (length >= (int)sizeof name) {
			snprintf(p->message, sizeof p->message, "the name of the folder %.200s is too long", p->o->out);
			return false;
		}
		written = player_draw(p, mode);
		if (written)
			engine_target_read(p->target, p->pixels);
		written = written && write_picture(p, name);
	}
	return written;
}

/* Of the player's own mode, which is drawn last. */
static bool write_linear(player *p)
{
	char name[PLAYER_PATH];
	if (!name_frame(p, p->o->linear, p->frame, name))
		return false;
	engine_target_read_radiance(p->target, p->radiance);
	return engine_pfm_write(name, engine_target_width(p->target), engine_target_height(p->target), p->radiance,
				p->message, sizeof p->message);
}

static bool write_field(player *p)
{
	char name[PLAYER_PATH];
	const export_objects objects = p->scene->objects(p->scene->user);
	return name_frame(p, p->o->field, p->frame, name) &&
	       export_field(p->gi, &objects, name, p->message, sizeof p->message);
}

bool player_write_frame(player *p)
{
	char name[PLAYER_PATH];
	bool written = true;
	if (is_gallery_frame(p))
		written = write_gallery(p); /* its last picture is the frame's own */
	else if (p->o->images || p->o->video)
		engine_target_read(p->target, p->pixels);
	if (p->o->images)
		written = name_frame(p, p->o->images, p->frame, name) && write_picture(p, name);
	if (written && p->o->linear)
		written = write_linear(p);
	if (written && p->o->field)
		written = write_field(p);
	if (written && p->o->video)
		written = video_write(&p->video, p->pixels, p->message, sizeof p->message);
	return written;
}

/* ---- end -----------------------------------------------------------------------------------------------------------
 */

bool player_close_files(player *p)
{
	bool written = report_close(&p->report, p->message, sizeof p->message) &&
		       video_close(&p->video, true, p->message, sizeof p->message);
	if (written && p->o->form_factors) {
		const export_objects objects = p->scene->objects(p->scene->user);
		written = export_form_factors(p->gi, &objects, p->o->form_factors, p->message, sizeof p->message);
	}
	return written;
}

static void print_place(const char *what, const char *where, const char *more)
{
	char line[PLAYER_PATH + 128];
	snprintf(line, sizeof line, "  %-22s %s%s", what, where, more);
	engine_output_one_line(line);
	puts(line);
}

void player_print_end(const player *p)
{
	char more[64];
	char title[256];
	snprintf(title, sizeof title, "%s", p->scene->title);
	engine_output_one_line(title);
	printf("%s: %u frames of %d x %d, %s\n", title, p->frame, p->o->width, p->o->height,
	       engine_context_describe(p->context));
	report_print(&p->report, stdout);
	if (p->exact_ms > 0)
		printf("  an exact frame, ms     %12.1f\n", p->exact_ms);
	snprintf(more, sizeof more, " (%u)", p->pictures);
	if (p->o->images && p->pictures)
		print_place("pictures", p->o->images, more);
	else if (p->pictures) {
		snprintf(more, sizeof more, "/frame_*.png (%u: direct, indirect, global)", p->pictures);
		print_place("pictures", p->o->out, more);
	}
	if (p->o->linear)
		print_place("linear pictures", p->o->linear, "");
	if (p->o->video)
		print_place("film", p->o->video, "");
	if (p->o->field)
		print_place("fields", p->o->field, "");
	if (p->o->form_factors)
		print_place("form factors", p->o->form_factors, "");
	if (p->report.path)
		print_place("report", p->report.path, "");
}
