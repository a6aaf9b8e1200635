/* The reference tested against what needs no reference: closed forms, furnaces, energy balance. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../reference/reference_error.h"
#include "../reference/exact.h"
#include "../reference/reference.h"
#include "../reference/solver.h"

static void check_near(double got, double wanted, double tolerance, const char *what, const char *file, int line)
{
	if (fabs(got - wanted) <= tolerance)
		return;
	print_error("%s: got %.13g, wanted %.13g +- %.3g\n", what, got, wanted, tolerance);
	_fail(file, line);
}

#define CHECK_NEAR(got, wanted, tolerance) check_near(got, wanted, tolerance, #got, __FILE__, __LINE__)

/* ---- closed forms ---- */

static const double PI = 3.14159265358979323846;

/* The values are catalogue values to 12 digits: half a unit of the last is 5e-13. */
static void test_exact_rectangles_and_discs(void **state)
{
	(void)state;
	const exact_occluder quarter = {0, 0.5, 0, 0.5, 0.5};
	CHECK_NEAR(exact_parallel_rectangles(1, 1, 1), 0.199824895698, 1e-12);
	CHECK_NEAR(exact_parallel_rectangles(4, 2, 1), 0.508988669041, 1e-12);
	CHECK_NEAR(exact_parallel_rectangles(10, 10, 1), 0.826994522397, 1e-12);
	CHECK_NEAR(exact_perpendicular_rectangles(1, 1, 1), 0.200043776075, 1e-12);
	CHECK_NEAR(exact_perpendicular_rectangles(2, 1, 1), 0.232852602795, 1e-12);
	CHECK_NEAR(exact_coaxial_discs(1, 1, 1), 0.381966011250, 1e-12);
	CHECK_NEAR(exact_parallel_rectangles_occluded(1, 1, 1, &quarter), 0.149868671774, 1e-12);
}

/* 8 digits are known; the integral is cut at its kinks, where it still has square-root ends (1e-9). */
static void test_exact_spheres(void **state)
{
	(void)state;
	CHECK_NEAR(exact_sphere_sphere(1, 1, 3), 0.02959031, 1e-8);
	CHECK_NEAR(exact_sphere_sphere(2, 0.5, 4), exact_sphere_sphere(0.5, 2, 4) / 16, 1e-8);
	CHECK_NEAR(exact_element_sphere(1, 2, 1), 0.25, 1e-15);
	CHECK_NEAR(exact_element_sphere(1, 2, 0.7), 0.175, 1e-15);
	CHECK_NEAR(exact_element_sphere(1, 2, -0.5), 0, 1e-15);
	/* the two branches meet where the horizon touches the sphere; the square root's end leaves 1e-8 */
	CHECK_NEAR(exact_element_sphere(1, 2, 0.5 - 1e-9), 0.125, 1e-8);
}

static void test_exact_reciprocity(void **state)
{
	(void)state;
	/* A1 F12 = A2 F21 with A = w l and h l, pi r^2 */
	CHECK_NEAR(exact_perpendicular_rectangles(3, 0.7, 2) * 0.7, exact_perpendicular_rectangles(0.7, 3, 2) * 3,
		   1e-13);
	CHECK_NEAR(exact_coaxial_discs(0.3, 2, 1.5) * 0.09, exact_coaxial_discs(2, 0.3, 1.5) * 4, 1e-13);
	/* a unit cube closes: 1 opposite face and 4 beside */
	CHECK_NEAR(exact_parallel_rectangles(1, 1, 1) + 4 * exact_perpendicular_rectangles(1, 1, 1), 1, 1e-13);
	/* an occluder that covers the far rectangle's whole view blocks all, one beside the shaft nothing */
	const exact_occluder all = {-1, 2, -1, 2, 0.5}, beside = {2, 3, 0, 1, 0.5};
	CHECK_NEAR(exact_parallel_rectangles_occluded(1, 1, 1, &all), 0, 1e-12);
	CHECK_NEAR(exact_parallel_rectangles_occluded(1, 1, 1, &beside), exact_parallel_rectangles(1, 1, 1), 1e-12);
}

