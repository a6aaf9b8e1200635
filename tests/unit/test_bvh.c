/* The hierarchy of boxes against brute force: every ray finds the same nearest distance, and what is merged stands for
 * all. */
#include "cages.h"

#include "bits.h"
#include "bvh.h"

#include <stdlib.h>

typedef struct ray {
	float origin[3], direction[3];
} ray;

static uint32_t random_bits(uint32_t *seed)
{
	*seed = *seed * 747796405u + 2891336453u;
	const uint32_t word = ((*seed >> ((*seed >> 28) + 4)) ^ *seed) * 277803737u;
	return (word >> 22) ^ word;
}

static float random_float(uint32_t *seed, float low, float high)
{
	return low + (high - low) * (float)(random_bits(seed) >> 8) / 16777216.0f;
}

/* Distance to a triangle, or INFINITY (Moeller and Trumbore 1997), in double. */
static double hit_triangle(const ray *r, gi_vec4 a, gi_vec4 b, gi_vec4 c)
{
	const double u[3] = {b.x - a.x, b.y - a.y, b.z - a.z}, v[3] = {c.x - a.x, c.y - a.y, c.z - a.z};
	const float *d = r->direction;
	const double p[3] = {d[1] * v[2] - d[2] * v[1], d[2] * v[0] - d[0] * v[2], d[0] * v[1] - d[1] * v[0]};
	const double det = u[0] * p[0] + u[1] * p[1] + u[2] * p[2];
	const double s[3] = {r->origin[0] - a.x, r->origin[1] - a.y, r->origin[2] - a.z};
	const double q[3] = {s[1] * u[2] - s[2] * u[1], s[2] * u[0] - s[0] * u[2], s[0] * u[1] - s[1] * u[0]};
	const double x = (s[0] * p[0] + s[1] * p[1] + s[2] * p[2]) / det;
	const double y = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / det;
	const double t = (v[0] * q[0] + v[1] * q[1] + v[2] * q[2]) / det;
	return x >= 0.0 && y >= 0.0 && x + y <= 1.0 && t > 0.0 ? t : INFINITY;
}

static double hit_primitive(const ray *r, const gi_primitive *p)
{
	return fmin(hit_triangle(r, p->a, p->b, p->c), hit_triangle(r, p->a, p->c, p->d));
}

/* The slab test as the shader does it, in float. */
static bool hit_box(const ray *r, const gi_bvh_node *node, float limit)
{
	const float lower[3] = {node->lower.x, node->lower.y, node->lower.z};
	const float upper[3] = {node->upper.x, node->upper.y, node->upper.z};
	float near = 0.0f, far = limit;
	for (int axis = 0; axis < 3; axis++) {
		const float inverse = 1.0f / r->direction[axis];
		const float t0 = (lower[axis] - r->origin[axis]) * inverse,
			    t1 = (upper[axis] - r->origin[axis]) * inverse;
		near = fmaxf(near, fminf(t0, t1));
		far = fminf(far, fmaxf(t0, t1));
	}
	return near <= far;
}

static double trace(const gi_bvh *bvh, const ray *r)
{
	double nearest = INFINITY;
	for (uint32_t node = 0; node < bvh->node_count;) {
		if (!hit_box(r, &bvh->nodes[node], INFINITY)) {
			node = gi_bits_from_float(bvh->nodes[node].lower.w);
			continue;
		}
		const uint32_t primitive = gi_bits_from_float(bvh->nodes[node].upper.w);
		if (primitive != GI_NONE)
			nearest = fmin(nearest, hit_primitive(r, &bvh->primitives[primitive]));
		node++;
	}
	return nearest;
}

static double trace_leaves(const gi_hierarchy *h, const ray *r)
{
	double nearest = INFINITY;
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++) {
		const gi_uvec4 c = h->topology[h->leaf_node[leaf]].corners;
		nearest = fmin(nearest, hit_triangle(r, h->vertices[c.x], h->vertices[c.y], h->vertices[c.z]));
		nearest = fmin(nearest, hit_triangle(r, h->vertices[c.x], h->vertices[c.z], h->vertices[c.w]));
	}
	return nearest;
}

/* Rays from a sphere about twice as large as the object, towards its middle. */
static ray random_ray(uint32_t *seed)
{
	ray r;
	for (int axis = 0; axis < 3; axis++) {
		r.origin[axis] = random_float(seed, -3.0f, 3.0f);
		r.direction[axis] = random_float(seed, -0.6f, 0.6f) - r.origin[axis];
	}
	return r;
}

