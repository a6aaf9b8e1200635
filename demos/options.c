#include "options.h"

#include "image.h"
#include "output.h"
#include "wall_clock.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { EXIT_USAGE = 2, MAX_FRAMES = 10000000, MAX_SIZE = 16384 };

enum {
	KEY_FRAMES = 0x100,
	KEY_FPS,
	KEY_SIZE,
	KEY_MODE,
	KEY_OVERLAY,
	KEY_CONTEXT,
	KEY_REBUILD,
	KEY_ROW_TOLERANCE,
	KEY_LEAF_SIZE,
	KEY_LEAVES,
	KEY_SOLVE_TOLERANCE,
	KEY_ESTIMATE,
	KEY_CAGE_FACES,
	KEY_BUDGET_FPS,
	KEY_BUDGET_MS,
	KEY_BUDGET_RAYS,
	KEY_BUDGET_ERROR,
	KEY_PHOTONS,
	KEY_SHADOW_MAP,
	KEY_FINE_SHADOWS,
	KEY_PIXEL_LAMPS,
	KEY_EXPOSURE,
	KEY_SKY,
	KEY_SHADERS,
	KEY_TWO_SIDED,
	KEY_IMAGES,
	KEY_LINEAR,
	KEY_REPORT,
	KEY_FIELD,
	KEY_FORM_FACTORS,
	KEY_VIDEO,
	KEY_OUT,
};

static const struct argp_option table[] = {
    {"frames", KEY_FRAMES, "N", 0, "how many frames; without it a window plays on", 0},
    {"fps", KEY_FPS, "R", 0, "frames a second: of a recorded animation (24), to be kept in a window (30)", 0},
    {"size", KEY_SIZE, "WxH", 0, "pixels of the picture (512x512)", 0},
    {"mode", KEY_MODE, "MODE", 0, "direct, indirect or global (global)", 0},
    {"overlay", KEY_OVERLAY, "NAME[:N]", 0,
     "wireframe, dirty, residual; hierarchy:N, nodes N levels deep; senders:N, visibility:N, blockers:N, of leaf N as "
     "--field counts; receivers: the probes",
     0},
    {"context", KEY_CONTEXT, "KIND", 0,
     "auto, glfw (a window), egl or osmesa (auto: a window where there is a display)", 0},
    {"exposure", KEY_EXPOSURE, "X", 0, "display value 1 per W/(m2 sr)", 0},
    {"sky", KEY_SKY, "E|FILE", 0,
     "light from a white sky, exitance in W/m2 (0; the scene's own), or from a picture, .hdr or .pfm", 0},
    {"shaders", KEY_SHADERS, "FOLDER", 0, "the library's shaders from there; F5 in a window reads them again", 0},
    {"two-sided", KEY_TWO_SIDED, "WHICH", OPTION_ARG_OPTIONAL,
     "faces of a file have two sides: on (all but lamps), off (those the file says), auto (turned or doubled where "
     "light "
     "falls on backs, with a line that says so); on without WHICH (auto)",
     0},
    {0, 0, 0, 0, "How fine:", 1},
    {"row-tolerance", KEY_ROW_TOLERANCE, "T", 0, "largest form factor that a row takes whole, 1e-6 < T <= 1 (0.01)", 1},
    {"leaf-size", KEY_LEAF_SIZE, "L", 0, "edge of the leaves, metres, instead of what the scene gives or is chosen", 1},
    {"leaves", KEY_LEAVES, "N", 0,
     "about so many are chosen where the scene gives no levels, 100..100000 (4000 without a GPU, 20000 with one)", 1},
    {"solve-tolerance", KEY_SOLVE_TOLERANCE, "T", 0, "certified bound over the light reflected, 0..1 (0.05)", 1},
    {"estimate", KEY_ESTIMATE, "N", 0,
     "leaves looked at to estimate the error of the rows, 0..65536; 0: none (256 where a few pictures are recorded, "
     "64 a frame where many are)",
     1},
    {"cage-faces", KEY_CAGE_FACES, "N", 0, "triangles of the cage that lights a detailed mesh", 1},
    {"budget-fps", KEY_BUDGET_FPS, "R", 0,
     "keep so many frames a second: an update gets the time that drawing leaves, what does not fit waits until all "
     "is at rest; 0: exact (30 in a window, 0 where frames are recorded)",
     1},
    {"budget-ms", KEY_BUDGET_MS, "MS", 0,
     "aim for so many milliseconds an update instead; what does not fit waits; 0: exact", 1},
    {"budget-rays", KEY_BUDGET_RAYS, "N", 0, "about so many rays an update", 1},
    {"budget-error", KEY_BUDGET_ERROR, "E", 0,
     "rows whose change is bounded by this share of the largest light reflected wait, 0..1", 1},
    {"pixel-lamps", KEY_PIXEL_LAMPS, "N", 0,
     "polygons that light per pixel, 0..32; others light through the leaves (32)", 1},
    {"shadow-map", KEY_SHADOW_MAP, "N", 0,
     "texels a side of the maps that their shadows come from, 64..4096 (512): more are finer and take longer", 1},
    {"fine-shadows", KEY_FINE_SHADOWS, 0, 0, "cast by what is drawn instead of by the leaves", 1},
    {"caustic-photons", KEY_PHOTONS, "N", 0,
     "photons that each lamp sends through each mirror and glass, 0..1048576 (16384); 0: no caustics", 1},
    {"rebuild", KEY_REBUILD, 0, 0, "build every frame from scratch", 1},
    {0, 0, 0, 0, "What to write:", 2},
    {"images", KEY_IMAGES, "PATTERN", 0, "a PNG each frame, e.g. frame_%04d.png", 2},
    {"linear", KEY_LINEAR, "PATTERN", 0,
     "a PFM each frame: radiance before exposure and tone mapping, W/(m2 sr), e.g. frame_%04d.pfm", 2},
    {"video", KEY_VIDEO, "FILE", 0, "a film of the pictures, e.g. film.mp4, where the program ffmpeg is installed", 2},
    {"report", KEY_REPORT, "FILE", 0, "a CSV line each frame", 2},
    {"field", KEY_FIELD, "PATTERN", 0, "a PLY of all leaves each frame, e.g. field_%04d.ply", 2},
    {"form-factors", KEY_FORM_FACTORS, "FILE", 0, "a CSV of form factors between the objects, after the last frame", 2},
    {"out", KEY_OUT, "FOLDER", 0, "where pictures and reports go that have no name of their own", 2},
    {0},
};