static void test_exact_polygon(void **state)
{
	(void)state;
	const double origin[3] = {0, 0, 0}, up[3] = {0, 0, 1};
	/* clockwise seen from above is counter-clockwise seen from below, where the point is */
	const double box[12] = {0, 0, 1, 0, 2, 1, 3, 2, 1, 3, 0, 1}, back[12] = {3, 0, 1, 3, 2, 1, 0, 2, 1, 0, 0, 1};
	const double wall[12] = {1, -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1},
		     upper[12] = {1, -1, 0, 1, 1, 0, 1, 1, 1, 1, -1, 1};
	CHECK_NEAR(exact_element_polygon(origin, up, box, 4), exact_element_rectangle(3, 2, 1), 1e-14);
	CHECK_NEAR(exact_element_polygon(origin, up, back, 4), -exact_element_rectangle(3, 2, 1), 1e-14);
	/* the half of the wall below the horizon does not count */
	CHECK_NEAR(fabs(exact_element_polygon(origin, up, wall, 4)), fabs(exact_element_polygon(origin, up, upper, 4)),
		   1e-14);
	assert_true(fabs(exact_element_polygon(origin, up, wall, 4)) > 0.05);
}

/* A 32-gon of the given circumradius about the axis at height 1, front towards the origin. */
static void polygon_disc(double radius, double corners[96])
{
	for (int i = 0; i < 32; i++) {
		double phi = -2 * PI * i / 32;
		corners[3 * i] = radius * cos(phi), corners[3 * i + 1] = radius * sin(phi), corners[3 * i + 2] = 1;
	}
}

/* The cone of a sphere of radius 1 at distance 2 has the tangent 1/sqrt(3): it lies between the inscribed and the
 * circumscribed 32-gon (1 % apart in area), also from elements whose horizon cuts it. Uncut, F = cosine * F(facing),
 * and facing the contour has 32 equal terms: that value is exact. */
static void test_exact_polygon_against_sphere(void **state)
{
	(void)state;
	const double origin[3] = {0, 0, 0}, cosines[4] = {0.8, 0.3, 0, -0.2};
	double inner[96], outer[96], radius = 1 / sqrt(3.0), apothem = radius * cos(PI / 32);
	polygon_disc(radius, inner);
	polygon_disc(radius / cos(PI / 32), outer);
	double edge = acos(0.75 + 0.25 * cos(2 * PI / 32));
	double facing = 32 * edge / (2 * PI) * apothem / sqrt(1 + apothem * apothem);
	for (int i = 0; i < 4; i++) {
		const double normal[3] = {sqrt(1 - cosines[i] * cosines[i]), 0, cosines[i]};
		double low = exact_element_polygon(origin, normal, inner, 32);
		double high = exact_element_polygon(origin, normal, outer, 32);
		double sphere = exact_element_sphere(1, 2, cosines[i]);
		if (i == 0)
			CHECK_NEAR(low, cosines[i] * facing, 1e-13);
		assert_true(low < sphere && sphere < high);
		CHECK_NEAR(high / low, 1, 0.02);
	}
}

/* ---- scenes ---- */

#define MAX_LEAVES 8192

typedef struct builder {
	float corners[12 * MAX_LEAVES], rho[3 * MAX_LEAVES], exitance[3 * MAX_LEAVES];
	double areas[MAX_LEAVES];
	reference_scene scene;
} builder;

static builder *new_builder(void)
{
	builder *b = calloc(1, sizeof *b);
	assert_non_null(b);
	b->scene.corners = b->corners;
	b->scene.rho = b->rho;
	b->scene.exitance = b->exitance;
	return b;
}

typedef struct material {
	float rho[3], exitance[3];
} material;

static const material BLACK = {{0, 0, 0}, {0, 0, 0}};

/* n x n leaves on the parallelogram o, o + u, o + u + v, o + v; the front is where u x v points. */
static void add_grid(builder *b, const double o[3], const double u[3], const double v[3], uint32_t n, material m)
{
	static const int du[4] = {0, 1, 1, 0}, dv[4] = {0, 0, 1, 1};
	for (uint32_t i = 0; i < n * n; i++) {
		size_t leaf = b->scene.leaf_count++;
		assert_true(leaf < MAX_LEAVES);
		for (int c = 0; c < 4; c++) {
			double s = (double)(i % n + (uint32_t)du[c]) / n, t = (double)(i / n + (uint32_t)dv[c]) / n;
			for (int k = 0; k < 3; k++)
				b->corners[12 * leaf + 3 * (size_t)c + (size_t)k] = (float)(o[k] + s * u[k] + t * v[k]);
		}
		memcpy(b->rho + 3 * leaf, m.rho, sizeof m.rho);
		memcpy(b->exitance + 3 * leaf, m.exitance, sizeof m.exitance);
	}
	reference_leaf_areas(&b->scene, b->areas);
}

/* A box with edges x, y, z from o; fronts inwards when x, y, z are right-handed, outwards when left-handed. */
static void add_box(builder *b, const double o[3], const double x[3], const double y[3], const double z[3], uint32_t n,
		    material m)
{
	const double *edges[3] = {x, y, z};
	for (int k = 0; k < 3; k++) {
		const double *u = edges[(k + 1) % 3], *v = edges[(k + 2) % 3], *w = edges[k];
		const double far[3] = {o[0] + w[0], o[1] + w[1], o[2] + w[2]};
		add_grid(b, o, u, v, n, m);
		add_grid(b, far, v, u, n, m);
	}
}

