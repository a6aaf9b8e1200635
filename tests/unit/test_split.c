/* Cages split face by face: every face has leaves of its size, areas stay, lines are not crossed, and the hierarchies
 * above the pieces keep the validator's rules. */
#include "cages.h"

#include "drawn_surface.h"
#include "split.h"

#include <stdlib.h>

typedef struct split_cage {
	gi_refined refined;
	gi_hierarchy h;
} split_cage;

static void split_open(const test_cage *t, const gi_split_def *def, split_cage *out)
{
	char message[256] = "";
	if (!gi_split(&t->cage, def, &out->refined, message, sizeof message) ||
	    !gi_hierarchy_build(&out->refined, &out->h, message, sizeof message))
		fail_msg("%s", message);
	const char *broken = gi_validate_hierarchy(&out->h);
	if (broken)
		fail_msg("%s", broken);
}

static void split_close(split_cage *s)
{
	gi_refined_free(&s->refined);
	gi_hierarchy_free(&s->h);
}

static const float *leaf_corner(const gi_hierarchy *h, uint32_t leaf, uint32_t k)
{
	const gi_uvec4 c = h->topology[h->leaf_node[leaf]].corners;
	const uint32_t v[4] = {c.x, c.y, c.z, c.w};
	return &h->vertices[v[k]].x;
}

static double distance(const float a[3], const float b[3])
{
	return sqrt(pow((double)a[0] - b[0], 2) + pow((double)a[1] - b[1], 2) + pow((double)a[2] - b[2], 2));
}

static double longest_edge(const gi_hierarchy *h)
{
	double longest = 0;
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++)
		for (uint32_t k = 0; k < 4; k++)
			longest = fmax(longest, distance(leaf_corner(h, leaf, k), leaf_corner(h, leaf, (k + 1) % 4)));
	return longest;
}

/* Two rectangles, 10 x 1 m and 0.3 x 0.2 m, in one cage. */
static void two_rectangles(test_cage *t)
{
	static const float corners[8][2] = {{0, 0}, {10, 0}, {10, 1}, {0, 1}, {0, 2}, {.3f, 2}, {.3f, 2.2f}, {0, 2.2f}};
	cage_begin(t, GI_REFINE_BILINEAR);
	for (int k = 0; k < 8; k++)
		cage_vertex(t, corners[k][0], corners[k][1], 0);
	cage_face(t, 4, (uint32_t[]){0, 1, 2, 3});
	cage_face(t, 4, (uint32_t[]){4, 5, 6, 7});
}

static void each_face_is_split_for_itself(void **state)
{
	(void)state;
	test_cage t;
	split_cage s;
	two_rectangles(&t);
	const gi_split_def def = {.leaf_size = .25f};
	split_open(&t, &def, &s);
	assert_int_equal(s.h.leaf_count, 40 * 4 + 2);
	CHECK_NEAR(gi_split_estimate(&t.cage, &def), s.h.leaf_count, 0);
	CHECK_NEAR(s.h.area, 10.06, 1e-6);
	assert_true(longest_edge(&s.h) <= .2501);
	split_close(&s);

	const float sizes[2] = {0, .05f};
	const gi_split_def own = {.leaf_size = 1, .leaf_sizes = sizes};
	split_open(&t, &own, &s);
	assert_int_equal(s.h.leaf_count, 10 + 6 * 4);
	split_close(&s);
}

/* Leaves of neighbours meet corner to corner: a cube has as many vertices as it would have by refinement. */
static void neighbours_share_their_corners(void **state)
{
	(void)state;
	test_cage t;
	split_cage s;
	cage_cube(&t, GI_REFINE_BILINEAR);
	split_open(&t, &(gi_split_def){.leaf_size = .4f}, &s);
	assert_int_equal(s.h.leaf_count, 6 * 25);
	assert_int_equal(s.refined.vertex_count, 6 * 25 + 2); /* Euler */
	assert_true(s.h.closed);
	CHECK_NEAR(s.h.volume, 8, 1e-6);
	split_close(&s);
}

static void triangles_and_polygons_are_split(void **state)
{
	(void)state;
	static void (*const makers[])(test_cage *, gi_refine_scheme) = {cage_cube, cage_octahedron, cage_tetrahedron,
									cage_prism};
	for (size_t maker = 0; maker < 4; maker++)
		for (float size = .07f; size < 3; size *= 3) {
			test_cage t;
			split_cage s, whole;
			makers[maker](&t, GI_REFINE_BILINEAR);
			split_open(&t, &(gi_split_def){.leaf_size = 1e3f}, &whole);
			const gi_split_def def = {.leaf_size = size};
			split_open(&t, &def, &s);
			CHECK_NEAR(s.h.area, whole.h.area, 1e-5 * whole.h.area);
			CHECK_NEAR(s.h.volume, whole.h.volume, 1e-5 * whole.h.volume);
			assert_true(longest_edge(&s.h) <= 1.42 * 1.01 * (double)size * 1.0001);
			assert_true(s.h.closed);
			split_close(&s);
			split_close(&whole);
		}
}

