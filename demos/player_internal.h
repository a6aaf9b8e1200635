/* What the parts of the player share. */
#ifndef DEMOS_PLAYER_INTERNAL_H
#define DEMOS_PLAYER_INTERNAL_H

#include "backdrop.h"
#include "frame_budget.h"
#include "hud.h"
#include "player.h"
#include "progress.h"
#include "report.h"
#include "tonemap.h"
#include "video.h"

enum { PLAYER_MESSAGE = 1024, PLAYER_PATH = 4096, PLAYER_GALLERY_STEP = 8 };

/* What keys make larger and smaller. */
typedef enum player_setting {
	PLAYER_SETTING_ROW_TOLERANCE,
	PLAYER_SETTING_SOLVE_TOLERANCE,
	PLAYER_SETTING_RATE,
	PLAYER_SETTING_LAMPS,
	PLAYER_SETTING_COUNT
} player_setting;

typedef struct player {
	const options *o;
	const player_scene *scene;

	engine_context *context;
	engine_target *target;
	engine_hud *hud; /* NULL without a window */
	gi_context *gi;
	engine_backdrop *backdrop; /* a picture of the sky; NULL: none */
	uint8_t *pixels;           /* of a picture on its way to a file */
	float *radiance;           /* the same of a linear one; NULL: none is written */
	progress progress;         /* until the first picture */

	bool recording;
	uint32_t frames; /* 0: endless */
	uint32_t frame;
	double time_s;

	camera camera;
	bool camera_taken; /* by the user */
	gi_mode mode;
	gi_overlay layer;
	float cursor[2];      /* pixels from the window's top left corner */
	uint32_t leaf, depth; /* of overlays: gi_view.overlay_leaf, overlay_depth */
	player_setting setting;
	int lamp_steps; /* what shines is brighter by so many steps than the scene has it */
	bool paused, rebuild, help;
	float exposure;

	gi_budget budget;  /* of the newest update */
	frame_budget rate; /* where budgets keep a frame rate */
	gi_pose *poses;    /* of the scene's objects in the frame before */
	uint32_t pose_count;

	double update_ms, frame_ms;
	double exact_ms;    /* a frame without a budget, after a recording under one; 0: not measured */
	double shown_ms;    /* the whole frame, until it was shown; of a recorded one frame_ms */
	double interval_ms; /* from frame to frame, smoothed; 0: not known yet */
	double last_clock_ms;
	video video;
	report report;
	char report_path[PLAYER_PATH];
	uint32_t pictures;
	uint32_t failed_frames; /* recorded ones without light to rely on */
	gi_outcome failure;     /* of the last of them */

	char message[PLAYER_MESSAGE]; /* why a step failed; "" so far */
} player;

/* After the scene was created. False with p->message when memory is short. */
bool player_budget_open(player *p);

/* The budget of the update about to be made, after the poses were set. */
gi_budget player_budget_next(player *p);

/* After the frame was shown. */
void player_budget_note(player *p, const gi_report *report);

/* Keys and mouse since the last frame. */
void player_input(player *p);

/* Takes the setting in force a step up or down. */
gi_result player_setting_turn(player *p, int step);

/* Its name, value and place in its range, for the screen. Returns text. */
const char *player_setting_text(const player *p, char *text, size_t size);

/* Can the files be written that were asked for? First of all, before scenes are built. */
bool player_check_files(player *p);

/* Makes the folders that files go to, and begins the report. */
bool player_open_files(player *p);

/* Whether this frame's picture goes to a file. */
bool player_wants_picture(const player *p);

/* Of a call of the library: the line that it told is p->message, else its result is. */
bool player_succeeded(player *p, gi_result result);

/* Draws the scene in a mode into the target's picture. */
gi_view player_view(const player *p); /* what the camera sees */
bool player_draw(player *p, gi_mode mode);

/* As asked for, or from the light of the first frame. */
void player_choose_exposure(player *p);

/* Writes the pictures and the field of this frame; the picture of the player's mode is in the target. */
bool player_write_frame(player *p);

/* After the last frame: form factors, the end of the report. */
bool player_close_files(player *p);

/* Where everything lies, and the table of the run. */
void player_print_end(const player *p);

#endif