/* Area mean of one channel over leaves [first, end), its standard error as the halves tell it, for either part. */
typedef struct mean {
	double value, sigma;
} mean;

static mean area_mean(const builder *b, double *const halves[2], uint32_t first, uint32_t end, int channel)
{
	double sum = 0, variance = 0, area = 0;
	for (size_t i = first; i < end; i++) {
		double r1 = halves[0][3 * i + (size_t)channel], r2 = halves[1][3 * i + (size_t)channel];
		area += b->areas[i];
		sum += b->areas[i] * 0.5 * (r1 + r2);
		variance += b->areas[i] * b->areas[i] * 0.25 * (r1 - r2) * (r1 - r2);
	}
	return (mean){sum / area, sqrt(variance) / area};
}

/* 5 standard errors: one false alarm in 1.7 million for a normal variable, and seeds are fixed. `most` keeps the test
 * sharp: the standard error itself has to be small. */
#define CHECK_MEAN(m, wanted, most)                                                                                    \
	do {                                                                                                           \
		assert_true((m).sigma < (most));                                                                       \
		CHECK_NEAR((m).value, wanted, 5 * (m).sigma);                                                          \
	} while (0)

static const double ORIGIN[3] = {0, 0, 0}, X[3] = {1, 0, 0}, Y[3] = {0, 1, 0}, Z[3] = {0, 0, 1};

/* ---- rays ---- */

/* A slanted plane far from the origin, cut into 4096 leaves, under a sky of 1: every first ray has to miss, so H is 1
 * to the last bit, unless a planar neighbour or the leaf itself gets in the way. */
static void test_planar_neighbours_do_not_occlude(void **state)
{
	(void)state;
	builder *b = new_builder();
	const double o[3] = {1000, -2000, 500}, u[3] = {7, 1, 3}, v[3] = {-2, 6, 1.7};
	add_grid(b, o, u, v, 64, (material){{0.5f, 0.5f, 0.5f}, {0, 0, 0}});
	for (int k = 0; k < 3; k++)
		b->scene.sky_exitance[k] = 1;
	reference_result r;
	assert_true(reference_trace(&b->scene, 64, 1, &r));
	for (uint32_t i = 0; i < 3 * r.leaf_count; i++)
		if (r.irradiance[0][i] != 1 || r.irradiance[1][i] != 1)
			fail_msg("leaf %u: %.9g %.9g, wanted 1", i / 3, r.irradiance[0][i], r.irradiance[1][i]);
	reference_result_free(&r);
	free(b);
}

/* A closed slanted box in a bright sky: what comes in is what leaks. The starts within one ray offset of an edge of
 * slightly less than a right angle may: 2^-18 of the box over leaves of 1/8, times a few edges, is 1e-4. */
static void test_closed_box_does_not_leak(void **state)
{
	(void)state;
	builder *b = new_builder();
	const double o[3] = {-3, 10, 2}, x[3] = {2, 1, 0}, y[3] = {-1, 2, 0.1}, z[3] = {0.1, -0.05, 2};
	add_box(b, o, x, y, z, 8, (material){{0.5f, 0.5f, 0.5f}, {0, 0, 0}});
	for (int k = 0; k < 3; k++)
		b->scene.sky_exitance[k] = 1;
	reference_result r;
	assert_true(reference_trace(&b->scene, 1024, 1, &r));
	mean m = area_mean(b, r.irradiance, 0, r.leaf_count, 0);
	CHECK_NEAR(m.value, 0, 1e-4);
	reference_result_free(&r);
	free(b);
}

/* ---- direct light ---- */

/* Two parallel unit squares 1 apart, the lower one emitting (1,2,3), black: H of the upper = F E exactly. */
static builder *parallel_squares(uint32_t n)
{
	builder *b = new_builder();
	add_grid(b, ORIGIN, X, Y, n, (material){{0, 0, 0}, {1, 2, 3}});
	add_grid(b, Z, Y, X, n, BLACK);
	return b;
}

