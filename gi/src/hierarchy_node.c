/* What a node knows of the leaves below it: area, mean normal, ball, cone, thickness, spread, the quad that it is.
 * Taken over those leaves in double, and stored as float. */
#include "hierarchy_node.h"

#include "hierarchy_quad.h"
#include "quad_cover.h"

#include <math.h>

/* A cluster's quad, in units of its radius: what rays forgive at edges and planes (rays.glsl). And its area, next to
 * its leaves': positions rounded to float cancel in a tiling, but for its outline. */
#define COVER_TOLERANCE 1e-6
#define TILED_TOLERANCE 3e-7
/* Normals of what is flat. */
#define FLAT_COSINE (1 - 1e-6f)
/* Below this part of its area the moment is rounding noise: a closed surface has no mean normal. */
#define NO_AXIS 1e-6

gi_vec3d gi_node_normal(const gi_hierarchy *h, uint32_t node)
{
	return gi_vec3d_from(h->geometry[node].axis);
}

/* ---- sums over leaves ---- */

static void add_outer(double t[6], gi_vec3d n, double area)
{
	if (area <= 0.0)
		return;
	const double outer[6] = {n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.y * n.z, n.z * n.x};
	for (int k = 0; k < 6; k++)
		t[k] += outer[k] / area;
}

static double lower_of(double a, double b)
{
	return b < a ? b : a;
}

static double higher_of(double a, double b)
{
	return b > a ? b : a;
}

static void widen(gi_node_sums *s, gi_vec3d lower, gi_vec3d upper)
{
	s->lower =
	    (gi_vec3d){lower_of(s->lower.x, lower.x), lower_of(s->lower.y, lower.y), lower_of(s->lower.z, lower.z)};
	s->upper =
	    (gi_vec3d){higher_of(s->upper.x, upper.x), higher_of(s->upper.y, upper.y), higher_of(s->upper.z, upper.z)};
}

gi_node_sums gi_node_no_sums(void)
{
	return (gi_node_sums){.lower = {INFINITY, INFINITY, INFINITY}, .upper = {-INFINITY, -INFINITY, -INFINITY}};
}

void gi_node_add_quad(gi_node_sums *s, const quad *q)
{
	const gi_vec3d abc = gi_vec3d_triangle(q->a, q->b, q->c), acd = gi_vec3d_triangle(q->a, q->c, q->d);
	const double area_abc = gi_vec3d_length(abc), area_acd = gi_vec3d_length(acd);
	s->moment = gi_vec3d_add(s->moment, gi_vec3d_add(abc, acd));
	s->area += area_abc + area_acd;
	add_outer(s->outer, abc, area_abc);
	add_outer(s->outer, acd, area_acd);
	const gi_vec3d corners[4] = {q->a, q->b, q->c, q->d};
	for (int i = 0; i < 4; i++)
		widen(s, corners[i], corners[i]);
}

void gi_node_add_sums(gi_node_sums *to, const gi_node_sums *s)
{
	to->moment = gi_vec3d_add(to->moment, s->moment);
	to->area += s->area;
	for (int k = 0; k < 6; k++)
		to->outer[k] += s->outer[k];
	widen(to, s->lower, s->upper);
}

/* Leaf after leaf. */
static gi_node_sums sum_leaves(const gi_hierarchy *h, uint32_t node)
{
	const gi_uvec4 range = h->topology[node].range;
	gi_node_sums sums = gi_node_no_sums();
	for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
		const quad q = node_quad(h, h->leaf_node[leaf]);
		gi_node_add_quad(&sums, &q);
	}
	return sums;
}

/* ---- single measures ----
 *
 * Extremes over leaves leave out what lies below a node that cannot hold one, by the ball and the cone that it has from
 * before: the same bits, for a patch of n leaves some of those at its rim instead of all. */

/* A share of a length and a part of a cosine that cover rounding of such bounds. */
#define LENGTH_SLACK 1e-7
#define COSINE_SLACK 1e-5

static void set_moment(gi_hierarchy *h, uint32_t node, const gi_node_sums *sums)
{
	const gi_vec3d moment = sums->moment;
	const double area = sums->area;
	h->geometry[node].moment = (gi_vec4){(float)moment.x, (float)moment.y, (float)moment.z, (float)area};
	const double length = gi_vec3d_length(moment);
	const gi_vec3d axis =
	    length > NO_AXIS * area ? gi_vec3d_scale(moment, 1.0 / length) : (gi_vec3d){0.0, 0.0, 1.0};
	h->geometry[node].axis =
	    (gi_vec4){(float)axis.x, (float)axis.y, (float)axis.z, length > NO_AXIS * area ? 1 : -1};
}

