/* Hierarchies of cubes, spheres, open planes and mixed faces keep the validator's rules, and the validator catches
 * trees that were broken on purpose. */
#include "cages.h"

#include "hierarchy_node.h"

#include <stdlib.h>

static void check_valid(const gi_hierarchy *h)
{
	const char *broken = gi_validate_hierarchy(h);
	if (broken)
		fail_msg("%s", broken);
}

static uint32_t count_flag(const gi_hierarchy *h, uint32_t flag)
{
	uint32_t count = 0;
	for (uint32_t node = 0; node < h->node_count; node++)
		count += (h->topology[node].range.w & flag) != 0;
	return count;
}

static void all_kinds_of_cages_are_valid(void **state)
{
	(void)state;
	static void (*const makers[])(test_cage *, gi_refine_scheme) = {cage_cube, cage_octahedron, cage_tetrahedron,
									cage_prism};
	static const gi_refine_scheme schemes[] = {GI_REFINE_BILINEAR, GI_REFINE_CATMULL_CLARK, GI_REFINE_LOOP};
	for (size_t maker = 0; maker < 4; maker++)
		for (size_t scheme = 0; scheme < 3; scheme++)
			for (uint32_t levels = 0; levels <= 4; levels++) {
				if (schemes[scheme] == GI_REFINE_LOOP && (maker == 0 || maker == 3))
					continue;
				test_cage t;
				gi_hierarchy h;
				makers[maker](&t, schemes[scheme]);
				build_cage(&t, levels, &h);
				check_valid(&h);
				assert_true(h.closed);
				assert_true(h.volume > 0.0);
				assert_int_equal(count_flag(&h, GI_NODE_BACK), 0);
				assert_int_equal(count_flag(&h, GI_NODE_LEAF), h.leaf_count);
				gi_hierarchy_free(&h);
			}
}

/* Small leaves far out, where a sphere measured about a centre that is not the stored one shows. */
static void leaves_far_from_the_origin_are_valid(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy h;
	cage_prism(&t, GI_REFINE_CATMULL_CLARK);
	for (uint32_t i = 0; i < t.cage.vertex_count; i++) {
		t.positions[3 * i] += 17.31f;
		t.positions[3 * i + 1] -= 9.777f;
		t.positions[3 * i + 2] += 5.123f;
	}
	build_cage(&t, 4, &h);
	check_valid(&h);
	gi_hierarchy_free(&h);
}

/* ---- extremes over all leaves of a node, none passed over ---- */

static double cosine_of_all(const gi_hierarchy *h, uint32_t node, gi_vec3d axis)
{
	const gi_uvec4 range = h->topology[node].range;
	double least = INFINITY;
	for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
		const quad q = node_quad(h, h->leaf_node[leaf]);
		const gi_vec3d halves[2] = {gi_vec3d_triangle(q.a, q.b, q.c), gi_vec3d_triangle(q.a, q.c, q.d)};
		for (int k = 0; k < 2; k++)
			least = fmin(least, gi_vec3d_dot(axis, halves[k]) / gi_vec3d_length(halves[k]));
	}
	return least;
}

static void distances_of_all(const gi_hierarchy *h, uint32_t node, gi_vec3d from, double *farthest, double *highest)
{
	const gi_uvec4 range = h->topology[node].range;
	const gi_vec3d normal = gi_node_normal(h, node);
	*farthest = *highest = 0;
	for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
		const quad q = node_quad(h, h->leaf_node[leaf]);
		const gi_vec3d corners[4] = {q.a, q.b, q.c, q.d};
		for (int k = 0; k < 4; k++) {
			const gi_vec3d to = gi_vec3d_sub(corners[k], from);
			*farthest = fmax(*farthest, gi_vec3d_length(to));
			*highest = fmax(*highest, fabs(gi_vec3d_dot(normal, to)));
		}
	}
}

static void expect_nothing_is_missed(const gi_hierarchy *h)
{
	for (uint32_t node = 0; node < h->node_count; node++) {
		const gi_vec4 sphere = h->geometry[node].sphere;
		const gi_vec3d normal = gi_node_normal(h, node), centre = gi_vec3d_from(sphere);
		double farthest, highest, found;
		distances_of_all(h, node, centre, &farthest, &highest);
		gi_node_farthest_corner(h, node, centre, &found);
		assert_true(found == farthest);
		assert_true(gi_node_thickness(h, node) == fmin(highest / (double)sphere.w, 1));
		assert_true(gi_node_least_cosine(h, node, normal) == cosine_of_all(h, node, normal));
	}
}

