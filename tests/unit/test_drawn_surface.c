/* Light goes from leaves to drawn vertices without loss, without bleeding, and smoothly. */
#include "cages.h"

#include "drawn_surface.h"
#include "split.h"

#include <stdlib.h>
#include <string.h>

typedef struct drawn_cage {
	gi_refined coarse, fine;
	gi_hierarchy h;
	gi_drawn_surface drawn;
} drawn_cage;

static void draw_cage(const test_cage *t, uint32_t levels, uint32_t extra, drawn_cage *out)
{
	refine_cage(t, levels, &out->coarse);
	refine_cage(t, levels + extra, &out->fine);
	assert_true(gi_hierarchy_build(&out->coarse, &out->h, NULL, 0));
	assert_true(gi_drawn_from_cage(&out->h, &out->coarse, extra > 0 ? &out->fine : &out->coarse, NULL,
				       GI_LIGHT_EDGE_COSINE, &out->drawn));
}

static void free_drawn(drawn_cage *s)
{
	gi_drawn_free(&s->drawn);
	gi_hierarchy_free(&s->h);
	gi_refined_free(&s->fine);
	gi_refined_free(&s->coarse);
}

static void check_drawn(const gi_hierarchy *h, const gi_drawn_surface *drawn)
{
	assert_int_equal(drawn->light_first[0], 0);
	for (uint32_t light = 0; light < drawn->light_count; light++) {
		float sum = 0.0f;
		assert_true(drawn->light_first[light + 1] > drawn->light_first[light]);
		for (uint32_t i = drawn->light_first[light]; i < drawn->light_first[light + 1]; i++) {
			assert_true(drawn->light_leaf[i] < h->leaf_count);
			assert_true(drawn->light_weight[i] > 0.0f);
			sum += drawn->light_weight[i];
		}
		CHECK_NEAR(sum, 1.0, 1e-6); /* rounding of a few terms */
	}
	for (uint32_t i = 0; i < drawn->vertex_count; i++) {
		const gi_draw_vertex *v = &drawn->vertices[i];
		float sum = 0.0f;
		for (int k = 0; k < 4; k++) {
			assert_true(v->light[k] < drawn->light_count);
			assert_true(v->weight[k] >= 0.0f);
			sum += v->weight[k];
		}
		CHECK_NEAR(sum, 1.0, 1e-6);
		CHECK_NEAR(v->normal[0] * v->normal[0] + v->normal[1] * v->normal[1] + v->normal[2] * v->normal[2], 1.0,
			   1e-5);
		assert_true(v->leaf < h->leaf_count);
	}
	assert_int_equal(drawn->index_count % 3, 0);
	for (uint32_t i = 0; i < drawn->index_count; i++)
		assert_true(drawn->indices[i] < drawn->vertex_count);
}

/* Light of a drawn vertex, given that of the leaves. */
static double shade(const gi_drawn_surface *drawn, uint32_t vertex, const double *leaf_light)
{
	const gi_draw_vertex *v = &drawn->vertices[vertex];
	double sum = 0.0;
	for (int k = 0; k < 4; k++)
		for (uint32_t i = drawn->light_first[v->light[k]]; i < drawn->light_first[v->light[k] + 1]; i++)
			sum += (double)v->weight[k] * drawn->light_weight[i] * leaf_light[drawn->light_leaf[i]];
	return sum;
}

static double drawn_area(const gi_drawn_surface *drawn)
{
	double area = 0.0;
	for (uint32_t i = 0; i < drawn->index_count; i += 3) {
		const float *a = drawn->vertices[drawn->indices[i]].position,
			    *b = drawn->vertices[drawn->indices[i + 1]].position;
		const float *c = drawn->vertices[drawn->indices[i + 2]].position;
		area += gi_quad_area(a, b, c, c);
	}
	return area;
}

/* Every triangle turns the way its vertices' normals say. */
static void check_winding(const gi_drawn_surface *drawn)
{
	for (uint32_t i = 0; i < drawn->index_count; i += 3) {
		const gi_draw_vertex *a = &drawn->vertices[drawn->indices[i]],
				     *b = &drawn->vertices[drawn->indices[i + 1]];
		const gi_draw_vertex *c = &drawn->vertices[drawn->indices[i + 2]];
		float u[3], v[3];
		for (int k = 0; k < 3; k++) {
			u[k] = b->position[k] - a->position[k];
			v[k] = c->position[k] - a->position[k];
		}
		const float n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
		assert_true(n[0] * a->normal[0] + n[1] * a->normal[1] + n[2] * a->normal[2] > 0.0f);
	}
}

