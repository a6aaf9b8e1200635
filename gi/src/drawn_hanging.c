#include "drawn_hanging.h"

#include "bits.h"
#include "host_memory.h"
#include "vec3d.h"

#include <string.h>

/* Of the longer edge's length: where less of an edge lies on it, a line that parts light may pass between the two that
 * was moved to a corner near by (split.c). */
#define SHORTEST 0.02

/* Light vertices that hang between ones that hang are followed so far; in a ring of them what is left of each one's own
 * leaves gets less every time. */
enum { MOST_TIMES = 40 };

typedef struct hanger {
	const gi_hierarchy *h;
	const uint8_t *parted;
	double least_cosine;
	const gi_leaf_edge *edges;
	uint32_t *first; /* by vertex, and one more: where its edges without a partner begin in `at` */
	uint32_t *at;    /* edges */
	void (*join)(uint32_t *group, uint32_t a, uint32_t b);
	uint32_t *group;
	gi_hanging_list *out;
} hanger;

static uint32_t vertex_at(const gi_hierarchy *h, uint32_t corner)
{
	return (&h->topology[h->leaf_node[corner / 4]].corners.x)[corner % 4];
}

static uint32_t next_corner(const gi_hierarchy *h, uint32_t corner)
{
	const gi_uvec4 c = h->topology[h->leaf_node[corner / 4]].corners;
	return corner - corner % 4 + (corner % 4 + 1) % (c.z == c.w ? 3 : 4);
}

static gi_vec3d position(const gi_hierarchy *h, uint32_t vertex)
{
	return gi_vec3d_from(h->vertices[vertex]);
}

static gi_vec3d normal(const gi_hierarchy *h, uint32_t corner)
{
	return gi_vec3d_from(h->geometry[h->leaf_node[corner / 4]].axis);
}

bool gi_drawn_has_partner(const gi_leaf_edge *edges, uint32_t count, uint32_t k)
{
	const gi_leaf_edge *e = &edges[k];
	return (k > 0 && e[-1].low == e->low && e[-1].high == e->high) ||
	       (k + 1 < count && e[1].low == e->low && e[1].high == e->high);
}

/* A counting sort by both ends. */
static bool list_by_vertex(hanger *g, uint32_t count)
{
	g->first = gi_calloc((size_t)g->h->vertex_count + 2, sizeof *g->first);
	g->at = gi_malloc((2 * (size_t)count + 1) * sizeof *g->at);
	if (!g->first || !g->at)
		return false;
	for (uint32_t k = 0; k < count; k++)
		for (int end = 0; end < 2 && !gi_drawn_has_partner(g->edges, count, k); end++)
			g->first[(end ? g->edges[k].high : g->edges[k].low) + 2]++;
	for (uint32_t v = 2; v < g->h->vertex_count + 2; v++)
		g->first[v] += g->first[v - 1];
	for (uint32_t k = 0; k < count; k++)
		for (int end = 0; end < 2 && !gi_drawn_has_partner(g->edges, count, k); end++)
			g->at[g->first[(end ? g->edges[k].high : g->edges[k].low) + 1]++] = k;
	return true;
}

/* Share of the way from a to b where p lies, which may be before or behind it; OFF: not in line with it. */
#define OFF (-1e30)
static double share_of(gi_vec3d a, gi_vec3d b, gi_vec3d p)
{
	const gi_vec3d way = gi_vec3d_sub(b, a), to = gi_vec3d_sub(p, a);
	const double length2 = gi_vec3d_dot(way, way), share = gi_vec3d_dot(way, to) / length2;
	const gi_vec3d off = gi_vec3d_sub(to, gi_vec3d_scale(way, share));
	return gi_vec3d_dot(off, off) <= GI_ON_EDGE * GI_ON_EDGE * length2 ? share : OFF;
}

static bool add_hanging(gi_hanging_list *list, gi_hanging item)
{
	if (list->count == list->capacity) {
		const uint32_t capacity = list->capacity ? 2 * list->capacity : 64;
		gi_hanging *grown = gi_realloc(list->items, capacity * sizeof *grown);
		if (!grown)
			return false;
		list->items = grown;
		list->capacity = capacity;
	}
	list->items[list->count++] = item;
	return true;
}

/* One corner of the shorter edge on the longer one, whose corners are ends[0] and ends[1]. */
static bool hang_corner(hanger *g, uint32_t corner, const uint32_t ends[2], double share)
{
	const uint32_t vertex = vertex_at(g->h, corner);
	for (int k = 0; k < 2; k++)
		if (vertex == vertex_at(g->h, ends[k])) {
			g->join(g->group, corner, ends[k]);
			return true;
		}
	return add_hanging(g->out, (gi_hanging){corner, {ends[0], ends[1]}, (float)share});
}