/* Of nodes whose balls and cones say so the leaves are not asked. Balls, creases, bumps; far out and tiny. */
static void extremes_are_those_of_all_leaves(void **state)
{
	(void)state;
	static void (*const makers[])(test_cage *, gi_refine_scheme) = {cage_cube, cage_octahedron, cage_prism};
	for (int maker = 0; maker < 3; maker++)
		for (int kind = 0; kind < 4; kind++) {
			test_cage t;
			gi_hierarchy h;
			makers[maker](&t, GI_REFINE_CATMULL_CLARK);
			for (uint32_t i = 0; i < 3 * t.cage.vertex_count; i++) {
				const float bump = .2f * sinf(7 * (float)i * (float)kind);
				t.positions[i] = (t.positions[i] + bump) * (kind == 2 ? 1e-5f : 1);
				t.positions[i] += kind == 3 ? 1e4f : 0;
			}
			build_cage(&t, 5, &h);
			expect_nothing_is_missed(&h);
			gi_hierarchy_free(&h);
		}
}

static void a_quad_has_the_area_of_its_triangles(void **state)
{
	(void)state;
	const float a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, c[3] = {1, 1, 1}, d[3] = {0, 1, 0};
	/* Both triangles are halves of 1 x sqrt 2 rectangles. */
	CHECK_NEAR(gi_quad_area(a, b, c, d), sqrt(2.0), 1e-12);
	CHECK_NEAR(gi_quad_area(a, b, c, c), sqrt(0.5), 1e-12);
}

static void a_bilinear_cube_is_measured_exactly(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy h;
	cage_cube(&t, GI_REFINE_BILINEAR);
	build_cage(&t, 2, &h);
	CHECK_NEAR(h.area, 24.0, 1e-12);
	CHECK_NEAR(h.volume, 8.0, 1e-12);
	assert_int_equal(h.leaf_count, 96);
	assert_int_equal(h.node_count, 96 + 24 + 6 + 5);
	/* Every face of every level is flat; the five clusters have no corners. */
	assert_int_equal(count_flag(&h, GI_NODE_FLAT), 96 + 24 + 6);
	assert_int_equal(count_flag(&h, GI_NODE_POLYGON), 96 + 24 + 6);
	assert_true(h.lower.x == -1.0f && h.upper.z == 1.0f);
	/* A closed surface has no mean normal. */
	assert_true(h.geometry[0].axis.w == -1.0f);
	CHECK_NEAR(h.geometry[0].moment.w, 24.0, 1e-5);
	for (uint32_t node = 0; node < h.node_count; node++)
		if (h.topology[node].range.w & GI_NODE_FLAT) {
			assert_true(h.geometry[node].axis.w == 1.0f);
			/* A square's sphere is its circumcircle's: half its diagonal. */
			CHECK_NEAR(h.geometry[node].sphere.w, sqrt(0.5 * h.geometry[node].moment.w), 1e-6);
		}
	gi_hierarchy_free(&h);
}

/* The axis of a flat node is rounded to float, its length too: the cone must not open by that, or coplanar patches, the
 * two sides of a sheet among them, would see each other. */
static void flat_nodes_have_one_normal_however_they_lie(void **state)
{
	(void)state;
	for (int turn = 1; turn < 40; turn++) {
		test_cage t;
		gi_hierarchy h;
		cage_cube(&t, GI_REFINE_BILINEAR);
		const double c = cos(.1 * turn), s = sin(.1 * turn), d = cos(.23 * turn), e = sin(.23 * turn);
		for (uint32_t i = 0; i < t.cage.vertex_count; i++) {
			float *p = t.positions + 3 * i;
			const double q[3] = {c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]};
			p[0] = (float)q[0];
			p[1] = (float)(d * q[1] - e * q[2]);
			p[2] = (float)(e * q[1] + d * q[2]);
		}
		build_cage(&t, 1, &h);
		check_valid(&h);
		for (uint32_t node = 0; node < h.node_count; node++)
			if (h.topology[node].range.w & GI_NODE_LEAF) {
				assert_true(h.geometry[node].axis.w == 1.0f);
				assert_int_equal(h.topology[node].range.w >> GI_NODE_THICKNESS_SHIFT, 0);
			}
		gi_hierarchy_free(&h);
	}
}

