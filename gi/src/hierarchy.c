/* Builds and checks the patch hierarchy of one object (hierarchy.h draws it).
 *
 *   gi_refined --sum_*--> area, normal and centre of every face of every level, bottom-up
 *              --emit_*--> nodes and leaves, depth-first: clusters (the base faces, parted about the median), then
 * faces
 *
 * Sums and measures are taken over the leaves of a node, in double, and stored as float: rounding does not pile up with
 * the levels.
 */
#include "hierarchy.h"

#include "host_memory.h"
#include "quad_cover.h"
#include "split.h"
#include "vec3d.h"

#include <stdio.h>
#include <string.h>

/* A face below this part of its own squared diagonal is a line or a point: its normal would be rounding. Of
 * its own, for a small lamp on a large object is a face as others are. */
#define ZERO_AREA 1e-12
/* Flat: every corner this near the plane, in units of the node's radius, and the areas this near each other. Positions
 * are rounded to float (6e-8); what bends by less than 1e-5 changes no form factor that float arithmetic could show. */
#define FLAT_TOLERANCE 1e-5
/* A cluster's quad, in units of its radius: what rays forgive at edges and planes (rays.glsl). And its area, next to
 * its leaves': positions rounded to float cancel in a tiling, but for its outline. */
#define COVER_TOLERANCE 1e-6
#define TILED_TOLERANCE 3e-7
/* Normals of what is flat. */
#define FLAT_COSINE (1 - 1e-6f)
/* Below this part of its area the moment is rounding noise: a closed surface has no mean normal. */
#define NO_AXIS 1e-6
/* Normals count this much of a bounds diagonal when base faces are clustered: opposite walls of a box part before the
 * halves of one wall do. */
#define NORMAL_WEIGHT 0.5

/* Keys are rounded to this part of the diagonal: symmetric cages are full of ties, and rounding of the positions must
 * not decide them, or the same cage at another scale would be another tree. */
#define KEY_STEPS 1048576.0

#define MAX_LEVELS GI_SPLIT_MAX_LEVELS

/* Sums over the leaves below a face. */
typedef struct face_sum {
	double area;
	gi_vec3d moment;
	gi_vec3d centre; /* area * centroid */
	uint32_t leaf_count;
} face_sum;

/* The faces of level + 1, grouped by parent: those of face f are children[first[f]] up to children[first[f + 1]]. */
typedef struct child_list {
	uint32_t *first;
	uint32_t *children;
} child_list;

/* A base face on its way into the cluster tree. */
typedef struct cluster_item {
	double key[6]; /* position / diagonal, normal * NORMAL_WEIGHT */
	uint32_t face;
} cluster_item;

typedef struct builder {
	const gi_refined *refined;
	uint32_t finest;
	double diagonal2;
	face_sum *sums[MAX_LEVELS];
	child_list lists[MAX_LEVELS];
	cluster_item *items;
	uint32_t item_count;
	gi_hierarchy *out;
} builder;

/* ---- geometry of faces ---- */

typedef struct quad {
	gi_vec3d a, b, c, d;
} quad;

static quad load_quad(const float (*positions)[3], const uint32_t corners[4])
{
	return (quad){gi_vec3d_load(positions[corners[0]]), gi_vec3d_load(positions[corners[1]]),
		      gi_vec3d_load(positions[corners[2]]), gi_vec3d_load(positions[corners[3]])};
}

static quad node_quad(const gi_hierarchy *h, uint32_t node)
{
	const gi_uvec4 c = h->topology[node].corners;
	return (quad){gi_vec3d_from(h->vertices[c.x]), gi_vec3d_from(h->vertices[c.y]), gi_vec3d_from(h->vertices[c.z]),
		      gi_vec3d_from(h->vertices[c.w])};
}

static gi_vec3d quad_moment(const quad *q)
{
	return gi_vec3d_add(gi_vec3d_triangle(q->a, q->b, q->c), gi_vec3d_triangle(q->a, q->c, q->d));
}