static bool is_parted(const hanger *g, uint32_t corner)
{
	return g->parted && g->parted[g->h->leaf_face[corner / 4]] >> (corner % 4) & 1;
}

/* A way along an edge from one of its ends, and how far it has come. */
typedef struct way {
	const gi_leaf_edge *edge;
	uint32_t ends[2]; /* its corners, in its own order */
	gi_vec3d a, b;
	bool back; /* from its second end */
	uint32_t vertex;
	double share;
} way;

static way way_along(const hanger *g, const gi_leaf_edge *edge, bool back)
{
	const uint32_t ends[2] = {edge->corner, next_corner(g->h, edge->corner)};
	return (way){.edge = edge,
		     .ends = {ends[0], ends[1]},
		     .a = position(g->h, vertex_at(g->h, ends[0])),
		     .b = position(g->h, vertex_at(g->h, ends[1])),
		     .back = back,
		     .vertex = vertex_at(g->h, ends[back]),
		     .share = back};
}

static uint32_t other_end(const gi_leaf_edge *e, uint32_t vertex)
{
	return e->low == vertex ? e->high : e->low;
}

/* The next edge on the way that belongs to another leaf and ends within it, or beyond its end; NULL: none. */
static const gi_leaf_edge *next_on(const hanger *g, const way *w, bool beyond)
{
	for (uint32_t k = g->first[w->vertex]; k < g->first[w->vertex + 1]; k++) {
		const gi_leaf_edge *e = &g->edges[g->at[k]];
		const double share = share_of(w->a, w->b, position(g->h, other_end(e, w->vertex)));
		const double from = w->back ? 1 - w->share : w->share, to = w->back ? 1 - share : share;
		if (e->corner / 4 != w->edge->corner / 4 && share != OFF && to > from &&
		    (to > 1 + GI_ON_EDGE) == beyond &&
		    gi_vec3d_dot(normal(g->h, w->edge->corner), normal(g->h, e->corner)) >= g->least_cosine)
			return e;
	}
	return NULL;
}

static uint32_t corner_at(const hanger *g, const gi_leaf_edge *e, uint32_t vertex)
{
	return vertex_at(g->h, e->corner) == vertex ? e->corner : next_corner(g->h, e->corner);
}

/* A corner of an edge on another edge. */
static bool hang_on(hanger *g, const way *w, uint32_t corner)
{
	return hang_corner(g, corner, w->ends, share_of(w->a, w->b, position(g->h, vertex_at(g->h, corner))));
}

/* Of two edges that overlap each has an end on the other. */
static bool hang_overlap(hanger *g, const way *w, const gi_leaf_edge *other)
{
	if (is_parted(g, w->edge->corner) || is_parted(g, other->corner))
		return true;
	const way along_other = way_along(g, other, false);
	return hang_on(g, w, corner_at(g, other, w->vertex)) && hang_on(g, &along_other, w->ends[!w->back]);
}

/* Shorter edges on the way, as far as one begins where the other ends. */
static bool walk(hanger *g, way w)
{
	const gi_leaf_edge *e;
	while ((e = next_on(g, &w, false))) {
		const double share = share_of(w.a, w.b, position(g->h, other_end(e, w.vertex)));
		const bool shares = fabs(share - w.share) > SHORTEST && !is_parted(g, e->corner);
		for (int end = 0; end < 2 && shares; end++)
			if (!hang_on(g, &w, end ? next_corner(g->h, e->corner) : e->corner))
				return false;
		w.vertex = other_end(e, w.vertex);
		w.share = share;
	}
	const bool inside = w.share > GI_ON_EDGE && w.share < 1 - GI_ON_EDGE;
	e = inside ? next_on(g, &w, true) : NULL;
	return !e || hang_overlap(g, &w, e);
}

bool gi_drawn_find_hanging(const gi_hierarchy *h, const uint8_t *parted, const gi_leaf_edge *edges, uint32_t count,
			   double least_cosine, void (*join)(uint32_t *group, uint32_t a, uint32_t b), uint32_t *group,
			   gi_hanging_list *out)
{
	hanger g = {.h = h,
		    .parted = parted,
		    .least_cosine = least_cosine,
		    .edges = edges,
		    .join = join,
		    .group = group,
		    .out = out};
	bool enough = list_by_vertex(&g, count);
	for (uint32_t k = 0; k < count && enough; k++)
		if (!gi_drawn_has_partner(edges, count, k))
			enough = walk(&g, way_along(&g, &edges[k], false)) && walk(&g, way_along(&g, &edges[k], true));
	gi_free(g.first);
	gi_free(g.at);
	return enough;
}