/* Cosine between the axis and a triangle's normal; 1 for a triangle without one. */
static double normal_cosine(gi_vec3d axis, gi_vec3d triangle_moment, double area, double least_area)
{
	return area > least_area ? gi_vec3d_dot(axis, triangle_moment) / area : 1.0;
}

/* At least the sine of an angle whose cosine was rounded to float: of small ones all of it may be rounding. */
static double sine_of_rounded(double cosine)
{
	return sqrt(higher_of(0.0, 1.0 - cosine * cosine) + 4e-7);
}

/* No more than the least cosine below a node that is measured already, by its cone. */
static double least_below(const gi_hierarchy *h, uint32_t node, gi_vec3d axis)
{
	const double cone = (double)h->geometry[node].axis.w;
	const double between = gi_vec3d_dot(axis, gi_node_normal(h, node));
	return between <= -cone ? -1.0 : between * cone - sine_of_rounded(between) * sine_of_rounded(cone);
}

/* The least cosine between an axis and the normals of the triangles of a node's leaves. A triangle of 1e-9 of its quad
 * is a quad that is a triangle: its normal is noise. */
double gi_node_least_cosine(const gi_hierarchy *h, uint32_t node, gi_vec3d axis)
{
	const uint32_t end = h->topology[node].range.x;
	double least = INFINITY; /* the axis as stored may be longer than 1 by its rounding */
	for (uint32_t n = node; n < end;) {
		const gi_uvec4 range = h->topology[n].range;
		if (n != node && least_below(h, n, axis) > least + COSINE_SLACK) {
			n = range.x;
			continue;
		}
		n++;
		if (!(range.w & GI_NODE_LEAF))
			continue;
		const quad q = node_quad(h, n - 1);
		const gi_vec3d abc = gi_vec3d_triangle(q.a, q.b, q.c), acd = gi_vec3d_triangle(q.a, q.c, q.d);
		const double area_abc = gi_vec3d_length(abc), area_acd = gi_vec3d_length(acd);
		const double noise = 1e-9 * (area_abc + area_acd);
		least = lower_of(least, normal_cosine(axis, abc, area_abc, noise));
		least = lower_of(least, normal_cosine(axis, acd, area_acd, noise));
	}
	return least;
}

/* The cone about the axis as stored. A cosine within 1e-9 of the float is as good as it: 1 stays 1 for flat nodes. */
static void set_cone(gi_hierarchy *h, uint32_t node)
{
	gi_vec4 *axis = &h->geometry[node].axis;
	if (axis->w < 0.0f)
		return;
	const gi_vec3d stored = gi_vec3d_rounded(gi_node_normal(h, node));
	const double cosine = fmax(-1.0, gi_node_least_cosine(h, node, stored) / gi_vec3d_length(stored));
	axis->w = (float)cosine;
	if (axis->w > cosine + 1e-9)
		axis->w = nextafterf(axis->w, -2.0f);
}

/* At least the squared distance of any corner below a node that is measured already, by its ball. */
static double reach2_below(const gi_hierarchy *h, uint32_t node, gi_vec3d from)
{
	const gi_vec4 sphere = h->geometry[node].sphere;
	const double reach = gi_vec3d_length(gi_vec3d_sub(gi_vec3d_from(sphere), from)) + (double)sphere.w;
	return reach * reach * (1 + LENGTH_SLACK);
}

/* The corner of a node's leaves farthest from a point; of those as far within rounding of the positions the first, so
 * that a symmetric cage has the same spheres at every scale. */
gi_vec3d gi_node_farthest_corner(const gi_hierarchy *h, uint32_t node, gi_vec3d from, double *distance)
{
	const uint32_t end = h->topology[node].range.x;
	gi_vec3d farthest = from;
	double most = 0.0, chosen = 0.0;
	for (uint32_t n = node; n < end;) {
		const gi_uvec4 range = h->topology[n].range;
		if (n != node && reach2_below(h, n, from) <= chosen) {
			n = range.x;
			continue;
		}
		n++;
		if (!(range.w & GI_NODE_LEAF))
			continue;
		const quad q = node_quad(h, n - 1);
		const gi_vec3d corners[4] = {q.a, q.b, q.c, q.d};
		for (int i = 0; i < 4; i++) {
			const gi_vec3d to = gi_vec3d_sub(corners[i], from);
			const double distance2 = gi_vec3d_dot(to, to);
			most = higher_of(most, distance2);
			if (distance2 > chosen * (1 + GI_TIE)) {
				chosen = distance2;
				farthest = corners[i];
			}
		}
	}
	*distance = sqrt(most);
	return farthest;
}

