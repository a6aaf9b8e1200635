/* Cuts the faces of a bilinear cage into trees of convex pieces (split.h).
 *
 *   cage --gi_refine--> base faces --divide--> nodes, depth-first --export_levels--> gi_refined
 *
 * A piece is cut, in this order: along a line that runs through most of it; into halves or quarters while it is larger
 * than a leaf; along any line that is left. So long walls part a floor at the top of its tree, and short ones cut the
 * leaves under them alone.
 */
#include "split.h"

#include "faces.h"
#include "vec3d.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A hundredth more than asked is not worth another row of leaves. */
#define SIZE_SLACK 1.01
/* A triangle is as large as a quad of this part of its longest edge. */
#define TRIANGLE_EDGE 1.42
/* Lines part a piece before it has the size of a leaf where they cover this much of the way across. */
#define THROUGH 0.6
/* Of two edges. */
#define ALIKE 0.5
/* In leaf sizes: lines this near an edge are the edge, and what is left of a line in a piece must be this long. */
#define SNAP 1e-3
#define SHORTEST 0.05
/* Lines are for shapes this flat: heights over the longest edge. */
#define FLAT 1e-4

enum { MAX_CORNERS = 6, MAX_CUT_DEPTH = 30, MOST_LEAVES = 1 << 24 };

typedef struct polygon {
	uint32_t count, v[MAX_CORNERS];
} polygon;

/* A line in the plane of its face, between two points. */
typedef struct line {
	gi_vec3d from, to;
	bool parts; /* light is not shared across */
} line;

/* Of a stack of lines. */
typedef struct span {
	uint32_t first, end;
} span;

typedef struct line_stack {
	line *lines;
	uint32_t count, room;
} line_stack;

typedef struct split_node {
	uint32_t parent, depth, face;
	uint32_t corners[4]; /* as in gi_refine_level */
	bool leaf;
	uint8_t parted; /* of a leaf: bit k, edge k lies on a line that parts light */
} split_node;

typedef struct splitter {
	const gi_split_def *def;
	gi_vec3d *points;
	uint32_t *component; /* of each point: points of one place are one where faces are joined */
	uint32_t point_count, point_room;
	uint32_t *table, table_room; /* hash of points */
	split_node *nodes;
	uint32_t node_count, node_room, leaf_count, depth;
	line_stack inside; /* lines inside the pieces on the way down */
	line_stack around; /* lines that part light, inside the pieces or on their edges */
	double size;       /* of the leaves of the face at hand */
	gi_vec3d normal;
	uint32_t face;
	bool full; /* out of memory, or too many leaves */
} splitter;

/* Room for one more. */
static bool reserve(void **array, uint32_t count, uint32_t *room, size_t size)
{
	if (count < *room)
		return true;
	const uint32_t more = *room ? 2 * *room : 256;
	void *grown = realloc(*array, size * more);
	if (!grown)
		return false;
	*array = grown;
	*room = more;
	return true;
}

/* ---- points: one a place ---- */

static uint32_t hash_of(const float p[3], uint32_t component)
{
	uint32_t hash = component * 0x9e3779b9u;
	for (int k = 0; k < 3; k++) {
		const float value = p[k] + 0.0f; /* -0 is 0 */
		uint32_t bits;
		memcpy(&bits, &value, sizeof bits);
		hash = (hash ^ bits) * 0x85ebca6bu;
		hash ^= hash >> 15;
	}
	return hash;
}

static void round_point(gi_vec3d p, float out[3])
{
	out[0] = (float)p.x;
	out[1] = (float)p.y;
	out[2] = (float)p.z;
}

/* The place of a point in the table: where one of its place and component is, or a free one. */
static uint32_t *find_place(const splitter *s, gi_vec3d p, uint32_t component)
{
	float at[3], other[3];
	round_point(p, at);
	uint32_t k = hash_of(at, component) & (s->table_room - 1);
	for (; s->table[k] != GI_NONE; k = (k + 1) & (s->table_room - 1)) {
		const uint32_t point = s->table[k];
		round_point(s->points[point], other);
		if (s->component[point] == component && at[0] == other[0] && at[1] == other[1] && at[2] == other[2])
			break;
	}
	return &s->table[k];
}

