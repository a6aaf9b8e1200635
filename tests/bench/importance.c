/* What it is worth that visibility rays go where light comes from: error of the irradiance at equal rays, with and
 * without, in four scenes: those of the benchmarks but for the furnace, where all places are alike, and a room full of
 * boxes.
 *
 * Two things are left out, one at a time and both: that an entry has the more rays the more light it may carry
 * (sampling_of in trace.glsl), and that its segments are drawn by what they carry (CANDIDATES). Without the first each
 * entry has the same number. The library knows of neither switch: shaders are read from a folder in which trace.glsl is
 * another one. Errors are against path tracing of the same leaves, in two halves whose noise drops out. Prints figures,
 * never passes or fails on one.
 */
#define _XOPEN_SOURCE 700 /* mkdtemp, symlink */
#include "bench_options.h"
#include "bench_scene.h"
#include "gi/gi.h"
#include "scenes/body.h"
#include "scenes/scenes.h"
#include "scenes/shapes.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct options {
	const char *scene; /* NULL: all */
	uint32_t paths;    /* a leaf, of each half of the truth */
	float row_tolerance;
} options;

/* ---- scenes ---- */

/* A closed room of 4 m, 27 boxes hanging in it, a lamp of 0.4 m below its ceiling. */
static gi_result create_boxes(gi_context *gi, gi_object *mover)
{
	static const float walls[3] = {.7f, .6f, .5f}, box[3] = {.3f, .5f, .7f}, black[3] = {0, 0, 0},
			   lamp[3] = {50, 50, 50};
	engine_mesh mesh;
	gi_object object;
	if (!shape_box((const float[]){-2, 0, -2}, (const float[]){2, 4, 2}, 10, true, &mesh))
		return GI_ERROR_OUT_OF_MEMORY;
	gi_result result = scene_add_body(gi, &(scene_body){.name = "room", .rho = walls}, &mesh, &object);
	for (int k = 0; !result && k < 27; k++) {
		const float x = (float)(k % 3) - 1, y = (float)(k / 3 % 3) + .7f, z = (float)(k / 9) - 1;
		if (!shape_box((const float[]){-.2f, -.2f, -.2f}, (const float[]){.2f, .2f, .2f}, 3, false, &mesh))
			return GI_ERROR_OUT_OF_MEMORY;
		result =
		    scene_add_body(gi, &(scene_body){.name = "box", .rho = box, .position = {x, y, z}}, &mesh, mover);
	}
	if (!result && !shape_quad((const float[]){-.2f, 3.9f, -.2f}, (const float[]){.4f, 0, 0},
				   (const float[]){0, 0, .4f}, 2, 2, &mesh))
		return GI_ERROR_OUT_OF_MEMORY;
	return result
		   ? result
		   : scene_add_body(gi, &(scene_body){.name = "lamp", .rho = black, .exitance = lamp}, &mesh, &object);
}

static const scene_kind BOXES = {.name = "boxes", .sky = GI_SKY_OFF, .create = create_boxes};

enum { SCENES = 4 };

static const scene_kind *scene_of(int k)
{
	static const char *const names[SCENES - 1] = {"cornell", "rooms", "corridor"};
	return k < SCENES - 1 ? scene_kind_find(names[k]) : &BOXES;
}

static bool is_wanted(const options *o, int k)
{
	return !o->scene || strcmp(o->scene, scene_of(k)->name) == 0;
}

/* ---- shaders ---- */

typedef struct change {
	const char *from, *to;
} change;

static const change ALIKE = {"return sampling(wanted, probes, emitter ? min(wanted, HIDDEN_PROBES) : probes);",
			     "return sampling(frame.limits.z, frame.limits.z, frame.limits.z);"};
static const change ANY = {"const uint CANDIDATES = 4u;", "const uint CANDIDATES = 1u;"};

typedef struct variant {
	const char *name;
	const change *changes[2];
	bool alike; /* all entries have as many rays as near ones */
} variant;

static const variant VARIANTS[] = {{"as it is", {NULL, NULL}, false},
				   {"any segments", {&ANY, NULL}, false},
				   {"rays alike", {&ALIKE, NULL}, true},
				   {"neither", {&ALIKE, &ANY}, true}};
enum { VARIANT_COUNT = sizeof VARIANTS / sizeof *VARIANTS };

