/* The pieces that split.c cuts faces into, the points and lines they are cut at: what its parts share.
 *
 *   split.c          the cage's faces, and how a face is divided
 *   split_points.c   points, one a place
 *   split_pieces.c   shapes, and how one is parted
 *   split_lines.c    lines to cut along, and which of a piece's edges lie on one
 *   split_export.c   nodes as levels of faces
 *   split_count.c    how many leaves there would be
 */
#ifndef GI_SPLIT_PIECES_H
#define GI_SPLIT_PIECES_H

#include "split.h"
#include "vec3d.h"

/* A hundredth more than asked is not worth another row of leaves. */
#define SPLIT_SIZE_SLACK 1.01
/* A triangle is as large as a quad of this part of its longest edge. */
#define SPLIT_TRIANGLE_EDGE 1.42
/* In leaf sizes: lines this near an edge are the edge. */
#define SPLIT_SNAP 1e-3

enum { SPLIT_MAX_CORNERS = 6 };

typedef struct polygon {
	uint32_t count, v[SPLIT_MAX_CORNERS];
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
	gi_stencils *stencils; /* of them; NULL: not wanted */
	uint32_t *component;   /* of each point: points of one place are one where faces are joined */
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

/* ---- points ---- */

/* Room for one more. */
bool split_reserve(void **array, uint32_t count, uint32_t *room, size_t size);

/* Room for one more point and its place in the table. */
bool split_reserve_point(splitter *s);
bool split_grow_table(splitter *s, uint32_t room);

/* The place of a point in the table: where one of its place and component is, or a free one. Where there are stencils
 * it is a sum of the same vertices as point `number` too: what lies in one place at rest need not stay there. */
uint32_t *split_find_place(const splitter *s, gi_vec3d p, uint32_t component, uint32_t number);

/* (a (n - k) + b k) / n: the same from either end. */
uint32_t split_point_between(splitter *s, uint32_t a, uint32_t b, double weight_a, double weight_b);
void split_round_point(gi_vec3d p, float out[3]);

/* ---- pieces ---- */

gi_vec3d split_corner(const splitter *s, const polygon *p, uint32_t k);
double split_edge_length(const splitter *s, const polygon *p, uint32_t k);

/* To the inside of edge k, in the plane. */
gi_vec3d split_inward(const splitter *s, const polygon *p, uint32_t k);
gi_vec3d split_normal(const splitter *s, const polygon *p);

/* Flat, and turning left at every corner as seen against s->normal. */
bool split_is_flat_and_convex(const splitter *s, const polygon *p);
bool split_is_larger_than_leaf(const splitter *s, const polygon *p);

/* Opposite edges are alike: a grid of cells suits it. */
bool split_suits_grid(const splitter *s, const polygon *p);

/* The two sides of a straight line; false where one of them has no area. */
bool split_part_along(splitter *s, const polygon *p, const line *l, polygon sides[2]);

/* At two corners. */
void split_part_in_two(const polygon *p, uint32_t from, uint32_t to, polygon parts[2]);

/* Into halves at the middle of the longest edge, or halves or quarters between rows of cells. Returns how many. */
uint32_t split_part_triangle(splitter *s, const polygon *p, polygon parts[4]);
uint32_t split_part_quad(splitter *s, const polygon *p, polygon parts[4]);

/* ---- lines ---- */

void split_push_line(splitter *s, line_stack *stack, const line *l);

/* Puts what the lines of the stack have inside a polygon, `margin` from its edges, on top of them. Returns where. */
span split_inherit_lines(splitter *s, line_stack *stack, const polygon *p, span of, double margin);

/* The line to part a polygon along next, GI_NONE: none. */
uint32_t split_choose_line(const splitter *s, const polygon *p, span lines);

/* Bit k: edge k lies on one of the lines. */
uint8_t split_parted_edges(const splitter *s, const polygon *p, span around);

/* ---- export ---- */

/* False when memory ran out. `materials`: of the cage's faces; NULL: all 0. */
bool split_export_levels(const splitter *s, const uint32_t *materials, gi_refined *out);
bool split_export_parted(const splitter *s, gi_refined *out);
bool split_export_points(const splitter *s, gi_refined *out);
bool split_export_faces(const splitter *s, gi_refined *out); /* their numbers */

#endif