static void clusters_keep_the_sides_of_a_cube_together(void **state)
{
	(void)state;
	/* A cube whose sides are 2 x 2 base faces each: where a cluster holds four faces they are one side. */
	test_cage cube, t;
	gi_refined r;
	cage_cube(&cube, GI_REFINE_BILINEAR);
	refine_cage(&cube, 1, &r);
	cage_begin(&t, GI_REFINE_BILINEAR);
	for (uint32_t i = 0; i < r.vertex_count; i++)
		cage_vertex(&t, r.positions[i][0], r.positions[i][1], r.positions[i][2]);
	for (uint32_t i = 0; i < r.levels[1].face_count; i++)
		cage_face(&t, 4, r.levels[1].corners[i]);
	gi_refined_free(&r);
	gi_hierarchy h;
	build_cage(&t, 0, &h);
	check_valid(&h);
	uint32_t narrow = 0;
	for (uint32_t node = 0; node < h.node_count; node++)
		narrow += h.topology[node].range.z >= 3 && h.geometry[node].axis.w > 0.9f;
	assert_true(narrow >= 4);
	gi_hierarchy_free(&h);
}

static void open_surfaces_show_their_backs(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy h;
	cage_grid(&t, GI_REFINE_CATMULL_CLARK, 3);
	build_cage(&t, 2, &h);
	check_valid(&h);
	assert_false(h.closed);
	assert_int_equal(count_flag(&h, GI_NODE_BACK), h.node_count);
	CHECK_NEAR(h.area, 9.0, 1e-6);
	gi_hierarchy_free(&h);

	/* Inside out a cube is closed and shows its backs. */
	cage_cube(&t, GI_REFINE_BILINEAR);
	for (uint32_t i = 0; i < 24; i += 4) {
		const uint32_t b = t.indices[i + 1];
		t.indices[i + 1] = t.indices[i + 3];
		t.indices[i + 3] = b;
	}
	build_cage(&t, 1, &h);
	assert_true(h.closed);
	CHECK_NEAR(h.volume, -8.0, 1e-12);
	assert_int_equal(count_flag(&h, GI_NODE_BACK), h.node_count);
	gi_hierarchy_free(&h);
}

static void a_plane_of_any_scheme_is_flat_inside(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy h;
	cage_grid(&t, GI_REFINE_CATMULL_CLARK, 3);
	build_cage(&t, 2, &h);
	/* Sharp corners and straight edges: every face keeps its outline, and so do the eight clusters of nine faces.
	 */
	assert_int_equal(count_flag(&h, GI_NODE_FLAT), 9 * (1 + 4 + 16) + 8);
	gi_hierarchy_free(&h);
	/* Rounded corners lose area against the quad: the four corner faces are no longer flat, nor their parents. */
	t.cage.boundary = GI_REFINE_BOUNDARY_EDGE_ONLY;
	build_cage(&t, 2, &h);
	check_valid(&h);
	assert_true(count_flag(&h, GI_NODE_FLAT) < 9 * (1 + 4 + 16));
	assert_true(count_flag(&h, GI_NODE_FLAT) >= 9 * 16);
	gi_hierarchy_free(&h);
}

static void bent_quads_are_not_flat(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy h;
	cage_grid(&t, GI_REFINE_BILINEAR, 2);
	t.positions[2] = 0.1f; /* lifts one corner of one quad */
	build_cage(&t, 0, &h);
	assert_int_equal(count_flag(&h, GI_NODE_FLAT), 3 + 1); /* and the pair of two that is not with it */
	check_valid(&h);
	gi_hierarchy_free(&h);
	/* The refined corner face stays bent to its last leaf. */
	build_cage(&t, 2, &h);
	assert_int_equal(count_flag(&h, GI_NODE_FLAT), 3 * (1 + 4 + 16) + 1);
	check_valid(&h);
	gi_hierarchy_free(&h);
}

static uint32_t count_polygon_clusters(const test_cage *t)
{
	gi_hierarchy h;
	build_cage(t, 0, &h);
	check_valid(&h);
	const uint32_t clusters = count_flag(&h, GI_NODE_POLYGON) - h.leaf_count;
	gi_hierarchy_free(&h);
	return clusters;
}

