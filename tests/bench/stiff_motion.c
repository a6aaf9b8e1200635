/* Distance to the solution by frame while a scene that reflects nearly everything moves, a few sweeps a frame: the
 * library, and Jacobi, from the light of the last frame and from a cold start.
 *
 * The solution is in double precision, of the very rows of the frame. The library cannot be told to keep to Jacobi, so
 * that is done here, on the CPU, in double precision, over the same links with the same sweeps.
 * Prints figures, never passes or fails on one.
 */
#include "bench_options.h"
#include "bench_scene.h"
#include "frame_rows.h"
#include "output.h"
#include "scenes/body.h"
#include "scenes/shapes.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

typedef struct options {
	const char *out;
	uint32_t moving, resting; /* frames */
	uint32_t sweeps;          /* a frame */
	float tolerance;
} options;

static const float RHOS[] = {0.9f, 0.99f, 0.999f, 0.9999f};
enum { RHO_COUNT = sizeof RHOS / sizeof *RHOS, MOST_FRAMES = 1000 };

typedef enum solver { LIBRARY, JACOBI, SOLVERS } solver;
typedef enum start { WARM, COLD, STARTS } start;
static const char *const solver_names[SOLVERS] = {"library", "Jacobi"}, *const start_names[STARTS] = {"warm", "cold"};

/* Distances are over the largest R = B - E of the solution. */
typedef struct frame_record {
	double distance[SOLVERS][STARTS];
	double bound[STARTS]; /* certified by the library */
	uint32_t sweeps[STARTS];
} frame_record;

typedef struct scene_record {
	frame_record frames[MOST_FRAMES];
	uint32_t leaves, jacobi_sweeps; /* foretold at the first frame */
	double amplification;
} scene_record;

/* ---- the scene ---- */

typedef struct room {
	gi_context *gi;
	gi_object box, lamp;
} room;

/* A box outward or inward; closed, so that no side of it is black. */
static gi_object add_box(gi_context *gi, const float lower[3], const float upper[3], bool inward, uint32_t levels,
			 gi_material material)
{
	engine_mesh mesh;
	if (!shape_box(lower, upper, 1, inward, &mesh))
		fail("out of memory");
	gi_object_def def = scene_mesh_def(&mesh);
	def.levels = levels;
	def.materials = &material;
	def.material_count = 1;
	gi_object object;
	check(gi_create_object(gi, &def, &object));
	engine_mesh_free(&mesh);
	return object;
}

static room open_room(const options *o, engine_context *context, float rho)
{
	gi_context_def def = gi_context_def_default();
	def.get_proc_address = engine_context_find_gl;
	def.get_proc_user = context;
	def.row_tolerance = 0.1f;
	def.solve_tolerance = o->tolerance;
	def.max_sweeps = o->sweeps;
	def.profile = false;
	room r;
	check(gi_context_create(&def, &r.gi));
	const gi_material wall = {.rho = {rho, rho, rho}};
	const gi_material bright = {.rho = {rho, rho, rho}, .exitance = {30, 30, 90}};
	add_box(r.gi, (float[]){-2, 0, -2}, (float[]){2, 3, 2}, true, 3, wall);
	r.box = add_box(r.gi, (float[]){-.5f, -.5f, -.5f}, (float[]){.5f, .5f, .5f}, false, 2, wall);
	r.lamp = add_box(r.gi, (float[]){-.3f, -.05f, -.3f}, (float[]){.3f, .05f, .3f}, false, 1, bright);
	return r;
}

/* Some 10 cm a frame: the box round the middle of the room, turning, the lamp to and fro below the ceiling. */
static void pose(const room *r, uint32_t frame)
{
	const float t = (float)frame, turn = 0.04f * t, way = 0.12f * t;
	check(gi_set_pose(r->gi, r->box,
			  (gi_pose){{.9f * cosf(way), .9f, .9f * sinf(way)}, {0, sinf(turn), 0, cosf(turn)}}));
	check(
	    gi_set_pose(r->gi, r->lamp, (gi_pose){{1.2f * sinf(.08f * t), 2.6f, 1.2f * cosf(.11f * t)}, {0, 0, 0, 1}}));
}

/* ---- measuring ---- */

/* B of Jacobi, three a leaf. */
static double *cold_start(const frame_rows *rows)
{
	double *b = calloc(frame_rows_values(rows), sizeof *b);
	if (!b)
		fail("out of memory");
	frame_rows_start(rows, b);
	return b;
}

static double distance_of_jacobi(const options *o, const frame_rows *rows, double *b)
{
	if (!frame_rows_sweep(rows, o->sweeps, b))
		fail("out of memory");
	return frame_rows_distance(rows, b);
}