static bool grow_table(splitter *s, uint32_t room)
{
	uint32_t *table = malloc(sizeof *table * room);
	if (!table)
		return false;
	memset(table, 0xff, sizeof *table * room);
	free(s->table);
	s->table = table;
	s->table_room = room;
	for (uint32_t k = 0; k < s->point_count; k++) {
		uint32_t *place = find_place(s, s->points[k], s->component[k]);
		if (*place == GI_NONE)
			*place = k;
	}
	return true;
}

static bool reserve_point(splitter *s)
{
	uint32_t room = s->point_room;
	return reserve((void **)&s->points, s->point_count, &room, sizeof *s->points) &&
	       reserve((void **)&s->component, s->point_count, &s->point_room, sizeof *s->component) &&
	       (2 * s->point_count < s->table_room || grow_table(s, 2 * s->table_room));
}

static uint32_t add_point(splitter *s, gi_vec3d p, uint32_t component)
{
	if (s->full || !reserve_point(s)) {
		s->full = true;
		return 0;
	}
	uint32_t *place = find_place(s, p, component);
	if (*place != GI_NONE)
		return *place;
	s->points[s->point_count] = p;
	s->component[s->point_count] = component;
	return *place = s->point_count++;
}

/* (a (n - k) + b k) / n: the same from either end. */
static uint32_t point_between(splitter *s, uint32_t a, uint32_t b, double weight_a, double weight_b)
{
	const gi_vec3d sum =
	    gi_vec3d_add(gi_vec3d_scale(s->points[a], weight_a), gi_vec3d_scale(s->points[b], weight_b));
	return add_point(s, gi_vec3d_scale(sum, 1 / (weight_a + weight_b)), s->component[a]);
}

/* ---- polygons ---- */

static gi_vec3d corner(const splitter *s, const polygon *p, uint32_t k)
{
	return s->points[p->v[k % p->count]];
}

static double edge_length(const splitter *s, const polygon *p, uint32_t k)
{
	return gi_vec3d_length(gi_vec3d_sub(corner(s, p, k + 1), corner(s, p, k)));
}

/* To the inside of edge k, in the plane. */
static gi_vec3d inward(const splitter *s, const polygon *p, uint32_t k)
{
	return gi_vec3d_unit(gi_vec3d_cross(s->normal, gi_vec3d_sub(corner(s, p, k + 1), corner(s, p, k))));
}

static gi_vec3d polygon_normal(const splitter *s, const polygon *p)
{
	const gi_vec3d sum = gi_vec3d_triangle(corner(s, p, 0), corner(s, p, 1), corner(s, p, 2));
	return gi_vec3d_unit(
	    p->count == 3 ? sum
			  : gi_vec3d_add(sum, gi_vec3d_triangle(corner(s, p, 0), corner(s, p, 2), corner(s, p, 3))));
}

/* Flat, and turning left at every corner as seen against s->normal. */
static bool is_flat_and_convex(const splitter *s, const polygon *p)
{
	double longest = 0;
	for (uint32_t k = 0; k < p->count; k++)
		longest = fmax(longest, edge_length(s, p, k));
	for (uint32_t k = 0; k < p->count; k++) {
		const gi_vec3d from = gi_vec3d_sub(corner(s, p, k), corner(s, p, 0));
		const gi_vec3d next = gi_vec3d_sub(corner(s, p, k + 2), corner(s, p, k));
		if (fabs(gi_vec3d_dot(from, s->normal)) > FLAT * longest ||
		    gi_vec3d_dot(inward(s, p, k), next) <= FLAT * longest)
			return false;
	}
	return true;
}

/* How many cells of the size lie along edges k and k + 2 of a quad. */
static double cells(const splitter *s, const polygon *p, uint32_t k)
{
	const double length = (edge_length(s, p, k) + edge_length(s, p, k + 2)) / 2;
	return fmax(1, ceil(length / (SIZE_SLACK * s->size) - 1e-9));
}

static uint32_t longest_edge(const splitter *s, const polygon *p)
{
	uint32_t longest = 0;
	for (uint32_t k = 1; k < p->count; k++)
		if (edge_length(s, p, k) > (1 + GI_TIE) * edge_length(s, p, longest))
			longest = k;
	return longest;
}