static void test_direct_parallel_squares(void **state)
{
	(void)state;
	builder *b = parallel_squares(8);
	reference_result r;
	assert_true(reference_trace(&b->scene, 1024, 1, &r));
	for (int k = 0; k < 3; k++) {
		CHECK_MEAN(area_mean(b, r.irradiance, 64, 128, k), (k + 1) * exact_parallel_rectangles(1, 1, 1), 1e-3);
		CHECK_MEAN(area_mean(b, r.direct, 64, 128, k), (k + 1) * exact_parallel_rectangles(1, 1, 1), 1e-3);
		/* the lower one sees nothing that shines */
		CHECK_NEAR(area_mean(b, r.irradiance, 0, 64, k).value, 0, 0);
	}
	reference_result_free(&r);
	free(b);
}

/* Whichever way a one-sided occluder looks, it is opaque. */
static void test_direct_with_occluder(void **state)
{
	(void)state;
	const double corner[3] = {0, 0, 0.5}, u[3] = {0.5, 0, 0}, v[3] = {0, 0.5, 0};
	for (int side = 0; side < 2; side++) {
		builder *b = parallel_squares(8);
		add_grid(b, corner, side ? u : v, side ? v : u, 4, BLACK);
		reference_result r;
		assert_true(reference_trace(&b->scene, 1024, 1, &r));
		CHECK_MEAN(area_mean(b, r.irradiance, 64, 128, 0), 0.149868671774, 1e-3);
		reference_result_free(&r);
		free(b);
	}
}

/* Two leaves back to back make a sheet: each side emits to its own half space, and neither hides the other. Black
 * squares on either side at distance 1; bounces off a sheet are in the energy balance below. */
static void test_sheet_of_two_leaves(void **state)
{
	(void)state;
	builder *b = new_builder();
	const double below[3] = {0, 0, -1};
	const material lit = {{0.5f, 0.5f, 0.5f}, {1, 1, 1}};
	add_grid(b, ORIGIN, X, Y, 8, lit);
	add_grid(b, ORIGIN, Y, X, 8, lit);
	add_grid(b, Z, Y, X, 8, BLACK);
	add_grid(b, below, X, Y, 8, BLACK);
	reference_result r;
	assert_true(reference_trace(&b->scene, 1024, 1, &r));
	CHECK_MEAN(area_mean(b, r.irradiance, 128, 192, 0), exact_parallel_rectangles(1, 1, 1), 1e-3);
	CHECK_MEAN(area_mean(b, r.irradiance, 192, 256, 0), exact_parallel_rectangles(1, 1, 1), 1e-3);
	CHECK_NEAR(area_mean(b, r.irradiance, 0, 128, 0).value, 0, 0);
	reference_result_free(&r);
	free(b);
}

/* A perpendicular emitter that shares an edge: the case where next-event estimation alone has no finite variance. The
 * balance heuristic bounds every sample by E, so no half of any leaf exceeds it. */
static void test_direct_shared_edge(void **state)
{
	(void)state;
	builder *b = new_builder();
	add_grid(b, ORIGIN, X, Y, 8, BLACK);
	add_grid(b, ORIGIN, Y, Z, 8, (material){{0, 0, 0}, {1, 1, 1}});
	reference_result r;
	assert_true(reference_trace(&b->scene, 1024, 1, &r));
	CHECK_MEAN(area_mean(b, r.irradiance, 0, 64, 1), 0.200043776075, 1e-3);
	for (uint32_t i = 0; i < 3 * r.leaf_count; i++)
		assert_true(r.irradiance[0][i] <= 1 && r.irradiance[1][i] <= 1);
	reference_result_free(&r);
	free(b);
}

/* ---- global light ---- */

/* Furnace: B = E / (1 - rho) everywhere, H = B. Triangle leaves are covered by cutting the quads of one face. */
static void split_into_triangles(builder *b, uint32_t leaf)
{
	float *p = b->corners + 12 * (size_t)leaf;
	size_t other = b->scene.leaf_count++;
	float *q = b->corners + 12 * other;
	assert_true(other < MAX_LEAVES);
	memcpy(q, p, 3 * sizeof *p);
	memcpy(q + 3, p + 6, 6 * sizeof *p);
	memcpy(q + 9, p + 9, 3 * sizeof *p);
	memcpy(p + 9, p + 6, 3 * sizeof *p);
	memcpy(b->rho + 3 * other, b->rho + 3 * (size_t)leaf, 3 * sizeof *p);
	memcpy(b->exitance + 3 * other, b->exitance + 3 * (size_t)leaf, 3 * sizeof *p);
	reference_leaf_areas(&b->scene, b->areas);
}

static builder *furnace(void)
{
	builder *b = new_builder();
	add_box(b, ORIGIN, X, Y, Z, 8, (material){{0.5f, 0.8f, 0}, {1, 0.5f, 3}});
	for (uint32_t i = 0; i < 64; i++)
		split_into_triangles(b, i);
	return b;
}

