/* The report's sampling estimate against the error it estimates: that of H against a path tracer, on four scenes.
 *
 * The measure is reference/error.h's, relative, with the reference's own noise removed. The estimate is that of one
 * update; its scatter over updates is printed.
 */
#include "harness.h"

#include "tests/reference/error.h"
#include "tests/reference/reference.h"
#include "scenes/buddha.h"
#include "scenes/cornell.h"
#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What the estimate claims. */
static const double FACTOR = 2;

/* In the furnace error and estimate are both 0 but for rounding: single precision over thousands of terms. */
static const double ROUNDING = 1e-4;

/* RELUME_LONG: the scenes in the size of the demo, and more paths. */
static bool is_long(void)
{
	return getenv("RELUME_LONG") != NULL;
}

static void *allocate(size_t count, size_t size)
{
	void *data = calloc(count, size);
	assert_non_null(data);
	return data;
}

/* ---- scenes ---- */

typedef struct surface {
	const char *name;
	uint32_t levels;
	float rho, exitance;
} surface;

static void add(gi_context *gi, const surface *s, engine_mesh *mesh)
{
	const harness_object o = {.name = s->name,
				  .levels = s->levels,
				  .rho = {s->rho, s->rho, s->rho},
				  .exitance = {s->exitance, s->exitance, s->exitance}};
	harness_add(gi, &o, mesh);
}

static void add_box(gi_context *gi, const surface *s, const float lower[3], const float upper[3], uint32_t n,
		    bool inward)
{
	engine_mesh mesh;
	assert_true(shape_box(lower, upper, n, inward, &mesh));
	add(gi, s, &mesh);
}

/* A square lamp of edge `size` that looks down. */
static void add_lamp(gi_context *gi, const float centre[3], float size, float exitance)
{
	const surface s = {.name = "lamp", .levels = 1, .exitance = exitance};
	const float corner[3] = {centre[0] - size / 2, centre[1], centre[2] - size / 2};
	engine_mesh mesh;
	assert_true(shape_quad(corner, (float[]){size, 0, 0}, (float[]){0, 0, size}, 1, 1, &mesh));
	add(gi, &s, &mesh);
}

/* A Buddha of `height` metres, its foot at `foot`, a leaf for each face of its cage. */
static void add_buddha(gi_context *gi, const float foot[3], float height, float rho, float exitance)
{
	engine_mesh mesh;
	assert_true(buddha_cage(&mesh));
	for (uint32_t k = 0; k < 3 * mesh.vertex_count; k++)
		mesh.positions[k] *= height;
	const harness_object o = {.name = "buddha",
				  .scheme = GI_SCHEME_CATMULL_CLARK,
				  .rho = {rho, rho, rho},
				  .exitance = {exitance, exitance, exitance},
				  .position = {foot[0], foot[1], foot[2]}};
	harness_add(gi, &o, &mesh);
}

static void build_cornell(gi_context *gi)
{
	cornell_def box = cornell_def_default();
	cornell made;
	if (!is_long())
		box.wall_levels = 2;
	assert_gi(cornell_create(gi, &box, &made));
}

static void add_sheet(gi_context *gi, const float corner[3], const float u[3], const float v[3], uint32_t n, uint32_t m)
{
	const harness_object o = {.name = "wall", .levels = 2, .rho = {.6f, .6f, .6f}, .double_sided = true};
	engine_mesh mesh;
	assert_true(shape_quad(corner, u, v, n, m, &mesh));
	harness_add(gi, &o, &mesh);
}

/* 8 x 3 x 4 m, parted by a sheet with a door; the lamp is in one room, the Buddha in the other. The sheet stands where
 * leaves end: no leaf reaches from one room into the other. */
static void build_rooms(gi_context *gi)
{
	const surface room = {.name = "rooms", .levels = is_long() ? 3 : 2, .rho = .7f};
	add_box(gi, &room, (float[]){-4, 0, -2}, (float[]){4, 3, 2}, 4, true);
	add_sheet(gi, (float[]){0, 0, -2}, (float[]){0, 3, 0}, (float[]){0, 0, 1.5f}, 3, 2);
	add_sheet(gi, (float[]){0, 0, .5f}, (float[]){0, 3, 0}, (float[]){0, 0, 1.5f}, 3, 2);
	add_sheet(gi, (float[]){0, 2.25f, -.5f}, (float[]){0, .75f, 0}, (float[]){0, 0, 1}, 1, 1);
	add_lamp(gi, (float[]){-2, 2.9f, 0}, .8f, 50);
	if (is_long())
		add_buddha(gi, (float[]){2, .005f, 0}, 1.5f, .6f, 0);
}