/* The longer diagonal, squared; of a triangle, whose d is c, the longest edge. */
static double quad_diagonal2(const quad *q)
{
	const gi_vec3d ac = gi_vec3d_sub(q->c, q->a), bd = gi_vec3d_sub(q->d, q->b), ab = gi_vec3d_sub(q->b, q->a);
	return fmax(fmax(gi_vec3d_dot(ac, ac), gi_vec3d_dot(bd, bd)), gi_vec3d_dot(ab, ab));
}

static double quad_area(const quad *q)
{
	return gi_vec3d_length(gi_vec3d_triangle(q->a, q->b, q->c)) +
	       gi_vec3d_length(gi_vec3d_triangle(q->a, q->c, q->d));
}

double gi_quad_area(const float a[3], const float b[3], const float c[3], const float d[3])
{
	const quad q = {gi_vec3d_load(a), gi_vec3d_load(b), gi_vec3d_load(c), gi_vec3d_load(d)};
	return quad_area(&q);
}

static face_sum sum_quad(const quad *q)
{
	const gi_vec3d abc = gi_vec3d_triangle(q->a, q->b, q->c), acd = gi_vec3d_triangle(q->a, q->c, q->d);
	const double area1 = gi_vec3d_length(abc), area2 = gi_vec3d_length(acd);
	const gi_vec3d ac = gi_vec3d_add(q->a, q->c);
	return (face_sum){.area = area1 + area2,
			  .moment = gi_vec3d_add(abc, acd),
			  .centre = gi_vec3d_add(gi_vec3d_scale(gi_vec3d_add(ac, q->b), area1 / 3.0),
						 gi_vec3d_scale(gi_vec3d_add(ac, q->d), area2 / 3.0)),
			  .leaf_count = 1};
}

static void add_sum(face_sum *to, const face_sum *sum)
{
	to->area += sum->area;
	to->moment = gi_vec3d_add(to->moment, sum->moment);
	to->centre = gi_vec3d_add(to->centre, sum->centre);
	to->leaf_count += sum->leaf_count;
}

/* ---- sums and links of the refined levels ---- */

static void sum_leaves(builder *b)
{
	const gi_refine_level *level = &b->refined->levels[b->finest];
	for (uint32_t face = 0; face < level->face_count; face++) {
		const quad q = load_quad((const float(*)[3])b->refined->positions, level->corners[face]);
		const face_sum sum = sum_quad(&q);
		if (sum.area > ZERO_AREA * quad_diagonal2(&q))
			b->sums[b->finest][face] = sum;
	}
}

static void sum_parents(builder *b, uint32_t level)
{
	const gi_refine_level *below = &b->refined->levels[level + 1];
	for (uint32_t face = 0; face < below->face_count; face++)
		add_sum(&b->sums[level][below->parent[face]], &b->sums[level + 1][face]);
}

/* A counting sort: children stay in the order OpenSubdiv gave them. */
static void link_children(builder *b, uint32_t level)
{
	const gi_refine_level *below = &b->refined->levels[level + 1];
	const uint32_t count = b->refined->levels[level].face_count;
	child_list *list = &b->lists[level];
	for (uint32_t face = 0; face < below->face_count; face++)
		list->first[below->parent[face] + 1]++;
	for (uint32_t face = 0; face < count; face++)
		list->first[face + 1] += list->first[face];
	for (uint32_t face = below->face_count; face-- > 0;)
		list->children[--list->first[below->parent[face] + 1]] = face;
	/* Each first[f + 1] now is where f's children begin: one place too far up. */
	memmove(list->first, list->first + 1, count * sizeof *list->first);
	list->first[count] = below->face_count;
}

