/* Figures 4 and 5 of Song et al. (README) as numbers: our linear pictures beside a path tracer's (scripts/figures).
 *
 *     figure_numbers four OURS TRUTH CSV     folders with direct.pfm, indirect.pfm, global.pfm
 *     figure_numbers five OURS TRUTH CSV     linear pictures of the two balls
 *     figure_numbers crop IN.png LEFT,TOP,RIGHT,BOTTOM TIMES OUT.png
 *                                            a part in shares of the picture, enlarged
 *     figure_numbers difference OURS TRUTH OUT.png
 *                                            of two linear pictures: red where ours is brighter, blue darker
 *
 * CSV: figure,measure,place,unit,ours,truth. TRUTH "-" is none: numbers of ours alone.
 */
#include "image.h"
#include "output.h"
#include "picture_measures.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Radiance that only the lamp has, W/(m2 sr): its dimmest channel gives 9.4, the white floor about 0.1. */
static const double BRIGHT = 6;

static void fail(const char *message)
{
	fprintf(stderr, "figure_numbers: %s\n", message);
	exit(EXIT_FAILURE);
}

static picture load(const char *path)
{
	char message[512];
	picture p;
	if (!picture_read(path, &p, message, sizeof message))
		fail(message);
	return p;
}

/* ---- the table ---- */

typedef struct table {
	engine_output out;
	const char *figure;
	bool has_truth;
} table;

static table open_table(const char *path, const char *figure, bool has_truth)
{
	char message[512];
	table t = {.figure = figure, .has_truth = has_truth};
	if (!engine_output_open(&t.out, path, message, sizeof message))
		fail(message);
	fprintf(t.out.file, "figure,measure,place,unit,ours,truth\n");
	return t;
}

static void add(const table *t, const char *measure, const char *place, const char *unit, double ours, double truth)
{
	fprintf(t->out.file, "%s,%s,%s,%s,%.6g,", t->figure, measure, place, unit, ours);
	if (t->has_truth)
		fprintf(t->out.file, "%.6g", truth);
	fprintf(t->out.file, "\n");
}

static void close_table(table *t)
{
	char message[512];
	if (!engine_output_close(&t->out, true, message, sizeof message))
		fail(message);
}

/* ---- figure 4 ---- */

enum { DIRECT, INDIRECT, GLOBAL, MODES };
static const char *const MODE_NAMES[MODES] = {"direct", "indirect", "global"};

/* Edges of shadows on the floor that the camera sees whole, from the umbra to where nothing is in the lamp's way. */
static const struct {
	const char *place;
	floor_line line;
} SHADOWS[] = {
    {"small ball", {{2.05, 1.00}, {2.65, 1.29}}},
    {"Buddha towards the red wall", {{-0.80, 0.70}, {-1.70, 1.00}}},
    {"Buddha towards the green wall", {{0.75, 0.61}, {1.45, 0.79}}},
    {"Buddha towards the camera", {{0.50, 1.00}, {0.90, 1.70}}},
};

/* Where colours of the walls fall: floor before a wall, and sides of the Buddha, in shares of the picture. */
static const struct {
	const char *place;
	floor_part floor;
} FLOORS[] = {
    {"floor by the red wall", {-2.65, 0.4, -2.25, 1.6}},
    {"floor in the middle", {-0.3, 1.6, 0.3, 2.4}},
    {"floor by the green wall", {2.25, 1.6, 2.65, 2.5}},
};
static const struct {
	const char *place;
	picture_part part;
} SIDES[] = {
    {"sleeve in shade on the red side", {0.438, 0.66, 0.452, 0.68}},
    {"sleeve in shade on the green side", {0.548, 0.66, 0.562, 0.68}},
    {"knee in light on the red side", {0.372, 0.755, 0.392, 0.768}},
    {"knee in light on the green side", {0.608, 0.755, 0.628, 0.768}},
};
enum { FLOOR_COUNT = sizeof FLOORS / sizeof *FLOORS, PLACES = FLOOR_COUNT + sizeof SIDES / sizeof *SIDES };

static const char *name_of_place(int k)
{
	return k < FLOOR_COUNT ? FLOORS[k].place : SIDES[k - FLOOR_COUNT].place;
}

static void mean_of_place(const picture *p, int k, double rgb[3])
{
	if (k < FLOOR_COUNT)
		picture_floor_mean(p, FLOORS[k].floor, rgb);
	else
		picture_mean(p, SIDES[k - FLOOR_COUNT].part, rgb);
}

static void load_modes(const char *folder, picture modes[MODES])
{
	for (int m = 0; m < MODES; m++) {
		char path[4096];
		snprintf(path, sizeof path, "%s/%s.pfm", folder, MODE_NAMES[m]);
		modes[m] = load(path);
	}
}

