#include "frame_budget.h"

#include <math.h>

/* Of a new measurement; a single frame is noise, and the view may change. */
static const double LEARNING = 0.2;

/* Of the frame asked for, on top of what no budget shortens: where drawing takes it all the rate is lost anyway, and
 * the light moves on. */
static const double LEAST_SHARE = 0.125;

/* So long after the last motion what still waits is refreshed in one go. */
static const double PATIENCE_MS = 500;

/* Pieces at rest take up to this share of the time that the rest has lasted: whoever turns the view sees it stop but
 * briefly. */
static const double PIECE_SHARE = 0.5;

/* Choosing rows takes time of its own: an update that fits twice is made without. */
static const double FITS_SHARE = 0.5;

frame_budget frame_budget_make(double frames_per_second)
{
	const double target_ms = frames_per_second > 0 ? 1e3 / frames_per_second : 0;
	/* Until something is known: half of it. */
	return (frame_budget){.target_ms = target_ms, .rest_ms = 0.5 * target_ms, .moved_ms = -INFINITY};
}

static double left_ms(const frame_budget *b)
{
	return fmax(b->fixed_ms + LEAST_SHARE * b->target_ms, b->target_ms - b->rest_ms);
}

gi_budget frame_budget_next(frame_budget *b, bool moved, double now_ms)
{
	b->moving = moved;
	if (moved)
		b->moved_ms = now_ms;
	const double still_ms = now_ms - b->moved_ms;
	const bool exact = b->target_ms <= 0 || still_ms >= PATIENCE_MS || b->exact_fits;
	b->asked_ms = exact ? 0 : fmax(left_ms(b), PIECE_SHARE * still_ms);
	return (gi_budget){.ms = (float)b->asked_ms};
}

/* The passes of an update by the GPU's timers, all or those that take as long whatever the budget. */
static double measured_ms(const gi_report *report, bool fixed_alone)
{
	double sum = 0;
	for (int k = 0; k < GI_PASS_COUNT && report->outcome != GI_OUTCOME_AT_REST; k++) {
		const bool fixed = k == GI_PASS_POSE || k == GI_PASS_CHOOSE || k == GI_PASS_SOLVE || k == GI_PASS_LIGHT;
		if (k != GI_PASS_SHADOW && k != GI_PASS_DRAW && (fixed || !fixed_alone))
			sum += (double)report->pass_ms[k];
	}
	return sum;
}

static void learn(double *value, double measured)
{
	*value += LEARNING * (measured - *value);
}

void frame_budget_note(frame_budget *b, double frame_ms, const gi_report *report)
{
	const double update_ms = measured_ms(report, false);
	const bool cut_short = report->waiting_rows > 0 && b->asked_ms > 0;
	const double rest_ms = fmax(frame_ms - (cut_short ? b->asked_ms : update_ms), 0);
	if (report->frame <= 1) /* builds every row, and shaders compile */
		return;
	/* Beyond the target it makes no difference, and a single slow frame would take long to be forgotten. */
	learn(&b->rest_ms, fmin(rest_ms, b->target_ms));
	if (cut_short)
		learn(&b->fixed_ms, fmin(measured_ms(report, true), b->target_ms));
	if (b->moving) /* at rest an update may be the small remainder of one */
		b->exact_fits = !report->waiting_rows && update_ms <= FITS_SHARE * left_ms(b);
}