static void list_items(builder *b)
{
	const double diagonal = sqrt(b->diagonal2);
	for (uint32_t face = 0; face < b->refined->levels[0].face_count; face++) {
		const face_sum *sum = &b->sums[0][face];
		if (sum->leaf_count == 0)
			continue;
		const gi_vec3d centre = gi_vec3d_scale(sum->centre, 1.0 / (sum->area * diagonal));
		const gi_vec3d normal = gi_vec3d_scale(sum->moment, NORMAL_WEIGHT / sum->area);
		cluster_item item = {{centre.x, centre.y, centre.z, normal.x, normal.y, normal.z}, face};
		for (int axis = 0; axis < 6; axis++)
			item.key[axis] = rint(item.key[axis] * KEY_STEPS) / KEY_STEPS;
		b->items[b->item_count++] = item;
	}
}

/* ---- nodes ---- */

static gi_vec3d node_normal(const gi_hierarchy *h, uint32_t node)
{
	return gi_vec3d_from(h->geometry[node].axis);
}

static void set_moment(gi_hierarchy *h, uint32_t node)
{
	const gi_uvec4 range = h->topology[node].range;
	gi_vec3d moment = {0};
	double area = 0.0;
	for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
		const quad q = node_quad(h, h->leaf_node[leaf]);
		moment = gi_vec3d_add(moment, quad_moment(&q));
		area += quad_area(&q);
	}
	h->geometry[node].moment = (gi_vec4){(float)moment.x, (float)moment.y, (float)moment.z, (float)area};
	const double length = gi_vec3d_length(moment);
	const gi_vec3d axis =
	    length > NO_AXIS * area ? gi_vec3d_scale(moment, 1.0 / length) : (gi_vec3d){0.0, 0.0, 1.0};
	h->geometry[node].axis =
	    (gi_vec4){(float)axis.x, (float)axis.y, (float)axis.z, length > NO_AXIS * area ? 1 : -1};
}

/* Cosine between the axis and a triangle's normal; 1 for a triangle without one. */
static double normal_cosine(gi_vec3d axis, gi_vec3d triangle_moment, double least_area)
{
	const double area = gi_vec3d_length(triangle_moment);
	return area > least_area ? gi_vec3d_dot(axis, triangle_moment) / area : 1.0;
}

/* The least cosine between an axis and the normals of the triangles of a node's leaves. A triangle of 1e-9 of its quad
 * is a quad that is a triangle: its normal is noise. */
static double least_cosine(const gi_hierarchy *h, uint32_t node, gi_vec3d axis)
{
	const gi_uvec4 range = h->topology[node].range;
	double least = INFINITY; /* the axis as stored may be longer than 1 by its rounding */
	for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
		const quad q = node_quad(h, h->leaf_node[leaf]);
		const double noise = 1e-9 * quad_area(&q);
		least = fmin(least, normal_cosine(axis, gi_vec3d_triangle(q.a, q.b, q.c), noise));
		least = fmin(least, normal_cosine(axis, gi_vec3d_triangle(q.a, q.c, q.d), noise));
	}
	return least;
}

/* The cone about the axis as stored. A cosine within 1e-9 of the float is as good as it: 1 stays 1 for flat nodes. */
static void set_cone(gi_hierarchy *h, uint32_t node)
{
	gi_vec4 *axis = &h->geometry[node].axis;
	if (axis->w < 0.0f)
		return;
	const gi_vec3d stored = gi_vec3d_rounded(node_normal(h, node));
	const double cosine = fmax(-1.0, least_cosine(h, node, stored) / gi_vec3d_length(stored));
	axis->w = (float)cosine;
	if (axis->w > cosine + 1e-9)
		axis->w = nextafterf(axis->w, -2.0f);
}

static gi_vec3d bounds_centre(const gi_hierarchy *h, uint32_t node)
{
	const gi_uvec4 range = h->topology[node].range;
	gi_vec3d lower = {INFINITY, INFINITY, INFINITY}, upper = {-INFINITY, -INFINITY, -INFINITY};
	for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
		const quad q = node_quad(h, h->leaf_node[leaf]);
		const gi_vec3d corners[4] = {q.a, q.b, q.c, q.d};
		for (int i = 0; i < 4; i++) {
			lower = (gi_vec3d){fmin(lower.x, corners[i].x), fmin(lower.y, corners[i].y),
					   fmin(lower.z, corners[i].z)};
			upper = (gi_vec3d){fmax(upper.x, corners[i].x), fmax(upper.y, corners[i].y),
					   fmax(upper.z, corners[i].z)};
		}
	}
	return gi_vec3d_scale(gi_vec3d_add(lower, upper), 0.5);
}

