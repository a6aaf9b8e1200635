#include "drawn_locator.h"

#include "bits.h"
#include "drawn_build.h"
#include "host_memory.h"

#include <math.h>

/* A leaf that faces as the vertex does is preferred to one that does not, unless it is this many times as far away and
 * this part of the diagonal farther: a scan's crevice that its cage has not must not be lit as the statue's other side.
 */
#define PREFER_TIMES 4.0
#define PREFER_FARTHER 0.02

/* The leaves found so far that are closest to a point: of those that face as its normal does, and of all. */
typedef struct search {
	gi_vec3d point, normal;
	gi_leaf_point facing, any;
} search;

/* Part of a leaf, and what of the leaf's corners is in each of its own. */
typedef struct part {
	gi_vec3d corner[3];
	uint32_t first, second, third; /* the leaf's corners; third == 4: their middle */
} part;

bool gi_drawn_locator_build(const gi_hierarchy *h, bool from_middle, gi_drawn_locator *out)
{
	const gi_vec3d diagonal = gi_vec3d_sub(gi_vec3d_from(h->upper), gi_vec3d_from(h->lower));
	*out = (gi_drawn_locator){
	    .h = h, .farther = PREFER_FARTHER * gi_vec3d_length(diagonal), .from_middle = from_middle};
	bool enough = true;
	const size_t count = h->leaf_count;
	gi_box *boxes = gi_drawn_allocate(count, sizeof *boxes, &enough);
	out->nodes = gi_drawn_allocate(2 * count, sizeof *out->nodes, &enough);
	out->order = gi_drawn_allocate(count, sizeof *out->order, &enough);
	for (uint32_t leaf = 0; enough && leaf < count; leaf++) {
		const quad q = leaf_quad(h, leaf);
		gi_vec4 l = h->vertices[q.v[0]], u = l;
		for (uint32_t k = 1; k < q.count; k++) {
			const gi_vec4 v = h->vertices[q.v[k]];
			l = (gi_vec4){fminf(l.x, v.x), fminf(l.y, v.y), fminf(l.z, v.z), 0.0f};
			u = (gi_vec4){fmaxf(u.x, v.x), fmaxf(u.y, v.y), fmaxf(u.z, v.z), 0.0f};
		}
		boxes[leaf] = (gi_box){{l.x, l.y, l.z}, {u.x, u.y, u.z}};
	}
	if (enough)
		gi_bvh_build_boxes(boxes, h->leaf_count, out->nodes, out->order);
	gi_free(boxes);
	return enough;
}

/* Barycentric coordinates of the point of a triangle closest to p, by the regions of Ericson, "Real-Time Collision
 * Detection" (2005), section 5.1.5. The triangle has an area. */
static gi_vec3d closest_barycentric(gi_vec3d p, gi_vec3d a, gi_vec3d b, gi_vec3d c)
{
	const gi_vec3d ab = gi_vec3d_sub(b, a), ac = gi_vec3d_sub(c, a);
	const gi_vec3d ap = gi_vec3d_sub(p, a), bp = gi_vec3d_sub(p, b), cp = gi_vec3d_sub(p, c);
	const double d1 = gi_vec3d_dot(ab, ap), d2 = gi_vec3d_dot(ac, ap);
	if (d1 <= 0.0 && d2 <= 0.0)
		return (gi_vec3d){1.0, 0.0, 0.0};
	const double d3 = gi_vec3d_dot(ab, bp), d4 = gi_vec3d_dot(ac, bp);
	if (d3 >= 0.0 && d4 <= d3)
		return (gi_vec3d){0.0, 1.0, 0.0};
	const double vc = d1 * d4 - d3 * d2;
	if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0)
		return (gi_vec3d){-d3 / (d1 - d3), d1 / (d1 - d3), 0.0};
	const double d5 = gi_vec3d_dot(ab, cp), d6 = gi_vec3d_dot(ac, cp);
	if (d6 >= 0.0 && d5 <= d6)
		return (gi_vec3d){0.0, 0.0, 1.0};
	const double vb = d5 * d2 - d1 * d6;
	if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0)
		return (gi_vec3d){-d6 / (d2 - d6), 0.0, d2 / (d2 - d6)};
	const double va = d3 * d6 - d5 * d4, sum = va + vb + vc;
	/* A sliver whose sum cancels is as good as its edge b c. */
	if ((va <= 0.0 && d4 >= d3 && d5 >= d6) || !(sum > 0.0)) {
		const double w = fmin(fmax((d4 - d3) / ((d4 - d3) + (d5 - d6)), 0.0), 1.0);
		return (gi_vec3d){0.0, 1.0 - w, w};
	}
	return (gi_vec3d){va / sum, vb / sum, vc / sum};
}