/* A wall of any number of faces is a rectangle, and so are its parts; what is not tiled by a quad is none. */
static void clusters_of_a_wall_are_quads(void **state)
{
	(void)state;
	test_cage t;
	for (uint32_t n = 2; n <= 9; n++) {
		cage_grid(&t, GI_REFINE_BILINEAR, n);
		assert_int_equal(count_polygon_clusters(&t), n * n - 1);
	}
	/* Of two materials: the whole is no quad, halves are. */
	cage_grid(&t, GI_REFINE_BILINEAR, 2);
	t.materials[0] = t.materials[1] = 1;
	assert_true(count_polygon_clusters(&t) < 3);
	/* Of a 3 x 4 wall the corner is missing; the quad of its outermost corners has the area of the rest, and not
	 * its shape. */
	cage_begin(&t, GI_REFINE_BILINEAR);
	for (uint32_t y = 0; y <= 4; y++)
		for (uint32_t x = 0; x <= 3; x++)
			cage_vertex(&t, (float)x, (float)y, 0.0f);
	for (uint32_t y = 0; y < 4; y++)
		for (uint32_t x = 0; x < 3; x++)
			if (x < 2 || y < 2)
				cage_face(&t, 4, (uint32_t[]){4 * y + x, 4 * y + x + 1, 4 * y + x + 5, 4 * y + x + 4});
	memset(t.materials, 0, sizeof t.materials);
	gi_hierarchy h;
	build_cage(&t, 0, &h);
	check_valid(&h);
	assert_int_equal(h.topology[0].range.w & GI_NODE_POLYGON, 0);
	gi_hierarchy_free(&h);
}

/* Whichever corner comes first, and cut finer too: quads or a middle would cover the notch. */
static void an_arrowhead_keeps_its_area(void **state)
{
	(void)state;
	const float points[4][2] = {{0.5f, 0.5f}, {0.0f, 3.0f}, {0.0f, 0.0f}, {3.0f, 0.0f}}; /* reflex at the first */
	for (uint32_t turn = 0; turn < 8; turn++) {
		test_cage t;
		gi_hierarchy h;
		cage_begin(&t, GI_REFINE_BILINEAR);
		for (uint32_t i = 0; i < 4; i++)
			cage_vertex(&t, points[(i + turn) % 4][0], points[(i + turn) % 4][1], 0.0f);
		cage_face(&t, 4, (uint32_t[]){0, 1, 2, 3});
		build_cage(&t, turn / 4, &h);
		check_valid(&h);
		double area = h.area;
		printf("arrowhead of 1.5 m2 from corner %u at level %u: %.7f m2\n", turn % 4, turn / 4, area);
		assert_true(fabs(area - 1.5) < 1e-6);
		gi_hierarchy_free(&h);
	}
}