/* 2 x 2.5 x 16 m, a small lamp every metre. */
static void build_corridor(gi_context *gi)
{
	const uint32_t fine = is_long() ? 3 : 2;
	for (int side = 0; side < 6; side++) {
		/* corner, u, v of each wall seen from inside */
		static const float walls[6][3][3] = {
		    {{-1, 0, 0}, {0, 0, 16}, {2, 0, 0}},   {{-1, 2.5f, 0}, {2, 0, 0}, {0, 0, 16}},
		    {{-1, 0, 0}, {0, 2.5f, 0}, {0, 0, 16}}, {{1, 0, 0}, {0, 0, 16}, {0, 2.5f, 0}},
		    {{-1, 0, 0}, {2, 0, 0}, {0, 2.5f, 0}}, {{-1, 0, 16}, {0, 2.5f, 0}, {2, 0, 0}}};
		const surface s = {.name = "wall", .levels = fine, .rho = side < 2 ? .5f : .7f};
		engine_mesh mesh;
		uint32_t n[2];
		for (int k = 0; k < 2; k++)
			n[k] = walls[side][1 + k][2] > 3 ? 8 : 1;
		assert_true(shape_quad(walls[side][0], walls[side][1], walls[side][2], n[0], n[1], &mesh));
		add(gi, &s, &mesh);
	}
	for (int k = 0; k < 16; k++)
		add_lamp(gi, (float[]){k & 1 ? .4f : -.4f, 2.45f, .5f + (float)k}, .12f, 200);
}

/* Rho and E alike on everything: B = E / (1 - rho) everywhere. */
static const float FURNACE_RHO = .5f, FURNACE_E = 1;

static void build_furnace(gi_context *gi)
{
	const surface room = {.name = "room", .levels = 2, .rho = FURNACE_RHO, .exitance = FURNACE_E};
	add_box(gi, &room, (float[]){-1, 0, -1}, (float[]){1, 2, 1}, 3, true);
	add_buddha(gi, (float[]){0, .01f, 0}, 1.5f, FURNACE_RHO, FURNACE_E);
}

typedef struct scene {
	const char *name;
	void (*build)(gi_context *gi);
	gi_sky sky;
	bool furnace;
} scene;

static const scene SCENES[] = {
    {"cornell", build_cornell, GI_SKY_AUTO, false},
    {"two rooms", build_rooms, GI_SKY_AUTO, false},
    {"corridor", build_corridor, GI_SKY_OFF, false}, /* closed by six walls, each an object */
    {"furnace", build_furnace, GI_SKY_AUTO, true},
};
enum { SCENE_COUNT = sizeof SCENES / sizeof *SCENES };

/* ---- reference ---- */

typedef struct truth {
	reference_result traced;
	double *areas;
} truth;

static truth trace_truth(const gi_leaf *leaves, uint32_t count)
{
	float *corners = allocate(12 * count, sizeof *corners), *rho = allocate(3 * count, sizeof *rho),
	      *exitance = allocate(3 * count, sizeof *exitance);
	truth t = {.areas = allocate(count, sizeof *t.areas)};
	for (uint32_t k = 0; k < count; k++) {
		memcpy(corners + 12 * k, leaves[k].corners, sizeof leaves[k].corners);
		memcpy(rho + 3 * k, leaves[k].rho, sizeof leaves[k].rho);
		memcpy(exitance + 3 * k, leaves[k].exitance, sizeof leaves[k].exitance);
	}
	const reference_scene s = {.corners = corners, .rho = rho, .exitance = exitance, .leaf_count = count};
	assert_true(reference_trace(&s, getenv("PATHS") ? (uint32_t)atoi(getenv("PATHS")) : is_long() ? 1024 : 512, 1, &t.traced));
	reference_leaf_areas(&s, t.areas);
	free(corners);
	free(rho);
	free(exitance);
	return t;
}

static void free_truth(truth *t)
{
	reference_result_free(&t->traced);
	free(t->areas);
}