static bool is_larger_than_leaf(const splitter *s, const polygon *p)
{
	if (p->count == 3)
		return edge_length(s, p, longest_edge(s, p)) > TRIANGLE_EDGE * SIZE_SLACK * s->size;
	return cells(s, p, 0) > 1 || cells(s, p, 1) > 1;
}

/* ---- lines ---- */

/* The part of a line, from t[0] to t[1], inside a polygon and `margin` from its edges; false: none. */
static bool clip(const splitter *s, const polygon *p, const line *l, double margin, double t[2])
{
	for (uint32_t k = 0; k < p->count; k++) {
		const gi_vec3d in = inward(s, p, k), a = corner(s, p, k);
		const double from = gi_vec3d_dot(in, gi_vec3d_sub(l->from, a)) - margin,
			     to = gi_vec3d_dot(in, gi_vec3d_sub(l->to, a)) - margin;
		const double slope = to - from;
		if (fabs(slope) <= 1e-12 * (fabs(from) + fabs(to) + margin)) {
			if (from < 0)
				return false;
		} else if (slope > 0) {
			t[0] = fmax(t[0], -from / slope);
		} else {
			t[1] = fmin(t[1], -from / slope);
		}
	}
	return t[0] < t[1];
}

static gi_vec3d along(const line *l, double t)
{
	return gi_vec3d_add(l->from, gi_vec3d_scale(gi_vec3d_sub(l->to, l->from), t));
}

static double line_length(const line *l)
{
	return gi_vec3d_length(gi_vec3d_sub(l->to, l->from));
}

static void push_line(splitter *s, line_stack *stack, const line *l)
{
	if (reserve((void **)&stack->lines, stack->count, &stack->room, sizeof *stack->lines))
		stack->lines[stack->count++] = *l;
	else
		s->full = true;
}

/* Puts what the lines of the stack have inside a polygon, `margin` from its edges, on top of them. Returns where. */
static span inherit_lines(splitter *s, line_stack *stack, const polygon *p, span of, double margin)
{
	const uint32_t first = stack->count;
	for (uint32_t k = of.first; k < of.end && !s->full; k++) {
		const line l = stack->lines[k];
		double t[2] = {0, 1};
		if (!clip(s, p, &l, margin, t) || (t[1] - t[0]) * line_length(&l) < SHORTEST * s->size)
			continue;
		push_line(s, stack, &(line){along(&l, t[0]), along(&l, t[1]), l.parts});
	}
	return (span){first, stack->count};
}

/* Does edge k of a polygon lie on a line: its ends in one with it, its middle between the line's ends? */
static bool lies_on(const splitter *s, const polygon *p, uint32_t k, const line *l)
{
	const gi_vec3d direction = gi_vec3d_unit(gi_vec3d_sub(l->to, l->from)),
		       side = gi_vec3d_cross(s->normal, direction);
	const gi_vec3d a = gi_vec3d_sub(corner(s, p, k), l->from), b = gi_vec3d_sub(corner(s, p, k + 1), l->from);
	/* Where a cut was made within SNAP of a corner the edge ends there. */
	const double near = 2 * SNAP * s->size;
	const double middle = 0.5 * (gi_vec3d_dot(a, direction) + gi_vec3d_dot(b, direction));
	return fabs(gi_vec3d_dot(a, side)) <= near && fabs(gi_vec3d_dot(b, side)) <= near && middle > 0 &&
	       middle < line_length(l);
}

static uint8_t parted_edges(const splitter *s, const polygon *p, span around)
{
	uint8_t parted = 0;
	for (uint32_t l = around.first; l < around.end; l++)
		for (uint32_t k = 0; k < p->count; k++)
			parted |= lies_on(s, p, k, &s->around.lines[l]) ? 1u << k : 0u;
	return parted;
}

/* How much of the way across a polygon the lines cover that lie in one with a given one. Parts that overlap count once:
 * the longest way from the first start to the last end, less the gaps, is what a sweep in order of starts finds. */
