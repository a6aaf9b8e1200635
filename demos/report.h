/* Figures of a run: a CSV line a frame, and medians at the end. */
#ifndef DEMOS_REPORT_H
#define DEMOS_REPORT_H

#include "gi/gi.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* One frame: what the library reports and what a clock on the wall says. */
typedef struct report_frame {
	uint32_t number;  /* counted from 0 */
	double time_s;    /* of the animation */
	double update_ms; /* poses, gi_update and, where frames are recorded, the wait for the GPU */
	double frame_ms;  /* that and the picture */
	double budget_ms; /* what gi_update was given; 0: exact, or another kind of budget */
	double
	    shown_ms; /* from frame to frame: with text and what the window takes; frame_ms where frames are recorded */
	gi_report gi;
} report_frame;

/* The columns of the end's table. */
typedef enum report_column {
	REPORT_UPDATE_MS,
	REPORT_FRAME_MS,
	REPORT_FPS,
	REPORT_BUDGET_MS,
	REPORT_SWEEPS,
	REPORT_DIRTY_PERCENT,
	REPORT_RAYS,
	REPORT_RESIDUAL,
	REPORT_AMPLIFICATION,
	REPORT_BOUND,
	REPORT_ROUNDING,
	REPORT_WAITING_PERCENT,
	REPORT_STALE_BOUND,
	REPORT_ESTIMATE,
	REPORT_ESTIMATE_PERCENT,
	REPORT_PASS_MS, /* and the other passes */
	REPORT_COLUMNS = REPORT_PASS_MS + GI_PASS_COUNT
} report_column;

typedef struct report {
	FILE *file; /* NULL: no CSV */
	long whole; /* bytes of the header and whole lines in it */
	uint32_t lines;
	const char *path;
	float (*values)[REPORT_COLUMNS]; /* one row a frame, the first frame included */
	uint32_t count, capacity;
	gi_report first, last;
	double first_ms;
	double start_ms;      /* from the start of the program to the first picture */
	uint32_t outcomes[8]; /* by outcome, from GI_OUTCOME_NOT_FINITE on */
} report;

/* Opens path (NULL: no file) and writes the header. False with one line in message. */
bool report_open(report *r, const char *path, char *message, size_t message_size);

/* Writes and remembers a frame: its line is in the file when this returns. False with one line in message when the disk
 * is full; the lines before it stay. */
bool report_add(report *r, const report_frame *frame, char *message, size_t message_size);

/* Closes the file; false with one line in message when what was written did not reach it. */
bool report_close(report *r, char *message, size_t message_size);

/* Closes the file of a run that failed; one without any frame goes away. */
void report_abandon(report *r);

/* Prints the table of the run: the first frame apart, median, least and most of the others. */
void report_print(const report *r, FILE *to);

/* The estimated error of all frames together, %: the root of the mean of their squares. 0 without estimates. */
double report_estimate_percent(const report *r);

/* Frees what the table was made of. */
void report_free(report *r);

/* "converged" etc. */
const char *report_outcome_name(gi_outcome outcome);

/* "Jacobi" or "Chebyshev". */
const char *report_method_name(gi_method method);

#endif
