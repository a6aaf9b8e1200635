/* Checks a hierarchy: one function a rule, in the order in which later ones rely on earlier ones. */
#include "hierarchy_node.h"
#include "hierarchy_quad.h"

#include <math.h>

static const char *check_range(const gi_hierarchy *h, uint32_t node)
{
	const gi_uvec4 range = h->topology[node].range;
	if (range.x <= node || range.x > h->node_count)
		return "the skip of a node points backwards or beyond the last node";
	if (range.z == 0 || range.y >= h->leaf_count || range.z > h->leaf_count - range.y)
		return "a node covers no leaves, or leaves that do not exist";
	const bool leaf = range.w & GI_NODE_LEAF;
	if (leaf != (range.x == node + 1))
		return "a leaf has children, or an inner node has none";
	if (leaf && (range.z != 1 || h->leaf_node[range.y] != node))
		return "a leaf's node and the node's leaf disagree";
	return NULL;
}

static const char *check_children(const gi_hierarchy *h, uint32_t node)
{
	const gi_uvec4 range = h->topology[node].range;
	if (range.w & GI_NODE_LEAF)
		return NULL;
	uint32_t leaf = range.y;
	for (uint32_t child = node + 1; child < range.x; child = h->topology[child].range.x) {
		const gi_uvec4 inner = h->topology[child].range;
		if (inner.x > range.x || inner.y != leaf)
			return "the ranges of a node's children do not follow one another inside its own";
		leaf += inner.z;
	}
	return leaf == range.y + range.z ? NULL : "the leaves of a node's children are not all of its own";
}

static const char *check_corners(const gi_hierarchy *h, uint32_t node)
{
	const gi_uvec4 corners = h->topology[node].corners;
	const uint32_t flags = h->topology[node].range.w, n = h->vertex_count;
	if (!(flags & GI_NODE_POLYGON)) {
		if (flags & (GI_NODE_LEAF | GI_NODE_FLAT))
			return "a leaf or a flat node has no corners";
		const bool none = (corners.x & corners.y & corners.z & corners.w) == GI_NONE;
		return none ? NULL : "a node without the polygon flag has corners";
	}
	return corners.x < n && corners.y < n && corners.z < n && corners.w < n ? NULL : "a corner is not a vertex";
}

static bool is_near(double a, double b, double tolerance)
{
	return fabs(a - b) <= tolerance; /* false for NaN */
}

static const char *check_sums(const gi_hierarchy *h, uint32_t node)
{
	const gi_vec4 moment = h->geometry[node].moment;
	double area = 0.0;
	gi_vec3d sum = {0};
	if (h->topology[node].range.w & GI_NODE_LEAF) {
		const quad q = node_quad(h, node);
		area = quad_area(&q);
		sum = quad_moment(&q);
	}
	for (uint32_t child = node + 1; child < h->topology[node].range.x; child = h->topology[child].range.x) {
		area += h->geometry[child].moment.w;
		sum = gi_vec3d_add(sum, gi_vec3d_from(h->geometry[child].moment));
	}
	if (!(area > 0.0) || !is_near(moment.w, area, 1e-5 * area))
		return "the areas of a node's children do not add up to its own";
	if (gi_vec3d_length(gi_vec3d_sub(gi_vec3d_from(moment), sum)) > 1e-5 * area)
		return "the moments of a node's children do not add up to its own";
	return NULL;
}

static const char *check_cone(const gi_hierarchy *h, uint32_t node)
{
	const gi_vec4 axis = h->geometry[node].axis;
	if (!is_near(gi_vec3d_length(gi_node_normal(h, node)), 1.0, 1e-5) || !(axis.w >= -1.0f && axis.w <= 1.0f))
		return "a node's axis is not of length one, or its cone not a cosine";
	/* 1e-6: the axis is rounded to float. */
	return axis.w <= gi_node_least_cosine(h, node, gi_node_normal(h, node)) + 1e-6 || axis.w == -1.0f
		   ? NULL
		   : "a normal lies outside its node's cone";
}

static const char *check_sphere(const gi_hierarchy *h, uint32_t node)
{
	const gi_vec4 sphere = h->geometry[node].sphere;
	double radius;
	gi_node_farthest_corner(h, node, gi_vec3d_from(sphere), &radius);
	return radius <= sphere.w * (1.0 + 1e-6) ? NULL : "a corner lies outside its node's sphere";
}

static const char *check_thickness(const gi_hierarchy *h, uint32_t node)
{
	const double stored = (double)(h->topology[node].range.w >> GI_NODE_THICKNESS_SHIFT) / GI_NODE_THICKNESS_STEPS;
	return gi_node_thickness(h, node) <= stored + GI_FLAT_TOLERANCE ? NULL
									: "a corner lies outside its node's thickness";
}

static const char *check_flat(const gi_hierarchy *h, uint32_t node)
{
	const bool flat = h->topology[node].range.w & GI_NODE_FLAT;
	return !flat || gi_node_is_flat(h, node) ? NULL : "a flat node is not the surface of its leaves";
}

const char *gi_validate_hierarchy(const gi_hierarchy *h)
{
	static const char *(*const rules[])(const gi_hierarchy *, uint32_t) = {
	    check_range, check_corners, check_children,  check_sums,
	    check_cone,  check_sphere,  check_thickness, check_flat,
	};
	if (h->node_count == 0 || h->leaf_count == 0)
		return "there are no nodes";
	if (h->topology[0].range.x != h->node_count || h->topology[0].range.y != 0 ||
	    h->topology[0].range.z != h->leaf_count)
		return "the root does not cover everything";
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++)
		if (h->leaf_node[leaf] >= h->node_count)
			return "the node of a leaf does not exist";
	for (size_t rule = 0; rule < sizeof rules / sizeof rules[0]; rule++)
		for (uint32_t node = 0; node < h->node_count; node++) {
			const char *broken = rules[rule](h, node);
			if (broken)
				return broken;
		}
	return NULL;
}