/* On which side of the line from a to b are a leaf's corners? Both: the leaf is crossed. */
static bool is_crossed(const gi_hierarchy *h, uint32_t leaf, const float a[3], const float b[3])
{
	double least = INFINITY, most = -INFINITY;
	for (uint32_t k = 0; k < 4; k++) {
		const float *p = leaf_corner(h, leaf, k);
		const double side =
		    ((double)b[0] - a[0]) * ((double)p[1] - a[1]) - ((double)b[1] - a[1]) * ((double)p[0] - a[0]);
		least = fmin(least, side);
		most = fmax(most, side);
	}
	return least < -1e-5 && most > 1e-5;
}

/* A wall right across a floor, from 3.3 to 3.5 m, parts the tree at its top; a short one the leaves under it alone. */
static void lines_are_not_crossed(void **state)
{
	(void)state;
	static const gi_leaf_cut across[] = {{0, {3.3f, -1, 0}, {3.3f, 3, 0}, false},
					     {0, {3.5f, 0, .4f}, {3.5f, 1, -2}, false}};
	static const gi_leaf_cut slanted[] = {{0, {2, .2f, 0}, {7, .9f, 0}, false}};
	test_cage t;
	split_cage s;
	two_rectangles(&t);
	split_open(&t, &(gi_split_def){.leaf_size = .5f, .cuts = across, .cut_count = 2}, &s);
	for (uint32_t node = 0; node < s.h.node_count; node++) {
		const gi_uvec4 range = s.h.topology[node].range;
		bool before = false, behind = false;
		for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
			assert_false(is_crossed(&s.h, leaf, across[0].from, across[0].to));
			before = before || leaf_corner(&s.h, leaf, 0)[0] + leaf_corner(&s.h, leaf, 2)[0] < 6.6f;
			behind = behind || leaf_corner(&s.h, leaf, 0)[0] + leaf_corner(&s.h, leaf, 2)[0] > 7;
		}
		/* Nodes on both sides of the wall: the face, and the root above it. */
		assert_true(!(before && behind) || range.z > 40);
	}
	CHECK_NEAR(s.h.area, 10.06, 1e-5);
	split_close(&s);

	split_open(&t, &(gi_split_def){.leaf_size = .5f, .cuts = slanted, .cut_count = 1}, &s);
	uint32_t crossed = 0;
	for (uint32_t leaf = 0; leaf < s.h.leaf_count; leaf++) {
		const double x = (double)leaf_corner(&s.h, leaf, 0)[0] + leaf_corner(&s.h, leaf, 2)[0];
		crossed += x > 4 && x < 14 && is_crossed(&s.h, leaf, slanted[0].from, slanted[0].to);
	}
	assert_int_equal(crossed, 0);
	/* 20 x 2 leaves, those along the line in two to four. */
	assert_true(s.h.leaf_count > 50 && s.h.leaf_count < 90);
	CHECK_NEAR(s.h.area, 10.06, 1e-5);
	split_close(&s);
}

/* As many lines as one likes: some thousand leaves, none without end, the surface whole. */
static void many_lines_end(void **state)
{
	(void)state;
	enum { LINES = 300 };
	gi_leaf_cut cuts[LINES];
	for (int k = 0; k < LINES; k++)
		cuts[k] = (gi_leaf_cut){0,
					{(float)(rand() % 1000) / 100, (float)(rand() % 100) / 100, 0},
					{(float)(rand() % 1000) / 100, (float)(rand() % 100) / 100, 0},
					rand() % 2 == 0};
	test_cage t;
	split_cage s;
	two_rectangles(&t);
	split_open(&t, &(gi_split_def){.leaf_size = .5f, .cuts = cuts, .cut_count = LINES}, &s);
	printf("%d random lines: %u leaves\n", LINES, s.h.leaf_count);
	CHECK_NEAR(s.h.area, 10.06, 1e-4);
	split_close(&s);
}

static void the_same_cage_gives_the_same_leaves(void **state)
{
	(void)state;
	static const gi_leaf_cut cuts[] = {{0, {2, .2f, 0}, {7, .9f, 0}, false}, {1, {.1f, 2, 0}, {.1f, 3, 0}, true}};
	const gi_split_def def = {.leaf_size = .1f, .cuts = cuts, .cut_count = 2};
	test_cage t;
	split_cage a, b;
	two_rectangles(&t);
	split_open(&t, &def, &a);
	split_open(&t, &def, &b);
	assert_int_equal(a.h.leaf_count, b.h.leaf_count);
	assert_memory_equal(a.refined.positions, b.refined.positions,
			    sizeof *a.refined.positions * a.refined.vertex_count);
	split_close(&a);
	split_close(&b);
}