static void store_sphere(gi_hierarchy *h, uint32_t node, gi_vec3d centre)
{
	gi_vec4 *sphere = &h->geometry[node].sphere;
	double radius;
	gi_node_farthest_corner(h, node, gi_vec3d_rounded(centre), &radius);
	*sphere = (gi_vec4){(float)centre.x, (float)centre.y, (float)centre.z, (float)radius};
	if (sphere->w < radius)
		sphere->w = nextafterf(sphere->w, INFINITY);
}

/* Badoiu and Clarkson's iteration, "Smaller core-sets for balls" (2003): step ever shorter towards the farthest point;
 * the best centre seen is kept. From the centre of the bounds a few steps take most of what there is to gain. */
static void set_sphere(gi_hierarchy *h, uint32_t node, const gi_node_sums *sums)
{
	enum { STEPS = 4 };
	gi_vec3d centre = gi_vec3d_scale(gi_vec3d_add(sums->lower, sums->upper), 0.5), best = centre;
	double best_radius = INFINITY;
	for (int step = 0; step <= STEPS; step++) {
		double radius;
		const gi_vec3d far = gi_node_farthest_corner(h, node, centre, &radius);
		if (radius < best_radius * (1 - GI_TIE)) {
			best_radius = radius;
			best = centre;
		}
		centre = gi_vec3d_add(centre, gi_vec3d_scale(gi_vec3d_sub(far, centre), 1.0 / (step + 8)));
	}
	store_sphere(h, node, best);
}

/* At least the height over a plane of any corner below a node that is measured already, by its ball. The normal is as
 * long as its rounding leaves it, and heights are off by their lengths' rounding. */
static double height_below(const gi_hierarchy *h, uint32_t node, gi_vec3d normal, gi_vec3d point)
{
	const gi_vec4 sphere = h->geometry[node].sphere;
	const gi_vec3d to = gi_vec3d_sub(gi_vec3d_from(sphere), point);
	const double length = gi_vec3d_length(to);
	return fabs(gi_vec3d_dot(normal, to)) + (double)sphere.w * (1 + 1e-6) + LENGTH_SLACK * length;
}

/* How far the corners of a node's leaves are from the plane through its sphere's centre, over its radius. */
double gi_node_thickness(const gi_hierarchy *h, uint32_t node)
{
	const uint32_t end = h->topology[node].range.x;
	const gi_vec4 sphere = h->geometry[node].sphere;
	const gi_vec3d centre = gi_vec3d_from(sphere), normal = gi_node_normal(h, node);
	double most = 0.0;
	for (uint32_t n = node; n < end;) {
		const gi_uvec4 range = h->topology[n].range;
		if (n != node && height_below(h, n, normal, centre) <= most) {
			n = range.x;
			continue;
		}
		n++;
		if (!(range.w & GI_NODE_LEAF))
			continue;
		const quad q = node_quad(h, n - 1);
		const gi_vec3d corners[4] = {q.a, q.b, q.c, q.d};
		for (int i = 0; i < 4; i++)
			most = higher_of(most, fabs(gi_vec3d_dot(normal, gi_vec3d_sub(corners[i], centre))));
	}
	return fmin(most / sphere.w, 1.0);
}

/* What is flat but for rounding is flat: or patches of one plane would see each other. */
static void set_thickness(gi_hierarchy *h, uint32_t node)
{
	const double thickness = gi_node_thickness(h, node);
	if (thickness > GI_FLAT_TOLERANCE)
		h->topology[node].range.w |= (uint32_t)ceil(thickness * GI_NODE_THICKNESS_STEPS)
					     << GI_NODE_THICKNESS_SHIFT;
}

/* Are all corners of the node's leaves within the tolerance, metres, of the plane through a point? */
static bool is_coplanar(const gi_hierarchy *h, uint32_t node, gi_vec3d point, gi_vec3d normal, double tolerance)
{
	const gi_uvec4 range = h->topology[node].range;
	for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
		const quad q = node_quad(h, h->leaf_node[leaf]);
		const gi_vec3d corners[4] = {q.a, q.b, q.c, q.d};
		for (int i = 0; i < 4; i++)
			if (fabs(gi_vec3d_dot(normal, gi_vec3d_sub(corners[i], point))) > tolerance)
				return false;
	}
	return true;
}