static void test_furnace(void **state)
{
	(void)state;
	builder *b = furnace();
	reference_result r;
	assert_true(reference_trace(&b->scene, 1024, 3, &r));
	const double wanted[3] = {2, 2.5, 3};
	for (int k = 0; k < 3; k++) {
		CHECK_MEAN(area_mean(b, r.irradiance, 0, r.leaf_count, k), wanted[k], 0.005);
		CHECK_MEAN(area_mean(b, r.direct, 0, r.leaf_count, k), b->exitance[k], 0.005);
	}
	for (size_t i = 0; i < r.leaf_count; i++) /* and leaf by leaf, at single-leaf noise */
		CHECK_NEAR(0.5 * (r.irradiance[0][3 * i] + r.irradiance[1][3 * i]), 2, 0.2);
	reference_result_free(&r);
	free(b);
}

/* With the exact H known, the errors of the halves have to be independent over the 448 leaves: their correlation is
 * then 0 +- 1/sqrt(448) = 0.047. And their difference has to tell the truth about the error of their mean. */
static void test_halves_are_independent(void **state)
{
	(void)state;
	builder *b = furnace();
	reference_result r;
	assert_true(reference_trace(&b->scene, 256, 5, &r));
	double c11 = 0, c22 = 0, c12 = 0, difference = 0, error = 0;
	for (size_t i = 0; i < r.leaf_count; i++) {
		double e1 = r.irradiance[0][3 * i] - 2, e2 = r.irradiance[1][3 * i] - 2;
		c11 += e1 * e1, c22 += e2 * e2, c12 += e1 * e2;
		difference += (e1 - e2) * (e1 - e2) / 4;
		error += (e1 + e2) * (e1 + e2) / 4;
	}
	CHECK_NEAR(c12 / sqrt(c11 * c22), 0, 4 * 0.047);
	CHECK_NEAR(sqrt(difference / error), 1, 4 * 0.047);
	reference_result_free(&r);
	free(b);
}

/* max_bounces = k leaves H = E (1 + rho + ... + rho^k). */
static void test_bounce_limit(void **state)
{
	(void)state;
	builder *b = furnace();
	reference_result r;
	const reference_options options = {.paths_per_leaf = 512, .seed = 1, .max_bounces = 2};
	assert_true(reference_trace_with(&b->scene, &options, &r));
	CHECK_MEAN(area_mean(b, r.irradiance, 0, r.leaf_count, 0), 1.75, 0.005);
	reference_result_free(&r);
	free(b);
}

/* A room with one lit patch in the ceiling, a block standing free in it and a sheet: rho the same everywhere, so the
 * area mean of H over everything is Phi / (S (1 - rho)), whatever hides what. */
static void test_energy_balance(void **state)
{
	(void)state;
	builder *b = new_builder();
	const material grey = {{0.6f, 0.6f, 0.6f}, {0, 0, 0}};
	const double x[3] = {4, 0, 0}, y[3] = {0, 3, 0}, z[3] = {0, 0, 2.5};
	add_box(b, ORIGIN, x, y, z, 8, grey);
	const double block[3] = {1, 1, 0.5}, bx[3] = {0.8, 0.3, 0}, by[3] = {-0.3, 0.8, 0.1}, bz[3] = {0, 0, 1.1};
	add_box(b, block, by, bx, bz, 4, grey);
	const double sheet[3] = {2.5, 0.5, 0.3}, sx[3] = {1, 0.5, 0}, sz[3] = {0.2, 0, 1.5};
	add_grid(b, sheet, sx, sz, 5, grey);
	add_grid(b, sheet, sz, sx, 5, grey);
	/* grid 5 of the room is its ceiling */
	const float bright[3] = {10, 5, 0};
	uint32_t lit = 5 * 64 + 4 * 8 + 4;
	assert_true(b->corners[12 * lit + 2] == 2.5f);
	memcpy(b->exitance + 3 * lit, bright, sizeof bright);
	double total = 0;
	for (uint32_t i = 0; i < b->scene.leaf_count; i++)
		total += b->areas[i];
	reference_result r;
	assert_true(reference_trace(&b->scene, 1024, 1, &r));
	double wanted = 10 * b->areas[lit] / total / (1 - 0.6);
	CHECK_MEAN(area_mean(b, r.irradiance, 0, r.leaf_count, 0), wanted, 0.01 * wanted);
	CHECK_MEAN(area_mean(b, r.irradiance, 0, r.leaf_count, 1), wanted / 2, 0.01 * wanted);
	CHECK_NEAR(area_mean(b, r.irradiance, 0, r.leaf_count, 2).value, 0, 0);
	reference_result_free(&r);
	free(b);
}

