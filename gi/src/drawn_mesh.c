/* The drawn surface of an object that is drawn as a mesh of its own, finer than its cage. */
#include "drawn_build.h"

#include "bits.h"
#include "bvh.h"
#include "host_memory.h"

#include <math.h>

/* A simplified cage has edges that the scan it stands for has not: there only 70 degrees are taken for an edge of the
 * scan. */
#define CAGE_EDGE_COSINE 0.342
/* A leaf that faces as the vertex does is preferred to one that does not, unless it is this many times as far away and
 * this part of the diagonal farther: a scan's crevice that its cage has not must not be lit as the statue's other side.
 */
#define PREFER_TIMES 4.0
#define PREFER_FARTHER 0.02

/* The leaves in a bounding volume hierarchy, to find the one closest to a point. */
typedef struct locator {
	const gi_hierarchy *h;
	gi_bvh_node *nodes;
	uint32_t *order;
	double farther; /* PREFER_FARTHER of the diagonal */
} locator;

typedef struct closest {
	double distance2; /* INFINITY: none found */
	uint32_t leaf;
	float weight[4]; /* of the leaf's corners */
} closest;

/* The leaves found so far that are closest to a point: of those that face as its normal does, and of all. */
typedef struct search {
	gi_vec3d point, normal;
	closest facing, any;
} search;