static double measure_error(gi_context *gi, uint32_t count, truth *t)
{
	gi_leaf *leaves = allocate(count, sizeof *leaves);
	assert_gi(gi_read_leaves(gi, leaves, count, &count));
	if (!t->areas)
		*t = trace_truth(leaves, count);
	double *h = allocate(3 * count, sizeof *h);
	for (uint32_t k = 0; k < count; k++)
		for (uint32_t c = 0; c < 3; c++)
			h[3 * k + c] = leaves[k].irradiance[c];
	reference_error e;
	assert_true(reference_error_measure(h, t->traced.irradiance[0], t->traced.irradiance[1], t->areas, count, &e));
	if (getenv("DBG")) {
		double sq[32] = {0}, total = 0, power = 0, bias[32] = {0}, area[32] = {0};
		for (uint32_t k = 0; k < count; k++)
			for (uint32_t c = 0; c < 3; c++) {
				const double a = h[3*k+c]-t->traced.irradiance[0][3*k+c], b = h[3*k+c]-t->traced.irradiance[1][3*k+c];
				sq[leaves[k].object.index1] += t->areas[k]*a*b; total += t->areas[k]*a*b;
				bias[leaves[k].object.index1] += t->areas[k]*(a+b)/2; area[leaves[k].object.index1] += t->areas[k];
				power += t->areas[k]*t->traced.irradiance[0][3*k+c]*t->traced.irradiance[1][3*k+c];
			}
		double A = 0, bb = 0;
		for (int o = 1; o < 32; o++) A += area[o], bb += bias[o];
		for (int o = 1; o < 32; o++) if (area[o] > 0) printf("   object %d area %.2f: share of error %.3f, rms there %.4f bias %.4f of H rms\n", o, area[o]/3, sq[o]/total, sqrt(fmax(0,sq[o]/area[o])/(power/A)), bias[o]/area[o]/sqrt(power/A));
		printf("   mean signed error %.4f of H rms\n", bb/A/sqrt(power/A));
	}
	free(h);
	free(leaves);
	return e.rms;
}

/* ---- the claim ---- */

static gi_context *solved(const scene *s, float row_tolerance, uint32_t near_samples, uint32_t leaves)
{
	gi_context_def def = harness_def();
	def.row_tolerance = row_tolerance;
	def.near_samples = near_samples;
	def.sky = s->sky;
	def.solve_tolerance = 1e-5f;
	def.estimate_leaves = leaves;
	gi_context *gi = harness_context(&def);
	s->build(gi);
	assert_gi(gi_commit(gi));
	assert_int_equal(harness_update(gi).outcome, GI_OUTCOME_CONVERGED);
	return gi;
}

typedef struct series {
	double mean, least, most, deviation; /* mean and deviation of the squares' roots */
} series;

/* Estimates of successive updates of one scene, other leaves each. */
static series repeat(gi_context *gi, int count)
{
	series s = {.least = INFINITY};
	double squares = 0, fourth = 0;
	for (int k = 0; k < count; k++) {
		gi_reset_radiosity(gi);
		const double x = harness_update(gi).sampling_relative;
		s.least = fmin(s.least, x);
		s.most = fmax(s.most, x);
		s.mean += x / count;
		squares += x * x / count;
		fourth += x * x * x * x / count;
	}
	s.deviation = sqrt(fmax(0, squares - s.mean * s.mean));
	s.mean = sqrt(squares);
	(void)fourth;
	return s;
}

static void compare(const scene *s, float row_tolerance, uint32_t near_samples, truth *t)
{
	static const uint32_t LEAVES = 256;
	gi_context *gi = solved(s, row_tolerance, near_samples, LEAVES);
	gi_report report;
	assert_gi(gi_get_report(gi, &report));
	const double error = measure_error(gi, report.leaves, t), estimate = report.sampling_relative;
	const series r = repeat(gi, getenv("REPEAT") ? atoi(getenv("REPEAT")) : 4);
	printf("  %-10s %5.2f %2u %5.0f  %8.4f %% %8.4f %%  %5.2f   %7llu %8.2f  %.3f [%.3f %.3f] %.3f\n", s->name,
	       (double)row_tolerance, near_samples, (double)report.entries / report.leaves, 100 * error, 100 * estimate,
	       estimate / error, (unsigned long long)report.sampling_rays, (double)report.pass_ms[GI_PASS_ESTIMATE],
	       r.mean / error, r.least / error, r.most / error, r.deviation / error);
	gi_context_destroy(gi);
}

static void estimate_within_a_factor(void **state)
{
	(void)state;
	static const float tolerances[4] = {.1f, .03f, .01f, .003f};
	for (int k = getenv("SC") ? atoi(getenv("SC")) : 0; k < (getenv("SC") ? atoi(getenv("SC")) + 1 : SCENE_COUNT); k++) {
		truth t = {0};
		for (int n = 0; n < (getenv("N1")?1:2); n++)
			for (int j = getenv("T0")?atoi(getenv("T0")):0; j < (getenv("T1")?atoi(getenv("T1")):3); j++)
				compare(&SCENES[k], tolerances[j], n ? 4 : 1, &t);
		free_truth(&t);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(estimate_within_a_factor)};
	setvbuf(stdout, NULL, _IOLBF, 0);
	(void)FACTOR; (void)ROUNDING;
	return cmocka_run_group_tests_name("estimate", tests, harness_open, harness_close);
}