static double covered(const splitter *s, const polygon *p, span lines, const line *on)
{
	const gi_vec3d direction = gi_vec3d_unit(gi_vec3d_sub(on->to, on->from)),
		       side = gi_vec3d_cross(s->normal, direction);
	double reached = -INFINITY, sum = 0;
	for (;;) {
		double start = INFINITY, end = 0;
		for (uint32_t k = lines.first; k < lines.end; k++) {
			const gi_vec3d a = gi_vec3d_sub(s->inside.lines[k].from, on->from),
				       b = gi_vec3d_sub(s->inside.lines[k].to, on->from);
			const double u = gi_vec3d_dot(a, direction), v = gi_vec3d_dot(b, direction);
			const double from = fmax(fmin(u, v), reached), to = fmax(u, v);
			if (fabs(gi_vec3d_dot(a, side)) > SNAP * s->size ||
			    fabs(gi_vec3d_dot(b, side)) > SNAP * s->size || to <= reached || from > start ||
			    (from == start && to <= end))
				continue;
			start = from;
			end = to;
		}
		if (start == INFINITY)
			break;
		sum += end - start;
		reached = end;
	}
	double t[2] = {-INFINITY, INFINITY};
	const line whole = {.from = on->from, .to = gi_vec3d_add(on->from, direction)};
	return clip(s, p, &whole, 0, t) ? sum / (t[1] - t[0]) : 0;
}

/* The line to part a polygon along next, GI_NONE: none. */
static uint32_t choose_line(const splitter *s, const polygon *p, span lines)
{
	enum { CANDIDATES = 64 }; /* each looks at all */
	const double least = is_larger_than_leaf(s, p) ? THROUGH : 0;
	double most = 0;
	uint32_t best = GI_NONE;
	for (uint32_t k = lines.first; k < lines.end && k < lines.first + CANDIDATES; k++) {
		const double part = covered(s, p, lines, &s->inside.lines[k]);
		if (part >= least && part > most * (1 + GI_TIE)) {
			most = part;
			best = k;
		}
	}
	return best;
}

/* ---- division ---- */

static void add_corner(polygon *p, uint32_t v)
{
	if (p->count < MAX_CORNERS)
		p->v[p->count++] = v;
}

/* The two sides of a straight line; false where one of them has no area. */
static bool part_along(splitter *s, const polygon *p, const line *l, polygon sides[2])
{
	const gi_vec3d side = gi_vec3d_unit(gi_vec3d_cross(s->normal, gi_vec3d_sub(l->to, l->from)));
	double height[MAX_CORNERS];
	for (uint32_t k = 0; k < p->count; k++) {
		height[k] = gi_vec3d_dot(side, gi_vec3d_sub(corner(s, p, k), l->from));
		height[k] = fabs(height[k]) <= SNAP * s->size ? 0 : height[k];
	}
	sides[0].count = sides[1].count = 0;
	for (uint32_t k = 0; k < p->count; k++) {
		const uint32_t next = (k + 1) % p->count;
		if (height[k] >= 0)
			add_corner(&sides[0], p->v[k]);
		if (height[k] <= 0)
			add_corner(&sides[1], p->v[k]);
		if (height[k] * height[next] < 0) {
			const uint32_t v = point_between(s, p->v[k], p->v[next], fabs(height[next]), fabs(height[k]));
			add_corner(&sides[0], v);
			add_corner(&sides[1], v);
		}
	}
	return sides[0].count >= 3 && sides[1].count >= 3;
}

static void part_in_two(const polygon *p, uint32_t from, uint32_t to, polygon parts[2])
{
	parts[0].count = parts[1].count = 0;
	for (uint32_t k = from; k <= to; k++)
		add_corner(&parts[0], p->v[k]);
	for (uint32_t k = to; k <= from + p->count; k++)
		add_corner(&parts[1], p->v[k % p->count]);
}

/* Halves a triangle at the middle of its longest edge. */
static uint32_t part_triangle(splitter *s, const polygon *p, polygon parts[4])
{
	const uint32_t k = longest_edge(s, p), a = p->v[k], b = p->v[(k + 1) % 3], c = p->v[(k + 2) % 3];
	const uint32_t middle = point_between(s, a, b, 1, 1);
	parts[0] = (polygon){3, {a, middle, c}};
	parts[1] = (polygon){3, {middle, b, c}};
	return 2;
}

