/* The forward light tracer against closed forms: Fresnel, plates, mirror and glass balls, energy. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../reference/exact.h"
#include "../reference/light_trace.h"

static const double PI = 3.14159265358979323846;

static void check_near(double got, double wanted, double tolerance, const char *what, int line)
{
	printf("%s: %.6g, wanted %.6g +- %.2g\n", what, got, wanted, tolerance);
	if (!(fabs(got - wanted) <= tolerance))
		_fail(__FILE__, line);
}

#define CHECK_NEAR(got, wanted, tolerance) check_near(got, wanted, tolerance, #got, __LINE__)

/* ---- scenes ---- */

enum { MOST_VERTICES = 20000, MOST_TRIANGLES = 40000 };

enum { BLACK, LAMP, SPECIAL };

typedef struct test_scene {
	light_scene scene;
	light_surface surfaces[3];
	float positions[3 * MOST_VERTICES], normals[3 * MOST_VERTICES];
	uint32_t corners[3 * MOST_TRIANGLES], surface_of[MOST_TRIANGLES];
} test_scene;

static test_scene *new_scene(light_surface special)
{
	test_scene *s = calloc(1, sizeof *s);
	assert_non_null(s);
	s->surfaces[LAMP].exitance[0] = s->surfaces[LAMP].exitance[1] = s->surfaces[LAMP].exitance[2] = 1;
	s->surfaces[SPECIAL] = special;
	s->scene = (light_scene){s->positions, s->normals, s->corners, s->surface_of, s->surfaces, 0, 0};
	return s;
}

static uint32_t add_vertex(test_scene *s, const double p[3], const double n[3])
{
	uint32_t v = s->scene.vertex_count++;
	assert_true(v < MOST_VERTICES);
	for (int k = 0; k < 3; k++) {
		s->positions[3 * v + k] = (float)p[k];
		s->normals[3 * v + k] = (float)n[k];
	}
	return v;
}

static void add_triangle(test_scene *s, uint32_t a, uint32_t b, uint32_t c, uint32_t surface)
{
	uint32_t t = s->scene.triangle_count++;
	assert_true(t < MOST_TRIANGLES);
	memcpy(s->corners + 3 * t, (const uint32_t[]){a, b, c}, 3 * sizeof a);
	s->surface_of[t] = surface;
}

/* A square of half side `half` at height y, whose front is up (+1) or down (-1). */
static void add_square(test_scene *s, double half, double y, int up, uint32_t surface)
{
	const double n[3] = {0, up, 0};
	uint32_t v[4];
	for (int k = 0; k < 4; k++) {
		double x = k == 0 || k == 3 ? -half : half, z = k < 2 ? -half : half;
		v[k] = add_vertex(s, (const double[]){x, y, z}, n);
	}
	bool turned = up > 0;
	add_triangle(s, v[0], v[turned ? 2 : 1], v[turned ? 1 : 2], surface);
	add_triangle(s, v[0], v[turned ? 3 : 2], v[turned ? 2 : 3], surface);
}

/* About the origin; normals are the sphere's. */
static void add_ball(test_scene *s, double radius, uint32_t slices, uint32_t stacks)
{
	uint32_t first = s->scene.vertex_count;
	for (uint32_t i = 0; i <= stacks; i++)
		for (uint32_t j = 0; j < slices; j++) {
			double theta = PI * i / stacks, phi = 2 * PI * j / slices;
			const double n[3] = {sin(theta) * cos(phi), cos(theta), sin(theta) * sin(phi)};
			add_vertex(s, (const double[]){radius * n[0], radius * n[1], radius * n[2]}, n);
		}
	for (uint32_t i = 0; i < stacks; i++)
		for (uint32_t j = 0; j < slices; j++) {
			uint32_t a = first + i * slices + j, b = first + i * slices + (j + 1) % slices;
			uint32_t c = b + slices, d = a + slices;
			if (i > 0)
				add_triangle(s, a, b, c, SPECIAL);
			if (i + 1 < stacks)
				add_triangle(s, a, c, d, SPECIAL);
		}
}

static double sum_of(const light_flux *flux, uint32_t count)
{
	double sum = 0;
	for (uint32_t k = 0; k < count; k++)
		sum += flux[k].rgb[0];
	return sum;
}

typedef struct shares {
	double direct, specular, absorbed, escaped; /* of what was emitted */
} shares;

static shares trace_shares(test_scene *s, uint64_t photons)
{
	light_result result;
	assert_true(light_trace(&s->scene, photons, 1, &result));
	uint32_t count = s->scene.triangle_count;
	double all = result.emitted.rgb[0];
	shares out = {sum_of(result.direct, count) / all, sum_of(result.specular, count) / all,
		      result.absorbed.rgb[0] / all, result.escaped.rgb[0] / all};
	light_result_free(&result);
	CHECK_NEAR(out.direct + out.specular + out.absorbed + out.escaped, 1, 1e-9);
	return out;
}

