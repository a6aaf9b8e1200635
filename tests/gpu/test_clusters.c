/* Objects whose parts see nothing of each other: no cluster of them may lose light that is there, or bring light that
 * is not. Sources one behind the other against closed forms; what is sealed, behind a wall or behind slats against path
 * tracing.
 */
#include "harness.h"
#include "snapshot.h"

#include "scenes/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double HALF_PER_CENT = 0.005;

static void expect_near(const char *what, double value, double truth, double relative)
{
	printf("  %-56s %.9f  truth %.9f  error %+.4f %%\n", what, value, truth, 100 * (value - truth) / truth);
	if (!(fabs(value - truth) <= relative * fabs(truth)))
		fail_msg("%s: %.9f is not %.9f within %g", what, value, truth, relative);
}

/* ---- sources one behind the other ---- */

/* Unit squares a gap c apart, facing each other (Howell's C-11). */
static double parallel_squares(double c)
{
	const double x = 1 / c, s = sqrt(1 + x * x), pi = 3.14159265358979323846;
	return 2 / (pi * x * x) * (log(s * s / sqrt(1 + 2 * x * x)) + 2 * x * s * atan(x / s) - 2 * x * atan(x));
}

/* From a point to the rectangle [0,a] x [0,b] at distance c, its corner on the point's normal; odd in a and b. */
static double point_to_corner(double a, double b, double c)
{
	const double x = a / c, y = b / c, u = sqrt(1 + x * x), v = sqrt(1 + y * y);
	return (x / u * atan(y / u) + y / v * atan(x / v)) / (2 * 3.14159265358979323846);
}

/* From the unit square to one at a distance, `shift` to the side: midpoint rule over points of the first, whose error
 * is below 1e-5 of it at these distances. */
static double shifted_squares(double shift, double c)
{
	enum { POINTS = 200 };
	double sum = 0;
	for (int i = 0; i < POINTS; i++)
		for (int j = 0; j < POINTS; j++) {
			const double u = (i + .5) / POINTS, v = (j + .5) / POINTS, low = shift - u, high = low + 1;
			sum += point_to_corner(high, 1 - v, c) - point_to_corner(low, 1 - v, c) -
			       point_to_corner(high, -v, c) + point_to_corner(low, -v, c);
		}
	return sum / (POINTS * POINTS);
}

/* 45 degrees about x, then about z: no plane of the scene is one of the axes' any more. */
static void turn(engine_mesh *mesh)
{
	const float s = sqrtf(.5f);
	for (uint32_t k = 0; k < mesh->vertex_count; k++) {
		float *p = mesh->positions + 3 * k;
		const float q[3] = {p[0], s * (p[1] - p[2]), s * (p[1] + p[2])};
		p[0] = s * (q[0] - q[1]);
		p[1] = s * (q[0] + q[1]);
		p[2] = q[2];
	}
}

typedef struct stack {
	float near, far, shift; /* distances from the receiver; the far part's shift to the side */
	bool boxes, turned;
	uint32_t levels;
} stack;

static void append_part(engine_mesh *mesh, const stack *s, float distance, float shift)
{
	engine_mesh part;
	const float lower[3] = {shift, distance, 0}, upper[3] = {1 + shift, distance + .25f, 1};
	assert_true(s->boxes ? shape_box(lower, upper, 1, false, &part)
			     : shape_quad(lower, (float[]){1, 0, 0}, (float[]){0, 0, 1}, 1, 1, &part));
	assert_true(shape_append(mesh, &part));
}

static gi_object add_turned(gi_context *gi, const stack *s, const char *name, uint32_t levels, engine_mesh *mesh)
{
	if (s->turned)
		turn(mesh);
	return harness_add(gi, &(harness_object){.name = name, .levels = levels, .rho = {.5f, .5f, .5f}}, mesh);
}

/* From a unit square to an object of two parts, both facing it, the second behind the first. */
static double factor_to_stack(const stack *s)
{
	gi_context_def def = harness_def();
	def.row_tolerance = 0.002f;
	def.near_samples = 16;
	gi_context *gi = harness_context(&def);
	engine_mesh square, parts = {0};
	assert_true(shape_quad((float[]){0, 0, 0}, (float[]){0, 0, 1}, (float[]){1, 0, 0}, 1, 1, &square));
	const gi_object receiver = add_turned(gi, s, "receiver", 3, &square);
	append_part(&parts, s, s->near, 0);
	append_part(&parts, s, s->far, s->shift);
	const gi_object source = add_turned(gi, s, "source", s->levels, &parts);
	assert_gi(gi_commit(gi));
	harness_update(gi);
	double factor;
	assert_gi(gi_form_factor(gi, receiver, source, &factor));
	gi_context_destroy(gi);
	return factor;
}

/* Squares of one size, one right behind the other: the second is hidden from every point of the receiver. */
static void sources_one_behind_the_other(void **state)
{
	(void)state;
	static const float gaps[] = {.5f, 1, 1.5f, 2, 4, 8};
	for (int form = 0; form < 4; form++)
		for (size_t k = 0; k < sizeof gaps / sizeof *gaps; k++) {
			const stack s = {1, 1 + gaps[k], 0, form & 1, form >> 1, k % 2 ? 3 : 0};
			char what[80];
			snprintf(what, sizeof what, "%s%s, a second %.1f m behind the first",
				 s.boxes ? "boxes" : "squares", s.turned ? " at 45 degrees" : "", (double)gaps[k]);
			expect_near(what, factor_to_stack(&s), parallel_squares(1), HALF_PER_CENT);
		}
	static const float nears[] = {.5f, 2, 3};
	for (size_t k = 0; k < sizeof nears / sizeof *nears; k++) {
		const stack s = {nears[k], nears[k] + 5, 0, false, k == 1, 3};
		char what[80];
		snprintf(what, sizeof what, "squares, the first at %.1f m, a second 5 m behind", (double)nears[k]);
		expect_near(what, factor_to_stack(&s), parallel_squares(nears[k]), HALF_PER_CENT);
	}
}

/* A second square so far to the side that the first hides none of it. */
static void sources_side_by_side_at_two_distances(void **state)
{
	(void)state;
	static const float fars[] = {1.5f, 2, 4};
	for (int turned = 0; turned < 2; turned++)
		for (size_t k = 0; k < sizeof fars / sizeof *fars; k++) {
			const stack s = {1, fars[k], fars[k] + .1f, false, turned, 3};
			char what[80];
			snprintf(what, sizeof what, "squares%s at 1 and %.1f m, side by side",
				 turned ? " at 45 degrees" : "", (double)fars[k]);
			expect_near(what, factor_to_stack(&s),
				    parallel_squares(1) + shifted_squares((double)s.shift, (double)s.far),
				    HALF_PER_CENT);
		}
}

int main(void)
{
	setvbuf(stdout, NULL, _IOLBF, 0);
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(sources_one_behind_the_other),
	    cmocka_unit_test(sources_side_by_side_at_two_distances),
	};
	return cmocka_run_group_tests_name("clusters", tests, harness_open, harness_close);
}