/* ---- light vertices ---- */

typedef struct mixer {
	const gi_drawn_surface *drawn;
	const gi_hanging_list *list;
	const uint32_t *light;
	uint32_t *of;  /* by light vertex: the number of what makes it hang, and one; 0: it does not */
	float *weight; /* by leaf, of the one that is being made */
	uint32_t *leaves, leaf_count;
} mixer;

static void add_leaves(mixer *m, uint32_t light, float share)
{
	for (uint32_t k = m->drawn->light_first[light]; k < m->drawn->light_first[light + 1]; k++) {
		const uint32_t leaf = m->drawn->light_leaf[k];
		if (m->weight[leaf] == 0)
			m->leaves[m->leaf_count++] = leaf;
		m->weight[leaf] += share * m->drawn->light_weight[k];
	}
}

typedef struct links {
	uint32_t *leaf;
	float *weight;
	size_t count, capacity;
} links;

static bool add_link(links *l, uint32_t leaf, float weight)
{
	if (l->count == l->capacity) {
		const size_t capacity = l->capacity ? 2 * l->capacity : 64;
		uint32_t *leaves = gi_realloc(l->leaf, capacity * sizeof *leaves);
		l->leaf = leaves ? leaves : l->leaf;
		float *weights = leaves ? gi_realloc(l->weight, capacity * sizeof *weights) : NULL;
		l->weight = weights ? weights : l->weight;
		if (!weights)
			return false;
		l->capacity = capacity;
	}
	l->leaf[l->count] = leaf;
	l->weight[l->count++] = weight;
	return true;
}

static bool take_mixed(mixer *m, links *to)
{
	bool enough = true;
	for (uint32_t k = 0; k < m->leaf_count; k++) {
		const uint32_t leaf = m->leaves[k];
		enough = enough && add_link(to, leaf, m->weight[leaf]);
		m->weight[leaf] = 0;
	}
	m->leaf_count = 0;
	return enough;
}

/* All light vertices anew: what hangs becomes the mean of those at the ends of its edge, as they are. */
static bool mix_once(mixer *m, gi_drawn_surface *drawn)
{
	links to = {0};
	uint32_t *first = gi_calloc((size_t)drawn->light_count + 1, sizeof *first);
	bool enough = first != NULL;
	for (uint32_t light = 0; light < drawn->light_count && enough; light++) {
		const gi_hanging *item = m->of[light] ? &m->list->items[m->of[light] - 1] : NULL;
		add_leaves(m, item ? m->light[item->ends[0]] : light, item ? 1 - item->share : 1);
		if (item)
			add_leaves(m, m->light[item->ends[1]], item->share);
		enough = take_mixed(m, &to);
		first[light + 1] = (uint32_t)to.count;
	}
	gi_free(enough ? drawn->light_first : first);
	gi_free(enough ? drawn->light_leaf : to.leaf);
	gi_free(enough ? drawn->light_weight : to.weight);
	if (enough) {
		drawn->light_first = first;
		drawn->light_leaf = to.leaf;
		drawn->light_weight = to.weight;
	}
	return enough;
}

/* Returns how often to mix: once, but where what hangs hangs between others that do. */
static uint32_t note_hanging(mixer *m)
{
	bool deep = false;
	for (uint32_t k = 0; k < m->list->count; k++) {
		const gi_hanging *item = &m->list->items[k];
		const uint32_t light = m->light[item->corner];
		if (m->of[light] == 0 && light != m->light[item->ends[0]] && light != m->light[item->ends[1]])
			m->of[light] = k + 1;
	}
	for (uint32_t k = 0; k < m->list->count; k++)
		for (int end = 0; end < 2; end++)
			deep = deep || m->of[m->light[m->list->items[k].ends[end]]] != 0;
	return deep ? MOST_TIMES : 1;
}

bool gi_drawn_hang_lights(const gi_hanging_list *list, const uint32_t *light, uint32_t leaf_count,
			  gi_drawn_surface *drawn)
{
	if (list->count == 0)
		return true;
	mixer m = {.drawn = drawn,
		   .list = list,
		   .light = light,
		   .of = gi_calloc((size_t)drawn->light_count + 1, sizeof *m.of),
		   .weight = gi_calloc((size_t)leaf_count + 1, sizeof *m.weight),
		   .leaves = gi_malloc(((size_t)leaf_count + 1) * sizeof *m.leaves)};
	bool enough = m.of && m.weight && m.leaves;
	for (uint32_t times = enough ? note_hanging(&m) : 0; times > 0 && enough; times--)
		enough = mix_once(&m, drawn);
	gi_free(m.of);
	gi_free(m.weight);
	gi_free(m.leaves);
	return enough;
}
