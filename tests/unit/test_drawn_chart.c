/* Texture coordinates of what is drawn: each corner of a triangle has its own, whatever vertices triangles share. */
#include "drawn_chart.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

enum { TRIANGLES = 60, VERTICES = 20, MATERIALS = 4 };

/* Each corner in the order in which the chart has them is that of a triangle of its material, in the order of these,
 * with the coordinates and the vertex that it had. */
static void expect_same_corners(const gi_drawn_surface *drawn, const float (*uvs)[2], const uint32_t *materials,
				const gi_drawn_chart *chart)
{
	uint32_t at = 0;
	assert_int_equal(chart->first[0], 0);
	assert_int_equal(chart->first[MATERIALS], drawn->index_count);
	for (uint32_t m = 0; m < MATERIALS; m++) {
		assert_int_equal(chart->first[m], at);
		for (uint32_t k = 0; k < drawn->index_count; k++) {
			if ((materials ? materials[k / 3] : 0) != m)
				continue;
			const uint32_t v = chart->indices[at++];
			assert_true(v < chart->vertex_count);
			assert_memory_equal(chart->uvs[v], uvs[k], sizeof *uvs);
			assert_int_equal(v < VERTICES ? v : chart->source[v - VERTICES], drawn->indices[k]);
		}
	}
	assert_int_equal(at, drawn->index_count);
}

/* Every corner of vertex v has one of so many pairs of coordinates. */
static gi_drawn_chart chart_of(uint32_t pairs, const uint32_t *materials)
{
	uint32_t indices[3 * TRIANGLES];
	float uvs[3 * TRIANGLES][2];
	gi_drawn_chart chart;
	for (uint32_t k = 0; k < 3 * TRIANGLES; k++) {
		indices[k] = k * 7 % VERTICES;
		uvs[k][0] = (float)indices[k];
		uvs[k][1] = (float)(k * 13 / 3 % pairs);
	}
	const gi_drawn_surface drawn = {.vertex_count = VERTICES, .indices = indices, .index_count = 3 * TRIANGLES};
	assert_true(gi_drawn_chart_build(&drawn, (const float(*)[2])uvs, materials, MATERIALS, &chart));
	expect_same_corners(&drawn, (const float(*)[2])uvs, materials, &chart);
	return chart;
}

static void corners_keep_their_coordinates(void **state)
{
	(void)state;
	uint32_t materials[TRIANGLES];
	for (uint32_t t = 0; t < TRIANGLES; t++)
		materials[t] = t * 5 % 3 == 0 ? 3 : t % 2; /* none has 2 */
	for (uint32_t pairs = 1; pairs <= 3 * TRIANGLES; pairs++) {
		gi_drawn_chart chart = chart_of(pairs, pairs % 2 ? materials : NULL);
		gi_drawn_chart_free(&chart);
	}
}

static void vertices_are_drawn_again_where_they_must(void **state)
{
	(void)state;
	gi_drawn_chart one = chart_of(1, NULL), two = chart_of(2, NULL);
	assert_int_equal(one.vertex_count, VERTICES);
	assert_in_range(two.vertex_count, VERTICES + 1, 2 * VERTICES);
	gi_drawn_chart_free(&one);
	gi_drawn_chart_free(&two);
}

/* A fan of thousands of triangles, each with coordinates of its own at the middle, takes no square of that. */
static void fans_are_quick(void **state)
{
	(void)state;
	const uint32_t count = 300000;
	uint32_t *indices = calloc(3 * (size_t)count, sizeof *indices);
	float(*uvs)[2] = calloc(3 * (size_t)count, sizeof *uvs);
	gi_drawn_chart chart;
	assert_true(indices && uvs);
	for (uint32_t k = 0; k < 3 * count; k++)
		uvs[k][0] = (float)k;
	const gi_drawn_surface drawn = {.vertex_count = 1, .indices = indices, .index_count = 3 * count};
	assert_true(gi_drawn_chart_build(&drawn, (const float(*)[2])uvs, NULL, 1, &chart));
	assert_int_equal(chart.vertex_count, 3 * count);
	gi_drawn_chart_free(&chart);
	free(indices);
	free(uvs);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(corners_keep_their_coordinates),
	    cmocka_unit_test(vertices_are_drawn_again_where_they_must),
	    cmocka_unit_test(fans_are_quick),
	};
	return cmocka_run_group_tests_name("drawn chart", tests, NULL, NULL);
}