static double *light_of_leaves(const gi_hierarchy *h, double x, double y, double z)
{
	double *light = calloc(h->leaf_count, sizeof *light);
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++) {
		const gi_uvec4 c = h->topology[h->leaf_node[leaf]].corners;
		const gi_vec4 a = h->vertices[c.x], b = h->vertices[c.y], d = h->vertices[c.z], e = h->vertices[c.w];
		light[leaf] =
		    0.25 * (x * (a.x + b.x + d.x + e.x) + y * (a.y + b.y + d.y + e.y) + z * (a.z + b.z + d.z + e.z));
	}
	return light;
}

static void every_scheme_is_drawn_whole(void **state)
{
	(void)state;
	static void (*const makers[])(test_cage *, gi_refine_scheme) = {cage_cube, cage_prism, cage_octahedron};
	static const gi_refine_scheme schemes[] = {GI_REFINE_BILINEAR, GI_REFINE_CATMULL_CLARK, GI_REFINE_LOOP};
	for (size_t maker = 0; maker < 3; maker++)
		for (size_t scheme = 0; scheme < 3; scheme++)
			for (uint32_t levels = 0; levels < 3; levels++)
				for (uint32_t extra = 0; extra < 3; extra++) {
					if (schemes[scheme] == GI_REFINE_LOOP && maker != 2)
						continue;
					test_cage t;
					drawn_cage s;
					makers[maker](&t, schemes[scheme]);
					draw_cage(&t, levels, extra, &s);
					check_drawn(&s.h, &s.drawn);
					check_winding(&s.drawn);
					gi_hierarchy fine;
					build_cage(&t, levels + extra, &fine);
					CHECK_NEAR(drawn_area(&s.drawn), fine.area,
						   1e-5 * fine.area); /* float positions */
					gi_hierarchy_free(&fine);
					free_drawn(&s);
				}
}

static void a_linear_light_is_drawn_linear(void **state)
{
	(void)state;
	test_cage t;
	drawn_cage s;
	cage_grid(&t, GI_REFINE_CATMULL_CLARK, 6);
	for (uint32_t extra = 0; extra < 3; extra++) {
		draw_cage(&t, 1, extra, &s);
		double *light = light_of_leaves(&s.h, 3.0, -2.0, 0.0);
		uint32_t inside = 0;
		for (uint32_t i = 0; i < s.drawn.vertex_count; i++) {
			const float *p = s.drawn.vertices[i].position;
			/* A boundary vertex is lit by one side alone; one leaf further in all is exact. Limit positions
			 * near the boundary are not evenly spaced, so only the middle is compared. */
			if (p[0] < 2.0f || p[0] > 4.0f || p[1] < 2.0f || p[1] > 4.0f)
				continue;
			CHECK_NEAR(shade(&s.drawn, i, light), 3.0 * p[0] - 2.0 * p[1], 1e-5);
			inside++;
		}
		assert_true(inside >= 25);
		free(light);
		free_drawn(&s);
	}
}

static void constant_light_stays_constant(void **state)
{
	(void)state;
	test_cage t;
	drawn_cage s;
	cage_prism(&t, GI_REFINE_CATMULL_CLARK);
	draw_cage(&t, 2, 1, &s);
	double *light = calloc(s.h.leaf_count, sizeof *light);
	for (uint32_t leaf = 0; leaf < s.h.leaf_count; leaf++)
		light[leaf] = 0.75;
	for (uint32_t i = 0; i < s.drawn.vertex_count; i++)
		CHECK_NEAR(shade(&s.drawn, i, light), 0.75, 1e-6);
	free(light);
	free_drawn(&s);
}