static void rays_find_what_brute_force_finds(void **state)
{
	(void)state;
	test_cage t;
	uint32_t seed = 1;
	for (int shape = 0; shape < 4; shape++) {
		gi_hierarchy h;
		gi_bvh bvh;
		(shape == 0   ? cage_prism
		 : shape == 1 ? cage_octahedron
			      : cage_cube)(&t, shape == 3 ? GI_REFINE_BILINEAR : GI_REFINE_CATMULL_CLARK);
		build_cage(&t, 3, &h);
		assert_true(gi_bvh_build(&h, &bvh));
		uint32_t hits = 0;
		for (int i = 0; i < 3000; i++) {
			const ray r = random_ray(&seed);
			const double expected = trace_leaves(&h, &r), found = trace(&bvh, &r);
			hits += expected < INFINITY;
			/* A merged wall's planes are rounded apart from its leaves'. */
			if (found != expected)
				CHECK_NEAR(found, expected, 1e-5);
		}
		assert_true(hits > 1000);
		gi_bvh_free(&bvh);
		gi_hierarchy_free(&h);
	}
}

/* Rays at the very edges and corners of flat, axis-aligned boxes: what the padding is for. */
static void slabs_never_miss_points_on_the_surface(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy h;
	gi_bvh bvh;
	uint32_t seed = 7;
	cage_cube(&t, GI_REFINE_BILINEAR);
	t.cage.scale[0] = 0.3f;
	t.cage.scale[1] = 0.7f;
	build_cage(&t, 2, &h);
	assert_true(gi_bvh_build(&h, &bvh));
	for (uint32_t i = 0; i < 20000; i++) {
		const uint32_t primitive = i % bvh.primitive_count;
		const gi_primitive *p = &bvh.primitives[primitive];
		const float s = (float)(i % 3) * 0.5f,
			    to[3] = {p->a.x + s * (p->b.x - p->a.x), p->a.y + s * (p->b.y - p->a.y),
				     p->a.z + s * (p->b.z - p->a.z)};
		ray r;
		for (int axis = 0; axis < 3; axis++) {
			r.origin[axis] = random_float(&seed, -2.0f, 2.0f);
			r.direction[axis] = to[axis] - r.origin[axis];
		}
		bool reached = false;
		for (uint32_t node = 0; node < bvh.node_count;) {
			if (!hit_box(&r, &bvh.nodes[node], INFINITY)) {
				node = gi_bits_from_float(bvh.nodes[node].lower.w);
				continue;
			}
			reached = reached || gi_bits_from_float(bvh.nodes[node].upper.w) == primitive;
			node++;
		}
		assert_true(reached);
	}
	gi_bvh_free(&bvh);
	gi_hierarchy_free(&h);
}

static void check_nodes(const gi_bvh_node *nodes, uint32_t node_count, uint32_t leaf_count)
{
	uint32_t leaves = 0;
	for (uint32_t node = 0; node < node_count; node++) {
		const uint32_t skip = gi_bits_from_float(nodes[node].lower.w),
			       item = gi_bits_from_float(nodes[node].upper.w);
		assert_true(skip > node && skip <= node_count);
		assert_int_equal(item != GI_NONE, skip == node + 1);
		if (item != GI_NONE) {
			assert_int_equal(item, leaves++);
			continue;
		}
		const uint32_t second = gi_bits_from_float(nodes[node + 1].lower.w);
		assert_int_equal(gi_bits_from_float(nodes[second].lower.w), skip);
		const uint32_t children[2] = {node + 1, second};
		for (int i = 0; i < 2; i++) {
			const gi_vec4 l = nodes[children[i]].lower, u = nodes[children[i]].upper;
			assert_true(l.x >= nodes[node].lower.x && l.y >= nodes[node].lower.y &&
				    l.z >= nodes[node].lower.z);
			assert_true(u.x <= nodes[node].upper.x && u.y <= nodes[node].upper.y &&
				    u.z <= nodes[node].upper.z);
		}
	}
	assert_int_equal(leaves, leaf_count);
	if (node_count > 0)
		assert_int_equal(gi_bits_from_float(nodes[0].lower.w), node_count);
}