/* Between rows of cells near the middle, in both directions where there is more than one. */
static uint32_t part_quad(splitter *s, const polygon *p, polygon parts[4])
{
	const uint32_t a = p->v[0], b = p->v[1], c = p->v[2], d = p->v[3];
	const double n = cells(s, p, 0), m = cells(s, p, 1), i = floor(n / 2), j = floor(m / 2);
	if (m == 1) {
		const uint32_t ab = point_between(s, a, b, n - i, i), dc = point_between(s, d, c, n - i, i);
		parts[0] = (polygon){4, {a, ab, dc, d}};
		parts[1] = (polygon){4, {ab, b, c, dc}};
		return 2;
	}
	const uint32_t ad = point_between(s, a, d, m - j, j), bc = point_between(s, b, c, m - j, j);
	if (n == 1) {
		parts[0] = (polygon){4, {a, b, bc, ad}};
		parts[1] = (polygon){4, {ad, bc, c, d}};
		return 2;
	}
	const uint32_t ab = point_between(s, a, b, n - i, i), dc = point_between(s, d, c, n - i, i),
		       middle = point_between(s, ad, bc, n - i, i);
	parts[0] = (polygon){4, {a, ab, middle, ad}};
	parts[1] = (polygon){4, {ab, b, bc, middle}};
	parts[2] = (polygon){4, {middle, bc, c, dc}};
	parts[3] = (polygon){4, {ad, middle, dc, d}};
	return 4;
}

/* Opposite edges are alike: a grid of cells suits it. */
static bool suits_grid(const splitter *s, const polygon *p)
{
	for (uint32_t k = 0; k < 2; k++) {
		const double a = edge_length(s, p, k), b = edge_length(s, p, k + 2);
		if (fmin(a, b) < ALIKE * fmax(a, b))
			return false;
	}
	return p->count == 4;
}

/* A slanted line through a large quad would leave two of which no grid has cells alike: there it cuts cells alone. */
static bool part_by_line(splitter *s, const polygon *p, span lines, polygon parts[2])
{
	const uint32_t l = choose_line(s, p, lines);
	if (l == GI_NONE)
		return false;
	const line chosen = s->inside.lines[l];
	return part_along(s, p, &chosen, parts) &&
	       (!is_larger_than_leaf(s, p) || p->count == 3 || (suits_grid(s, &parts[0]) && suits_grid(s, &parts[1])));
}

/* The parts of a polygon, 0: it is a leaf. */
static uint32_t part(splitter *s, const polygon *p, uint32_t depth, span lines, polygon parts[4])
{
	if (p->count > 4) {
		part_in_two(p, 0, p->count / 2, parts);
		return 2;
	}
	if (depth < MAX_CUT_DEPTH && part_by_line(s, p, lines, parts))
		return 2;
	if (!is_larger_than_leaf(s, p))
		return 0;
	return p->count == 3 ? part_triangle(s, p, parts) : part_quad(s, p, parts);
}

static uint32_t add_node(splitter *s, const polygon *p, uint32_t parent, uint32_t depth)
{
	if (s->full || !reserve((void **)&s->nodes, s->node_count, &s->node_room, sizeof *s->nodes) ||
	    s->leaf_count >= MOST_LEAVES || depth >= GI_SPLIT_MAX_LEVELS) {
		s->full = true;
		return 0;
	}
	split_node *n = &s->nodes[s->node_count];
	*n = (split_node){.parent = parent, .depth = depth, .face = s->face};
	for (uint32_t k = 0; k < 4; k++)
		n->corners[k] = p->count > 4 ? UINT32_MAX : p->v[k < p->count ? k : p->count - 1];
	s->depth = depth > s->depth ? depth : s->depth;
	return s->node_count++;
}

/* `inside` and `around`: the parent's lines. */
static void divide(splitter *s, const polygon *p, uint32_t parent, uint32_t depth, span inside, span around)
{
	const uint32_t node = add_node(s, p, parent, depth);
	if (s->full)
		return;
	const span own = inherit_lines(s, &s->inside, p, inside, SNAP * s->size),
		   near = inherit_lines(s, &s->around, p, around, -SNAP * s->size);
	polygon parts[4];
	const uint32_t count = part(s, p, depth, own, parts);
	s->nodes[node].leaf = count == 0;
	s->nodes[node].parted = count == 0 ? parted_edges(s, p, near) : 0;
	s->leaf_count += count == 0;
	for (uint32_t k = 0; k < count && !s->full; k++)
		divide(s, &parts[k], node, depth + 1, own, near);
	s->inside.count = own.first;
	s->around.count = near.first;
}