static void light_does_not_go_round_the_edges_of_a_box(void **state)
{
	(void)state;
	test_cage t;
	drawn_cage s;
	cage_cube(&t, GI_REFINE_BILINEAR);
	memset(t.materials, 0, sizeof t.materials);
	draw_cage(&t, 2, 1, &s);
	/* Six sides of 5 x 5 light vertices each, drawn as fans: 25 corners and 16 centres a side. */
	assert_int_equal(s.drawn.light_count, 6 * 25);
	assert_int_equal(s.drawn.vertex_count, 6 * (25 + 16));
	assert_int_equal(s.drawn.index_count, 6 * 16 * 12);
	double *light = calloc(s.h.leaf_count, sizeof *light);
	for (uint32_t leaf = 0; leaf < s.h.leaf_count; leaf++)
		light[leaf] = s.h.geometry[s.h.leaf_node[leaf]].axis.z > 0.5f;
	for (uint32_t i = 0; i < s.drawn.vertex_count; i++)
		CHECK_NEAR(shade(&s.drawn, i, light), s.drawn.vertices[i].normal[2] > 0.5f, 1e-6);
	free(light);
	free_drawn(&s);
}

/* The drawn vertex in a place; all that are there have one light where nothing parts it. */
static uint32_t drawn_at(const gi_drawn_surface *drawn, const gi_vec4 *place)
{
	for (uint32_t i = 0; i < drawn->vertex_count; i++)
		if (drawn->vertices[i].position[0] == place->x && drawn->vertices[i].position[1] == place->y &&
		    drawn->vertices[i].position[2] == place->z)
			return i;
	fail_msg("no vertex is drawn at %g %g %g", (double)place->x, (double)place->y, (double)place->z);
	return 0;
}

typedef struct steps {
	double largest; /* of the light along edges of leaves, where vertices of others lie on them */
	uint32_t count; /* of such vertices */
} steps;

static void look_along(const drawn_cage *s, const double *light, const gi_vec4 *a, const gi_vec4 *b, steps *out)
{
	const double ab[3] = {(double)b->x - a->x, (double)b->y - a->y, (double)b->z - a->z};
	const double at_a = shade(&s->drawn, drawn_at(&s->drawn, a), light),
		     at_b = shade(&s->drawn, drawn_at(&s->drawn, b), light);
	for (uint32_t v = 0; v < s->h.vertex_count; v++) {
		const gi_vec4 *m = &s->h.vertices[v];
		const double am[3] = {(double)m->x - a->x, (double)m->y - a->y, (double)m->z - a->z};
		const double length2 = ab[0] * ab[0] + ab[1] * ab[1] + ab[2] * ab[2],
			     share = (ab[0] * am[0] + ab[1] * am[1] + ab[2] * am[2]) / length2;
		double off2 = 0;
		for (int c = 0; c < 3; c++)
			off2 += pow(am[c] - share * ab[c], 2);
		if (share < 1e-4 || share > 1 - 1e-4 || off2 > 1e-10 * length2)
			continue;
		out->count++;
		out->largest = fmax(out->largest, fabs(shade(&s->drawn, drawn_at(&s->drawn, m), light) -
						       (at_a * (1 - share) + at_b * share)));
	}
}

/* Cuts that end within a face leave leaves of other sizes beside each other: light goes on across all the same. */
static void light_has_no_step_where_leaves_hang(void **state)
{
	(void)state;
	static const gi_leaf_cut cuts[] = {{0, {1.1f, .6f, 0}, {2.3f, .6f, 0}, false},
					   {0, {1.1f, .6f, 0}, {1.1f, 2.2f, 0}, false},
					   {0, {2.9f, 2.6f, 0}, {3.7f, 3.3f, 0}, false}};
	test_cage t;
	drawn_cage s = {0};
	char message[256];
	cage_begin(&t, GI_REFINE_BILINEAR);
	cage_face(&t, 4,
		  (uint32_t[]){cage_vertex(&t, 0, 0, 0), cage_vertex(&t, 4, 0, 0), cage_vertex(&t, 4, 4, 0),
			       cage_vertex(&t, 0, 4, 0)});
	assert_true(gi_split(&t.cage, &(gi_split_def){.leaf_size = .9f, .cuts = cuts, .cut_count = 3}, &s.coarse,
			     message, sizeof message));
	assert_true(gi_hierarchy_build(&s.coarse, &s.h, NULL, 0));
	assert_true(gi_drawn_from_cage(&s.h, &s.coarse, &s.coarse, NULL, GI_LIGHT_EDGE_COSINE, &s.drawn));
	check_drawn(&s.h, &s.drawn);
	double *light = calloc(s.h.leaf_count, sizeof *light);
	assert_non_null(light);
	for (uint32_t leaf = 0; leaf < s.h.leaf_count; leaf++)
		light[leaf] = (double)(leaf * 7919u % 97u) / 97;
	steps seen = {0};
	for (uint32_t leaf = 0; leaf < s.h.leaf_count; leaf++) {
		const gi_uvec4 c = s.h.topology[s.h.leaf_node[leaf]].corners;
		const uint32_t v[5] = {c.x, c.y, c.z, c.w, c.x};
		for (int k = 0; k < 4; k++)
			if (v[k] != v[k + 1])
				look_along(&s, light, &s.h.vertices[v[k]], &s.h.vertices[v[k + 1]], &seen);
	}
	printf("%u leaves, %u corners hang on edges of others, steps of at most %.2g\n", s.h.leaf_count, seen.count,
	       seen.largest);
	assert_true(seen.count >= 4);
	assert_true(seen.largest <=
		    5e-4); /* a ring of corners that hang on each other's edges is not followed for ever */
	free(light);
	free_drawn(&s);
}