static void for_each_shader(const char *folder, void (*act)(const char *folder, const char *name))
{
	DIR *shaders = opendir(RELUME_SOURCE_DIR "/shaders");
	if (!shaders)
		fail("the shaders' folder is not there");
	for (const struct dirent *entry; (entry = readdir(shaders));)
		if (entry->d_name[0] != '.')
			act(folder, entry->d_name);
	closedir(shaders);
}

static void link_shader(const char *folder, const char *name)
{
	char from[1024], to[1024];
	snprintf(from, sizeof from, RELUME_SOURCE_DIR "/shaders/%s", name);
	snprintf(to, sizeof to, "%s/%s", folder, name);
	if (symlink(from, to))
		fail("a shader cannot be linked to");
}

static void unlink_shader(const char *folder, const char *name)
{
	char path[1024];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	unlink(path);
}

static char *read_text(const char *path)
{
	FILE *file = fopen(path, "r");
	enum { MOST = 1 << 20 };
	char *text = calloc(1, MOST);
	if (!file || !text || !fread(text, 1, MOST - 1, file))
		fail("trace.glsl cannot be read");
	fclose(file);
	return text;
}

static void write_changed(const char *folder, const change *c)
{
	char path[1024];
	snprintf(path, sizeof path, "%s/trace.glsl", folder);
	char *text = read_text(path), *at = strstr(text, c->from);
	if (!at)
		fail("trace.glsl is not what this program changes: see its first lines");
	unlink(path);
	FILE *file = fopen(path, "w");
	if (!file || fprintf(file, "%.*s%s%s", (int)(at - text), text, c->to, at + strlen(c->from)) < 0 || fclose(file))
		fail("trace.glsl cannot be written");
	free(text);
}

/* ---- errors ---- */

typedef struct session {
	const options *options;
	engine_context *context;
	const scene_kind *kind;
	uint32_t leaves;
	float *truth[2]; /* 3 a leaf */
} session;

static gi_context *open_gi(const session *s, const char *shaders)
{
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = engine_context_find_gl;
	def.get_proc_user = s->context;
	def.row_tolerance = s->options->row_tolerance;
	def.solve_tolerance = 0.01f;
	def.sky = s->kind->sky;
	def.shader_directory = shaders;
	gi_context *gi;
	gi_object mover;
	check(gi_context_create(&def, &gi));
	check(s->kind->create(gi, &mover));
	check(gi_commit(gi));
	bench_step(gi);
	return gi;
}

static void find_truth(session *s)
{
	gi_context *gi = open_gi(s, NULL);
	check(gi_read_leaves(gi, NULL, 0, &s->leaves));
	for (uint32_t half = 0; half < 2; half++) {
		const gi_path_options paths = {s->options->paths, half + 1};
		uint32_t count;
		s->truth[half] = calloc(3 * (size_t)s->leaves + 1, sizeof(float));
		if (!s->truth[half])
			fail("out of memory");
		check(gi_trace_paths(gi, &paths, s->truth[half], s->leaves, &count));
	}
	gi_context_destroy(gi);
}

/* Area-weighted RMS of H less the truth, of RMS H. */
static double error_of(const session *s, gi_context *gi)
{
	gi_leaf *leaves = calloc((size_t)s->leaves + 1, sizeof *leaves);
	uint32_t count;
	if (!leaves)
		fail("out of memory");
	check(gi_read_leaves(gi, leaves, s->leaves, &count));
	double error = 0, power = 0;
	for (uint32_t leaf = 0; leaf < count; leaf++)
		for (uint32_t c = 0; c < 3; c++) {
			const double h = (double)leaves[leaf].irradiance[c], area = (double)leaves[leaf].area;
			const double one = (double)s->truth[0][3 * leaf + c], other = (double)s->truth[1][3 * leaf + c];
			error += area * (h - one) * (h - other);
			power += area * one * other;
		}
	free(leaves);
	return sqrt(fmax(error, 0) / power);
}

/* ---- a series of settings ---- */

enum { SETTINGS = 4 };
static const uint32_t NEAR[SETTINGS] = {1, 2, 4, 8}, EMITTER[SETTINGS] = {4, 4, 8, 16};

typedef struct series {
	double rays[SETTINGS], errors[SETTINGS];
} series;