static double width_of(const picture *direct, const floor_line *line)
{
	double share[SHADOW_SAMPLES];
	picture_shadow(direct, line, share);
	return penumbra_width(line, share);
}

static void add_shadows(const table *t, const picture *ours, const picture *truth)
{
	for (size_t k = 0; k < sizeof SHADOWS / sizeof *SHADOWS; k++)
		add(t, "penumbra", SHADOWS[k].place, "m", width_of(ours, &SHADOWS[k].line),
		    t->has_truth ? width_of(truth, &SHADOWS[k].line) : NAN);
}

/* Red over green of a mode over that of direct light: 1 where no wall lends its colour. */
static double bleeding(const picture modes[MODES], int mode, int place)
{
	double rgb[3], plain[3];
	mean_of_place(&modes[mode], place, rgb);
	mean_of_place(&modes[DIRECT], place, plain);
	return rgb[0] / rgb[1] / (plain[0] / plain[1]);
}

static void add_colours(const table *t, const picture ours[MODES], const picture truth[MODES])
{
	for (int place = 0; place < PLACES; place++)
		for (int m = 0; m < MODES; m++) {
			char measure[64];
			double a[3], b[3] = {NAN, NAN, NAN};
			mean_of_place(&ours[m], place, a);
			if (t->has_truth)
				mean_of_place(&truth[m], place, b);
			snprintf(measure, sizeof measure, "radiance %s", MODE_NAMES[m]);
			add(t, measure, name_of_place(place), "W/(m2 sr)", picture_luminance(a), picture_luminance(b));
			snprintf(measure, sizeof measure, "red over green %s", MODE_NAMES[m]);
			add(t, measure, name_of_place(place), "", a[0] / a[1], b[0] / b[1]);
			if (m == DIRECT)
				continue;
			snprintf(measure, sizeof measure, "bleeding %s", MODE_NAMES[m]);
			add(t, measure, name_of_place(place), "", bleeding(ours, m, place),
			    t->has_truth ? bleeding(truth, m, place) : NAN);
		}
}

static void add_distance(const table *t, const char *place, const picture *ours, const picture *truth)
{
	if (!t->has_truth)
		return;
	if (ours->width != truth->width || ours->height != truth->height)
		fail("the two pictures are not of one size");
	const picture_distance d = picture_compare(ours, truth, BRIGHT);
	add(t, "relative MSE", place, "", d.relative_mse, 0);
	add(t, "RMS over mean", place, "", d.rms_of_mean, 0);
}

static void write_four(const char *ours_folder, const char *truth_folder, const char *csv)
{
	picture ours[MODES], truth[MODES] = {{0}};
	table t = open_table(csv, "4", strcmp(truth_folder, "-") != 0);
	load_modes(ours_folder, ours);
	if (t.has_truth)
		load_modes(truth_folder, truth);
	add_shadows(&t, &ours[DIRECT], &truth[DIRECT]);
	add_colours(&t, ours, truth);
	for (int m = 0; m < MODES; m++)
		add_distance(&t, MODE_NAMES[m], &ours[m], &truth[m]);
	close_table(&t);
	for (int m = 0; m < MODES; m++) {
		picture_free(&ours[m]);
		picture_free(&truth[m]);
	}
}

/* ---- figure 5 ---- */

/* What the glass ball gathers, the shadow round it; the floor that the mirror ball scatters light over; cells a side.
 */
static const struct {
	const char *place;
	floor_part part;
	int cells;
} CAUSTICS[] = {
    {"caustic of the glass ball", {0.75, 0.75, 1.35, 1.35}, 6},
    {"shadow and caustic of the glass ball", {0.35, 0.35, 1.75, 1.75}, 7},
    {"floor before both balls", {-2.0, 1.8, 2.0, 2.6}, 8},
};

static const struct {
	const char *place;
	picture_part part;
} BALLS[] = {
    {"mirror ball", {0.33, 0.66, 0.44, 0.78}},
    {"glass ball", {0.575, 0.73, 0.68, 0.83}},
};

