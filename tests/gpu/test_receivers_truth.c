/* Receivers against path tracing: texels of walls, vertices of a mesh finer than its cage, and points that look all
 * round, whose light is compared in 26 directions.
 *
 * The reference is Embree's, of the scene's leaves and of a small square at each receiver, in two independent halves,
 * so that its noise drops out. Figures are RMS over a set's points, relative to that of the reference.
 */
#include "harmonics.h"
#include "pieces.h"

#include "tests/reference/leaves.h"
#include "tests/reference/reference_error.h"
#include "scenes/cornell.h"
#include "scenes/scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double LIMIT = 0.05;

/* Where leaves, which are cut as ever, are 6 % too bright themselves: at a row tolerance of 0.003 2 %. */
static const double DARK_LIMIT = 0.11;

/* Against a scene whose Buddha is four times as fine as the one that casts the library's shadows. */
static const double FINER_LIMIT = 0.08;

/* Half a side of the reference's squares, and how far above the surface they lie, metres. */
static const float SQUARE = 1e-3f, LIFT = 1e-3f;

enum { DIRECTIONS = 26 };

typedef struct points {
	float (*at)[3], (*normal)[3];
	uint32_t count;
} points;

static points allocate_points(uint32_t count)
{
	points p = {.at = calloc(count, sizeof *p.at), .normal = calloc(count, sizeof *p.normal), .count = count};
	assert_non_null(p.at);
	assert_non_null(p.normal);
	return p;
}

static void free_points(points *p)
{
	free(p->at);
	free(p->normal);
}

/* ---- the reference ---- */

typedef struct world {
	gi_context *gi;
	gi_leaf *leaves;
	uint32_t count;
	bool open; /* to a black sky */
} world;

static world open_world(const gi_context_def *def)
{
	return (world){.gi = harness_context(def)};
}

/* After the commit and an update. */
static void read_world(world *w)
{
	assert_gi(gi_read_leaves(w->gi, NULL, 0, &w->count));
	w->leaves = calloc(w->count, sizeof *w->leaves);
	assert_non_null(w->leaves);
	assert_gi(gi_read_leaves(w->gi, w->leaves, w->count, &w->count));
}

static void close_world(world *w)
{
	free(w->leaves);
	gi_context_destroy(w->gi);
}