/* The corner of a node's leaves farthest from a point; of those as far within rounding of the positions the first, so
 * that a symmetric cage has the same spheres at every scale. */
static gi_vec3d farthest_corner(const gi_hierarchy *h, uint32_t node, gi_vec3d from, double *distance)
{
	const gi_uvec4 range = h->topology[node].range;
	gi_vec3d farthest = from;
	double most = 0.0, chosen = 0.0;
	for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
		const quad q = node_quad(h, h->leaf_node[leaf]);
		const gi_vec3d corners[4] = {q.a, q.b, q.c, q.d};
		for (int i = 0; i < 4; i++) {
			const gi_vec3d to = gi_vec3d_sub(corners[i], from);
			const double distance2 = gi_vec3d_dot(to, to);
			most = fmax(most, distance2);
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
	farthest_corner(h, node, gi_vec3d_rounded(centre), &radius);
	*sphere = (gi_vec4){(float)centre.x, (float)centre.y, (float)centre.z, (float)radius};
	if (sphere->w < radius)
		sphere->w = nextafterf(sphere->w, INFINITY);
}

/* Badoiu and Clarkson's iteration, "Smaller core-sets for balls" (2003): step ever shorter towards the farthest point;
 * the best centre seen is kept. From the centre of the bounds a few steps take most of what there is to gain. */
static void set_sphere(gi_hierarchy *h, uint32_t node)
{
	enum { STEPS = 4 };
	gi_vec3d centre = bounds_centre(h, node), best = centre;
	double best_radius = INFINITY;
	for (int step = 0; step <= STEPS; step++) {
		double radius;
		const gi_vec3d far = farthest_corner(h, node, centre, &radius);
		if (radius < best_radius * (1 - GI_TIE)) {
			best_radius = radius;
			best = centre;
		}
		centre = gi_vec3d_add(centre, gi_vec3d_scale(gi_vec3d_sub(far, centre), 1.0 / (step + 8)));
	}
	store_sphere(h, node, best);
}

/* How far the corners of a node's leaves are from the plane through its sphere's centre, over its radius. */
static double thickness_of(const gi_hierarchy *h, uint32_t node)
{
	const gi_uvec4 range = h->topology[node].range;
	const gi_vec4 sphere = h->geometry[node].sphere;
	const gi_vec3d centre = gi_vec3d_from(sphere), normal = node_normal(h, node);
	double most = 0.0;
	for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
		const quad q = node_quad(h, h->leaf_node[leaf]);
		const gi_vec3d corners[4] = {q.a, q.b, q.c, q.d};
		for (int i = 0; i < 4; i++)
			most = fmax(most, fabs(gi_vec3d_dot(normal, gi_vec3d_sub(corners[i], centre))));
	}
	return fmin(most / sphere.w, 1.0);
}

/* What is flat but for rounding is flat: or patches of one plane would see each other. */
static void set_thickness(gi_hierarchy *h, uint32_t node)
{
	const double thickness = thickness_of(h, node);
	if (thickness > FLAT_TOLERANCE)
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
	return fabs(a - b) <= FLAT_TOLERANCE * fmax(fabs(a), fabs(b));
}

/* Do the node's two triangles cover exactly its leaves? In one plane, with the same area, and nothing folded over
 * (folds make the area larger than the length of the moment). */
static bool is_flat(const gi_hierarchy *h, uint32_t node)
{
	const gi_vec4 moment = h->geometry[node].moment;
	const quad q = node_quad(h, node);
	const double length = gi_vec3d_length(gi_vec3d_from(moment));
	return nearly(length, moment.w) && nearly(quad_area(&q), moment.w) &&
	       nearly(gi_vec3d_dot(quad_moment(&q), node_normal(h, node)), moment.w) &&
	       is_coplanar(h, node, q.a, node_normal(h, node), FLAT_TOLERANCE * h->geometry[node].sphere.w);
}