/* ---- seams ---- */

/* An edge of a drawn triangle by where it begins and ends. */
typedef struct drawn_edge {
	float ends[6];
} drawn_edge;

static int by_bytes(const void *a, const void *b)
{
	return memcmp(a, b, sizeof(drawn_edge));
}

/* Each edge of a triangle is one of another, the other way round: nothing is seen between the two. */
static void check_closed(const gi_drawn_surface *drawn)
{
	drawn_edge *edges = calloc(drawn->index_count, sizeof *edges);
	assert_non_null(edges);
	for (uint32_t k = 0; k < drawn->index_count; k++) {
		const uint32_t next = k - k % 3 + (k + 1) % 3;
		const float *from = drawn->vertices[drawn->indices[k]].position,
			    *to = drawn->vertices[drawn->indices[next]].position;
		for (int c = 0; c < 3; c++) {
			edges[k].ends[c] = from[c] + 0.0f; /* no -0 */
			edges[k].ends[3 + c] = to[c] + 0.0f;
		}
	}
	qsort(edges, drawn->index_count, sizeof *edges, by_bytes);
	uint32_t open = 0;
	for (uint32_t k = 0; k < drawn->index_count; k++) {
		drawn_edge back;
		memcpy(back.ends, edges[k].ends + 3, sizeof *back.ends * 3);
		memcpy(back.ends + 3, edges[k].ends, sizeof *back.ends * 3);
		open += !bsearch(&back, edges, drawn->index_count, sizeof *edges, by_bytes);
	}
	free(edges);
	if (open)
		fail_msg("%u edges of %u are open", open, drawn->index_count);
}

/* A cube, two sides of it in triangles, whose faces are cut each for itself: no leaf's corner lies unseen on an edge of
 * another leaf. */
static void leaves_of_other_sizes_leave_no_gap(void **state)
{
	(void)state;
	static const gi_leaf_cut cuts[] = {{0, {.3f, .4f, 0}, {.8f, .4f, 0}, true},
					   {0, {.3f, .4f, 0}, {.3f, 1, 0}, true},
					   {1, {.1f, .2f, 1}, {.9f, .7f, 1}, false},
					   {2, {.25f, 0, .35f}, {.75f, 0, .6f}, true}};
	static const float sizes[] = {.3f, .17f, .4f, .23f, .31f, .12f, .29f, .5f};
	static const uint32_t faces[8][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3},
					     {0, 4, 6},    {0, 6, 2},    {1, 3, 7},    {1, 7, 5}};
	test_cage t;
	drawn_cage s = {0};
	char message[256];
	uint32_t v[8], corners[4];
	cage_begin(&t, GI_REFINE_BILINEAR);
	for (uint32_t k = 0; k < 8; k++)
		v[k] = cage_vertex(&t, (float)(k & 1), (float)(k >> 1 & 1), (float)(k >> 2));
	for (uint32_t f = 0; f < 8; f++) {
		for (uint32_t k = 0; k < 4; k++)
			corners[k] = v[faces[f][k]];
		cage_face(&t, f < 4 ? 4 : 3, corners);
	}
	const gi_split_def def = {.leaf_size = .3f, .leaf_sizes = sizes, .cuts = cuts, .cut_count = 4};
	assert_true(gi_split(&t.cage, &def, &s.coarse, message, sizeof message));
	assert_true(gi_hierarchy_build(&s.coarse, &s.h, NULL, 0));
	assert_true(gi_drawn_from_cage(&s.h, &s.coarse, &s.coarse, NULL, GI_LIGHT_EDGE_COSINE, &s.drawn));
	check_drawn(&s.h, &s.drawn);
	check_closed(&s.drawn);
	assert_float_equal(drawn_area(&s.drawn), 6, 1e-5);
	free_drawn(&s);
}