static series measure(const session *s, const variant *v)
{
	char folder[] = "/tmp/relume-importance-XXXXXX";
	if (!mkdtemp(folder))
		fail("no folder for shaders can be made");
	for_each_shader(folder, link_shader);
	for (int k = 0; k < 2 && v->changes[k]; k++)
		write_changed(folder, v->changes[k]);
	gi_context *gi = open_gi(s, folder);
	series out;
	for (int k = 0; k < SETTINGS; k++) {
		check(gi_set_rows(gi, s->options->row_tolerance, 20, EMITTER[k], NEAR[k]));
		out.rays[k] = (double)bench_step(gi).rays;
		out.errors[k] = error_of(s, gi);
		printf("| %s | %s | %u%s | %.0f | %.2f |\n", s->kind->name, v->name, NEAR[k],
		       v->alike          ? ""
		       : EMITTER[k] == 4 ? ", 4"
		       : EMITTER[k] == 8 ? ", 8"
					 : ", 16",
		       out.rays[k], 100 * out.errors[k]);
		fflush(stdout);
	}
	gi_context_destroy(gi);
	for_each_shader(folder, unlink_shader);
	rmdir(folder);
	return out;
}

/* Error at so many rays, between settings as a power of the rays; below 0: outside of them. */
static double error_at(const series *s, double rays)
{
	for (int k = 0; k + 1 < SETTINGS; k++)
		if (rays >= s->rays[k] && rays <= s->rays[k + 1]) {
			const double along = log(rays / s->rays[k]) / log(s->rays[k + 1] / s->rays[k]);
			return s->errors[k] * pow(s->errors[k + 1] / s->errors[k], along);
		}
	return -1;
}

static void run_scene(session *s, double at_equal[VARIANT_COUNT], double *rays)
{
	series all[VARIANT_COUNT];
	find_truth(s);
	for (int v = 0; v < VARIANT_COUNT; v++)
		all[v] = measure(s, &VARIANTS[v]);
	/* Where all have settings on both sides: the geometric mean of what they share. */
	double low = 0, high = INFINITY;
	for (int v = 0; v < VARIANT_COUNT; v++) {
		low = fmax(low, all[v].rays[0]);
		high = fmin(high, all[v].rays[SETTINGS - 1]);
	}
	*rays = sqrt(low * high);
	for (int v = 0; v < VARIANT_COUNT; v++)
		at_equal[v] = error_at(&all[v], *rays);
	free(s->truth[0]);
	free(s->truth[1]);
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
	options *o = state->input;
	switch (key) {
	case 'n':
		o->scene = argument;
		for (int k = 0; k < SCENES; k++)
			if (is_wanted(o, k))
				return 0;
		argp_error(state, "there is no scene '%s'", argument);
		return EINVAL;
	case 'p':
		o->paths = bench_parse_count(argument, 1, 1 << 20, "paths", state);
		return 0;
	case 't':
		o->row_tolerance = bench_parse_number(argument, 1e-3f, 1, "row-tolerance", state);
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

int main(int argc, char **argv)
{
	static const struct argp_option list[] = {
	    {"scene", 'n', "NAME", 0, "one of cornell, rooms, corridor, boxes; default all", 0},
	    {"paths", 'p', "N", 0, "of each leaf, for each half of the truth; default 256", 0},
	    {"row-tolerance", 't', "T", 0, "default 0.1", 0},
	    {0},
	};
	const bench_command command = {"gi_importance",
				       "Error at equal rays, with rays that go where light comes from "
				       "and without.",
				       list, parse_option};
	options o = {.paths = 256, .row_tolerance = 0.1f};
	const engine_context_kind kind = bench_parse(&command, argc, argv, &o);
	session s = {.options = &o, .context = bench_open_window(kind, 64)};
	double at_equal[SCENES][VARIANT_COUNT], rays[SCENES];
	printf("| scene | rays | near samples, of emitters | rays taken | error, %% |\n|---|---|---|---|---|\n");
	for (int k = 0; k < SCENES; k++) {
		s.kind = scene_of(k);
		if (is_wanted(&o, k))
			run_scene(&s, at_equal[k], &rays[k]);
	}
	printf("\n| scene | rays |");
	for (int v = 0; v < VARIANT_COUNT; v++)
		printf(" %s |", VARIANTS[v].name);
	printf("\n|---|---|---|---|---|---|\n");
	for (int k = 0; k < SCENES; k++) {
		if (!is_wanted(&o, k))
			continue;
		printf("| %s | %.0f |", scene_of(k)->name, rays[k]);
		for (int v = 0; v < VARIANT_COUNT; v++)
			printf(" %.2f |", 100 * at_equal[k][v]);
		printf("\n");
	}
	engine_context_destroy(s.context);
	return 0;
}