static void test_threads_change_nothing(void **state)
{
	(void)state;
	builder *b = furnace();
	reference_result r[3];
	reference_options options = {.paths_per_leaf = 64, .seed = 9};
	for (uint32_t i = 0; i < 3; i++) {
		const uint32_t threads[3] = {1, 2, 7};
		options.thread_count = threads[i];
		assert_true(reference_trace_with(&b->scene, &options, &r[i]));
	}
	size_t bytes = 3 * sizeof(double) * r[0].leaf_count;
	for (int i = 1; i < 3; i++) {
		assert_int_equal(r[0].segments, r[i].segments);
		for (int half = 0; half < 2; half++) {
			assert_memory_equal(r[0].irradiance[half], r[i].irradiance[half], bytes);
			assert_memory_equal(r[0].direct[half], r[i].direct[half], bytes);
		}
	}
	reference_result_free(&r[2]);
	options.seed = 10;
	assert_true(reference_trace_with(&b->scene, &options, &r[2]));
	assert_memory_not_equal(r[0].irradiance[0], r[2].irradiance[0], bytes);
	for (int i = 0; i < 3; i++)
		reference_result_free(&r[i]);
	free(b);
}

static void test_odd_input(void **state)
{
	(void)state;
	builder *b = parallel_squares(2);
	reference_result r;
	float *corner = b->corners + 12 * 4;
	const float kept = corner[0];
	corner[0] = NAN;
	assert_false(reference_trace(&b->scene, 16, 1, &r));
	assert_null(r.irradiance[0]);
	corner[0] = kept;
	b->rho[0] = 1;
	assert_false(reference_trace(&b->scene, 16, 1, &r));
	b->rho[0] = 0;
	assert_false(reference_trace(&b->scene, 0, 1, &r));
	for (int c = 1; c < 4; c++) /* a leaf shrunk to a point is dark, and no nuisance to others */
		memcpy(corner + 3 * c, corner, 3 * sizeof *corner);
	assert_true(reference_trace(&b->scene, 15, 1, &r));
	assert_int_equal(r.paths_per_half, 8);
	assert_true(r.irradiance[0][12] == 0 && r.irradiance[0][15] > 0);
	reference_result_free(&r);
	memset(b->corners, 0, sizeof b->corners); /* nothing but points */
	assert_true(reference_trace(&b->scene, 16, 1, &r));
	assert_true(r.segments == 0 && r.irradiance[1][15] == 0);
	reference_result_free(&r);
	b->scene.leaf_count = 0;
	assert_false(reference_trace(&b->scene, 16, 1, &r));
	free(b);
}

/* ---- error measures ---- */

static void test_error_by_hand(void **state)
{
	(void)state;
	const double h[6] = {2, 0, 0, 1, 1, 1}, r1[6] = {1, 0, 0, 1, 1, 1}, r2[6] = {3, 0, 0, 1, 1, 1},
		     areas[2] = {2, 1};
	reference_error e;
	assert_true(reference_error_measure(h, r1, r2, areas, 2, &e));
	/* cross: 2 * 1 * 3 + 1 * 3 = 9; error: 2 * (1)(-1) = -2; the mean is met exactly */
	CHECK_NEAR(e.squared, -2.0 / 9, 1e-15);
	CHECK_NEAR(e.rms, 0, 0);
	CHECK_NEAR(e.plain, 0, 0);
	CHECK_NEAR(e.noise, sqrt(2.0 / 9), 1e-15); /* 2 * (1 - 3)^2 / 4 = 2 */
	CHECK_NEAR(e.bias, 0, 1e-15);
	const double dark[6] = {0};
	assert_false(reference_error_measure(h, dark, dark, areas, 2, &e));
	const float records[8] = {1, 2, 3, 9, 4, 5, 6, 9};
	double rgb[6];
	reference_widen(records, 4, 2, rgb);
	CHECK_NEAR(rgb[2], 3, 0);
	CHECK_NEAR(rgb[3], 4, 0);
}

static double uniform(uint64_t *s)
{
	*s = *s * 6364136223846793005u + 1442695040888963407u;
	return (double)(*s >> 11) * 0x1p-53;
}

/* A constant 2 % error under 10 % noise in each half: the plain measure reads sqrt(0.02^2 + 0.1^2 / 2) = 7.3 %, the
 * unbiased one 2 %. Its own scatter: squared is 4e-4 +- 0.01 / sqrt(60000) = 4e-5, so rms is 0.02 +- 0.001. */