static void surfaces_that_only_touch_share_no_light(void **state)
{
	(void)state;
	/* Two squares in one plane that meet in one vertex alone. */
	test_cage t;
	drawn_cage s;
	cage_begin(&t, GI_REFINE_BILINEAR);
	const uint32_t a = cage_vertex(&t, 0, 0, 0);
	cage_face(&t, 4, (uint32_t[]){a, cage_vertex(&t, 1, 0, 0), cage_vertex(&t, 1, 1, 0), cage_vertex(&t, 0, 1, 0)});
	cage_face(&t, 4,
		  (uint32_t[]){a, cage_vertex(&t, -1, 0, 0), cage_vertex(&t, -1, -1, 0), cage_vertex(&t, 0, -1, 0)});
	draw_cage(&t, 0, 0, &s);
	check_drawn(&s.h, &s.drawn);
	assert_int_equal(s.drawn.light_count, 8);
	free_drawn(&s);
}

static void smooth_surfaces_share_their_vertices(void **state)
{
	(void)state;
	test_cage t;
	drawn_cage s;
	cage_cube(&t, GI_REFINE_CATMULL_CLARK);
	memset(t.materials, 0, sizeof t.materials);
	draw_cage(&t, 3, 1, &s);
	/* No edge anywhere: one light vertex a leaf corner, one drawn vertex a finer corner. */
	assert_int_equal(s.drawn.light_count, s.coarse.vertex_count);
	assert_int_equal(s.drawn.vertex_count, s.fine.vertex_count);
	assert_int_equal(s.drawn.index_count, 6 * s.fine.levels[4].face_count);
	free_drawn(&s);

	/* Materials part them. */
	cage_cube(&t, GI_REFINE_CATMULL_CLARK);
	draw_cage(&t, 3, 1, &s);
	assert_true(s.drawn.vertex_count > s.fine.vertex_count);
	assert_int_equal(s.drawn.light_count, s.coarse.vertex_count);
	free_drawn(&s);

	cage_octahedron(&t, GI_REFINE_LOOP);
	memset(t.materials, 0, sizeof t.materials);
	draw_cage(&t, 3, 2, &s);
	assert_int_equal(s.drawn.light_count, s.coarse.vertex_count);
	assert_int_equal(s.drawn.vertex_count, s.fine.vertex_count);
	free_drawn(&s);
}

static void finer_levels_must_be_of_the_same_cage(void **state)
{
	(void)state;
	test_cage t, other;
	gi_refined coarse, fine;
	gi_hierarchy h;
	gi_drawn_surface drawn;
	cage_cube(&t, GI_REFINE_BILINEAR);
	cage_grid(&other, GI_REFINE_BILINEAR, 2);
	refine_cage(&t, 1, &coarse);
	refine_cage(&other, 2, &fine);
	assert_true(gi_hierarchy_build(&coarse, &h, NULL, 0));
	assert_false(gi_drawn_from_cage(&h, &coarse, &fine, NULL, GI_LIGHT_EDGE_COSINE, &drawn));
	assert_null(drawn.vertices);
	gi_hierarchy_free(&h);
	gi_refined_free(&coarse);
	gi_refined_free(&fine);
}

/* ---- detailed meshes ---- */

typedef struct ball {
	float *positions;
	uint32_t *indices;
	uint32_t vertex_count, index_count;
} ball;