static void add_outer(double t[6], gi_vec3d triangle_moment)
{
	const double area = gi_vec3d_length(triangle_moment);
	if (area <= 0.0)
		return;
	const gi_vec3d n = triangle_moment;
	const double outer[6] = {n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.y * n.z, n.z * n.x};
	for (int k = 0; k < 6; k++)
		t[k] += outer[k] / area;
}

/* T, and the shape factor between the two cases that are exact: |T| / area is 1 for flat nodes, 1 / sqrt 3 for normals
 * all round. */
static void set_spread(gi_hierarchy *h, uint32_t node)
{
	const gi_uvec4 range = h->topology[node].range;
	double t[6] = {0};
	for (uint32_t leaf = range.y; leaf < range.y + range.z; leaf++) {
		const quad q = node_quad(h, h->leaf_node[leaf]);
		add_outer(t, gi_vec3d_triangle(q.a, q.b, q.c));
		add_outer(t, gi_vec3d_triangle(q.a, q.c, q.d));
	}
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

/* A cluster whose leaves tile a quad is as good as a face. */
static void set_cover(gi_hierarchy *h, uint32_t node)
{
	gi_node_topology *t = &h->topology[node];
	uint32_t corners[4];
	const double tolerance = COVER_TOLERANCE * h->geometry[node].sphere.w;
	if (h->geometry[node].axis.w < FLAT_COSINE || !is_of_one_material(h, node) ||
	    !gi_quad_cover(h, t->range.y, t->range.z, node_normal(h, node), tolerance, corners))
		return;
	t->corners = (gi_uvec4){corners[0], corners[1], corners[2], corners[3]};
	const quad q = node_quad(h, node);
	if (is_tiled(h, node) && is_coplanar(h, node, q.a, node_normal(h, node), tolerance))
		t->range.w |= GI_NODE_POLYGON | GI_NODE_FLAT;
	else
		t->corners = (gi_uvec4){GI_NONE, GI_NONE, GI_NONE, GI_NONE};
}

static void measure_node(gi_hierarchy *h, uint32_t node)
{
	set_moment(h, node);
	set_spread(h, node);
	set_cone(h, node);
	set_sphere(h, node);
	set_thickness(h, node);
	gi_uvec4 *range = &h->topology[node].range;
	if (!(range->w & GI_NODE_POLYGON))
		set_cover(h, node);
	else if (is_flat(h, node))
		range->w |= GI_NODE_FLAT;
}

/* ---- depth-first emission ---- */

static uint32_t open_node(gi_hierarchy *h, const uint32_t *corners)
{
	const uint32_t node = h->node_count++;
	h->topology[node].range = (gi_uvec4){0, h->leaf_count, 0, 0};
	h->topology[node].corners = (gi_uvec4){GI_NONE, GI_NONE, GI_NONE, GI_NONE};
	if (corners && corners[0] != UINT32_MAX) {
		h->topology[node].corners = (gi_uvec4){corners[0], corners[1], corners[2], corners[3]};
		h->topology[node].range.w = GI_NODE_POLYGON;
	}
	return node;
}

static void close_node(gi_hierarchy *h, uint32_t node)
{
	gi_uvec4 *range = &h->topology[node].range;
	range->x = h->node_count;
	range->z = h->leaf_count - range->y;
	measure_node(h, node);
}

static void emit_leaf(builder *b, uint32_t face, uint32_t node)
{
	gi_hierarchy *h = b->out;
	const uint32_t leaf = h->leaf_count++;
	h->topology[node].range.w |= GI_NODE_LEAF;
	h->leaf_node[leaf] = node;
	h->leaf_face[leaf] = face;
	h->leaf_material[leaf] = b->refined->levels[b->finest].material[face];
}

/* Follows a face that was not refined further, an only child on every level below, to the finest. */
static uint32_t skip_only_children(const builder *b, uint32_t level, uint32_t *face)
{
	for (; level < b->finest; level++) {
		const uint32_t *first = b->lists[level].first + *face;
		if (first[1] - first[0] != 1)
			break;
		*face = b->lists[level].children[first[0]];
	}
	return level;
}

/* At most MAX_LEVELS deep. */
static void emit_face(builder *b, uint32_t level, uint32_t face)
{
	level = skip_only_children(b, level, &face);
	const uint32_t node = open_node(b->out, b->refined->levels[level].corners[face]);
	if (level == b->finest) {
		emit_leaf(b, face, node);
	} else {
		const child_list *list = &b->lists[level];
		for (uint32_t i = list->first[face]; i < list->first[face + 1]; i++)
			if (b->sums[level + 1][list->children[i]].leaf_count > 0)
				emit_face(b, level + 1, list->children[i]);
	}
	close_node(b->out, node);
}

static bool item_before(const cluster_item *a, const cluster_item *b, int axis)
{
	return a->key[axis] != b->key[axis] ? a->key[axis] < b->key[axis] : a->face < b->face;
}

static int widest_axis(const cluster_item *items, uint32_t count)
{
	int widest = 0;
	double most = -1.0;
	for (int axis = 0; axis < 6; axis++) {
		double lower = items[0].key[axis], upper = lower;
		for (uint32_t i = 1; i < count; i++) {
			lower = fmin(lower, items[i].key[axis]);
			upper = fmax(upper, items[i].key[axis]);
		}
		if (upper - lower > most) {
			most = upper - lower;
			widest = axis;
		}
	}
	return widest;
}

/* Hoare's selection as Wirth gives it: no item before `middle` comes after it in order, none behind it before. Items
 * differ by face at least, so the two sets are a function of the input alone. */
static void select_items(cluster_item *items, int64_t count, int64_t middle, int axis)
{
	int64_t begin = 0, end = count - 1;
	while (begin < end) {
		const cluster_item pivot = items[middle];
		int64_t low = begin, high = end;
		while (low <= high) {
			while (item_before(&items[low], &pivot, axis))
				low++;
			while (item_before(&pivot, &items[high], axis))
				high--;
			if (low > high)
				break;
			const cluster_item swapped = items[low];
			items[low++] = items[high];
			items[high--] = swapped;
		}
		if (high < middle)
			begin = low;
		if (middle < low)
			end = high;
	}
}

/* Where to part items about their middle: not through a row of faces with one key, if it ends near by. A wall of n by m
 * faces falls into rectangles then, which quads cover. */
static uint32_t split_of(const cluster_item *items, uint32_t count, int axis)
{
	const uint32_t middle = count / 2;
	const double key = items[middle].key[axis], same = 2 / KEY_STEPS;
	uint32_t before = 0, behind = 0;
	for (uint32_t i = 0; i < count; i++) {
		before += items[i].key[axis] < key - same;
		behind += items[i].key[axis] > key + same;
	}
	const uint32_t split = middle - before <= count - behind - middle ? before : count - behind;
	return split >= count / 4 && split <= count - count / 4 && split > 0 && split < count ? split : middle;
}

/* At most 2.5 log2(items) deep: no part has more than three quarters. */
static void emit_cluster(builder *b, cluster_item *items, uint32_t count)
{
	if (count == 1) {
		emit_face(b, 0, items[0].face);
		return;
	}
	const uint32_t node = open_node(b->out, NULL);
	const int axis = widest_axis(items, count);
	select_items(items, count, count / 2, axis);
	const uint32_t split = split_of(items, count, axis);
	select_items(items, count, split, axis);
	emit_cluster(b, items, split);
	emit_cluster(b, items + split, count - split);
	close_node(b->out, node);
}

/* ---- build ---- */

static void set_bounds(gi_hierarchy *h)
{
	gi_vec4 lower = {INFINITY, INFINITY, INFINITY, 0}, upper = {-INFINITY, -INFINITY, -INFINITY, 0};
	for (uint32_t i = 0; i < h->vertex_count; i++) {
		const gi_vec4 v = h->vertices[i];
		lower = (gi_vec4){fminf(lower.x, v.x), fminf(lower.y, v.y), fminf(lower.z, v.z), 0};
		upper = (gi_vec4){fmaxf(upper.x, v.x), fmaxf(upper.y, v.y), fmaxf(upper.z, v.z), 0};
	}
	h->lower = lower;
	h->upper = upper;
}

/* Sum of the tetrahedra from the middle of the bounds to the leaves' triangles: near the surface, so that little
 * cancels. */
static void set_totals(gi_hierarchy *h)
{
	const gi_vec3d from = gi_vec3d_scale(gi_vec3d_add(gi_vec3d_from(h->lower), gi_vec3d_from(h->upper)), 0.5);
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++) {
		const quad q = node_quad(h, h->leaf_node[leaf]);
		const gi_vec3d abc = gi_vec3d_triangle(q.a, q.b, q.c), acd = gi_vec3d_triangle(q.a, q.c, q.d);
		const gi_vec3d a = gi_vec3d_sub(q.a, from);
		h->area += gi_vec3d_length(abc) + gi_vec3d_length(acd);
		h->volume += gi_vec3d_dot(a, gi_vec3d_add(abc, acd)) / 3.0;
	}
}