/* Both contexts hold the same rows; *jacobi is the warm one's B, NULL before the first frame. */
static void measure(const options *o, const room rooms[STARTS], const gi_report reports[STARTS], double **jacobi,
		    frame_record *record)
{
	frame_rows *rows = frame_rows_read(rooms[WARM].gi);
	if (!rows)
		fail("the double-precision solution was not found");
	double *cold = cold_start(rows);
	if (!*jacobi)
		*jacobi = cold_start(rows);
	const double scale = 1 / frame_rows_reflected(rows);
	record->distance[JACOBI][COLD] = scale * distance_of_jacobi(o, rows, cold);
	record->distance[JACOBI][WARM] = scale * distance_of_jacobi(o, rows, *jacobi);
	for (int k = 0; k < STARTS; k++) {
		double distance;
		if (!frame_rows_context_distance(rows, rooms[k].gi, &distance))
			fail("B cannot be read");
		record->distance[LIBRARY][k] = scale * distance;
		record->bound[k] = scale * (double)reports[k].solve_bound;
		record->sweeps[k] = reports[k].sweeps;
	}
	free(cold);
	frame_rows_free(rows);
}

static void run_scene(const options *o, engine_context *context, float rho, scene_record *record)
{
	room rooms[STARTS];
	for (int k = 0; k < STARTS; k++) {
		rooms[k] = open_room(o, context, rho);
		check(gi_commit(rooms[k].gi));
	}
	double *jacobi = NULL;
	for (uint32_t frame = 0; frame < o->moving + o->resting; frame++) {
		gi_report reports[STARTS];
		gi_reset_radiosity(rooms[COLD].gi);
		for (int k = 0; k < STARTS; k++) {
			if (frame < o->moving)
				pose(&rooms[k], frame);
			reports[k] = bench_step(rooms[k].gi);
		}
		if (frame == 0) {
			record->leaves = reports[COLD].leaves;
			record->jacobi_sweeps = reports[COLD].jacobi_sweeps;
			record->amplification = (double)reports[COLD].amplification;
		}
		measure(o, rooms, reports, &jacobi, &record->frames[frame]);
	}
	free(jacobi);
	for (int k = 0; k < STARTS; k++)
		gi_context_destroy(rooms[k].gi);
}

/* ---- output ---- */

static FILE *open_file(const options *o, const char *name, engine_output *output)
{
	char path[1024], message[512];
	snprintf(path, sizeof path, "%s/%s", o->out, name);
	if (!engine_output_open(output, path, message, sizeof message))
		fail(message);
	return output->file;
}

static void close_file(engine_output *output)
{
	char message[512];
	if (!engine_output_close(output, true, message, sizeof message))
		fail(message);
}

static void write_csv(const options *o, const scene_record *records)
{
	engine_output output;
	FILE *out = open_file(o, "stiff-motion.csv", &output);
	fprintf(out, "rho,frame,moving,solver,start,sweeps,distance,bound\n");
	for (int r = 0; r < RHO_COUNT; r++)
		for (uint32_t f = 0; f < o->moving + o->resting; f++)
			for (int solver = 0; solver < SOLVERS; solver++)
				for (int start = 0; start < STARTS; start++) {
					const frame_record *k = &records[r].frames[f];
					fprintf(out, "%g,%u,%d,%s,%s,", (double)RHOS[r], f, f < o->moving,
						solver_names[solver], start_names[start]);
					if (solver == LIBRARY)
						fprintf(out, "%u,%.6g,%.6g\n", k->sweeps[start],
							k->distance[solver][start], k->bound[start]);
					else
						fprintf(out, "%u,%.6g,\n", o->sweeps, k->distance[solver][start]);
				}
	close_file(&output);
}

/* Of the moving frames the second half, when warm starts have had time to get somewhere: median and worst, %. */
static void print_moving(const options *o, const scene_record *r, solver solver, start start, FILE *out)
{
	static samples distances;
	distances.count = 0;
	for (uint32_t f = o->moving / 2; f < o->moving; f++)
		samples_add(&distances, 100 * r->frames[f].distance[solver][start]);
	fprintf(out, " %.3g, %.3g |", samples_median(&distances), samples_quantile(&distances, 1));
}

static double most_over_cold(const options *o, const scene_record *r)
{
	double most = 0;
	for (uint32_t f = 0; f < o->moving; f++)
		most = fmax(most, r->frames[f].distance[LIBRARY][WARM] / r->frames[f].distance[LIBRARY][COLD]);
	return most;
}

static double most_of_bound(const options *o, const scene_record *r)
{
	double most = 0;
	for (uint32_t f = 0; f < o->moving + o->resting; f++)
		for (int k = 0; k < STARTS; k++)
			most = fmax(most, r->frames[f].distance[LIBRARY][k] / r->frames[f].bound[k]);
	return most;
}

