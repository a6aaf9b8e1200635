/* Plays a scene: opens a context, creates the objects, and then frame by frame poses, light, picture, files.
 *
 * Recorded (--frames given, or no window): time goes on by 1/fps a frame, every frame waits for its GPU, so that each
 * line of the report is about its own frame. Played in a window without --frames: time is the clock's, nothing
 * waits for the GPU, and a budget for every update keeps the frame rate (frame_budget.h).
 */
#ifndef DEMOS_PLAYER_H
#define DEMOS_PLAYER_H

#include "camera.h"
#include "export.h"
#include "options.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct player_scene {
	void *user; /* handed to the functions */
	const char *title;

	/* Creates the objects; the player commits. False with one line in message. */
	bool (*create)(void *user, gi_context *gi, char *message, size_t message_size);
	/* Sets the poses of that time. */
	gi_result (*animate)(void *user, gi_context *gi, double time_s);
	/* The scene's own camera, asked every frame until the user takes it over. */
	void (*view)(void *user, double time_s, camera *out);
	/* The user pushes what can be pushed over the floor, metres; NULL: nothing can. */
	void (*move)(void *user, float x, float z);
	/* The user takes hold of what is seen in that direction, to be moved from now on; NULL: there is but one. */
	void (*grab)(void *user, const float eye[3], const float direction[3]);
	/* A key that the player itself has no use for: upper-case ASCII, or an engine_key; NULL: there are none. */
	gi_result (*press)(void *user, gi_context *gi, int key);
	const char *const (*keys)[2]; /* what they do, for the list on screen: key_count of key and action */
	uint32_t key_count;
	/* > 0: it has receivers, which P and --overlay receivers show so large, metres */
	float receiver_radius;
	/* For the exports. */
	export_objects (*objects)(void *user);

	/* A sky of its own, unless --sky says otherwise: equirectangular, as gi_set_sky_image takes it; NULL: none. */
	const float *sky;
	uint32_t sky_width, sky_height;

	double loop_s;      /* > 0: a window begins anew after so long */
	uint32_t frames;    /* recorded frames when nobody says how many; > 0 */
	float exposure;     /* > 0: used unless --exposure says otherwise; 0: from the light of the first frame */
	bool gallery;       /* without --images: every eighth frame in all three modes goes to the folder --out */
	bool exact_frame;   /* a recording under a budget also says what an exact frame takes */
	const char *report; /* without --report: a file in the folder --out; NULL: none */
} player_scene;

/* Returns the exit code; whatever failed has been told on stderr in one line. */
int player_run(const options *o, const player_scene *scene);

#endif