static void mark_backs(gi_hierarchy *h)
{
	if (h->closed && h->volume > 0.0)
		return;
	for (uint32_t node = 0; node < h->node_count; node++)
		h->topology[node].range.w |= GI_NODE_BACK;
}

static void *allocate(size_t count, size_t size, bool *enough)
{
	void *memory = gi_calloc(count > 0 ? count : 1, size);
	*enough = *enough && memory;
	return memory;
}

static bool allocate_builder(builder *b)
{
	bool enough = true;
	for (uint32_t level = 0; level < b->refined->level_count; level++) {
		const uint32_t count = b->refined->levels[level].face_count;
		b->sums[level] = allocate(count, sizeof(face_sum), &enough);
		if (level == b->finest)
			break;
		b->lists[level].first = allocate((size_t)count + 1, sizeof(uint32_t), &enough);
		b->lists[level].children =
		    allocate(b->refined->levels[level + 1].face_count, sizeof(uint32_t), &enough);
	}
	b->items = allocate(b->refined->levels[0].face_count, sizeof *b->items, &enough);
	return enough;
}

static void free_builder(builder *b)
{
	for (uint32_t level = 0; level < MAX_LEVELS; level++) {
		gi_free(b->sums[level]);
		gi_free(b->lists[level].first);
		gi_free(b->lists[level].children);
	}
	gi_free(b->items);
}