__attribute__((format(printf, 2, 0))) static void say(const char *program, const char *format, va_list arguments)
{
	char line[4096];
	vsnprintf(line, sizeof line, format, arguments);
	engine_output_one_line(line);
	fprintf(stderr, "%s: %s\n", program, line);
}

void options_fail(const char *program, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	say(program, format, arguments);
	va_end(arguments);
	exit(EXIT_USAGE);
}

void options_say(const char *program, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	say(program, format, arguments);
	va_end(arguments);
}

/* A number, with nothing before or after it. */
static bool parse_number(const char *text, double *value)
{
	char *end;
	errno = 0;
	*value = strtod(text, &end);
	return *text > ' ' && end != text && *end == '\0' && isfinite(*value);
}

uint32_t options_count(const char *program, const char *option, const char *text, uint32_t low, uint32_t high)
{
	double value;
	if (!parse_number(text, &value) || value < low || value > high || value != floor(value))
		options_fail(program, "%s %s: must be a whole number of %u to %u", option, text, low, high);
	return (uint32_t)value;
}

/* A number in (0, high] that is still one as a float: no fewer digits, not 0. */
float options_positive(const options *o, const char *option, const char *text, double high)
{
	double value;
	if (!parse_number(text, &value) || !(value > 0) || value > high)
		options_fail(o->program, "%s %s: must be a number above 0 and at most %g", option, text, high);
	if ((float)value < FLT_MIN)
		options_fail(o->program, "%s %s: is too small, must be at least %.3g", option, text, (double)FLT_MIN);
	return (float)value;
}

/* The same with 0. */
static float not_negative(const options *o, const char *option, const char *text, double high)
{
	double value;
	if (parse_number(text, &value) && value == 0)
		return 0;
	return options_positive(o, option, text, high);
}

static void parse_size(options *o, const char *text)
{
	char after;
	if (sscanf(text, "%5dx%5d%c", &o->width, &o->height, &after) != 2 || o->width < 1 || o->height < 1 ||
	    o->width > MAX_SIZE || o->height > MAX_SIZE)
		options_fail(o->program, "--size %s: must be WIDTHxHEIGHT, 1 to %d each, e.g. 512x512", text, MAX_SIZE);
}