static void cross(const float a[3], const float b[3], float out[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static void normalise(float v[3])
{
	const float length = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
	for (int k = 0; k < 3; k++)
		v[k] /= length;
}

/* A black square about a point, facing along the normal. */
static gi_leaf square_at(const float at[3], const float normal[3])
{
	const int axis = fabsf(normal[0]) < .6f ? 0 : 1;
	float first[3], second[3], least[3] = {0};
	least[axis] = 1;
	cross(least, normal, first);
	normalise(first);
	cross(normal, first, second);
	gi_leaf l = {0};
	for (int c = 0; c < 4; c++)
		for (int k = 0; k < 3; k++)
			l.corners[c][k] = at[k] + LIFT * normal[k] + SQUARE * (c == 0 || c == 3 ? -1 : 1) * first[k] +
					  SQUARE * (c < 2 ? -1 : 1) * second[k];
	return l;
}

/* What falls on points along their normals, in two halves. */
static reference_result trace_points(const world *w, const points *p, uint32_t paths)
{
	gi_leaf *all = calloc(w->count + p->count, sizeof *all);
	assert_non_null(all);
	memcpy(all, w->leaves, sizeof *all * w->count);
	for (uint32_t k = 0; k < p->count; k++)
		all[w->count + k] = square_at(p->at[k], p->normal[k]);
	leaf_scene s;
	assert_true(leaf_scene_make(all, w->count + p->count, &s));
	reference_result out;
	const reference_options options = {.paths_per_leaf = paths, .seed = 1, .first_leaf = w->count};
	assert_true(reference_trace_with(&s.scene, &options, &out));
	leaf_scene_free(&s);
	free(all);
	return out;
}

static reference_error measure(const double *h, const double *first, const double *second, uint32_t count)
{
	double *ones = malloc(sizeof *ones * count);
	assert_non_null(ones);
	for (uint32_t k = 0; k < count; k++)
		ones[k] = 1;
	reference_error e;
	assert_true(reference_error_measure(h, first, second, ones, count, &e));
	free(ones);
	return e;
}

static void expect_within(const char *what, const reference_error *e, double limit)
{
	if (!(e->rms <= limit))
		fail_msg("%s: error of H %g is more than %g", what, e->rms, limit);
}

/* ---- receivers ---- */

static gi_receivers create(world *w, const points *p, float offset, uint32_t harmonics)
{
	gi_receivers_def def = gi_receivers_def_default();
	def.positions = p->at[0];
	def.normals = harmonics ? NULL : p->normal[0];
	def.count = p->count;
	def.offset = offset;
	def.harmonics = harmonics;
	gi_receivers out;
	if (gi_create_receivers(w->gi, &def, &out))
		fail_msg("gi_create_receivers: %s", harness_last_message());
	return out;
}

static float *read_light(world *w, gi_receivers set, uint32_t vectors)
{
	float *light = malloc(4 * sizeof *light * vectors);
	assert_non_null(light);
	uint32_t count;
	assert_gi(gi_read_receivers(w->gi, set, light, vectors, &count));
	assert_int_equal(count, vectors);
	return light;
}

/* scene: what the reference traces, that of w or a finer one. */
static void expect_texels(world *w, const world *scene, const points *p, gi_receivers set, uint32_t paths, double limit,
			  const char *what)
{
	float *light = read_light(w, set, p->count);
	double *h = malloc(3 * sizeof *h * p->count);
	assert_non_null(h);
	reference_widen(light, 4, p->count, h);
	reference_result truth = trace_points(scene, p, paths);
	const size_t from = 3 * (size_t)scene->count;
	const reference_error e = measure(h, truth.irradiance[0] + from, truth.irradiance[1] + from, p->count);
	printf("  %s: %u points, error of H %.2f %%, bias %+.2f %% (reference's noise %.1f %%)\n", what, p->count,
	       100 * e.rms, 100 * e.bias, 100 * e.noise);
	expect_within(what, &e, limit);
	reference_result_free(&truth);
	free(h);
	free(light);
}

/* E along a normal by coefficients. */
static double along(const double *c, uint32_t stride, const float n[3], uint32_t channel)
{
	double basis[9], sum = 0;
	harmonics_of(n, basis);
	for (uint32_t k = 0; k < stride; k++)
		sum += basis[k] * c[3 * k + channel];
	return sum;
}

/* Lebedev's 26 points, and weights with sum 1: exact up to band 7. The axes, middles of edges and corners of a cube. */
static double direction(uint32_t k, float out[3])
{
	static const double weights[3] = {1.0 / 21, 4.0 / 105, 9.0 / 280};
	uint32_t found = 0;
	for (int code = 0; code < 27; code++) {
		const int v[3] = {code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1},
			  parts = abs(v[0]) + abs(v[1]) + abs(v[2]);
		if (parts == 0 || found++ != k)
			continue;
		for (int c = 0; c < 3; c++)
			out[c] = (float)v[c] / sqrtf((float)parts);
		return weights[parts - 1];
	}
	fail();
	return 0;
}

/* Squares on a small ball about each point, which hide nothing from each other. */
static points look_round(const points *p)
{
	points out = allocate_points(DIRECTIONS * p->count);
	for (uint32_t k = 0; k < out.count; k++) {
		direction(k % DIRECTIONS, out.normal[k]);
		for (int c = 0; c < 3; c++)
			out.at[k][c] = p->at[k / DIRECTIONS][c] + .01f * out.normal[k][c];
	}
	return out;
}

/* Coefficients of what falls on a point along the directions. */
static void project(const double *e, uint32_t stride, double *c)
{
	memset(c, 0, 3 * sizeof *c * stride);
	for (uint32_t d = 0; d < DIRECTIONS; d++) {
		float n[3];
		double basis[9];
		const double weight = 4 * acos(-1.0) * direction(d, n);
		harmonics_of(n, basis);
		for (uint32_t k = 0; k < 3 * stride; k++)
			c[k] += weight * basis[k / 3] * e[3 * d + k % 3];
	}
}

static double *project_all(const double *e, uint32_t points, uint32_t stride)
{
	double *c = malloc(3 * sizeof *c * stride * points);
	assert_non_null(c);
	for (uint32_t k = 0; k < points; k++)
		project(e + 3 * DIRECTIONS * (size_t)k, stride, c + 3 * stride * (size_t)k);
	return c;
}

/* Coefficients against those of the reference, all as one vector a point: by Parseval the error of E(n) over all n. And
 * what the bands that are left out make of E along the directions. */
static void expect_probes(world *w, const points *p, gi_receivers set, uint32_t harmonics, uint32_t paths, double limit,
			  const char *what)
{
	const uint32_t stride = (harmonics + 1) * (harmonics + 1), count = stride * p->count;
	float *light = read_light(w, set, count);
	points round = look_round(p);
	reference_result truth = trace_points(w, &round, paths);
	const size_t from = 3 * (size_t)w->count;
	double *c = malloc(3 * sizeof *c * count), *e = malloc(3 * sizeof *e * round.count);
	assert_non_null(c);
	assert_non_null(e);
	reference_widen(light, 4, count, c);
	for (uint32_t k = 0; k < round.count; k++)
		for (uint32_t channel = 0; channel < 3; channel++)
			e[3 * k + channel] =
			    along(c + 3 * stride * (size_t)(k / DIRECTIONS), stride, round.normal[k], channel);
	double *halves[2];
	for (int half = 0; half < 2; half++)
		halves[half] = project_all(truth.irradiance[half] + from, p->count, stride);
	const reference_error coefficients = measure(c, halves[0], halves[1], count);
	const reference_error all = measure(e, truth.irradiance[0] + from, truth.irradiance[1] + from, round.count);
	printf("  %s: %u points, error of coefficients %.2f %%, along 26 directions %.2f %%\n", what, p->count,
	       100 * coefficients.rms, 100 * all.rms);
	expect_within(what, &coefficients, limit);
	for (int half = 0; half < 2; half++)
		free(halves[half]);
	reference_result_free(&truth);
	free(c);
	free(e);
	free_points(&round);
	free(light);
}

/* ---- where they are ---- */

/* Middles of n x n texels of a parallelogram. */
static points texels(const float corner[3], const float u[3], const float v[3], uint32_t n)
{
	points p = allocate_points(n * n);
	for (uint32_t k = 0; k < p.count; k++) {
		const float s = ((float)(k % n) + .5f) / (float)n, t = ((float)(k / n) + .5f) / (float)n;
		for (int c = 0; c < 3; c++)
			p.at[k][c] = corner[c] + s * u[c] + t * v[c];
		cross(u, v, p.normal[k]);
		normalise(p.normal[k]);
	}
	return p;
}

static points grid(const float lower[3], const float upper[3], uint32_t n)
{
	points p = allocate_points(n * n * n);
	for (uint32_t k = 0; k < p.count; k++) {
		const uint32_t place[3] = {k % n, k / n % n, k / n / n};
		for (int c = 0; c < 3; c++)
			p.at[k][c] = lower[c] + (upper[c] - lower[c]) * (float)place[c] / (float)(n - 1);
	}
	return p;
}

/* The vertices of an object's leaves, with normals that are means over the leaves about them. */
static points vertices_of(const world *w, gi_object object)
{
	points p = allocate_points(4 * w->count);
	p.count = 0;
	for (uint32_t l = 0; l < w->count; l++) {
		const gi_leaf *leaf = &w->leaves[l];
		if (leaf->object.index1 != object.index1)
			continue;
		float u[3], v[3], n[3];
		for (int c = 0; c < 3; c++) {
			u[c] = leaf->corners[2][c] - leaf->corners[0][c];
			v[c] = leaf->corners[3][c] - leaf->corners[1][c];
		}
		cross(u, v, n);
		for (int corner = 0; corner < 4; corner++) {
			uint32_t k = 0;
			while (k < p.count && memcmp(p.at[k], leaf->corners[corner], sizeof p.at[k]) != 0)
				k++;
			if (k == p.count)
				memcpy(p.at[p.count++], leaf->corners[corner], sizeof p.at[k]);
			for (int c = 0; c < 3; c++)
				p.normal[k][c] += n[c];
		}
	}
	for (uint32_t k = 0; k < p.count; k++)
		normalise(p.normal[k]);
	return p;
}

/* Moved along their normals, as the receivers are: the squares of the reference are to lie where they do. */
static void lift(points *p, float offset)
{
	for (uint32_t k = 0; k < p->count; k++)
		for (int c = 0; c < 3; c++)
			p->at[k][c] += offset * p->normal[k][c];
}

static gi_context_def world_def(gi_sky sky)
{
	gi_context_def def = harness_def();
	def.solve_tolerance = 1e-3f;
	def.sky = sky;
	return def;
}

static void cornell_with_buddha(void **state)
{
	(void)state;
	const gi_context_def def = world_def(GI_SKY_AUTO);
	world w = open_world(&def), fine = open_world(&def);
	cornell_def box = cornell_def_default();
	cornell made, finer;
	assert_gi(cornell_create(w.gi, &box, &made));
	box.smooth_levels = 1;
	assert_gi(cornell_create(fine.gi, &box, &finer));
	assert_gi(gi_commit(fine.gi));
	read_world(&fine);
	/* As far as the cage's leaves are from its limit surface. */
	static const float OFFSET = .02f;
	points floor = texels((float[]){-2.7f, 0, -2.7f}, (float[]){0, 0, 5.4f}, (float[]){5.4f, 0, 0}, 16);
	points wall = texels((float[]){-2.75f, .1f, -2.7f}, (float[]){0, 5.3f, 0}, (float[]){0, 0, 5.4f}, 10);
	points mesh = vertices_of(&fine, finer.buddha);
	points air = grid((float[]){-2.2f, .5f, -2.2f}, (float[]){2.2f, 5, 2.2f}, 3);
	const gi_receivers on_floor = create(&w, &floor, 0, 0), on_wall = create(&w, &wall, 0, 0),
			   on_mesh = create(&w, &mesh, OFFSET, 0), one = create(&w, &air, 0, 1),
			   two = create(&w, &air, 0, 2);
	assert_gi(gi_commit(w.gi));
	const gi_report report = harness_update(w.gi);
	assert_int_equal(report.outcome, GI_OUTCOME_CONVERGED);
	read_world(&w);
	const uint32_t paths = harness_paths(512);
	expect_texels(&w, &w, &floor, on_floor, paths, LIMIT, "texels of the floor");
	expect_texels(&w, &w, &wall, on_wall, paths, LIMIT, "texels of a wall");
	lift(&mesh, OFFSET);
	expect_texels(&w, &w, &mesh, on_mesh, paths, LIMIT, "vertices of a finer Buddha");
	expect_texels(&w, &fine, &mesh, on_mesh, paths, FINER_LIMIT, "the same, if that were in the box");
	expect_probes(&w, &air, one, 1, paths, LIMIT, "probes, band 1");
	expect_probes(&w, &air, two, 2, paths, LIMIT, "probes, band 2");
	free_points(&floor);
	free_points(&wall);
	free_points(&mesh);
	free_points(&air);
	close_world(&w);
	close_world(&fine);
}

/* ---- dark rooms ---- */

/* A place that receivers are in: texels of its floor, and probes in its air. */
typedef struct place {
	const char *name;
	float lower[3], upper[3];
	uint32_t paths;
	double limit;
} place;

/* Texels of its floor and probes, at the defaults. */
static void expect_place(world *w, const place *p)
{
	const float width = p->upper[0] - p->lower[0], depth = p->upper[2] - p->lower[2], in = .1f;
	points floor = texels((float[]){p->lower[0] + in, p->lower[1], p->lower[2] + in},
			      (float[]){0, 0, depth - 2 * in}, (float[]){width - 2 * in, 0, 0}, 10);
	const float lower[3] = {p->lower[0] + .7f, p->lower[1] + .3f, p->lower[2] + .4f},
		    upper[3] = {p->upper[0] - .7f, p->upper[1] - .3f, p->upper[2] - .4f};
	points air = grid(lower, upper, 2);
	const gi_receivers on_floor = create(w, &floor, 0, 0), in_air = create(w, &air, 0, 2);
	assert_gi(gi_commit(w->gi));
	harness_update(w->gi);
	read_world(w);
	char what[64];
	snprintf(what, sizeof what, "texels of the floor, %s", p->name);
	expect_texels(w, w, &floor, on_floor, harness_paths(p->paths), p->limit, what);
	snprintf(what, sizeof what, "probes, %s", p->name);
	expect_probes(w, &air, in_air, 2, harness_paths(p->paths), p->limit, what);
	free_points(&floor);
	free_points(&air);
	free(w->leaves);
	w->leaves = NULL;
}

static world open_scene(const char *name)
{
	const scene_kind *kind = scene_kind_find(name);
	const gi_context_def def = world_def(kind->sky);
	world w = open_world(&def);
	gi_object mover;
	assert_gi(kind->create(w.gi, &mover));
	assert_gi(gi_set_pose(w.gi, mover, kind->pose(2)));
	return w;
}

/* What reaches the second room comes through the door. */
static void two_rooms(void **state)
{
	(void)state;
	world w = open_scene("rooms");
	expect_place(&w, &(place){"lit room", {-4.2f, 0, -2}, {-.1f, 2.7f, 2}, 1024, LIMIT});
	expect_place(&w, &(place){"dim room", {.1f, 0, -2}, {4.2f, 2.7f, 2}, 8192, LIMIT});
	close_world(&w);
}

static void corridor_of_lamps(void **state)
{
	(void)state;
	world w = open_scene("corridor");
	expect_place(&w, &(place){"corridor", {-1.2f, 0, -8}, {1.2f, 2.6f, 8}, 1024, LIMIT});
	close_world(&w);
}

static void add_blocks(world *w, const box *blocks, size_t count)
{
	for (size_t k = 0; k < count; k++)
		add_block(w->gi, &(harness_object){.name = "wall", .levels = 4, .rho = {.7f, .65f, .6f}}, blocks[k]);
}

static void add_lamp(world *w, const float corner[3], const float u[3], const float v[3])
{
	add_quad(w->gi, &(harness_object){.name = "lamp", .levels = 2, .exitance = {90, 80, 70}}, corner, u, v);
}

/* Three rooms in a row, 4.8, 3.4 and 3.8 m long, whose doors are not opposite each other; the first has the lamp. */
static void behind_two_doors(void **state)
{
	(void)state;
	if (!harness_is_long())
		skip();
	const gi_context_def def = world_def(GI_SKY_OFF);
	world w = open_world(&def);
	add_room(w.gi, &(harness_object){.name = "shell", .levels = 5, .rho = {.7f, .65f, .6f}},
		 (box){{0, 0, 0}, {12, 2.4f, 4}});
	/* Between leaves, which are 0.375 x 0.075 x 0.125 m. */
	static const box WALLS[] = {
	    {{3.75f, 0, 0}, {4.125f, 2.4f, .5f}},       {{3.75f, 0, 1.5f}, {4.125f, 2.4f, 4}},
	    {{3.75f, 2.1f, .5f}, {4.125f, 2.4f, 1.5f}}, {{7.875f, 0, 0}, {8.25f, 2.4f, 2.5f}},
	    {{7.875f, 0, 3.5f}, {8.25f, 2.4f, 4}},      {{7.875f, 2.1f, 2.5f}, {8.25f, 2.4f, 3.5f}}};
	add_blocks(&w, WALLS, sizeof WALLS / sizeof *WALLS);
	add_lamp(&w, (float[]){1, 2.3f, 1.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1});
	expect_place(&w, &(place){"behind a door", {4.125f, 0, 0}, {7.875f, 2.4f, 4}, 8192, LIMIT});
	expect_place(&w, &(place){"behind two doors", {8.25f, 0, 0}, {12, 2.4f, 4}, 32768, DARK_LIMIT});
	close_world(&w);
}

/* What a lamp below the floor sends up through a slit of 19 cm. */
static void attic(void **state)
{
	(void)state;
	if (!harness_is_long())
		skip();
	const gi_context_def def = world_def(GI_SKY_OFF);
	world w = open_world(&def);
	add_room(w.gi, &(harness_object){.name = "shell", .levels = 5, .rho = {.7f, .65f, .6f}},
		 (box){{0, 0, 0}, {6, 4.8f, 4}});
	static const box SLABS[] = {{{0, 2.4f, 0}, {2.625f, 2.7f, 4}}, {{2.8125f, 2.4f, 0}, {6, 2.7f, 4}}};
	add_blocks(&w, SLABS, sizeof SLABS / sizeof *SLABS);
	add_lamp(&w, (float[]){3.5f, 2.3f, 1.5f}, (float[]){1, 0, 0}, (float[]){0, 0, 1});
	expect_place(&w, &(place){"attic", {3, 2.7f, 0}, {6, 4.8f, 4}, 16384, LIMIT});
	close_world(&w);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(cornell_with_buddha), cmocka_unit_test(two_rooms),
					   cmocka_unit_test(corridor_of_lamps), cmocka_unit_test(behind_two_doors),
					   cmocka_unit_test(attic)};
	return cmocka_run_group_tests_name("receivers, truth", tests, harness_open, harness_close);
}