static bool copy_vertices(const gi_refined *refined, gi_hierarchy *h)
{
	bool enough = true;
	h->vertex_count = refined->vertex_count;
	h->vertices = allocate(h->vertex_count, sizeof *h->vertices, &enough);
	for (uint32_t i = 0; enough && i < h->vertex_count; i++) {
		const float *p = refined->positions[i];
		h->vertices[i] = (gi_vec4){p[0], p[1], p[2], 0.0f};
	}
	return enough;
}

static bool allocate_nodes(builder *b)
{
	gi_hierarchy *h = b->out;
	size_t nodes = b->item_count - 1, leaves = 0;
	for (uint32_t level = 0; level <= b->finest; level++) {
		leaves = 0;
		for (uint32_t face = 0; face < b->refined->levels[level].face_count; face++)
			leaves += b->sums[level][face].leaf_count > 0;
		nodes += leaves;
	}
	bool enough = true;
	h->geometry = allocate(nodes, sizeof *h->geometry, &enough);
	h->spread = allocate(nodes, sizeof *h->spread, &enough);
	h->topology = allocate(nodes, sizeof *h->topology, &enough);
	h->leaf_node = allocate(leaves, sizeof *h->leaf_node, &enough);
	h->leaf_material = allocate(leaves, sizeof *h->leaf_material, &enough);
	h->leaf_face = allocate(leaves, sizeof *h->leaf_face, &enough);
	return enough;
}

