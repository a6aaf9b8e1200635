#define _POSIX_C_SOURCE 200809L
#include "progress.h"

#include "gl.h"
#include "wall_clock.h"

#include <stdio.h>
#include <unistd.h>

/* A swap may wait for the display: so often it costs little. */
static const double WINDOW_EVERY_MS = 20;

enum { MARGIN = 12, LINE = 24, BAR_WIDTH = 240, BAR_HEIGHT = 6 };

static const float GREY[4] = {0.8f, 0.8f, 0.8f, 1}, DARK[4] = {0.25f, 0.25f, 0.25f, 1};

static void collect(engine_hud *hud, const char *what, uint32_t done, uint32_t total)
{
	engine_hud_text(hud, MARGIN, MARGIN, 2, GREY, "%s ...", what);
	if (!total)
		return;
	const float all[4] = {MARGIN, MARGIN + LINE, BAR_WIDTH, BAR_HEIGHT};
	const float part[4] = {MARGIN, MARGIN + LINE, BAR_WIDTH * (float)done / (float)total, BAR_HEIGHT};
	engine_hud_box(hud, all, DARK);
	engine_hud_box(hud, part, GREY);
}

/* Straight into the window: the picture's own buffers belong to the scene. */
static void draw(progress *p, const char *what, uint32_t done, uint32_t total)
{
	const int width = engine_context_width(p->context), height = engine_context_height(p->context);
	collect(p->hud, what, done, total);
	glBindFramebuffer(GL_FRAMEBUFFER, 0);
	glViewport(0, 0, width, height);
	glClearColor(0, 0, 0, 1);
	glClear(GL_COLOR_BUFFER_BIT);
	engine_hud_draw(p->hud, width, height);
	engine_context_swap(p->context);
	engine_context_poll(p->context); /* the window answers */
}

/* The cursor waits at the beginning of the line, so that messages and the next step write over it. */
static void tell_terminal(const char *program, const char *what, uint32_t done, uint32_t total)
{
	fprintf(stderr, "\r%s: %s ...", program, what);
	if (total)
		fprintf(stderr, " %u of %u", done < total ? done + 1 : total, total);
	fputs("\033[K\r", stderr);
	fflush(stderr);
}

void progress_show(progress *p, const char *what, uint32_t done, uint32_t total)
{
	p->told = isatty(STDERR_FILENO);
	if (p->told)
		tell_terminal(p->program, what, done, total);
	const double now = wall_clock_ms();
	if (!p->hud || (p->shown_ms > 0 && now - p->shown_ms < WINDOW_EVERY_MS))
		return;
	draw(p, what, done, total);
	p->shown_ms = wall_clock_ms();
}

void progress_end(progress *p)
{
	if (!p->told)
		return;
	fputs("\033[K", stderr);
	fflush(stderr);
	p->told = false;
}
