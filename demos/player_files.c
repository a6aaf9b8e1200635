#define _POSIX_C_SOURCE 200809L
#include "player_internal.h"

#include "image.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

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

/* The folder that a file will go to must be there before an hour of frames is. */
static bool can_write_beside(player *p, const char *name)
{
	char folder[PLAYER_PATH] = ".";
	const char *slash = name ? strrchr(name, '/') : NULL;
	if (!name || (slash && (size_t)(slash - name) + 2 > sizeof folder))
		return true;
	if (slash)
		snprintf(folder, sizeof folder, "%.*s", (int)(slash - name) + 1, name);
	struct stat status;
	if (stat(folder, &status) == 0 && !S_ISDIR(status.st_mode))
		errno = ENOTDIR;
	else if (access(folder, W_OK | X_OK) == 0)
		return true;
	snprintf(p->message, sizeof p->message, "cannot write %s: %s", name, strerror(errno));
	return false;
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
	const options *o = p->o;
	if (!can_write_beside(p, o->images) || !can_write_beside(p, o->field) ||
	    !can_write_beside(p, o->form_factors) || !can_write_beside(p, o->report))
		return false;
	if (uses_out(p) && !make_folders(p, o->out))
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
	return p->o->images || is_gallery_frame(p);
}

static bool name_frame(player *p, const char *pattern, char name[PLAYER_PATH])
{
	if (engine_frame_pattern_name(pattern, (int)p->frame, name, PLAYER_PATH))
		return true;
	snprintf(p->message, sizeof p->message, "the name of a frame is too long: %.200s", pattern);
	return false;
}

static bool write_picture(player *p, const char *name)
{
	engine_target_read(p->target, p->pixels);
	if (!engine_image_write_png(name, engine_target_width(p->target), engine_target_height(p->target), p->pixels,
				    p->message, sizeof p->message))
		return false;
	p->pictures++;
	return true;
}

/* One frame in all three modes, as the paper's figure 4 compares them; the player's own mode last, for the window. */
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
		written = player_draw(p, mode) && write_picture(p, name);
	}
	return written;
}

static bool write_field(player *p)
{
	char name[PLAYER_PATH];
	const export_objects objects = p->scene->objects(p->scene->user);
	return name_frame(p, p->o->field, name) && export_field(p->gi, &objects, name, p->message, sizeof p->message);
}

bool player_write_frame(player *p)
{
	char name[PLAYER_PATH];
	bool written = true;
	if (p->o->images)
		written = name_frame(p, p->o->images, name) && write_picture(p, name);
	else if (is_gallery_frame(p))
		written = write_gallery(p);
	if (written && p->o->field)
		written = write_field(p);
	return written;
}

/* ---- end -----------------------------------------------------------------------------------------------------------
 */

bool player_close_files(player *p)
{
	bool written = report_close(&p->report, p->message, sizeof p->message);
	if (written && p->o->form_factors) {
		const export_objects objects = p->scene->objects(p->scene->user);
		written = export_form_factors(p->gi, &objects, p->o->form_factors, p->message, sizeof p->message);
	}
	return written;
}

static void print_place(const char *what, const char *where, const char *more)
{
	fprintf(stdout, "  %-22s %s%s\n", what, where, more);
}

void player_print_end(const player *p)
{
	char more[64];
	printf("%s: %u frames of %d x %d, %s\n", p->scene->title, p->frame, p->o->width, p->o->height,
	       engine_context_describe(p->context));
	report_print(&p->report, stdout);
	snprintf(more, sizeof more, " (%u)", p->pictures);
	if (p->o->images && p->pictures)
		print_place("pictures", p->o->images, more);
	else if (p->pictures) {
		snprintf(more, sizeof more, "/frame_*.png (%u: direct, indirect, global)", p->pictures);
		print_place("pictures", p->o->out, more);
	}
	if (p->o->field)
		print_place("fields", p->o->field, "");
	if (p->o->form_factors)
		print_place("form factors", p->o->form_factors, "");
	if (p->report.path)
		print_place("report", p->report.path, "");
}
