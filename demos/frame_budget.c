#include "frame_budget.h"

#include <math.h>

/* Of a new measurement; a single frame is noise, and the view may change. */
static const double LEARNING = 0.2;

/* Shares of the frame asked for: the smallest update that does anything, and the one that keeps the light moving where
 * not even that fits and the rate is lost. */
static const double SMALLEST = 1.0 / 16, LOST = 1.0 / 8;

/* Of the frame asked for: more than that an update is not corrected by what those before it took too long. */
static const double MOST_CORRECTED = 0.25;

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
	const double left = b->target_ms - b->rest_ms, smallest = SMALLEST * b->target_ms;
	return left < smallest ? LOST * b->target_ms : fmax(left - b->over_ms, smallest);
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

double frame_budget_update_ms(const gi_report *report)
{
	double sum = 0;
	for (int k = 0; k < GI_PASS_COUNT && report->outcome != GI_OUTCOME_AT_REST; k++)
		sum += k == GI_PASS_SHADOW || k == GI_PASS_DRAW ? 0 : (double)report->pass_ms[k];
	return sum;
}

static void learn(double *value, double measured)
{
	*value += LEARNING * (measured - *value);
}

void frame_budget_note(frame_budget *b, double frame_ms, const gi_report *report)
{
	const double update_ms = frame_budget_update_ms(report), most = MOST_CORRECTED * b->target_ms;
	if (report->frame <= 1) /* builds every row, and shaders compile */
		return;
	/* Beyond the target it makes no difference, and a single slow frame would take long to be forgotten. */
	learn(&b->rest_ms, fmin(fmax(frame_ms - update_ms, 0), b->target_ms));
	if (report->waiting_rows && b->asked_ms > 0)
		learn(&b->over_ms, fmax(-most, fmin(update_ms - b->asked_ms, most)));
	if (b->moving) /* at rest an update may be the small remainder of one */
		b->exact_fits = !report->waiting_rows && update_ms <= FITS_SHARE * left_ms(b);
}
