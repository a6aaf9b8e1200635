/* The command line that the programs share.
 *
 * Whatever is wrong with it is one line on stderr and exit code 2, before anything is opened or written.
 */
#ifndef DEMOS_OPTIONS_H
#define DEMOS_OPTIONS_H

#include "context.h"
#include "gi/gi.h"

#include <argp.h>
#include <stdbool.h>
#include <stdint.h>

/* Which faces of a file have two sides. */
typedef enum options_sides {
	OPTIONS_SIDES_AUTO, /* those that light reaches from behind (default) */
	OPTIONS_SIDES_ON,   /* all but lamps */
	OPTIONS_SIDES_OFF,  /* those the file says */
} options_sides;

typedef struct options {
	const char *program;
	double began_ms; /* when it did, by wall_clock_ms */
	uint32_t frames; /* 0: endless in a window, the program's choice without one */
	double fps;      /* frames a second of a recorded animation, default 24 */
	int width, height;
	gi_mode mode;
	gi_overlay overlay;
	uint32_t overlay_number; /* of the overlay: a leaf, or a depth */
	bool receivers;          /* there are some to be shown, as the program's own parser found */
	engine_context_kind context;
	bool rebuild;        /* every frame from scratch */
	float row_tolerance; /* 0: the library's default, as the next two */
	float solve_tolerance;
	float leaf_size;      /* 0: the levels that scene or program give, or what is chosen */
	uint32_t leaves;      /* about how many are chosen where nothing gives levels; 0: what suits the renderer */
	uint32_t estimate;    /* leaves that estimate the error of the rows, where estimate_given; 0: none */
	bool estimate_given;  /* else some where pictures are recorded */
	uint32_t cage_faces;  /* of the cage that lights a detailed mesh; 0: the program's default */
	float sky;            /* exitance of a white sky, W/m2; 0: black */
	const char *sky_file; /* a picture of it; NULL: none */
	bool sky_given;       /* of a scene that has a sky of its own: it counts no more */
	const char *shaders;  /* folder; NULL: those built in */
	options_sides two_sided;
	float exposure;        /* display value 1 per W/(m2 sr); 0: the program's choice */
	gi_budget budget;      /* of every update, where budget_given; all zero: exact */
	bool budget_given;     /* a budget of its own, instead of a frame rate to keep */
	double budget_fps;     /* frames a second that budgets keep; 0: every update is exact */
	bool budget_fps_given; /* else a window keeps them and a recording is exact */
	uint32_t pixel_lamps;  /* polygons lit per pixel */
	uint32_t shadow_map;   /* texels a side of their depth maps; 0: the library's default */
	bool fine_shadows;     /* cast by what is drawn */
	uint32_t photons;      /* through each mirror and glass, where photons_given */
	bool photons_given;    /* else the library's default */
	/* Files to write; NULL: none */
	const char *images, *linear, *video, *report, *field, *form_factors;
	const char *out; /* folder for what has no name of its own */
} options;

/* To be a child of a program's own parser; its input is an options made by options_default. */
extern const struct argp options_argp;

/* Also sees to it that a standard output that cannot be written fails the program (engine_output_watch). */
options options_default(const char *program);

/* Runs argp so that every complaint is one line and ends the program with code 2. */
void options_parse(const struct argp *parser, int argc, char **argv, void *input);

/* Prints "program: message" and ends with code 2. */
#if defined(__GNUC__)
__attribute__((noreturn, format(printf, 2, 3)))
#endif
void options_fail(const char *program, const char *format, ...);

/* Prints "program: message", one line whatever names are in it. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void options_say(const char *program, const char *format, ...);

/* A number above 0 and up to high, or the end of the program with a line that names the option. */
float options_positive(const options *o, const char *option, const char *text, double high);

/* A whole number of low..high, or the end of the program with a line that names the option. */
uint32_t options_count(const char *program, const char *option, const char *text, uint32_t low, uint32_t high);

/* The name that --mode takes. */
const char *options_mode_name(gi_mode mode);

#endif