/* A Catmull-Clark ball, each vertex moved out or in by up to `bump`. */
static void make_ball(ball *out, uint32_t levels, float bump)
{
	test_cage t;
	gi_refined r;
	cage_cube(&t, GI_REFINE_CATMULL_CLARK);
	refine_cage(&t, levels, &r);
	const gi_refine_level *level = &r.levels[levels];
	out->vertex_count = r.vertex_count;
	out->index_count = 6 * level->face_count;
	out->positions = calloc(out->vertex_count, 3 * sizeof(float));
	out->indices = calloc(out->index_count, sizeof(uint32_t));
	for (uint32_t i = 0; i < r.vertex_count; i++)
		for (int k = 0; k < 3; k++)
			out->positions[3 * i + k] = r.positions[i][k] * (1.0f + bump * sinf(37.0f * (float)i));
	for (uint32_t i = 0; i < level->face_count; i++) {
		const uint32_t *c = level->corners[i], triangles[6] = {c[0], c[1], c[2], c[0], c[2], c[3]};
		memcpy(out->indices + 6 * i, triangles, sizeof triangles);
	}
	gi_refined_free(&r);
}

static void free_ball(ball *b)
{
	free(b->positions);
	free(b->indices);
}

static void a_detailed_ball_takes_the_light_of_its_cage(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy h;
	gi_drawn_surface drawn;
	ball b;
	cage_cube(&t, GI_REFINE_CATMULL_CLARK);
	build_cage(&t, 2, &h);
	make_ball(&b, 5, 0.01f);
	assert_true(gi_drawn_from_mesh(&h, b.positions, b.vertex_count, b.indices, b.index_count,
				       GI_LIGHT_CAGE_EDGE_COSINE, &drawn));
	check_drawn(&h, &drawn);
	assert_int_equal(drawn.vertex_count, b.vertex_count);
	assert_int_equal(drawn.index_count, b.index_count);
	assert_memory_equal(drawn.indices, b.indices, b.index_count * sizeof *b.indices);
	double *light = light_of_leaves(&h, 1.0, 0.0, 0.0);
	for (uint32_t i = 0; i < drawn.vertex_count; i++) {
		const gi_vec4 sphere = h.geometry[h.leaf_node[drawn.vertices[i].leaf]].sphere;
		const float *p = drawn.vertices[i].position;
		const double d = hypot(hypot(p[0] - sphere.x, p[1] - sphere.y), p[2] - sphere.z);
		/* The ball leaves its cage's leaves by less than a tenth: bumps of 0.01 and the sag of the leaves. */
		assert_true(d < sphere.w + 0.1);
		CHECK_NEAR(shade(&drawn, i, light), p[0], 0.12);
	}
	free(light);
	gi_drawn_free(&drawn);
	gi_hierarchy_free(&h);
	free_ball(&b);
}

static void light_varies_smoothly_over_a_detailed_mesh(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy h;
	gi_drawn_surface drawn;
	ball b;
	cage_cube(&t, GI_REFINE_CATMULL_CLARK);
	build_cage(&t, 2, &h);
	make_ball(&b, 6, 0.0f);
	assert_true(gi_drawn_from_mesh(&h, b.positions, b.vertex_count, b.indices, b.index_count,
				       GI_LIGHT_CAGE_EDGE_COSINE, &drawn));
	double *light = light_of_leaves(&h, 1.0, 0.0, 0.0);
	for (uint32_t i = 0; i < drawn.index_count; i++) {
		const uint32_t a = drawn.indices[i], c = drawn.indices[i % 3 == 2 ? i - 2 : i + 1];
		const float *p = drawn.vertices[a].position, *q = drawn.vertices[c].position;
		const double step = hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
		/* The light has slope 1; interpolation between leaf corners may triple it, a jump would be a leaf wide.
		 */
		assert_true(fabs(shade(&drawn, a, light) - shade(&drawn, c, light)) < 3.0 * step);
	}
	free(light);
	gi_drawn_free(&drawn);
	gi_hierarchy_free(&h);
	free_ball(&b);
}