static const char *const OUT_OF_MEMORY = "out of memory while building the hierarchy";

/* NULL when all went well, else why not. */
static const char *build(builder *b)
{
	gi_hierarchy *h = b->out;
	if (!copy_vertices(b->refined, h) || !allocate_builder(b))
		return OUT_OF_MEMORY;
	set_bounds(h);
	const gi_vec3d diagonal = gi_vec3d_sub(gi_vec3d_from(h->upper), gi_vec3d_from(h->lower));
	b->diagonal2 = gi_vec3d_dot(diagonal, diagonal);

	sum_leaves(b);
	for (uint32_t level = b->finest; level-- > 0;) {
		sum_parents(b, level);
		link_children(b, level);
	}
	list_items(b);
	if (b->item_count == 0)
		return "no face has an area";
	if (!allocate_nodes(b))
		return OUT_OF_MEMORY;
	emit_cluster(b, b->items, b->item_count);
	set_totals(h);
	h->closed = b->refined->closed;
	mark_backs(h);
	return NULL;
}

bool gi_hierarchy_build(const gi_refined *refined, gi_hierarchy *out, char *message, size_t message_size)
{
	*out = (gi_hierarchy){0};
	const char *problem = "the refined cage has no levels, or too many";
	if (refined->level_count > 0 && refined->level_count <= MAX_LEVELS) {
		builder b = {.refined = refined, .finest = refined->level_count - 1, .out = out};
		problem = build(&b);
		free_builder(&b);
	}
	if (!problem)
		return true;
	gi_hierarchy_free(out);
	out->out_of_memory = problem == OUT_OF_MEMORY;
	if (message && message_size > 0)
		snprintf(message, message_size, "%s", problem);
	return false;
}

void gi_hierarchy_free(gi_hierarchy *hierarchy)
{
	if (!hierarchy)
		return;
	gi_free(hierarchy->vertices);
	gi_free(hierarchy->leaf_node);
	gi_free(hierarchy->leaf_material);
	gi_free(hierarchy->leaf_face);
	gi_free(hierarchy->geometry);
	gi_free(hierarchy->spread);
	gi_free(hierarchy->topology);
	*hierarchy = (gi_hierarchy){0};
}

/* ---- validation: one function a rule, in the order in which later ones rely on earlier ones ---- */

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
	if (!is_near(gi_vec3d_length(node_normal(h, node)), 1.0, 1e-5) || !(axis.w >= -1.0f && axis.w <= 1.0f))
		return "a node's axis is not of length one, or its cone not a cosine";
	/* 1e-6: the axis is rounded to float. */
	return axis.w <= least_cosine(h, node, node_normal(h, node)) + 1e-6 || axis.w == -1.0f
		   ? NULL
		   : "a normal lies outside its node's cone";
}

static const char *check_sphere(const gi_hierarchy *h, uint32_t node)
{
	const gi_vec4 sphere = h->geometry[node].sphere;
	double radius;
	farthest_corner(h, node, gi_vec3d_from(sphere), &radius);
	return radius <= sphere.w * (1.0 + 1e-6) ? NULL : "a corner lies outside its node's sphere";
}

static const char *check_thickness(const gi_hierarchy *h, uint32_t node)
{
	const double stored = (double)(h->topology[node].range.w >> GI_NODE_THICKNESS_SHIFT) / GI_NODE_THICKNESS_STEPS;
	return thickness_of(h, node) <= stored + FLAT_TOLERANCE ? NULL : "a corner lies outside its node's thickness";
}

static const char *check_flat(const gi_hierarchy *h, uint32_t node)
{
	const bool flat = h->topology[node].range.w & GI_NODE_FLAT;
	return !flat || is_flat(h, node) ? NULL : "a flat node is not the surface of its leaves";
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