/* ---- the cage ---- */

/* A cut's line in the plane of a face. */
static line project(const splitter *s, const polygon *p, const gi_leaf_cut *cut, const float scale[3])
{
	gi_vec3d ends[2] = {gi_vec3d_load(cut->from), gi_vec3d_load(cut->to)};
	for (int k = 0; k < 2; k++) {
		ends[k] = (gi_vec3d){ends[k].x * scale[0], ends[k].y * scale[1], ends[k].z * scale[2]};
		const double height = gi_vec3d_dot(s->normal, gi_vec3d_sub(ends[k], corner(s, p, 0)));
		ends[k] = gi_vec3d_sub(ends[k], gi_vec3d_scale(s->normal, height));
	}
	return (line){ends[0], ends[1], cut->parts};
}

/* `order`: the cuts by face; the face's begin at *next. */
static void divide_face(splitter *s, const polygon *p, uint32_t parent, uint32_t depth, const uint32_t *order,
			uint32_t next, const float scale[3])
{
	const gi_split_def *def = s->def;
	const float own = def->leaf_sizes ? def->leaf_sizes[s->face] : 0;
	s->size = own > 0 ? own : def->leaf_size;
	s->normal = polygon_normal(s, p);
	s->inside.count = s->around.count = 0;
	const bool cut = is_flat_and_convex(s, p);
	for (; cut && next < def->cut_count && def->cuts[order[next]].face == s->face && !s->full; next++) {
		const line l = project(s, p, &def->cuts[order[next]], scale);
		push_line(s, &s->inside, &l);
		if (l.parts)
			push_line(s, &s->around, &l);
	}
	divide(s, p, parent, depth, (span){0, s->inside.count}, (span){0, s->around.count});
}

/* A counting sort. offsets: face_count + 1, where each face's cuts begin. */
static void sort_cuts(const gi_split_def *def, uint32_t face_count, uint32_t *offsets, uint32_t *order)
{
	memset(offsets, 0, sizeof *offsets * ((size_t)face_count + 1));
	for (uint32_t k = 0; k < def->cut_count; k++)
		offsets[def->cuts[k].face + 1]++;
	for (uint32_t k = 0; k < face_count; k++)
		offsets[k + 1] += offsets[k];
	for (uint32_t k = def->cut_count; k-- > 0;)
		order[--offsets[def->cuts[k].face + 1]] = k;
	memmove(offsets, offsets + 1, sizeof *offsets * face_count);
}

static polygon polygon_of(const uint32_t corners[4])
{
	return (polygon){corners[2] == corners[3] ? 3 : 4, {corners[0], corners[1], corners[2], corners[3]}};
}

/* Points of the base, each in the component of those it is joined with by faces. */
static bool take_points(splitter *s, const gi_refined *base)
{
	const gi_refine_level *finest = &base->levels[base->level_count - 1];
	uint32_t *group = malloc(sizeof *group * base->vertex_count);
	uint32_t room = 256;
	while (room < 4 * base->vertex_count)
		room *= 2;
	if (!group || !grow_table(s, room)) {
		free(group);
		return false;
	}
	for (uint32_t k = 0; k < base->vertex_count; k++)
		group[k] = k;
	for (uint32_t face = 0; face < finest->face_count; face++)
		for (int k = 1; k < 4; k++)
			gi_join(group, finest->corners[face][k], finest->corners[face][0]);
	for (uint32_t k = 0; k < base->vertex_count && !s->full; k++) {
		if (!reserve_point(s)) {
			s->full = true;
			break;
		}
		/* Points of the cage stay apart where the cage has them apart. */
		s->points[k] = gi_vec3d_load(base->positions[k]);
		s->component[k] = gi_group_of(group, k);
		uint32_t *place = find_place(s, s->points[k], s->component[k]);
		s->point_count++;
		if (*place == GI_NONE)
			*place = k;
	}
	free(group);
	return !s->full;
}

/* Faces of the base, whose materials are numbers of faces of the cage; a face of more than four corners has its quads
 * below it. */
