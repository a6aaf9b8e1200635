/* How long an update may take so that a frame rate is kept while things move, and how what waited is made good at rest.
 *
 * A frame is an update and the rest: drawing, text, showing it, waiting for the display. The rest is measured from
 * frame to frame, and the update gets what it leaves of the frame, less what updates take longer than they were given.
 * Where not even the smallest update fits the rate is lost; an update then gets enough for the light to move on.
 */
#ifndef DEMOS_FRAME_BUDGET_H
#define DEMOS_FRAME_BUDGET_H

#include "gi/gi.h"

#include <stdbool.h>

typedef struct frame_budget {
	double target_ms; /* of a whole frame; 0: every update is exact */
	double rest_ms;   /* of a frame without its update, smoothed, as the next */
	double over_ms;   /* what updates take beyond what they were given */
	double asked_ms;  /* what the newest update was given; 0: it is exact */
	double moved_ms;  /* when something last moved, by the caller's clock */
	bool moving;      /* in the newest update */
	bool exact_fits;  /* an exact update takes so much less than there is that nothing has to be chosen */
} frame_budget;

/* frames_per_second 0: exact. The first updates are exact as well, until something moves. */
frame_budget frame_budget_make(double frames_per_second);

/* The budget of the update about to be made. `moved`: something will have moved since the update before; now_ms: any
 * clock that only goes forward. Exact again half a second after the last motion, and on the way there in pieces that
 * grow: all is exact within a second where an exact update takes no more than half of one. */
gi_budget frame_budget_next(frame_budget *b, bool moved, double now_ms);

/* What the passes of the report's update took by the GPU's timers, ms; 0 at rest. */
double frame_budget_update_ms(const gi_report *report);

/* What the frame took from its beginning until it was shown, and the newest report. */
void frame_budget_note(frame_budget *b, double frame_ms, const gi_report *report);

#endif