static void write_five(const char *ours_path, const char *truth_path, const char *csv)
{
	picture ours = load(ours_path), truth = {0};
	table t = open_table(csv, "5", strcmp(truth_path, "-") != 0);
	if (t.has_truth)
		truth = load(truth_path);
	for (size_t k = 0; k < sizeof CAUSTICS / sizeof *CAUSTICS; k++) {
		const floor_distance d =
		    picture_compare_floor(&ours, t.has_truth ? &truth : &ours, CAUSTICS[k].part, CAUSTICS[k].cells);
		add(&t, "radiance", CAUSTICS[k].place, "W/(m2 sr)", d.a, d.b);
		if (t.has_truth)
			add(&t, "relative RMS of cells", CAUSTICS[k].place, "", d.relative_rms, 0);
	}
	for (size_t k = 0; k < sizeof BALLS / sizeof *BALLS; k++) {
		double a[3], b[3] = {NAN, NAN, NAN};
		picture_mean(&ours, BALLS[k].part, a);
		if (t.has_truth)
			picture_mean(&truth, BALLS[k].part, b);
		add(&t, "radiance", BALLS[k].place, "W/(m2 sr)", picture_luminance(a), picture_luminance(b));
	}
	add_distance(&t, "picture", &ours, &truth);
	close_table(&t);
	picture_free(&ours);
	picture_free(&truth);
}

/* ---- pictures ---- */

static void write_png(const char *path, int width, int height, const uint8_t *rgb)
{
	char message[512];
	if (!engine_image_write_png(path, width, height, rgb, message, sizeof message))
		fail(message);
}

static void crop(const char *from, const char *part, const char *times_text, const char *to)
{
	char message[512];
	int width, height;
	uint8_t *rgb;
	picture_part p;
	const int times = atoi(times_text);
	if (sscanf(part, "%lf,%lf,%lf,%lf", &p.left, &p.top, &p.right, &p.bottom) != 4 || times < 1 || times > 64 ||
	    !(p.left >= 0 && p.left < p.right && p.right <= 1 && p.top >= 0 && p.top < p.bottom && p.bottom <= 1))
		fail("a part is LEFT,TOP,RIGHT,BOTTOM in shares of the picture, TIMES 1 to 64");
	if (!engine_image_read_png(from, &width, &height, &rgb, message, sizeof message))
		fail(message);
	const int left = (int)(p.left * width), top = (int)(p.top * height);
	const int wide = times * ((int)(p.right * width) - left), high = times * ((int)(p.bottom * height) - top);
	uint8_t *out = wide > 0 && high > 0 ? malloc(3 * (size_t)wide * (size_t)high) : NULL;
	if (!out)
		fail("the part has no pixel, or memory is short");
	for (int y = 0; y < high; y++)
		for (int x = 0; x < wide; x++)
			memcpy(out + 3 * ((size_t)y * (size_t)wide + (size_t)x),
			       rgb + 3 * ((size_t)(top + y / times) * (size_t)width + (size_t)(left + x / times)), 3);
	write_png(to, wide, high, out);
	free(out);
	free(rgb);
}

/* Full colour at about half of what the floor has, W/(m2 sr). */
static const double FULL = 0.05;

static uint8_t shade(double share)
{
	return (uint8_t)lround(255 * fmin(fmax(share, 0), 1));
}

static void difference(const char *ours_path, const char *truth_path, const char *to)
{
	picture a = load(ours_path), b = load(truth_path);
	if (a.width != b.width || a.height != b.height)
		fail("the two pictures are not of one size");
	const size_t count = (size_t)a.width * (size_t)a.height;
	uint8_t *out = calloc(count, 3);
	if (!out)
		fail("out of memory");
	for (size_t k = 0; k < count; k++) {
		double of_a[3], of_b[3];
		for (int c = 0; c < 3; c++) {
			of_a[c] = (double)a.rgb[3 * k + (size_t)c];
			of_b[c] = (double)b.rgb[3 * k + (size_t)c];
		}
		const double more = (picture_luminance(of_a) - picture_luminance(of_b)) / FULL;
		out[3 * k] = shade(more);
		out[3 * k + 2] = shade(-more);
	}
	write_png(to, a.width, a.height, out);
	free(out);
	picture_free(&a);
	picture_free(&b);
}

int main(int argc, char **argv)
{
	engine_output_watch("figure_numbers");
	const char *what = argc > 1 ? argv[1] : "";
	if (argc == 5 && strcmp(what, "four") == 0)
		write_four(argv[2], argv[3], argv[4]);
	else if (argc == 5 && strcmp(what, "five") == 0)
		write_five(argv[2], argv[3], argv[4]);
	else if (argc == 6 && strcmp(what, "crop") == 0)
		crop(argv[2], argv[3], argv[4], argv[5]);
	else if (argc == 5 && strcmp(what, "difference") == 0)
		difference(argv[2], argv[3], argv[4]);
	else {
		fprintf(stderr, "figure_numbers: four OURS TRUTH CSV, five OURS TRUTH CSV, crop IN PART TIMES OUT or "
				"difference OURS TRUTH OUT\n");
		return 2;
	}
	return 0;
}