static void divide_all(splitter *s, const gi_refined *base, const uint32_t *offsets, const uint32_t *order,
		       const float scale[3])
{
	const gi_refine_level *top = &base->levels[0];
	if (base->level_count == 1) {
		for (uint32_t face = 0; face < top->face_count && !s->full; face++) {
			const polygon p = polygon_of(top->corners[face]);
			s->face = top->material[face];
			divide_face(s, &p, GI_NONE, 0, order, offsets[s->face], scale);
		}
		return;
	}
	const gi_refine_level *quads = &base->levels[1];
	for (uint32_t face = 0; face < top->face_count && !s->full; face++) {
		s->face = top->material[face];
		const polygon whole =
		    top->corners[face][0] == UINT32_MAX ? (polygon){.count = 5} : polygon_of(top->corners[face]);
		add_node(s, &whole, GI_NONE, 0);
	}
	for (uint32_t quad = 0; quad < quads->face_count && !s->full; quad++) {
		const polygon p = polygon_of(quads->corners[quad]);
		s->face = quads->material[quad];
		divide_face(s, &p, quads->parent[quad], 1, order, offsets[s->face], scale);
	}
}

/* ---- how many ---- */

static gi_vec3d cage_point(const gi_refine_cage *cage, uint32_t index)
{
	const float *p = cage->positions + 3 * (size_t)cage->indices[index];
	return (gi_vec3d){(double)p[0] * cage->scale[0], (double)p[1] * cage->scale[1], (double)p[2] * cage->scale[2]};
}

static double cage_edge(const gi_refine_cage *cage, uint32_t from, uint32_t to)
{
	return gi_vec3d_length(gi_vec3d_sub(cage_point(cage, to), cage_point(cage, from)));
}

/* By area, and not fewer than its longest edge takes. */
static double estimate_polygon(const gi_refine_cage *cage, uint32_t first, uint32_t count, double size)
{
	gi_vec3d moment = {0};
	double longest = 0;
	for (uint32_t k = 0; k < count; k++) {
		longest = fmax(longest, cage_edge(cage, first + k, first + (k + 1) % count));
		if (k >= 2)
			moment = gi_vec3d_add(moment, gi_vec3d_triangle(cage_point(cage, first),
									cage_point(cage, first + k - 1),
									cage_point(cage, first + k)));
	}
	return fmax(gi_vec3d_length(moment) / (0.75 * size * size),
		    fmax(count == 3 ? 1 : count, longest / (TRIANGLE_EDGE * size)));
}

static double estimate_quad(const gi_refine_cage *cage, uint32_t first, double size)
{
	const double n = (cage_edge(cage, first, first + 1) + cage_edge(cage, first + 2, first + 3)) / 2,
		     m = (cage_edge(cage, first + 1, first + 2) + cage_edge(cage, first + 3, first)) / 2;
	return fmax(1, ceil(n / (SIZE_SLACK * size) - 1e-9)) * fmax(1, ceil(m / (SIZE_SLACK * size) - 1e-9));
}

double gi_split_estimate(const gi_refine_cage *cage, const gi_split_def *def)
{
	double sum = 0;
	for (uint32_t face = 0, first = 0; face < cage->face_count; face++) {
		const uint32_t count = gi_corner_count(cage->face_counts, face);
		const double own = def->leaf_sizes ? def->leaf_sizes[face] : 0, size = own > 0 ? own : def->leaf_size;
		sum += count == 4 ? estimate_quad(cage, first, size) : estimate_polygon(cage, first, count, size);
		first += count;
	}
	return sum;
}

/* ---- export ---- */

static bool allocate_level(gi_refine_level *to, uint32_t count, bool top)
{
	to->face_count = count;
	to->corners = malloc(sizeof *to->corners * (count + 1));
	to->material = malloc(sizeof *to->material * (count + 1));
	to->parent = top ? NULL : malloc(sizeof *to->parent * (count + 1));
	return to->corners && to->material && (top || to->parent);
}

static bool is_on_level(const split_node *n, uint32_t level)
{
	return n->depth == level || (n->leaf && n->depth < level);
}