static bool build_locator(const gi_hierarchy *h, locator *out)
{
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

/* Tries the triangle of a leaf's corners 0, k and k + 1. */
static void try_triangle(const gi_hierarchy *h, uint32_t leaf, const quad *q, uint32_t k, search *s)
{
	const gi_vec3d a = vertex_position(h, q->v[0]), b = vertex_position(h, q->v[k]);
	const gi_vec3d c = vertex_position(h, q->v[k + 1]);
	const gi_vec3d moment = gi_vec3d_triangle(a, b, c);
	if (!(gi_vec3d_length(moment) > 0.0))
		return;
	const gi_vec3d w = closest_barycentric(s->point, a, b, c);
	const gi_vec3d at =
	    gi_vec3d_add(gi_vec3d_add(gi_vec3d_scale(a, w.x), gi_vec3d_scale(b, w.y)), gi_vec3d_scale(c, w.z));
	const gi_vec3d to = gi_vec3d_sub(at, s->point);
	closest found = {.distance2 = gi_vec3d_dot(to, to), .leaf = leaf, .weight = {(float)w.x}};
	found.weight[k] = (float)w.y;
	found.weight[k + 1] = (float)w.z;
	if (found.distance2 < s->any.distance2)
		s->any = found;
	/* A vertex without a normal agrees with all. */
	const bool facing = gi_vec3d_dot(moment, s->normal) > 0.0 || gi_vec3d_dot(s->normal, s->normal) == 0.0;
	if (facing && found.distance2 < s->facing.distance2)
		s->facing = found;
}

static void try_leaf(const gi_hierarchy *h, uint32_t leaf, search *s)
{
	const quad q = leaf_quad(h, leaf);
	for (uint32_t k = 1; k + 1 < q.count; k++)
		try_triangle(h, leaf, &q, k, s);
}

/* The squared distance up to which a leaf that faces the right way is preferred. */
static double reach2(const locator *l, const search *s)
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

/* `near` is a leaf that is likely close: with it found first most of the tree is never entered. */
static closest find_closest(const locator *l, gi_vec3d point, gi_vec3d normal, uint32_t near)
{
	search s = {
	    .point = point, .normal = normal, .facing = {.distance2 = INFINITY}, .any = {.distance2 = INFINITY}};
	try_leaf(l->h, near, &s);
	const uint32_t count = 2 * l->h->leaf_count - 1;
	double limit2 = fmin(s.facing.distance2, reach2(l, &s));
	for (uint32_t node = 0; node < count;) {
		if (box_distance2(&l->nodes[node], point) > limit2) {
			node = gi_bits_from_float(l->nodes[node].lower.w);
			continue;
		}
		const uint32_t item = gi_bits_from_float(l->nodes[node].upper.w);
		if (item != GI_NONE) {
			try_leaf(l->h, l->order[item], &s);
			limit2 = fmin(s.facing.distance2, reach2(l, &s));
		}
		node++;
	}
	return s.facing.distance2 <= reach2(l, &s) ? s.facing : s.any;
}

/* A mesh as the caller gave it. */
typedef struct mesh {
	const float *positions;
	uint32_t vertex_count;
	const uint32_t *indices;
	uint32_t index_count;
} mesh;

static bool is_valid(const mesh *m)
{
	for (size_t i = 0; i < 3 * (size_t)m->vertex_count; i++)
		if (!isfinite(m->positions[i]))
			return false;
	for (uint32_t i = 0; i < m->index_count; i++)
		if (m->indices[i] >= m->vertex_count)
			return false;
	return m->index_count % 3 == 0;
}

static gi_vec3d mesh_position(const mesh *m, uint32_t vertex)
{
	return gi_vec3d_load(m->positions + 3 * (size_t)vertex);
}

static void sum_normals(const mesh *m, gi_vec3d *normals)
{
	for (uint32_t i = 0; i + 2 < m->index_count; i += 3) {
		const uint32_t *t = m->indices + i;
		const gi_vec3d moment =
		    gi_vec3d_triangle(mesh_position(m, t[0]), mesh_position(m, t[1]), mesh_position(m, t[2]));
		for (int k = 0; k < 3; k++)
			normals[t[k]] = gi_vec3d_add(normals[t[k]], moment);
	}
}

/* For each vertex one before it, a neighbour where there is one: its leaf is where the search for this one's begins. */
static void find_guides(const mesh *m, uint32_t *guide)
{
	for (uint32_t i = 0; i < m->vertex_count; i++)
		guide[i] = i > 0 ? i - 1 : 0;
	for (uint32_t i = 0; i < m->index_count; i++) {
		const uint32_t vertex = m->indices[i];
		const uint32_t next = m->indices[i % 3 == 2 ? i - 2 : i + 1];
		if (next < vertex)
			guide[vertex] = next;
		else if (vertex < next)
			guide[next] = vertex;
	}
}

static void draw_mesh(drawn_builder *s, const locator *l, const mesh *m, const gi_vec3d *normals, const uint32_t *guide)
{
	for (uint32_t i = 0; i < m->vertex_count; i++) {
		const gi_vec3d point = mesh_position(m, i), normal = unit_or(normals[i], (gi_vec3d){0.0, 0.0, 0.0});
		const uint32_t near = i > 0 ? s->out->vertices[guide[i]].leaf : 0;
		const closest found = find_closest(l, point, normal, near);
		gi_draw_vertex v = {0};
		gi_vec3d_store(v.position, point);
		gi_vec3d_store(v.normal, unit_or(normal, leaf_normal(s->h, found.leaf)));
		gi_drawn_set_light(s, found.leaf, found.weight, &v);
		gi_drawn_add_vertex(s, &v);
	}
	for (uint32_t i = 0; i < m->index_count; i++)
		s->out->indices[s->out->index_count++] = m->indices[i];
}

static bool draw_from_mesh(drawn_builder *s, const mesh *m)
{
	locator l = {.h = s->h};
	const gi_vec3d diagonal = gi_vec3d_sub(gi_vec3d_from(s->h->upper), gi_vec3d_from(s->h->lower));
	l.farther = PREFER_FARTHER * gi_vec3d_length(diagonal);
	bool enough = gi_drawn_make_lights(s, CAGE_EDGE_COSINE) && build_locator(s->h, &l);
	gi_vec3d *normals = gi_drawn_allocate(m->vertex_count, sizeof *normals, &enough);
	uint32_t *guide = gi_drawn_allocate(m->vertex_count, sizeof *guide, &enough);
	s->out->vertices = gi_drawn_allocate(m->vertex_count, sizeof *s->out->vertices, &enough);
	s->out->indices = gi_drawn_allocate(m->index_count, sizeof *s->out->indices, &enough);
	if (enough) {
		sum_normals(m, normals);
		find_guides(m, guide);
		draw_mesh(s, &l, m, normals, guide);
	}
	gi_free(normals);
	gi_free(guide);
	gi_free(l.nodes);
	gi_free(l.order);
	return enough;
}

/* False also for an index out of range or a coordinate that is not finite. */
bool gi_drawn_from_mesh(const gi_hierarchy *hierarchy, const float *positions, uint32_t vertex_count,
			const uint32_t *indices, uint32_t index_count, gi_drawn_surface *out)
{
	*out = (gi_drawn_surface){0};
	const mesh m = {positions, vertex_count, indices, index_count};
	if (hierarchy->leaf_count == 0 || !is_valid(&m))
		return false;
	drawn_builder s = {.h = hierarchy, .out = out};
	const bool done = draw_from_mesh(&s, &m);
	gi_drawn_free_builder(&s);
	if (!done)
		gi_drawn_free(out);
	return done;
}