/* A polygon of 8 corners: 3 x 3 less the notch of 1 x 2. */
static void a_concave_polygon_keeps_its_area(void **state)
{
	(void)state;
	const float points[8][2] = {{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
	for (uint32_t turn = 0; turn < 16; turn++) {
		test_cage t;
		gi_hierarchy h;
		cage_begin(&t, GI_REFINE_BILINEAR);
		for (uint32_t i = 0; i < 8; i++)
			cage_vertex(&t, points[(i + turn) % 8][0], 0.6f * points[(i + turn) % 8][1],
				    0.8f * points[(i + turn) % 8][1]);
		cage_face(&t, 8, (uint32_t[]){0, 1, 2, 3, 4, 5, 6, 7});
		build_cage(&t, turn / 8, &h);
		double area = h.area;
		printf("U of 7 m2 from corner %u at level %u: %.7f m2\n", turn % 8, turn / 8, area);
		assert_true(fabs(area - 7) < 1e-5);
		gi_hierarchy_free(&h);
	}
}

/* A bow-tie encloses nothing that could be meant. */
static void a_face_that_crosses_itself_is_refused(void **state)
{
	(void)state;
	const float points[5][2] = {{0, 0}, {2, 2}, {2, 0}, {0, 1.5f}, {-1, 1}};
	test_cage t;
	gi_refined r;
	char message[256];
	cage_begin(&t, GI_REFINE_BILINEAR);
	for (uint32_t i = 0; i < 5; i++)
		cage_vertex(&t, points[i][0], points[i][1], 0);
	cage_face(&t, 5, (uint32_t[]){0, 1, 2, 3, 4});
	assert_false(gi_refine(&t.cage, 0, &r, message, sizeof message));
	assert_non_null(strstr(message, "crosses itself"));
}

static void n_gons_have_children_and_no_corners(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy h;
	cage_prism(&t, GI_REFINE_BILINEAR);
	build_cage(&t, 0, &h);
	check_valid(&h);
	assert_int_equal(h.leaf_count, 5 + 5 + 4 * 4 + 3 + 3);
	/* Leaves, the four quads and two triangles above theirs; not the two pentagons. */
	assert_int_equal(count_flag(&h, GI_NODE_POLYGON), h.leaf_count + 6);
	uint32_t fives = 0;
	for (uint32_t node = 0; node < h.node_count; node++)
		fives += h.topology[node].range.z == 5 && h.topology[node].range.x == node + 6;
	assert_int_equal(fives, 2);
	for (uint32_t leaf = 0; leaf < h.leaf_count; leaf++)
		assert_true(h.leaf_material[leaf] < t.cage.face_count);
	gi_hierarchy_free(&h);
}

static void faces_without_area_are_dropped(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy h;
	cage_grid(&t, GI_REFINE_BILINEAR, 2);
	cage_vertex(&t, 3.0f, 0.0f, 0.0f);
	cage_face(&t, 3, (uint32_t[]){1, 2, 9}); /* on one line */
	build_cage(&t, 0, &h);
	check_valid(&h);
	assert_int_equal(h.leaf_count, 4);
	for (uint32_t leaf = 0; leaf < 4; leaf++)
		assert_true(h.leaf_face[leaf] < 4);
	gi_hierarchy_free(&h);
	build_cage(&t, 1, &h);
	check_valid(&h);
	assert_int_equal(h.leaf_count, 16);
	gi_hierarchy_free(&h);
}

static void nothing_left_is_an_error(void **state)
{
	(void)state;
	test_cage t;
	gi_refined r;
	gi_hierarchy h;
	char message[128] = "";
	cage_begin(&t, GI_REFINE_BILINEAR);
	for (int i = 0; i < 3; i++)
		cage_vertex(&t, (float)i, (float)i, 2.0f);
	cage_face(&t, 3, (uint32_t[]){0, 1, 2});
	refine_cage(&t, 1, &r);
	assert_false(gi_hierarchy_build(&r, &h, message, sizeof message));
	assert_non_null(strstr(message, "area"));
	assert_null(h.vertices);
	assert_int_equal(h.node_count, 0);
	assert_false(gi_hierarchy_build(&r, &h, NULL, 0));
	gi_refined_free(&r);
}

static void one_quad_is_root_and_leaf(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy h;
	cage_grid(&t, GI_REFINE_BILINEAR, 1);
	build_cage(&t, 0, &h);
	check_valid(&h);
	assert_int_equal(h.node_count, 1);
	assert_int_equal(h.topology[0].range.w, GI_NODE_LEAF | GI_NODE_POLYGON | GI_NODE_FLAT | GI_NODE_BACK);
	gi_hierarchy_free(&h);
}

static void the_same_cage_gives_the_same_bytes(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy a, b;
	cage_prism(&t, GI_REFINE_CATMULL_CLARK);
	build_cage(&t, 3, &a);
	build_cage(&t, 3, &b);
	assert_int_equal(a.node_count, b.node_count);
	assert_memory_equal(a.geometry, b.geometry, a.node_count * sizeof *a.geometry);
	assert_memory_equal(a.topology, b.topology, a.node_count * sizeof *a.topology);
	assert_memory_equal(a.leaf_face, b.leaf_face, a.leaf_count * sizeof *a.leaf_face);
	gi_hierarchy_free(&a);
	gi_hierarchy_free(&b);
}

/* ---- the validator ---- */

typedef void breaker(gi_hierarchy *h);

static void break_area(gi_hierarchy *h)
{
	h->geometry[3].moment.w *= 1.001f;
}
static void break_area_nan(gi_hierarchy *h)
{
	h->geometry[0].moment.w = NAN;
}
static void break_moment(gi_hierarchy *h)
{
	h->geometry[2].moment.x += 0.01f;
}
static void break_sphere(gi_hierarchy *h)
{
	h->geometry[h->leaf_node[5]].sphere.w *= 0.99f;
}
static void break_cone(gi_hierarchy *h)
{
	h->geometry[1].axis.w = 0.999f;
}
static void break_axis(gi_hierarchy *h)
{
	h->geometry[h->leaf_node[0]].axis.x += 0.1f;
}
static void break_skip(gi_hierarchy *h)
{
	h->topology[2].range.x = 2;
}
static void break_skip_far(gi_hierarchy *h)
{
	h->topology[2].range.x++;
}
static void break_range(gi_hierarchy *h)
{
	h->topology[1].range.z--;
}
static void break_leaf_range(gi_hierarchy *h)
{
	h->topology[1].range.y = h->leaf_count;
}
static void break_leaf_flag(gi_hierarchy *h)
{
	h->topology[h->leaf_node[3]].range.w &= ~GI_NODE_LEAF;
}
static void break_leaf_node(gi_hierarchy *h)
{
	h->leaf_node[3] = h->leaf_node[4];
}
static void break_leaf_node_far(gi_hierarchy *h)
{
	h->leaf_node[3] = h->node_count;
}
static void break_corner(gi_hierarchy *h)
{
	h->topology[h->leaf_node[3]].corners.y = h->vertex_count;
}
static void break_cluster_corner(gi_hierarchy *h)
{
	h->topology[0].corners.x = 0;
}
static void break_polygon_flag(gi_hierarchy *h)
{
	h->topology[h->leaf_node[3]].range.w &= ~GI_NODE_POLYGON;
}
static void break_flat(gi_hierarchy *h)
{
	for (uint32_t node = 0; node < h->node_count; node++)
		if (h->topology[node].range.w & GI_NODE_POLYGON)
			h->topology[node].range.w |= GI_NODE_FLAT;
}
static void break_root(gi_hierarchy *h)
{
	h->topology[0].range.x--;
}

static void the_validator_catches_broken_trees(void **state)
{
	(void)state;
	static breaker *const breakers[] = {
	    break_area,         break_area_nan,  break_moment,        break_sphere, break_cone,
	    break_axis,         break_skip,      break_skip_far,      break_range,  break_leaf_range,
	    break_leaf_flag,    break_leaf_node, break_leaf_node_far, break_corner, break_cluster_corner,
	    break_polygon_flag, break_flat,      break_root,
	};
	test_cage t;
	cage_cube(&t, GI_REFINE_CATMULL_CLARK);
	for (size_t i = 0; i < sizeof breakers / sizeof breakers[0]; i++) {
		gi_hierarchy h;
		build_cage(&t, 2, &h);
		check_valid(&h);
		breakers[i](&h);
		if (!gi_validate_hierarchy(&h))
			fail_msg("breaker %zu went unnoticed", i);
		gi_hierarchy_free(&h);
	}
	const gi_hierarchy empty = {0};
	assert_non_null(gi_validate_hierarchy(&empty));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(all_kinds_of_cages_are_valid),
	    cmocka_unit_test(leaves_far_from_the_origin_are_valid),
	    cmocka_unit_test(extremes_are_those_of_all_leaves),
	    cmocka_unit_test(a_quad_has_the_area_of_its_triangles),
	    cmocka_unit_test(a_bilinear_cube_is_measured_exactly),
	    cmocka_unit_test(flat_nodes_have_one_normal_however_they_lie),
	    cmocka_unit_test(clusters_keep_the_sides_of_a_cube_together),
	    cmocka_unit_test(open_surfaces_show_their_backs),
	    cmocka_unit_test(a_plane_of_any_scheme_is_flat_inside),
	    cmocka_unit_test(bent_quads_are_not_flat),
	    cmocka_unit_test(clusters_of_a_wall_are_quads),
	    cmocka_unit_test(an_arrowhead_keeps_its_area),
	    cmocka_unit_test(a_concave_polygon_keeps_its_area),
	    cmocka_unit_test(a_face_that_crosses_itself_is_refused),
	    cmocka_unit_test(n_gons_have_children_and_no_corners),
	    cmocka_unit_test(faces_without_area_are_dropped),
	    cmocka_unit_test(nothing_left_is_an_error),
	    cmocka_unit_test(one_quad_is_root_and_leaf),
	    cmocka_unit_test(the_same_cage_gives_the_same_bytes),
	    cmocka_unit_test(the_validator_catches_broken_trees),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