static void print_table(const options *o, const scene_record *records, FILE *out)
{
	fprintf(out,
		"| rho | A | Jacobi's sweeps, foretold | library, warm | library, cold | Jacobi, warm | Jacobi, cold "
		"| library, warm, at rest | Jacobi, warm, at rest | warm over cold, at most | distance over certified "
		"bound, at most |\n"
		"|---|---|---|---|---|---|---|---|---|---|---|\n");
	for (int k = 0; k < RHO_COUNT; k++) {
		const scene_record *r = &records[k];
		const frame_record *last = &r->frames[o->moving + o->resting - 1];
		fprintf(out, "| %g | %.0f | %u |", (double)RHOS[k], r->amplification, r->jacobi_sweeps);
		for (int solver = 0; solver < SOLVERS; solver++)
			for (int start = 0; start < STARTS; start++)
				print_moving(o, r, solver, start, out);
		fprintf(out, " %.2g | %.2g | %.2g | %.2g |\n", 100 * last->distance[LIBRARY][WARM],
			100 * last->distance[JACOBI][WARM], most_over_cold(o, r), most_of_bound(o, r));
	}
}

static void write_document(const options *o, engine_context *context, const scene_record *records)
{
	engine_output output;
	FILE *out = open_file(o, "stiff-motion.md", &output);
	fprintf(
	    out,
	    "# Stiff scenes that move\n\n"
	    "Made by `scripts/bench stiff-motion --docs`; every figure is of that one run.\n\n"
	    "How far B is from the solution of the frame's rows, in double precision, at the leaf and channel that "
	    "is off\n"
	    "most, over the largest R = B - E of the solution. A closed room of 4 x 3 x 4 m, %u leaves, rows at "
	    "0.1; walls,\n"
	    "a box of 1 m and a lamp of 30, 30, 90 W/m2 have one rho. Box and lamp move by some 10 cm a frame for "
	    "%u frames\n"
	    "and rest for %u. Each frame takes %u sweeps, fewer where the\n"
	    "tolerance, %g, is met before; behind the first the library brings the flux into balance, of a cold start "
	    "too.\n"
	    "Warm is from the light of the last frame, cold from B = E. Jacobi is "
	    "computed on\n"
	    "the CPU in double precision, over the same links: the library has no switch for it.\n\n"
	    "![Distance to the solution by frame](pictures/stiff-motion.png)\n\n"
	    "In %% where nothing else is said. While it moves: median and worst frame of the second half. At rest: "
	    "the last\n"
	    "frame. A: the amplification, 1 / (1 - rho) at most. The last two columns are the library's.\n\n",
	    records[0].leaves, o->moving, o->resting, o->sweeps, (double)o->tolerance);
	print_table(o, records, out);
	fprintf(out, "\n- %s\n- commit %s\n", engine_context_describe(context), RELUME_COMMIT);
	close_file(&output);
}

/* ---- options ---- */

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
	options *o = state->input;
	switch (key) {
	case 'o':
		o->out = argument;
		return 0;
	case 'm':
		o->moving = bench_parse_count(argument, 2, MOST_FRAMES / 2, "moving", state);
		return 0;
	case 'r':
		o->resting = bench_parse_count(argument, 1, MOST_FRAMES / 2, "resting", state);
		return 0;
	case 's':
		o->sweeps = bench_parse_count(argument, 1, 1000, "sweeps", state);
		return 0;
	case 't':
		o->tolerance = bench_parse_number(argument, 1e-12f, 1, "tolerance", state);
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

int main(int argc, char **argv)
{
	static const struct argp_option list[] = {
	    {"out", 'o', "FOLDER", 0, "where stiff-motion.csv and stiff-motion.md go, default out", 0},
	    {"moving", 'm', "N", 0, "frames in which box and lamp move, default 100", 0},
	    {"resting", 'r', "N", 0, "frames at rest after them, default 50", 0},
	    {"sweeps", 's', "N", 0, "a frame, default 8", 0},
	    {"tolerance", 't', "T", 0, "of the solve, default 1e-4: sweeps are the limit", 0},
	    {0},
	};
	const bench_command command = {
	    "gi_stiff_motion", "Distance to the solution by frame in stiff scenes that move.", list, parse_option};
	options o = {.out = "out", .moving = 100, .resting = 50, .sweeps = 8, .tolerance = 1e-4f};
	const engine_context_kind kind = bench_parse(&command, argc, argv, &o);
	if (mkdir(o.out, 0777) && errno != EEXIST)
		fail("the folder --out cannot be made");

	engine_context *context = bench_open_window(kind, 64);
	static scene_record records[RHO_COUNT];
	for (int k = 0; k < RHO_COUNT; k++)
		run_scene(&o, context, RHOS[k], &records[k]);
	write_csv(&o, records);
	write_document(&o, context, records);
	print_table(&o, records, stdout);
	engine_context_destroy(context);
	return 0;
}
