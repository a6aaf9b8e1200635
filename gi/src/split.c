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
#include "host_memory.h"
#include "split_pieces.h"

#include <stdio.h>
#include <string.h>

enum { MAX_CUT_DEPTH = 30, MOST_LEAVES = 1 << 24 };

/* ---- division ---- */

/* A slanted line through a large quad would leave two of which no grid has cells alike: there it cuts cells alone. */
static bool part_by_line(splitter *s, const polygon *p, span lines, polygon parts[2])
{
	const uint32_t l = split_choose_line(s, p, lines);
	if (l == GI_NONE)
		return false;
	const line chosen = s->inside.lines[l];
	return split_part_along(s, p, &chosen, parts) &&
	       (!split_is_larger_than_leaf(s, p) || p->count == 3 ||
		(split_suits_grid(s, &parts[0]) && split_suits_grid(s, &parts[1])));
}

/* The parts of a polygon, 0: it is a leaf. */
static uint32_t part(splitter *s, const polygon *p, uint32_t depth, span lines, polygon parts[4])
{
	if (p->count > 4) {
		split_part_in_two(p, 0, p->count / 2, parts);
		return 2;
	}
	if (depth < MAX_CUT_DEPTH && part_by_line(s, p, lines, parts))
		return 2;
	if (!split_is_larger_than_leaf(s, p))
		return 0;
	return p->count == 3 ? split_part_triangle(s, p, parts) : split_part_quad(s, p, parts);
}

static uint32_t add_node(splitter *s, const polygon *p, uint32_t parent, uint32_t depth)
{
	if (s->full || !split_reserve((void **)&s->nodes, s->node_count, &s->node_room, sizeof *s->nodes) ||
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
	const span own = split_inherit_lines(s, &s->inside, p, inside, SPLIT_SNAP * s->size),
		   near = split_inherit_lines(s, &s->around, p, around, -SPLIT_SNAP * s->size);
	polygon parts[4];
	const uint32_t count = part(s, p, depth, own, parts);
	s->nodes[node].leaf = count == 0;
	s->nodes[node].parted = count == 0 ? split_parted_edges(s, p, near) : 0;
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
		const double height = gi_vec3d_dot(s->normal, gi_vec3d_sub(ends[k], split_corner(s, p, 0)));
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
	s->normal = split_normal(s, p);
	s->inside.count = s->around.count = 0;
	const bool cut = split_is_flat_and_convex(s, p);
	for (; cut && next < def->cut_count && def->cuts[order[next]].face == s->face && !s->full; next++) {
		const line l = project(s, p, &def->cuts[order[next]], scale);
		split_push_line(s, &s->inside, &l);
		if (l.parts)
			split_push_line(s, &s->around, &l);
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
	uint32_t *group = gi_malloc(sizeof *group * base->vertex_count);
	uint32_t room = 256;
	while (room < 4 * base->vertex_count)
		room *= 2;
	const bool sums = !s->stencils || gi_stencils_copy(&base->points, s->stencils);
	if (!group || !sums || !split_grow_table(s, room)) {
		gi_free(group);
		return false;
	}
	for (uint32_t k = 0; k < base->vertex_count; k++)
		group[k] = k;
	for (uint32_t face = 0; face < finest->face_count; face++)
		for (int k = 1; k < 4; k++)
			gi_join(group, finest->corners[face][k], finest->corners[face][0]);
	for (uint32_t k = 0; k < base->vertex_count && !s->full; k++) {
		if (!split_reserve_point(s)) {
			s->full = true;
			break;
		}
		/* Points of the cage stay apart where the cage has them apart. */
		s->points[k] = gi_vec3d_load(base->positions[k]);
		s->component[k] = gi_group_of(group, k);
		uint32_t *place = split_find_place(s, s->points[k], s->component[k], k);
		s->point_count++;
		if (*place == GI_NONE)
			*place = k;
	}
	gi_free(group);
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

static void free_splitter(splitter *s)
{
	gi_free(s->points);
	gi_free(s->component);
	gi_free(s->table);
	gi_free(s->nodes);
	gi_free(s->inside.lines);
	gi_free(s->around.lines);
	if (s->stencils)
		gi_stencils_free(s->stencils);
}

static bool split(splitter *s, const gi_refine_cage *cage, const gi_refined *base, gi_refined *out)
{
	uint32_t *offsets = gi_malloc(sizeof *offsets * ((size_t)cage->face_count + 1));
	uint32_t *order = gi_malloc(sizeof *order * ((size_t)s->def->cut_count + 1));
	bool done = offsets && order && take_points(s, base);
	if (done) {
		sort_cuts(s->def, cage->face_count, offsets, order);
		divide_all(s, base, offsets, order, cage->scale);
		done = !s->full && split_export_levels(s, cage->face_materials, out) && split_export_parted(s, out) &&
		       split_export_points(s, out) &&
		       (!(cage->stencils || cage->numbered) || split_export_faces(s, out));
	}
	if (done && s->stencils) {
		out->points = *s->stencils;
		*s->stencils = (gi_stencils){0};
	}
	out->closed = base->closed;
	gi_free(offsets);
	gi_free(order);
	return done;
}

bool gi_split(const gi_refine_cage *cage, const gi_split_def *def, gi_refined *out, char *message, size_t message_size)
{
	*out = (gi_refined){0};
	/* Faces without area are dropped: their numbers travel in the materials' place. */
	uint32_t *numbers = gi_malloc(sizeof *numbers * ((size_t)cage->face_count + 1));
	for (uint32_t k = 0; numbers && k < cage->face_count; k++)
		numbers[k] = k;
	gi_refine_cage numbered = *cage;
	numbered.face_materials = numbers;
	gi_refined base = {0};
	snprintf(message, message_size, "out of memory");
	const bool refined = numbers && gi_refine(&numbered, 0, &base, message, message_size);
	bool done = refined, memory = !numbers || base.out_of_memory;
	if (refined) {
		gi_stencils stencils = {0};
		splitter s = {.def = def, .stencils = cage->stencils ? &stencils : NULL};
		done = split(&s, cage, &base, out);
		memory = s.leaf_count < MOST_LEAVES;
		if (!done)
			snprintf(message, message_size, memory ? "out of memory" : "there would be more than %d leaves",
				 MOST_LEAVES);
		free_splitter(&s);
	}
	gi_refined_free(&base);
	gi_free(numbers);
	if (!done) {
		gi_refined_free(out);
		out->out_of_memory = memory;
	}
	return done;
}