static const char *const mode_names[] = {
    [GI_MODE_GLOBAL] = "global", [GI_MODE_DIRECT] = "direct", [GI_MODE_INDIRECT] = "indirect"};

const char *options_mode_name(gi_mode mode)
{
	return mode_names[mode];
}

/* A name, and for some a number behind a colon. */
static void parse_overlay(options *o, const char *text)
{
	static const char *const names[] = {"none",    "wireframe",  "dirty",    "residual", "hierarchy",
					    "senders", "visibility", "blockers", "receivers"};
	const size_t length = strcspn(text, ":");
	for (int k = 0; k <= GI_OVERLAY_RECEIVERS; k++)
		if (strlen(names[k]) == length && strncmp(names[k], text, length) == 0) {
			o->overlay = (gi_overlay)k;
			if (text[length])
				o->overlay_number =
				    options_count(o->program, "--overlay", text + length + 1, 0, UINT32_MAX - 1);
			return;
		}
	options_fail(o->program,
		     "--overlay takes wireframe, dirty, residual, hierarchy, senders, visibility, blockers or "
		     "receivers, not %s",
		     text);
}

static void parse_mode(options *o, const char *text)
{
	for (int k = 0; k < 3; k++)
		if (strcmp(text, mode_names[k]) == 0) {
			o->mode = (gi_mode)k;
			return;
		}
	options_fail(o->program, "--mode %s: must be direct, indirect or global", text);
}

static void parse_context(options *o, const char *text)
{
	if (!engine_context_kind_from_name(text, &o->context))
		options_fail(o->program, "--context %s: must be auto, glfw, egl or osmesa", text);
}

static void parse_two_sided(options *o, const char *text)
{
	static const char *const names[] = {
	    [OPTIONS_SIDES_AUTO] = "auto", [OPTIONS_SIDES_ON] = "on", [OPTIONS_SIDES_OFF] = "off"};
	for (int k = 0; k < 3; k++)
		if (strcmp(text ? text : "on", names[k]) == 0) {
			o->two_sided = (options_sides)k;
			return;
		}
	options_fail(o->program, "--two-sided=%s: must be on, off or auto", text);
}

static const char *checked_pattern(const options *o, const char *option, const char *text)
{
	char message[256];
	if (!engine_frame_pattern_check(text, message, sizeof message))
		options_fail(o->program, "%s: %s", option, message);
	return text;
}

static const char *checked_name(const options *o, const char *option, const char *text)
{
	if (!*text)
		options_fail(o->program, "%s: the name of a file is missing", option);
	return text;
}

/* A number, or the name of a file. */
static void parse_sky(options *o, char *text)
{
	double value;
	o->sky_given = true;
	o->sky_file = parse_number(text, &value) ? NULL : checked_name(o, "--sky", text);
	o->sky = o->sky_file ? 0 : not_negative(o, "--sky", text, 1e9);
}

static void parse_fineness(options *o, int key, const char *text)
{
	switch (key) {
	case KEY_ROW_TOLERANCE:
		o->row_tolerance = options_positive(o, "--row-tolerance", text, 1);
		if (o->row_tolerance <= 1e-6f)
			options_fail(o->program, "--row-tolerance %s: must be above 1e-6", text);
		break;
	case KEY_LEAF_SIZE:
		o->leaf_size = options_positive(o, "--leaf-size", text, 1e6);
		break;
	case KEY_LEAVES:
		o->leaves = options_count(o->program, "--leaves", text, 100, 100000);
		break;
	case KEY_SOLVE_TOLERANCE:
		o->solve_tolerance = options_positive(o, "--solve-tolerance", text, 1);
		break;
	case KEY_ESTIMATE:
		o->estimate = options_count(o->program, "--estimate", text, 0, 65536);
		o->estimate_given = true;
		break;
	case KEY_CAGE_FACES:
		o->cage_faces = options_count(o->program, "--cage-faces", text, 4, 1000000);
		break;
	case KEY_PHOTONS:
		o->photons = options_count(o->program, "--caustic-photons", text, 0, 1 << 20);
		o->photons_given = true;
		break;
	case KEY_SHADOW_MAP:
		o->shadow_map = options_count(o->program, "--shadow-map", text, 64, 4096);
		break;
	case KEY_FINE_SHADOWS:
		o->fine_shadows = true;
		break;
	case KEY_PIXEL_LAMPS:
		o->pixel_lamps = options_count(o->program, "--pixel-lamps", text, 0, 32);
		break;
	}
}