/* Inside the polygon of `count` corners, which turn left? */
static bool is_within(const float (*corners)[2], uint32_t count, double x, double y)
{
	for (uint32_t k = 0; k < count; k++) {
		const float *a = corners[k], *b = corners[(k + 1) % count];
		if (((double)b[0] - a[0]) * (y - a[1]) - ((double)b[1] - a[1]) * (x - a[0]) < 0)
			return false;
	}
	return true;
}

static bool leaf_is_within(const gi_hierarchy *h, uint32_t leaf, const float (*corners)[2], uint32_t count)
{
	double x = 0, y = 0;
	for (uint32_t k = 0; k < 4; k++) {
		x += .25 * leaf_corner(h, leaf, k)[0];
		y += .25 * leaf_corner(h, leaf, k)[1];
	}
	return is_within(corners, count, x, y);
}

/* How many light vertices take light from leaves under a thing and beside it. */
static uint32_t count_mixed(const split_cage *s, const gi_drawn_surface *drawn, const float (*corners)[2],
			    uint32_t count)
{
	uint32_t mixed = 0;
	for (uint32_t light = 0; light < drawn->light_count; light++) {
		uint32_t within = 0;
		for (uint32_t k = drawn->light_first[light]; k < drawn->light_first[light + 1]; k++)
			within += leaf_is_within(&s->h, drawn->light_leaf[k], corners, count);
		mixed += within > 0 && within < drawn->light_first[light + 1] - drawn->light_first[light];
	}
	return mixed;
}

static uint32_t mixed_lights(const test_cage *t, float leaf_size, const float (*corners)[2], uint32_t count, bool parts)
{
	gi_leaf_cut cuts[8];
	split_cage s;
	gi_drawn_surface drawn;
	for (uint32_t k = 0; k < count; k++) {
		const float *a = corners[k], *b = corners[(k + 1) % count];
		cuts[k] = (gi_leaf_cut){0, {a[0], a[1], 0}, {b[0], b[1], 0}, parts};
	}
	split_open(t, &(gi_split_def){.leaf_size = leaf_size, .cuts = cuts, .cut_count = count}, &s);
	assert_true(gi_drawn_from_cage(&s.h, &s.refined, &s.refined, NULL, GI_LIGHT_EDGE_COSINE, &drawn));
	const uint32_t mixed = count_mixed(&s, &drawn, corners, count);
	gi_drawn_free(&drawn);
	split_close(&s);
	return mixed;
}

/* What stands on a floor: no light vertex takes leaves under it and beside it, wherever the grid lies. */
static void light_stays_on_its_side(void **state)
{
	(void)state;
	static const float block[4][2] = {{1, .2f}, {1.9f, .2f}, {1.9f, .8f}, {1, .8f}},
			   on_grid[4][2] = {{2, .25f}, {4, .25f}, {4, .75f}, {2, .75f}},
			   turned[4][2] = {{5, .1f}, {6, .3f}, {5.8f, .9f}, {4.8f, .7f}},
			   wedge[3][2] = {{3.1f, .15f}, {7.3f, .4f}, {3.3f, .85f}};
	static const struct {
		const float (*corners)[2];
		uint32_t count;
	} things[] = {{block, 4}, {on_grid, 4}, {turned, 4}, {wedge, 3}};
	test_cage t;
	two_rectangles(&t);
	for (size_t k = 0; k < sizeof things / sizeof *things; k++)
		for (float size = .5f; size > .05f; size *= .6f) {
			const uint32_t shared = mixed_lights(&t, size, things[k].corners, things[k].count, false),
				       parted = mixed_lights(&t, size, things[k].corners, things[k].count, true);
			printf("thing %zu, leaves of %.2f: %u light vertices on both sides, %u where light is parted\n",
			       k, (double)size, shared, parted);
			assert_true(shared > 0);
			assert_int_equal(parted, 0);
		}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(each_face_is_split_for_itself),
	    cmocka_unit_test(neighbours_share_their_corners),
	    cmocka_unit_test(triangles_and_polygons_are_split),
	    cmocka_unit_test(lines_are_not_crossed),
	    cmocka_unit_test(light_stays_on_its_side),
	    cmocka_unit_test(many_lines_end),
	    cmocka_unit_test(the_same_cage_gives_the_same_leaves),
	};
	return cmocka_run_group_tests_name("split", tests, NULL, NULL);
}