static void test_error_without_the_noise(void **state)
{
	(void)state;
	enum { N = 20000 };
	double *h = malloc(3 * N * sizeof *h), *r1 = malloc(3 * N * sizeof *h), *r2 = malloc(3 * N * sizeof *h);
	double *areas = malloc(N * sizeof *h);
	assert_true(h && r1 && r2 && areas);
	uint64_t s = 1;
	for (int i = 0; i < 3 * N; i++) {
		h[i] = 1.02;
		r1[i] = 1 + 0.1 * sqrt(12.0) * (uniform(&s) - 0.5); /* standard deviation 0.1 */
		r2[i] = 1 + 0.1 * sqrt(12.0) * (uniform(&s) - 0.5);
		areas[i / 3] = 1;
	}
	reference_error e;
	assert_true(reference_error_measure(h, r1, r2, areas, N, &e));
	CHECK_NEAR(e.rms, 0.02, 0.004);
	CHECK_NEAR(e.plain, sqrt(0.0004 + 0.005), 0.001);
	CHECK_NEAR(e.noise, sqrt(0.005), 0.001);
	CHECK_NEAR(e.bias, 0.02, 0.002);
	free(h), free(r1), free(r2), free(areas);
}

/* ---- solver ---- */

typedef bool (*solve_function)(const reference_rows *, reference_solution *);

static bool solve_by_sweeps(const reference_rows *rows, reference_solution *out)
{
	return reference_solve(rows, 1000000, out);
}

static const solve_function SOLVERS[2] = {solve_by_sweeps, reference_solve_dense};

/* Unit cube, a leaf per face: 0 floor, 1 ceiling, 2 to 5 walls. */
typedef struct cube_rows {
	uint32_t offsets[7], columns[30];
	double weights[30];
	float rho[18], exitance[18];
	reference_rows rows;
} cube_rows;

static void cube_rows_init(cube_rows *c, float rho)
{
	uint32_t entry = 0;
	for (uint32_t i = 0; i < 6; i++) {
		c->offsets[i] = entry;
		for (uint32_t j = 0; j < 6; j++) {
			if (i == j)
				continue;
			c->columns[entry] = j;
			c->weights[entry++] =
			    (i ^ 1) == j ? exact_parallel_rectangles(1, 1, 1) : exact_perpendicular_rectangles(1, 1, 1);
		}
		for (uint32_t k = 3 * i; k < 3 * i + 3; k++) {
			c->rho[k] = rho;
			c->exitance[k] = i == 0 ? (float)(k + 1) : 0;
		}
	}
	c->offsets[6] = entry;
	c->rows = (reference_rows){.row_offsets = c->offsets,
				   .columns = c->columns,
				   .weights = c->weights,
				   .rho = c->rho,
				   .exitance = c->exitance,
				   .leaf_count = 6};
}

/* 1e-10: the table's last digit. */
static void test_solver_cube(void **state)
{
	(void)state;
	cube_rows c;
	cube_rows_init(&c, 0.5f);
	for (int s = 0; s < 2; s++) {
		reference_solution out;
		assert_true(SOLVERS[s](&c.rows, &out));
		assert_true(out.converged && out.bound <= 1e-13);
		CHECK_NEAR(out.contraction, 0.5, 1e-12);
		for (int k = 0; k < 3; k++) {
			CHECK_NEAR(out.radiosity[k] / (k + 1), 1.0909090981, 1e-10);
			CHECK_NEAR(out.radiosity[3 + k] / (k + 1), 0.1817458261, 1e-10);
			for (int wall = 2; wall < 6; wall++)
				CHECK_NEAR(out.radiosity[3 * wall + k] / (k + 1), 0.1818362689, 1e-10);
		}
		double h[18];
		assert_true(reference_irradiance(&c.rows, out.radiosity, h));
		CHECK_NEAR(h[3], out.radiosity[3] / 0.5, 1e-12);
		reference_solution_free(&out);
	}
}

static void test_solver_parallel_squares(void **state)
{
	(void)state;
	const double f = exact_parallel_rectangles(1, 1, 1), weights[2] = {f, f};
	const uint32_t offsets[3] = {0, 1, 2}, columns[2] = {1, 0};
	const float rho[6] = {0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f}, exitance[6] = {1, 1, 1, 0, 0, 0};
	const reference_rows rows = {.row_offsets = offsets,
				     .columns = columns,
				     .weights = weights,
				     .rho = rho,
				     .exitance = exitance,
				     .leaf_count = 2};
	for (int s = 0; s < 2; s++) {
		reference_solution out;
		assert_true(SOLVERS[s](&rows, &out));
		CHECK_NEAR(out.radiosity[0], 1.0100831523, 1e-10);
		CHECK_NEAR(out.radiosity[3], 0.1009198803, 1e-10);
		reference_solution_free(&out);
	}
}

