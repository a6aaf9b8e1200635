/* Lines that faces are cut along: what of them lies in a piece, which cuts it next, which run along its edges. */
#include "split_pieces.h"

/* Lines part a piece before it has the size of a leaf where they cover this much of the way across. */
#define THROUGH 0.6
/* In leaf sizes: what is left of a line in a piece must be this long. */
#define SHORTEST (1 / 64.0)

/* The part of a line, from t[0] to t[1], inside a polygon and `margin` from its edges; false: none. */
static bool clip(const splitter *s, const polygon *p, const line *l, double margin, double t[2])
{
	for (uint32_t k = 0; k < p->count; k++) {
		const gi_vec3d in = split_inward(s, p, k), a = split_corner(s, p, k);
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

void split_push_line(splitter *s, line_stack *stack, const line *l)
{
	if (split_reserve((void **)&stack->lines, stack->count, &stack->room, sizeof *stack->lines))
		stack->lines[stack->count++] = *l;
	else
		s->full = true;
}

/* Puts what the lines of the stack have inside a polygon, `margin` from its edges, on top of them. Returns where. */
span split_inherit_lines(splitter *s, line_stack *stack, const polygon *p, span of, double margin)
{
	const uint32_t first = stack->count;
	for (uint32_t k = of.first; k < of.end && !s->full; k++) {
		const line l = stack->lines[k];
		double t[2] = {0, 1};
		if (!clip(s, p, &l, margin, t) || (t[1] - t[0]) * line_length(&l) < SHORTEST * s->size)
			continue;
		split_push_line(s, stack, &(line){along(&l, t[0]), along(&l, t[1]), l.parts});
	}
	return (span){first, stack->count};
}

/* Does edge k of a polygon lie on a line: its ends in one with it, its middle between the line's ends? */
static bool lies_on(const splitter *s, const polygon *p, uint32_t k, const line *l)
{
	const gi_vec3d direction = gi_vec3d_unit(gi_vec3d_sub(l->to, l->from)),
		       side = gi_vec3d_cross(s->normal, direction);
	const gi_vec3d a = gi_vec3d_sub(split_corner(s, p, k), l->from),
		       b = gi_vec3d_sub(split_corner(s, p, k + 1), l->from);
	/* Where a cut was made within SPLIT_SNAP of a corner the edge ends there. */
	const double near = 2 * SPLIT_SNAP * s->size;
	const double middle = 0.5 * (gi_vec3d_dot(a, direction) + gi_vec3d_dot(b, direction));
	return fabs(gi_vec3d_dot(a, side)) <= near && fabs(gi_vec3d_dot(b, side)) <= near && middle > 0 &&
	       middle < line_length(l);
}

uint8_t split_parted_edges(const splitter *s, const polygon *p, span around)
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
			if (fabs(gi_vec3d_dot(a, side)) > SPLIT_SNAP * s->size ||
			    fabs(gi_vec3d_dot(b, side)) > SPLIT_SNAP * s->size || to <= reached || from > start ||
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

/* How far the middle of a polygon's corners is from a line. */
static double off_middle(const splitter *s, const polygon *p, const line *l)
{
	gi_vec3d middle = {0, 0, 0};
	for (uint32_t k = 0; k < p->count; k++)
		middle = gi_vec3d_add(middle, gi_vec3d_scale(split_corner(s, p, k), 1.0 / p->count));
	const gi_vec3d along = gi_vec3d_unit(gi_vec3d_sub(l->to, l->from));
	return gi_vec3d_length(gi_vec3d_cross(along, gi_vec3d_sub(middle, l->from)));
}

/* The line to part a polygon along next, GI_NONE: none. Of those that go as far across, the middle one: strips side by
 * side taken off one after the other would make a tree as deep as there are strips.
 */
uint32_t split_choose_line(const splitter *s, const polygon *p, span lines)
{
	enum { CANDIDATES = 64 }; /* each looks at all */
	const double least = split_is_larger_than_leaf(s, p) ? THROUGH : 0;
	double most = 0, nearest = INFINITY;
	uint32_t best = GI_NONE;
	for (uint32_t k = lines.first; k < lines.end && k < lines.first + CANDIDATES; k++) {
		const double part = covered(s, p, lines, &s->inside.lines[k]);
		if (part < least || part <= most * (1 - GI_TIE))
			continue;
		const double off = off_middle(s, p, &s->inside.lines[k]);
		if (part > most * (1 + GI_TIE) || off < nearest - GI_TIE * s->size) {
			most = fmax(most, part);
			nearest = off;
			best = k;
		}
	}
	return best;
}