static void parse_budget(options *o, int key, const char *text)
{
	o->budget_given = o->budget_given || key != KEY_BUDGET_FPS;
	switch (key) {
	case KEY_BUDGET_FPS:
		o->budget_fps = (double)not_negative(o, "--budget-fps", text, 1e6);
		o->budget_fps_given = true;
		break;
	case KEY_BUDGET_MS:
		o->budget.ms = not_negative(o, "--budget-ms", text, 1e6);
		break;
	case KEY_BUDGET_RAYS:
		o->budget.rays = options_count(o->program, "--budget-rays", text, 1, 2000000000);
		break;
	case KEY_BUDGET_ERROR:
		o->budget.error = options_positive(o, "--budget-error", text, 1);
		break;
	}
}

static void parse_output(options *o, int key, const char *text)
{
	switch (key) {
	case KEY_IMAGES:
		o->images = checked_pattern(o, "--images", text);
		break;
	case KEY_LINEAR:
		o->linear = checked_pattern(o, "--linear", text);
		break;
	case KEY_REPORT:
		o->report = checked_name(o, "--report", text);
		break;
	case KEY_FIELD:
		o->field = checked_pattern(o, "--field", text);
		break;
	case KEY_FORM_FACTORS:
		o->form_factors = checked_name(o, "--form-factors", text);
		break;
	case KEY_VIDEO:
		o->video = checked_name(o, "--video", text);
		break;
	case KEY_OUT:
		o->out = checked_name(o, "--out", text);
		break;
	}
}

static error_t parse(int key, char *text, struct argp_state *state)
{
	options *o = state->input;
	switch (key) {
	case ARGP_KEY_END:
		if (o->overlay == GI_OVERLAY_RECEIVERS && !o->receivers)
			options_fail(o->program, "--overlay receivers: there are none (gi_play --probes SPACING)");
		return 0;
	case ARGP_KEY_INIT:
		state->err_stream = NULL; /* no second line "Try ..." under what getopt says */
		return 0;
	case KEY_FRAMES:
		o->frames = options_count(o->program, "--frames", text, 1, MAX_FRAMES);
		return 0;
	case KEY_FPS:
		o->fps = options_positive(o, "--fps", text, 1e6);
		if (!o->budget_fps_given)
			o->budget_fps = o->fps;
		return 0;
	case KEY_SIZE:
		parse_size(o, text);
		return 0;
	case KEY_OVERLAY:
		parse_overlay(o, text);
		return 0;
	case KEY_MODE:
		parse_mode(o, text);
		return 0;
	case KEY_CONTEXT:
		parse_context(o, text);
		return 0;
	case KEY_EXPOSURE:
		o->exposure = options_positive(o, "--exposure", text, 1e9);
		return 0;
	case KEY_SKY:
		parse_sky(o, text);
		return 0;
	case KEY_SHADERS:
		o->shaders = text;
		return 0;
	case KEY_TWO_SIDED:
		parse_two_sided(o, text);
		return 0;
	case KEY_REBUILD:
		o->rebuild = true;
		return 0;
	}
	if (key >= KEY_BUDGET_FPS && key <= KEY_BUDGET_ERROR)
		parse_budget(o, key, text);
	else if (key >= KEY_ROW_TOLERANCE && key <= KEY_PIXEL_LAMPS)
		parse_fineness(o, key, text);
	else if (key >= KEY_IMAGES && key <= KEY_OUT)
		parse_output(o, key, text);
	else
		return ARGP_ERR_UNKNOWN;
	return 0;
}

const struct argp options_argp = {.options = table, .parser = parse};

options options_default(const char *program)
{
	engine_output_watch(program);
	return (options){.program = program,
			 .began_ms = wall_clock_ms(),
			 .fps = 24,
			 .budget_fps = 30,
			 .width = 512,
			 .height = 512,
			 .pixel_lamps = 32};
}

void options_parse(const struct argp *parser, int argc, char **argv, void *input)
{
	if (argp_parse(parser, argc, argv, 0, NULL, input))
		exit(EXIT_USAGE);
}
