/* The figures of a frame over its picture, and the list of keys. */
#ifndef DEMOS_FIGURES_H
#define DEMOS_FIGURES_H

#include "gi/gi.h"
#include "hud.h"

#include <stdbool.h>

typedef struct figures {
	const char *title;
	const char *renderer;
	gi_report report;
	gi_mode mode;
	gi_overlay layer;
	const char *setting; /* that keys turn now, and its value */
	double fps, update_ms, frame_ms;
	double budget_ms;  /* of the newest update; 0: exact, or another kind of budget */
	double target_fps; /* what budgets keep; 0: nothing */
	bool paused, rebuild, help, can_move, has_receivers;
	const char *const (*keys)[2]; /* the scene's own: key_count of key and action */
	uint32_t key_count;
} figures;

/* Collects text for engine_hud_draw; height of the picture in pixels. */
void figures_text(engine_hud *hud, const figures *o, int height);

#endif