/* Nodes of several leaves of unequal area, overlapping: B of both solvers satisfies the equation written out by hand.
 */
static void test_solver_nodes(void **state)
{
	(void)state;
	const reference_node nodes[4] = {{0, 1}, {1, 2}, {0, 3}, {2, 1}};
	const uint32_t offsets[4] = {0, 1, 2, 3}, columns[3] = {1, 2, 0};
	const double weights[3] = {0.9, 0.5, 0.7}, areas[3] = {1, 2, 3};
	const float rho[9] = {0.5f, 0, 0.9f, 0.8f, 0, 0.9f, 0.3f, 0, 0.9f}, exitance[9] = {1, 1, 1, 0, 2, 1, 0, 3, 1};
	const reference_rows rows = {.row_offsets = offsets,
				     .columns = columns,
				     .weights = weights,
				     .nodes = nodes,
				     .areas = areas,
				     .rho = rho,
				     .exitance = exitance,
				     .leaf_count = 3,
				     .node_count = 4};
	for (int s = 0; s < 2; s++) {
		reference_solution out;
		assert_true(SOLVERS[s](&rows, &out));
		const double *b = out.radiosity;
		for (int k = 0; k < 3; k++) {
			double far = (2 * b[3 + k] + 3 * b[6 + k]) / 5, all = (b[k] + 2 * b[3 + k] + 3 * b[6 + k]) / 6;
			CHECK_NEAR(b[k], exitance[k] + rho[k] * 0.9 * far, 1e-12);
			CHECK_NEAR(b[3 + k], exitance[3 + k] + rho[3 + k] * 0.5 * all, 1e-12);
			CHECK_NEAR(b[6 + k], exitance[6 + k] + rho[6 + k] * 0.7 * b[k], 1e-12);
		}
		reference_solution_free(&out);
	}
}

/* A furnace of rho 0.999 amplifies rounding a thousand times: 1e-12 relative is what double can give. */
static void test_solver_near_one(void **state)
{
	(void)state;
	cube_rows c;
	cube_rows_init(&c, 0.999f);
	for (int k = 0; k < 18; k++)
		c.exitance[k] = 1;
	for (int s = 0; s < 2; s++) {
		reference_solution out;
		assert_true(SOLVERS[s](&c.rows, &out));
		assert_true(out.converged);
		CHECK_NEAR(out.radiosity[4] * (1 - (double)0.999f), 1, 1e-11);
		assert_true(out.bound < 1e-11);
		reference_solution_free(&out);
	}
}

static void test_solver_refuses(void **state)
{
	(void)state;
	cube_rows c;
	reference_solution out;
	cube_rows_init(&c, 0.9f);
	c.weights[0] = 1.5; /* row sum 2.3 */
	assert_false(reference_solve(&c.rows, 100, &out));
	assert_null(out.radiosity);
	cube_rows_init(&c, 0.9f);
	c.columns[3] = 6;
	assert_false(reference_solve(&c.rows, 100, &out));
	assert_false(reference_solve_dense(&c.rows, &out));
	cube_rows_init(&c, 0.9f);
	assert_true(reference_solve(&c.rows, 2, &out)); /* too few sweeps: a bound that says so */
	assert_false(out.converged);
	assert_true(out.bound > 1e-3);
	reference_solution_free(&out);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_exact_rectangles_and_discs),
	    cmocka_unit_test(test_exact_spheres),
	    cmocka_unit_test(test_exact_reciprocity),
	    cmocka_unit_test(test_exact_polygon),
	    cmocka_unit_test(test_exact_polygon_against_sphere),
	    cmocka_unit_test(test_planar_neighbours_do_not_occlude),
	    cmocka_unit_test(test_closed_box_does_not_leak),
	    cmocka_unit_test(test_direct_parallel_squares),
	    cmocka_unit_test(test_direct_with_occluder),
	    cmocka_unit_test(test_sheet_of_two_leaves),
	    cmocka_unit_test(test_direct_shared_edge),
	    cmocka_unit_test(test_furnace),
	    cmocka_unit_test(test_halves_are_independent),
	    cmocka_unit_test(test_bounce_limit),
	    cmocka_unit_test(test_energy_balance),
	    cmocka_unit_test(test_threads_change_nothing),
	    cmocka_unit_test(test_odd_input),
	    cmocka_unit_test(test_error_by_hand),
	    cmocka_unit_test(test_error_without_the_noise),
	    cmocka_unit_test(test_solver_cube),
	    cmocka_unit_test(test_solver_parallel_squares),
	    cmocka_unit_test(test_solver_nodes),
	    cmocka_unit_test(test_solver_near_one),
	    cmocka_unit_test(test_solver_refuses),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