static bool nearly(double a, double b)
{
	return fabs(a - b) <= GI_FLAT_TOLERANCE * fmax(fabs(a), fabs(b));
}

/* Do the node's two triangles cover exactly its leaves? In one plane, with the same area, and nothing folded over
 * (folds make the area larger than the length of the moment). */
bool gi_node_is_flat(const gi_hierarchy *h, uint32_t node)
{
	const gi_vec4 moment = h->geometry[node].moment;
	const quad q = node_quad(h, node);
	const double length = gi_vec3d_length(gi_vec3d_from(moment));
	return nearly(length, moment.w) && nearly(quad_area(&q), moment.w) &&
	       nearly(gi_vec3d_dot(quad_moment(&q), gi_node_normal(h, node)), moment.w) &&
	       is_coplanar(h, node, q.a, gi_node_normal(h, node), GI_FLAT_TOLERANCE * h->geometry[node].sphere.w);
}

/* T, and the shape factor between the two cases that are exact: |T| / area is 1 for flat nodes, 1 / sqrt 3 for normals
 * all round. */
static void set_spread(gi_hierarchy *h, uint32_t node, const gi_node_sums *sums)
{
	const double *t = sums->outer;
	const double norm =
	    sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2] + 2 * (t[3] * t[3] + t[4] * t[4] + t[5] * t[5]));
	const double least = 1 / sqrt(3.0), flatness = (norm / h->geometry[node].moment.w - least) / (1 - least);
	const double shape = 0.8660254 + (1 - 0.8660254) * fmin(fmax(flatness, 0.0), 1.0);
	h->spread[node].diagonal = (gi_vec4){(float)t[0], (float)t[1], (float)t[2], 0};
	h->spread[node].mixed = (gi_vec4){(float)t[3], (float)t[4], (float)t[5], (float)shape};
}

static bool is_of_one_material(const gi_hierarchy *h, uint32_t node)
{
	const gi_uvec4 range = h->topology[node].range;
	for (uint32_t leaf = range.y + 1; leaf < range.y + range.z; leaf++)
		if (h->leaf_material[leaf] != h->leaf_material[range.y])
			return false;
	return true;
}

/* Does the node's quad have the area of its leaves, to the last hole? */
static bool is_tiled(const gi_hierarchy *h, uint32_t node)
{
	const gi_uvec4 range = h->topology[node].range;
	const quad whole = node_quad(h, node);
	double area = 0;
	for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
		const quad q = node_quad(h, h->leaf_node[leaf]);
		area += quad_area(&q);
	}
	return fabs(quad_area(&whole) - area) <= TILED_TOLERANCE * area;
}

/* A cluster whose leaves tile a quad is as good as a face, for as long as they do. */
static void set_cover(gi_hierarchy *h, uint32_t node)
{
	gi_node_topology *t = &h->topology[node];
	uint32_t corners[4];
	const double tolerance = COVER_TOLERANCE * h->geometry[node].sphere.w;
	if (h->deforms || h->geometry[node].axis.w < FLAT_COSINE || !is_of_one_material(h, node) ||
	    !gi_quad_cover(h, t->range.y, t->range.z, gi_node_normal(h, node), tolerance, corners))
		return;
	t->corners = (gi_uvec4){corners[0], corners[1], corners[2], corners[3]};
	const quad q = node_quad(h, node);
	if (is_tiled(h, node) && is_coplanar(h, node, q.a, gi_node_normal(h, node), tolerance))
		t->range.w |= GI_NODE_POLYGON | GI_NODE_FLAT;
	else
		t->corners = (gi_uvec4){GI_NONE, GI_NONE, GI_NONE, GI_NONE};
}

void gi_node_measure_by(gi_hierarchy *h, uint32_t node, const gi_node_sums *sums)
{
	set_moment(h, node, sums);
	set_spread(h, node, sums);
	set_cone(h, node);
	set_sphere(h, node, sums);
	set_thickness(h, node);
	gi_uvec4 *range = &h->topology[node].range;
	if (!(range->w & GI_NODE_POLYGON))
		set_cover(h, node);
	else if (gi_node_is_flat(h, node))
		range->w |= GI_NODE_FLAT;
}

void gi_node_measure(gi_hierarchy *h, uint32_t node)
{
	const gi_node_sums sums = sum_leaves(h, node);
	gi_node_measure_by(h, node, &sums);
}
