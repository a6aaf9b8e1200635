#include "drawn_seams.h"

#include "drawn_build.h"
#include "host_memory.h"
#include "vec3d.h"

#include <math.h>
#include <stdlib.h>

/* A vertex where an edge without a partner ends. */
typedef struct candidate {
	double along; /* its coordinate on the sweep's axis */
	uint32_t vertex;
} candidate;

typedef struct seamer {
	const gi_hierarchy *h;
	int axis;
	candidate *candidates;
	uint32_t count;
	gi_seams *out;
} seamer;

static double coordinate(gi_vec3d v, int axis)
{
	return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static int by_place(const void *a, const void *b)
{
	const candidate *x = a, *y = b;
	if (x->along != y->along)
		return x->along < y->along ? -1 : 1;
	return (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

static int by_corner(const void *a, const void *b)
{
	const gi_seam_point *x = a, *y = b;
	if (x->corner != y->corner)
		return x->corner < y->corner ? -1 : 1;
	if (x->share != y->share)
		return x->share < y->share ? -1 : 1;
	return (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

/* The axis along which those vertices are spread the most. */
static int widest_axis(const seamer *s)
{
	int widest = 0;
	double most = -1;
	for (int axis = 0; axis < 3; axis++) {
		double low = HUGE_VAL, high = -HUGE_VAL;
		for (uint32_t k = 0; k < s->count; k++) {
			const double at = coordinate(vertex_position(s->h, s->candidates[k].vertex), axis);
			low = fmin(low, at);
			high = fmax(high, at);
		}
		if (high - low > most) {
			most = high - low;
			widest = axis;
		}
	}
	return widest;
}

/* Ends of edges without a partner, each once, in the order of the sweep. */
static bool list_candidates(seamer *s, const gi_leaf_edge *edges, uint32_t count)
{
	s->candidates = gi_malloc(sizeof *s->candidates * (2 * (size_t)count + 1));
	if (!s->candidates)
		return false;
	for (uint32_t k = 0; k < count; k++)
		if (!gi_drawn_has_partner(edges, count, k)) {
			s->candidates[s->count++].vertex = edges[k].low;
			s->candidates[s->count++].vertex = edges[k].high;
		}
	s->axis = widest_axis(s);
	for (uint32_t k = 0; k < s->count; k++)
		s->candidates[k].along = coordinate(vertex_position(s->h, s->candidates[k].vertex), s->axis);
	if (s->count)
		qsort(s->candidates, s->count, sizeof *s->candidates, by_place);
	uint32_t kept = 0;
	for (uint32_t k = 0; k < s->count; k++)
		if (k == 0 || s->candidates[k].vertex != s->candidates[k - 1].vertex)
			s->candidates[kept++] = s->candidates[k];
	s->count = kept;
	return true;
}

/* The first candidate that is not before a place. */
static uint32_t first_from(const seamer *s, double along)
{
	uint32_t low = 0, high = s->count;
	while (low < high) {
		const uint32_t middle = low + (high - low) / 2;
		if (s->candidates[middle].along < along)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

static bool add_point(gi_seams *out, gi_seam_point point)
{
	if (out->count == out->capacity) {
		const uint32_t capacity = out->capacity ? 2 * out->capacity : 64;
		gi_seam_point *grown = gi_realloc(out->points, capacity * sizeof *grown);
		if (!grown)
			return false;
		out->points = grown;
		out->capacity = capacity;
	}
	out->points[out->count++] = point;
	return true;
}

static bool search_edge(const seamer *s, const gi_leaf_edge *edge)
{
	const quad q = leaf_quad(s->h, edge->corner / 4);
	const uint32_t k = edge->corner % 4;
	const gi_vec3d a = vertex_position(s->h, q.v[k]),
		       way = gi_vec3d_sub(vertex_position(s->h, q.v[(k + 1) % q.count]), a);
	const double length2 = gi_vec3d_dot(way, way), from = coordinate(a, s->axis), by = coordinate(way, s->axis);
	const double slack = GI_ON_EDGE * sqrt(length2), last = fmax(from, from + by) + slack;
	for (uint32_t i = first_from(s, fmin(from, from + by) - slack); i < s->count && s->candidates[i].along <= last;
	     i++) {
		const gi_vec3d to = gi_vec3d_sub(vertex_position(s->h, s->candidates[i].vertex), a);
		const double share = gi_vec3d_dot(way, to) / length2;
		const gi_vec3d off = gi_vec3d_sub(to, gi_vec3d_scale(way, share));
		const bool on = share > GI_ON_EDGE && share < 1 - GI_ON_EDGE && gi_vec3d_dot(off, off) <= slack * slack;
		if (on && !add_point(s->out, (gi_seam_point){edge->corner, s->candidates[i].vertex, (float)share}))
			return false;
	}
	return true;
}

static bool is_same_place(const gi_hierarchy *h, const gi_seam_point *a, const gi_seam_point *b)
{
	const gi_vec3d apart = gi_vec3d_sub(vertex_position(h, a->vertex), vertex_position(h, b->vertex));
	return a->corner == b->corner && gi_vec3d_dot(apart, apart) == 0;
}

bool gi_drawn_find_seams(const gi_hierarchy *h, const gi_leaf_edge *edges, uint32_t count, gi_seams *out)
{
	seamer s = {.h = h, .out = out};
	bool enough = list_candidates(&s, edges, count);
	for (uint32_t k = 0; enough && k < count; k++)
		if (!gi_drawn_has_partner(edges, count, k))
			enough = search_edge(&s, &edges[k]);
	gi_free(s.candidates);
	if (!enough || !out->count)
		return enough;
	qsort(out->points, out->count, sizeof *out->points, by_corner);
	uint32_t kept = 0;
	for (uint32_t k = 0; k < out->count; k++)
		if (k == 0 || !is_same_place(h, &out->points[k], &out->points[kept - 1]))
			out->points[kept++] = out->points[k];
	out->count = kept;
	return true;
}