static void both_sides_of_a_thin_slab_keep_their_own_light(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy h;
	gi_drawn_surface drawn;
	cage_cube(&t, GI_REFINE_BILINEAR);
	t.cage.scale[2] = 0.01f;
	build_cage(&t, 3, &h);
	/* A square facing down, just above the slab's top: nearest is the top, but the underside faces as it does. */
	const float positions[12] = {-0.5f, -0.5f, 0.011f, -0.5f, 0.5f,  0.011f,
				     0.5f,  0.5f,  0.011f, 0.5f,  -0.5f, 0.011f};
	const uint32_t down[6] = {0, 1, 2, 0, 2, 3}, up[6] = {0, 2, 1, 0, 3, 2};
	assert_true(gi_drawn_from_mesh(&h, positions, 4, down, 6, GI_LIGHT_CAGE_EDGE_COSINE, &drawn));
	for (uint32_t i = 0; i < 4; i++)
		assert_true(h.geometry[h.leaf_node[drawn.vertices[i].leaf]].axis.z < -0.9f);
	gi_drawn_free(&drawn);
	assert_true(gi_drawn_from_mesh(&h, positions, 4, up, 6, GI_LIGHT_CAGE_EDGE_COSINE, &drawn));
	for (uint32_t i = 0; i < 4; i++)
		assert_true(h.geometry[h.leaf_node[drawn.vertices[i].leaf]].axis.z > 0.9f);
	gi_drawn_free(&drawn);
	gi_hierarchy_free(&h);
}

static void a_vertex_that_nothing_faces_takes_the_closest(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy h;
	gi_drawn_surface drawn;
	cage_grid(&t, GI_REFINE_BILINEAR, 4);
	build_cage(&t, 0, &h);
	const float positions[12] = {1.2f, 1.2f, 0.1f, 1.2f, 1.4f, 0.1f, 1.4f, 1.2f, 0.1f, 9.0f, 9.0f, 9.0f};
	const uint32_t down[3] = {0, 1, 2};
	assert_true(gi_drawn_from_mesh(&h, positions, 4, down, 3, GI_LIGHT_CAGE_EDGE_COSINE, &drawn));
	check_drawn(&h, &drawn);
	const uint32_t node = h.leaf_node[drawn.vertices[0].leaf];
	assert_true(drawn.vertices[0].normal[2] < -0.9f);
	assert_true(h.geometry[node].sphere.x == 1.5f && h.geometry[node].sphere.y == 1.5f);
	/* A vertex of no triangle takes the leaf's normal. */
	assert_true(drawn.vertices[3].normal[2] > 0.9f);
	gi_drawn_free(&drawn);
	gi_hierarchy_free(&h);
}

static void broken_meshes_are_refused(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy h;
	gi_drawn_surface drawn;
	cage_grid(&t, GI_REFINE_BILINEAR, 2);
	build_cage(&t, 0, &h);
	float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
	uint32_t indices[3] = {0, 1, 3};
	assert_false(gi_drawn_from_mesh(&h, positions, 3, indices, 3, GI_LIGHT_CAGE_EDGE_COSINE, &drawn));
	assert_null(drawn.vertices);
	indices[2] = 2;
	positions[4] = NAN;
	assert_false(gi_drawn_from_mesh(&h, positions, 3, indices, 3, GI_LIGHT_CAGE_EDGE_COSINE, &drawn));
	positions[4] = 0.0f;
	assert_false(gi_drawn_from_mesh(&h, positions, 3, indices, 2, GI_LIGHT_CAGE_EDGE_COSINE, &drawn));
	assert_true(gi_drawn_from_mesh(&h, positions, 3, indices, 3, GI_LIGHT_CAGE_EDGE_COSINE, &drawn));
	gi_drawn_free(&drawn);
	gi_drawn_free(&drawn);
	gi_drawn_free(NULL);
	gi_hierarchy_free(&h);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(every_scheme_is_drawn_whole),
	    cmocka_unit_test(a_linear_light_is_drawn_linear),
	    cmocka_unit_test(constant_light_stays_constant),
	    cmocka_unit_test(light_does_not_go_round_the_edges_of_a_box),
	    cmocka_unit_test(light_has_no_step_where_leaves_hang),
	    cmocka_unit_test(leaves_of_other_sizes_leave_no_gap),
	    cmocka_unit_test(surfaces_that_only_touch_share_no_light),
	    cmocka_unit_test(smooth_surfaces_share_their_vertices),
	    cmocka_unit_test(finer_levels_must_be_of_the_same_cage),
	    cmocka_unit_test(a_detailed_ball_takes_the_light_of_its_cage),
	    cmocka_unit_test(light_varies_smoothly_over_a_detailed_mesh),
	    cmocka_unit_test(both_sides_of_a_thin_slab_keep_their_own_light),
	    cmocka_unit_test(a_vertex_that_nothing_faces_takes_the_closest),
	    cmocka_unit_test(broken_meshes_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
