/* What a program is busy with until its first picture: on a terminal's standard error, and in the window.
 *
 * A terminal's line is written over by the next one and erased at the end; files and pipes get nothing.
 */
#ifndef DEMOS_PROGRESS_H
#define DEMOS_PROGRESS_H

#include "context.h"
#include "hud.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct progress {
	const char *program;
	engine_context *context; /* the next two: NULL until there is a window */
	engine_hud *hud;
	double shown_ms; /* when the window last showed something; 0: never */
	bool told;       /* a line is on the terminal */
} progress;

/* Step `done` of `total` of `what` begins; total 0: nobody knows how many. */
void progress_show(progress *p, const char *what, uint32_t done, uint32_t total);

/* Erases the terminal's line, where there is one: a picture or a message comes. */
void progress_end(progress *p);

#endif