static void primitives_cover_every_leaf_once(void **state)
{
	(void)state;
	test_cage t;
	for (int shape = 0; shape < 3; shape++) {
		gi_hierarchy h;
		gi_bvh bvh;
		if (shape == 0)
			cage_prism(&t, GI_REFINE_BILINEAR);
		else if (shape == 1)
			cage_cube(&t, GI_REFINE_CATMULL_CLARK);
		else
			cage_grid(&t, GI_REFINE_BILINEAR, 5);
		build_cage(&t, 3, &h);
		assert_true(gi_bvh_build(&h, &bvh));
		assert_int_equal(bvh.node_count, 2 * bvh.primitive_count - 1);
		check_nodes(bvh.nodes, bvh.node_count, bvh.primitive_count);
		uint32_t *seen = calloc(h.leaf_count, sizeof *seen);
		double area = 0.0;
		for (uint32_t i = 0; i < bvh.primitive_count; i++) {
			const gi_primitive *p = &bvh.primitives[i];
			for (uint32_t leaf = gi_bits_from_float(p->a.w); leaf < gi_bits_from_float(p->b.w); leaf++)
				seen[leaf]++;
			const float corners[4][3] = {{p->a.x, p->a.y, p->a.z},
						     {p->b.x, p->b.y, p->b.z},
						     {p->c.x, p->c.y, p->c.z},
						     {p->d.x, p->d.y, p->d.z}};
			area += gi_quad_area(corners[0], corners[1], corners[2], corners[3]);
		}
		for (uint32_t leaf = 0; leaf < h.leaf_count; leaf++)
			assert_int_equal(seen[leaf], 1);
		CHECK_NEAR(area, h.area, 1e-5 * h.area); /* the tolerance of a flat node */
		free(seen);
		gi_bvh_free(&bvh);
		gi_hierarchy_free(&h);
	}
}

static void a_wall_is_one_primitive(void **state)
{
	(void)state;
	test_cage t;
	gi_hierarchy h;
	gi_bvh bvh;
	cage_cube(&t, GI_REFINE_BILINEAR);
	build_cage(&t, 4, &h);
	assert_true(gi_bvh_build(&h, &bvh));
	assert_int_equal(h.leaf_count, 6 * 256);
	assert_int_equal(bvh.primitive_count, 6);
	gi_bvh_free(&bvh);
	gi_bvh_free(&bvh);
	gi_bvh_free(NULL);
	gi_hierarchy_free(&h);
}

static void boxes_build_a_tree_of_their_own(void **state)
{
	(void)state;
	enum { COUNT = 300 };
	gi_box boxes[COUNT];
	gi_bvh_node nodes[2 * COUNT], again[2 * COUNT];
	uint32_t order[COUNT], order_again[COUNT], seed = 3;
	for (int i = 0; i < COUNT; i++) {
		const gi_vec4 at = {random_float(&seed, -5, 5), random_float(&seed, -1, 1), random_float(&seed, 0, 1),
				    0};
		const float size = random_float(&seed, 0.0f, 0.3f);
		boxes[i] = (gi_box){{at.x, at.y, at.z}, {at.x + size, at.y + size, at.z + size}};
	}
	for (uint32_t count = 0; count <= COUNT; count += count < 4 ? 1 : 37) {
		gi_bvh_build_boxes(boxes, count, nodes, order);
		check_nodes(nodes, count > 0 ? 2 * count - 1 : 0, count);
		for (uint32_t node = 0; node + 1 < 2 * count; node++) {
			const uint32_t item = gi_bits_from_float(nodes[node].upper.w);
			if (item == GI_NONE)
				continue;
			const gi_box *box = &boxes[order[item]];
			assert_true(nodes[node].lower.x <= box->lower[0] && nodes[node].upper.x >= box->upper[0]);
			assert_true(nodes[node].lower.z <= box->lower[2] && nodes[node].upper.z >= box->upper[2]);
		}
		gi_bvh_build_boxes(boxes, count, again, order_again);
		assert_memory_equal(order, order_again, count * sizeof *order);
		if (count > 0)
			assert_memory_equal(nodes, again, (2 * count - 1) * sizeof *nodes);
	}
}

static void equal_boxes_do_not_go_deep(void **state)
{
	(void)state;
	enum { COUNT = 4096 };
	static gi_box boxes[COUNT];
	static gi_bvh_node nodes[2 * COUNT];
	static uint32_t order[COUNT];
	for (int i = 0; i < COUNT; i++)
		boxes[i] = (gi_box){{1, 2, 3}, {2, 3, 4}};
	gi_bvh_build_boxes(boxes, COUNT, nodes, order);
	check_nodes(nodes, 2 * COUNT - 1, COUNT);
	/* Centres that double: the surface-area heuristic peels off one at a time, until the depth limit. */
	for (int i = 0; i < COUNT; i++) {
		const float x = ldexpf(1.0f, i % 100);
		boxes[i] = (gi_box){{x, 0, 0}, {x, 0, 0}};
	}
	gi_bvh_build_boxes(boxes, COUNT, nodes, order);
	check_nodes(nodes, 2 * COUNT - 1, COUNT);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(rays_find_what_brute_force_finds),
	    cmocka_unit_test(slabs_never_miss_points_on_the_surface),
	    cmocka_unit_test(primitives_cover_every_leaf_once),
	    cmocka_unit_test(a_wall_is_one_primitive),
	    cmocka_unit_test(boxes_build_a_tree_of_their_own),
	    cmocka_unit_test(equal_boxes_do_not_go_deep),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