static const light_surface GLASS = {.transmittance = {1, 1, 1}, .index = 1.5f};
enum { PHOTONS = 400000 };
/* Four standard deviations of a share of one half. */
static const double NOISE = 4 * 0.5 / 632;

/* ---- tests ---- */

static void test_fresnel(void **state)
{
	(void)state;
	CHECK_NEAR(light_fresnel(1, 1.5), 0.04, 1e-12);
	CHECK_NEAR(light_fresnel(1, 1 / 1.5), 0.04, 1e-12);
	/* At Brewster's angle, tan = n, one polarisation is not reflected at all, the other by ((n^2 - 1) / (n^2 +
	 * 1))^2. */
	CHECK_NEAR(light_fresnel(1 / sqrt(1 + 1.5 * 1.5), 1.5), 0.5 * pow(1.25 / 3.25, 2), 1e-12);
	CHECK_NEAR(light_fresnel(1e-9, 1.5), 1, 1e-8);
	/* Total internal reflection from sin = 1 / n on. */
	double critical = sqrt(1 - 1 / 2.25);
	CHECK_NEAR(light_fresnel(critical * 0.999, 1 / 1.5), 1, 0);
	assert_true(light_fresnel(critical * 1.001, 1 / 1.5) < 0.95);
}

/* What a plate lets through of light from all directions of a half space: (1 - R) / (1 + R) with all inner
 * reflections. */
static double plate_transmittance(double index)
{
	enum { STEPS = 100000 };
	double sum = 0;
	for (int k = 0; k < STEPS; k++) {
		double r = light_fresnel(sqrt((k + 0.5) / STEPS), index); /* uniform in cosine squared */
		sum += (1 - r) / (1 + r);
	}
	return sum / STEPS;
}

static void test_plate(void **state)
{
	(void)state;
	test_scene *s = new_scene(GLASS);
	s->scene.normals = NULL;
	add_square(s, 0.001, 0.02, -1, LAMP);
	add_square(s, 20, 0.01, 1, SPECIAL);
	add_square(s, 20, 0, -1, SPECIAL);
	add_square(s, 2000, -1, 1, BLACK);
	shares out = trace_shares(s, PHOTONS);
	CHECK_NEAR(out.specular, plate_transmittance(1.5), NOISE + 1e-3); /* a little goes by the plate's edge */
	free(s);
}

static void test_mirror_ball(void **state)
{
	(void)state;
	test_scene *s = new_scene((light_surface){.specular = {0.9f, 0.9f, 0.9f}});
	add_square(s, 0.001, 2, -1, LAMP);
	add_ball(s, 1, 180, 90);
	double seen = exact_element_sphere(1, 2, 1);
	shares out = trace_shares(s, PHOTONS);
	CHECK_NEAR(out.absorbed, 0.1 * seen, 0.1 * NOISE + 1e-4);
	CHECK_NEAR(out.escaped, 1 - 0.1 * seen, 0.1 * NOISE + 1e-4);
	free(s);
}

/* Glass of index 1 is not there; of 1.5 a ball of radius R brings what comes from a distance a of its centre
 * together at a distance b behind it, 1/a + 1/b = 1/f, f = n R / (2 (n - 1)) (thin pencils): much of it falls on a
 * small square there. */
static void test_glass_ball(void **state)
{
	(void)state;
	const double away = 20, behind = 1 / (1 / 1.5 - 1 / away), half = 0.1;
	const uint64_t photons = 2000000;
	for (int real = 0; real < 2; real++) {
		test_scene *s = new_scene(GLASS);
		s->surfaces[SPECIAL].index = real ? 1.5f : 1.0f;
		add_square(s, 0.01, away, -1, LAMP);
		add_square(s, half, -behind, 1, BLACK);
		add_ball(s, 1, 180, 90);
		light_result result;
		assert_true(light_trace(&s->scene, photons, 1, &result));
		double got = (result.specular[2].rgb[0] + result.specular[3].rgb[0]) / result.emitted.rgb[0];
		double square = 4 * half * half / (PI * pow(away + behind, 2)), ball = exact_element_sphere(1, away, 1);
		if (real)
			assert_true(got > 0.3 * ball && got < 0.6 * ball);
		else
			CHECK_NEAR(got, square, 4 * sqrt(square / (double)photons));
		printf("index %.1f: %.3g of the ball's light\n", (double)s->surfaces[SPECIAL].index, got / ball);
		light_result_free(&result);
		free(s);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_fresnel),
	    cmocka_unit_test(test_plate),
	    cmocka_unit_test(test_mirror_ball),
	    cmocka_unit_test(test_glass_ball),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