static void try_part(uint32_t leaf, const part *t, search *s)
{
	const gi_vec3d *c = t->corner, moment = gi_vec3d_triangle(c[0], c[1], c[2]);
	if (!(gi_vec3d_length(moment) > 0.0))
		return;
	const gi_vec3d w = closest_barycentric(s->point, c[0], c[1], c[2]);
	const gi_vec3d at =
	    gi_vec3d_add(gi_vec3d_add(gi_vec3d_scale(c[0], w.x), gi_vec3d_scale(c[1], w.y)), gi_vec3d_scale(c[2], w.z));
	const gi_vec3d to = gi_vec3d_sub(at, s->point);
	gi_leaf_point found = {.distance2 = gi_vec3d_dot(to, to), .leaf = leaf};
	found.weight[t->first] = (float)w.x;
	found.weight[t->second] = (float)w.y;
	for (uint32_t k = 0; k < 4; k++)
		found.weight[k] += t->third == 4 ? (float)(0.25 * w.z) : k == t->third ? (float)w.z : 0.0f;
	if (found.distance2 < s->any.distance2)
		s->any = found;
	/* A vertex without a normal agrees with all. */
	const bool facing = gi_vec3d_dot(moment, s->normal) > 0.0 || gi_vec3d_dot(s->normal, s->normal) == 0.0;
	if (facing && found.distance2 < s->facing.distance2)
		s->facing = found;
}

static void try_leaf(const gi_drawn_locator *l, uint32_t leaf, search *s)
{
	const quad q = leaf_quad(l->h, leaf);
	gi_vec3d at[4], middle = {0};
	for (uint32_t k = 0; k < 4; k++) {
		at[k] = vertex_position(l->h, q.v[k]);
		middle = gi_vec3d_add(middle, gi_vec3d_scale(at[k], 0.25));
	}
	const bool round = l->from_middle && q.count == 4;
	for (uint32_t k = 1; !round && k + 1 < q.count; k++)
		try_part(leaf, &(part){{at[0], at[k], at[k + 1]}, 0, k, k + 1}, s);
	for (uint32_t k = 0; round && k < 4; k++)
		try_part(leaf, &(part){{at[k], at[(k + 1) % 4], middle}, k, (k + 1) % 4, 4}, s);
}

/* The squared distance up to which a leaf that faces the right way is preferred. */
static double reach2(const gi_drawn_locator *l, const search *s)
{
	const double reach = PREFER_TIMES * sqrt(s->any.distance2) + l->farther;
	return reach * reach;
}

static double box_distance2(const gi_bvh_node *node, gi_vec3d p)
{
	const double x = fmax(fmax(node->lower.x - p.x, p.x - node->upper.x), 0.0);
	const double y = fmax(fmax(node->lower.y - p.y, p.y - node->upper.y), 0.0);
	const double z = fmax(fmax(node->lower.z - p.z, p.z - node->upper.z), 0.0);
	return x * x + y * y + z * z;
}

gi_leaf_point gi_drawn_locate(const gi_drawn_locator *l, gi_vec3d point, gi_vec3d normal, uint32_t near)
{
	search s = {
	    .point = point, .normal = normal, .facing = {.distance2 = INFINITY}, .any = {.distance2 = INFINITY}};
	try_leaf(l, near, &s);
	const uint32_t count = 2 * l->h->leaf_count - 1;
	double limit2 = fmin(s.facing.distance2, reach2(l, &s));
	for (uint32_t node = 0; node < count;) {
		if (box_distance2(&l->nodes[node], point) > limit2) {
			node = gi_bits_from_float(l->nodes[node].lower.w);
			continue;
		}
		const uint32_t item = gi_bits_from_float(l->nodes[node].upper.w);
		if (item != GI_NONE) {
			try_leaf(l, l->order[item], &s);
			limit2 = fmin(s.facing.distance2, reach2(l, &s));
		}
		node++;
	}
	return s.facing.distance2 <= reach2(l, &s) ? s.facing : s.any;
}

void gi_drawn_locator_free(gi_drawn_locator *l)
{
	gi_free(l->nodes);
	gi_free(l->order);
	*l = (gi_drawn_locator){0};
}