/* place[k]: number of node k on the level above, then on this one. */
static bool export_level(const splitter *s, uint32_t level, uint32_t *place, const uint32_t *materials,
			 gi_refine_level *to)
{
	uint32_t count = 0;
	for (uint32_t k = 0; k < s->node_count; k++)
		count += is_on_level(&s->nodes[k], level);
	if (!allocate_level(to, count, level == 0))
		return false;
	count = 0;
	for (uint32_t k = 0; k < s->node_count; k++) {
		const split_node *n = &s->nodes[k];
		if (!is_on_level(n, level))
			continue;
		memcpy(to->corners[count], n->corners, sizeof n->corners);
		to->material[count] = materials ? materials[n->face] : 0;
		if (level > 0)
			to->parent[count] = n->depth == level ? n->parent : k;
		count++;
	}
	/* Nodes come before their children, so no parent's place is lost before it was asked for. */
	for (uint32_t k = 0; level > 0 && k < count; k++)
		to->parent[k] = place[to->parent[k]];
	count = 0;
	for (uint32_t k = 0; k < s->node_count; k++)
		if (is_on_level(&s->nodes[k], level))
			place[k] = count++;
	return true;
}

static bool export_levels(const splitter *s, const uint32_t *materials, gi_refined *out)
{
	uint32_t *place = malloc(sizeof *place * (s->node_count + 1));
	out->levels = calloc(s->depth + 1, sizeof *out->levels);
	bool enough = place && out->levels;
	for (; enough && out->level_count <= s->depth; out->level_count++)
		enough = export_level(s, out->level_count, place, materials, &out->levels[out->level_count]);
	free(place);
	return enough;
}

/* The finest level's. */
static bool export_parted(const splitter *s, gi_refined *out)
{
	const uint32_t finest = out->level_count - 1;
	out->parted = malloc(out->levels[finest].face_count + 1);
	if (!out->parted)
		return false;
	uint32_t count = 0;
	for (uint32_t k = 0; k < s->node_count; k++)
		if (is_on_level(&s->nodes[k], finest))
			out->parted[count++] = s->nodes[k].parted;
	return true;
}

static bool export_points(const splitter *s, gi_refined *out)
{
	out->vertex_count = s->point_count;
	out->positions = malloc(sizeof *out->positions * (s->point_count + 1));
	out->normals = calloc(s->point_count + 1, sizeof *out->normals);
	if (!out->positions || !out->normals)
		return false;
	for (uint32_t k = 0; k < s->point_count; k++)
		round_point(s->points[k], out->positions[k]);
	return true;
}

static void free_splitter(splitter *s)
{
	free(s->points);
	free(s->component);
	free(s->table);
	free(s->nodes);
	free(s->inside.lines);
	free(s->around.lines);
}

static bool split(splitter *s, const gi_refine_cage *cage, const gi_refined *base, gi_refined *out)
{
	uint32_t *offsets = malloc(sizeof *offsets * ((size_t)cage->face_count + 1));
	uint32_t *order = malloc(sizeof *order * ((size_t)s->def->cut_count + 1));
	bool done = offsets && order && take_points(s, base);
	if (done) {
		sort_cuts(s->def, cage->face_count, offsets, order);
		divide_all(s, base, offsets, order, cage->scale);
		done = !s->full && export_levels(s, cage->face_materials, out) && export_parted(s, out) &&
		       export_points(s, out);
	}
	out->closed = base->closed;
	free(offsets);
	free(order);
	return done;
}

bool gi_split(const gi_refine_cage *cage, const gi_split_def *def, gi_refined *out, char *message, size_t message_size)
{
	*out = (gi_refined){0};
	/* Faces without area are dropped: their numbers travel in the materials' place. */
	uint32_t *numbers = malloc(sizeof *numbers * ((size_t)cage->face_count + 1));
	for (uint32_t k = 0; numbers && k < cage->face_count; k++)
		numbers[k] = k;
	gi_refine_cage numbered = *cage;
	numbered.face_materials = numbers;
	gi_refined base = {0};
	snprintf(message, message_size, "out of memory");
	const bool refined = numbers && gi_refine(&numbered, 0, &base, message, message_size);
	bool done = refined, memory = !numbers || base.out_of_memory;
	if (refined) {
		splitter s = {.def = def};
		done = split(&s, cage, &base, out);
		memory = s.leaf_count < MOST_LEAVES;
		if (!done)
			snprintf(message, message_size, memory ? "out of memory" : "there would be more than %d leaves",
				 MOST_LEAVES);
		free_splitter(&s);
	}
	gi_refined_free(&base);
	free(numbers);
	if (!done) {
		gi_refined_free(out);
		out->out_of_memory = memory;
	}
	return done;
}
