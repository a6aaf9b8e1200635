/* Light vertices and drawn vertices of one object (skin.h says what they are).
 *
 *   leaves --join_corners--> groups of corners --store_lights--> light vertices      (both kinds of skin)
 *   finer faces --refine_weights--> weights of the leaf's corners --draw_*--> drawn  (gi_skin_from_surface)
 *   mesh vertices --find_closest--> weights inside a leaf's triangle --> drawn       (gi_skin_from_mesh)
 *
 * A "corner" is leaf * 4 + k, k = 0..3; a triangle's fourth stands for its third and is in no group of its own.
 */
#include "skin.h"

#include "bits.h"
#include "bvh.h"
#include "memory.h"
#include "skin_hanging.h"
#include "vec3d.h"

#include <math.h>

/* Light is not shared across an edge where the leaves' normals differ by more than 40 degrees. */
#define EDGE_COSINE 0.766
/* A simplified cage has edges that the scan it stands for has not: there only 70 degrees are taken for an edge of the
 * scan. */
#define CAGE_EDGE_COSINE 0.342
/* A leaf is drawn flat when the finer surface stays this near its plane (in radii) and keeps its area, and limit
 * normals stay this near its own: less than shading could show. */
#define FLAT_DISTANCE 1e-4
#define FLAT_NORMAL 1e-3
/* Two drawn normals are one when no component differs by more: less than 8 bits could show, more than float rounds. */
#define SAME_NORMAL 1e-5f
/* A leaf that faces as the vertex does is preferred to one that does not, unless it is this many times as far away and
 * this part of the diagonal farther: a scan's crevice that its cage has not must not be lit as the statue's other side.
 */
#define PREFER_TIMES 4.0
#define PREFER_FARTHER 0.02

typedef struct skinner {
	const gi_hierarchy *h;
	const uint8_t *parted; /* as gi_refined has it; NULL: none */
	gi_skin *out;
	uint32_t *group; /* per corner: another corner of its group, or itself */
	gi_hanging_list hanging;
	uint32_t *first_drawn; /* per vertex of the surface: a drawn vertex there, GI_NONE for none yet */
	uint32_t *next_drawn;  /* per drawn vertex: the next one at the same place */
} skinner;

/* One more than asked for: no size is zero. */
static void *allocate(size_t count, size_t size, bool *enough)
{
	void *memory = gi_calloc(count + 1, size);
	*enough = *enough && memory;
	return memory;
}

typedef struct quad {
	uint32_t v[4];
	uint32_t count; /* 3: v[3] repeats v[2] */
} quad;

static quad leaf_quad(const gi_hierarchy *h, uint32_t leaf)
{
	const gi_uvec4 c = h->topology[h->leaf_node[leaf]].corners;
	return (quad){{c.x, c.y, c.z, c.w}, c.z == c.w ? 3 : 4};
}

static gi_vec3d leaf_normal(const gi_hierarchy *h, uint32_t leaf)
{
	return gi_vec3d_from(h->geometry[h->leaf_node[leaf]].axis);
}

static gi_vec3d vertex_position(const gi_hierarchy *h, uint32_t vertex)
{
	return gi_vec3d_from(h->vertices[vertex]);
}

static void store3(float out[3], gi_vec3d v)
{
	out[0] = (float)v.x;
	out[1] = (float)v.y;
	out[2] = (float)v.z;
}

static gi_vec3d unit_or(gi_vec3d v, gi_vec3d otherwise)
{
	const double length = gi_vec3d_length(v);
	return length > 0.0 ? gi_vec3d_scale(v, 1.0 / length) : otherwise;
}

/* ---- light vertices ---- */

static uint32_t group_of(uint32_t *group, uint32_t corner)
{
	while (group[corner] != corner) {
		group[corner] = group[group[corner]];
		corner = group[corner];
	}
	return corner;
}

/* The lowest corner names the group: numbers do not depend on the order of joining. */
static void join(uint32_t *group, uint32_t a, uint32_t b)
{
	a = group_of(group, a);
	b = group_of(group, b);
	group[a > b ? a : b] = a > b ? b : a;
}

static uint32_t list_edges(const gi_hierarchy *h, gi_skin_edge *edges)
{
	uint32_t count = 0;
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++) {
		const quad q = leaf_quad(h, leaf);
		for (uint32_t k = 0; k < q.count; k++) {
			const uint32_t a = q.v[k], b = q.v[(k + 1) % q.count];
			edges[count++] = (gi_skin_edge){a < b ? a : b, a < b ? b : a, 4 * leaf + k};
		}
	}
	return count;
}

/* One pass of a stable counting sort; first by `high`, then by `low`. `offsets` holds vertex_count + 1. */
static void sort_edges(const gi_skin_edge *from, gi_skin_edge *to, uint32_t count, bool by_low, uint32_t *offsets,
		       uint32_t vertex_count)
{
	for (uint32_t i = 0; i <= vertex_count; i++)
		offsets[i] = 0;
	for (uint32_t i = 0; i < count; i++)
		offsets[(by_low ? from[i].low : from[i].high) + 1]++;
	for (uint32_t i = 0; i < vertex_count; i++)
		offsets[i + 1] += offsets[i];
	for (uint32_t i = 0; i < count; i++)
		to[offsets[by_low ? from[i].low : from[i].high]++] = from[i];
}

/* The corner of an edge's leaf at the edge's lower or higher vertex. */
static uint32_t end_corner(const gi_hierarchy *h, const gi_skin_edge *e, bool low)
{
	const quad q = leaf_quad(h, e->corner / 4);
	const uint32_t k = e->corner % 4;
	const bool here = q.v[k] == (low ? e->low : e->high);
	return here ? e->corner : e->corner - k + (k + 1) % q.count;
}

static bool is_parted(const skinner *s, const gi_skin_edge *e)
{
	return s->parted && s->parted[s->h->leaf_face[e->corner / 4]] >> (e->corner % 4) & 1;
}

static void join_across(skinner *s, const gi_skin_edge *a, const gi_skin_edge *b, double least_cosine)
{
	const gi_hierarchy *h = s->h;
	uint32_t *group = s->group;
	if (is_parted(s, a) || is_parted(s, b))
		return;
	if (gi_vec3d_dot(leaf_normal(h, a->corner / 4), leaf_normal(h, b->corner / 4)) < least_cosine)
		return;
	join(group, end_corner(h, a, true), end_corner(h, b, true));
	join(group, end_corner(h, a, false), end_corner(h, b, false));
}

/* Joins the corners on both sides of every edge that is not sharp and does not part light. */
static bool join_corners(skinner *s, double least_cosine)
{
	const gi_hierarchy *h = s->h;
	bool enough = true;
	gi_skin_edge *edges = allocate(4 * (size_t)h->leaf_count, sizeof *edges, &enough);
	gi_skin_edge *sorted = allocate(4 * (size_t)h->leaf_count, sizeof *sorted, &enough);
	uint32_t *offsets = allocate(h->vertex_count, sizeof *offsets, &enough);
	if (enough) {
		const uint32_t count = list_edges(h, edges);
		sort_edges(edges, sorted, count, false, offsets, h->vertex_count);
		sort_edges(sorted, edges, count, true, offsets, h->vertex_count);
		for (uint32_t i = 0; i < 4 * h->leaf_count; i++)
			s->group[i] = i;
		for (uint32_t i = 0; i < count; i++)
			for (uint32_t j = i + 1;
			     j < count && edges[j].low == edges[i].low && edges[j].high == edges[i].high; j++)
				join_across(s, &edges[i], &edges[j], least_cosine);
		enough = gi_skin_find_hanging(h, s->parted, edges, count, least_cosine, join, s->group, &s->hanging);
	}
	gi_free(edges);
	gi_free(sorted);
	gi_free(offsets);
	return enough;
}

/* A leaf counts at its corner by its angle there: how the surface is cut into leaves round the vertex makes no
 * difference. 1e-6 keeps a vertex among slivers from dividing by zero. */
static float corner_angle(const gi_hierarchy *h, const quad *q, uint32_t k)
{
	const gi_vec3d at = vertex_position(h, q->v[k]);
	const gi_vec3d a = gi_vec3d_sub(vertex_position(h, q->v[(k + 1) % q->count]), at);
	const gi_vec3d b = gi_vec3d_sub(vertex_position(h, q->v[(k + q->count - 1) % q->count]), at);
	return (float)(atan2(gi_vec3d_length(gi_vec3d_cross(a, b)), gi_vec3d_dot(a, b)) + 1e-6);
}

/* Numbers the groups in the order of their first corners, and counts the leaves of each. */
static void number_lights(skinner *s)
{
	gi_skin *out = s->out;
	for (uint32_t leaf = 0; leaf < s->h->leaf_count; leaf++) {
		const quad q = leaf_quad(s->h, leaf);
		for (uint32_t k = 0; k < q.count; k++) {
			/* A group's name is its lowest corner, which is met first. */
			const uint32_t corner = 4 * leaf + k, name = group_of(s->group, corner);
			s->out->corner_light[corner] = name == corner ? out->light_count++ : s->out->corner_light[name];
			out->light_first[s->out->corner_light[corner] + 1]++;
		}
		if (q.count == 3)
			s->out->corner_light[4 * leaf + 3] = s->out->corner_light[4 * leaf + 2];
	}
	for (uint32_t light = 0; light < out->light_count; light++)
		out->light_first[light + 1] += out->light_first[light];
}

static void fill_lights(const skinner *s, uint32_t *filled)
{
	gi_skin *out = s->out;
	for (uint32_t leaf = 0; leaf < s->h->leaf_count; leaf++) {
		const quad q = leaf_quad(s->h, leaf);
		for (uint32_t k = 0; k < q.count; k++) {
			const uint32_t light = s->out->corner_light[4 * leaf + k];
			const uint32_t at = out->light_first[light] + filled[light]++;
			out->light_leaf[at] = leaf;
			out->light_weight[at] = corner_angle(s->h, &q, k);
		}
	}
	for (uint32_t light = 0; light < out->light_count; light++) {
		double sum = 0.0;
		for (uint32_t i = out->light_first[light]; i < out->light_first[light + 1]; i++)
			sum += out->light_weight[i];
		for (uint32_t i = out->light_first[light]; i < out->light_first[light + 1]; i++)
			out->light_weight[i] = (float)(out->light_weight[i] / sum);
	}
}

static bool make_lights(skinner *s, double least_cosine)
{
	const size_t corners = 4 * (size_t)s->h->leaf_count;
	bool enough = true;
	s->group = allocate(corners, sizeof *s->group, &enough);
	s->out->corner_light = allocate(corners, sizeof *s->out->corner_light, &enough);
	s->out->light_first = allocate(corners, sizeof *s->out->light_first, &enough);
	s->out->light_leaf = allocate(corners, sizeof *s->out->light_leaf, &enough);
	s->out->light_weight = allocate(corners, sizeof *s->out->light_weight, &enough);
	if (!enough || !join_corners(s, least_cosine))
		return false;
	number_lights(s);
	uint32_t *filled = allocate(s->out->light_count, sizeof *filled, &enough);
	if (enough)
		fill_lights(s, filled);
	gi_free(filled);
	return enough && gi_skin_hang_lights(&s->hanging, s->out->corner_light, s->h->leaf_count, s->out);
}

static void free_skinner(skinner *s)
{
	gi_free(s->group);
	gi_free(s->hanging.items);
	gi_free(s->first_drawn);
	gi_free(s->next_drawn);
}

/* ---- drawn vertices ---- */

static void add_light(gi_draw_vertex *v, uint32_t *count, uint32_t light, float weight)
{
	uint32_t at = 0;
	while (at < *count && v->light[at] < light)
		at++;
	if (at == *count || v->light[at] != light) {
		for (uint32_t i = (*count)++; i > at; i--) {
			v->light[i] = v->light[i - 1];
			v->weight[i] = v->weight[i - 1];
		}
		v->light[at] = light;
		v->weight[at] = 0.0f;
	}
	v->weight[at] += weight;
}

/* The light at a point of a leaf. In order of light vertex and without zeros, so that the two leaves of a smooth edge
 * give their common points the same. */
static void set_light(const skinner *s, uint32_t leaf, const float weight[4], gi_draw_vertex *v)
{
	uint32_t count = 0;
	for (uint32_t k = 0; k < 4; k++)
		if (weight[k] > 0.0f)
			add_light(v, &count, s->out->corner_light[4 * leaf + k], weight[k]);
	for (; count > 0 && count < 4; count++) {
		v->light[count] = v->light[0];
		v->weight[count] = 0.0f;
	}
	v->leaf = leaf;
}

static bool is_same(const skinner *s, const gi_draw_vertex *a, const gi_draw_vertex *b)
{
	if (s->h->leaf_material[a->leaf] != s->h->leaf_material[b->leaf])
		return false;
	for (int axis = 0; axis < 3; axis++)
		if (a->position[axis] != b->position[axis] || fabsf(a->normal[axis] - b->normal[axis]) > SAME_NORMAL)
			return false;
	for (int i = 0; i < 4; i++)
		if (a->light[i] != b->light[i] || a->weight[i] != b->weight[i])
			return false;
	return true;
}

static uint32_t add_vertex(skinner *s, const gi_draw_vertex *v)
{
	s->out->vertices[s->out->vertex_count] = *v;
	return s->out->vertex_count++;
}

/* The drawn vertex that is `v`, a new one where there is none; `place` is the number of its vertex of the surface. */
static uint32_t share_vertex(skinner *s, uint32_t place, const gi_draw_vertex *v)
{
	for (uint32_t i = s->first_drawn[place]; i != GI_NONE; i = s->next_drawn[i])
		if (is_same(s, &s->out->vertices[i], v))
			return i;
	const uint32_t added = add_vertex(s, v);
	s->next_drawn[added] = s->first_drawn[place];
	return s->first_drawn[place] = added;
}

static void add_triangle(gi_skin *out, uint32_t a, uint32_t b, uint32_t c)
{
	out->indices[out->index_count++] = a;
	out->indices[out->index_count++] = b;
	out->indices[out->index_count++] = c;
}

/* ---- the surface: light of the finer faces ---- */

/* A face of the level of the leaves or below: its leaf, and for each of its corners the weights of the leaf's corners.
 */
typedef struct fine_face {
	uint32_t leaf; /* GI_NONE: its leaf has no area and is not there */
	bool known;
	float weight[4][4];
} fine_face;

static uint32_t corner_count(const uint32_t corners[4])
{
	return corners[2] == corners[3] ? 3 : 4;
}

/* out = mean of `count` of a face's corner weights, from corner `from` on, cyclically among n. */
static void mean_weight(const fine_face *face, uint32_t from, uint32_t count, uint32_t n, float out[4])
{
	for (uint32_t i = 0; i < 4; i++) {
		float sum = 0.0f;
		for (uint32_t k = 0; k < count; k++)
			sum += face->weight[(from + k) % n][i];
		out[i] = sum / (float)count;
	}
}

/* The child at corner j of its parent, which is its own corner k: going round it has the middle of the parent's next
 * edge, the middle of the parent (a quad alone), and the middle of the edge before. */
static void weigh_corner_child(const fine_face *parent, uint32_t n, uint32_t j, fine_face *child, uint32_t m,
			       uint32_t k)
{
	mean_weight(parent, j, 1, n, child->weight[k]);
	mean_weight(parent, j, 2, n, child->weight[(k + 1) % m]);
	if (m == 4)
		mean_weight(parent, 0, n, n, child->weight[(k + 2) % m]);
	mean_weight(parent, (j + n - 1) % n, 2, n, child->weight[(k + m - 1) % m]);
	child->known = true;
}

/* Corners bear the numbers of the finest level: a child and its parent share the number of the corner they share. */
static void weigh_child(const uint32_t child_corners[4], const uint32_t parent_corners[4], const fine_face *parent,
			fine_face *child)
{
	const uint32_t m = corner_count(child_corners), n = corner_count(parent_corners);
	child->leaf = parent->leaf;
	for (uint32_t k = 0; k < m; k++)
		for (uint32_t j = 0; j < n; j++)
			if (child_corners[k] == parent_corners[j])
				weigh_corner_child(parent, n, j, child, m, k);
}

static bool copy_weight(const uint32_t sibling_corners[4], const fine_face *sibling, uint32_t vertex, float out[4])
{
	for (uint32_t k = 0; k < 4; k++)
		if (sibling->known && sibling_corners[k] == vertex) {
			for (uint32_t i = 0; i < 4; i++)
				out[i] = sibling->weight[k][i];
			return true;
		}
	return false;
}

/* Loop's middle triangle touches no corner of its parent; its corners are the siblings' edge middles. OpenSubdiv
 * numbers siblings one after another. */
static void weigh_middle_child(const gi_refine_level *level, fine_face *faces, uint32_t face)
{
	const uint32_t first = face > 3 ? face - 3 : 0;
	const uint32_t end = level->face_count - face > 4 ? face + 4 : level->face_count;
	for (uint32_t k = 0; k < 4; k++)
		for (uint32_t other = first; other < end; other++)
			if (level->parent[other] == level->parent[face] && other != face &&
			    copy_weight(level->corners[other], &faces[other], level->corners[face][k],
					faces[face].weight[k]))
				break;
}

static void refine_weights(const gi_refine_level *above, const gi_refine_level *level, const fine_face *parents,
			   fine_face *faces)
{
	for (uint32_t face = 0; face < level->face_count; face++) {
		const uint32_t parent = level->parent[face];
		weigh_child(level->corners[face], above->corners[parent], &parents[parent], &faces[face]);
		if (faces[face].known && corner_count(level->corners[face]) == 3)
			for (uint32_t i = 0; i < 4; i++)
				faces[face].weight[3][i] = faces[face].weight[2][i];
	}
	for (uint32_t face = 0; face < level->face_count; face++)
		if (!faces[face].known)
			weigh_middle_child(level, faces, face);
}

/* The faces of the leaves' own level: each corner is its leaf's. NULL when memory ran out. */
static fine_face *leaf_faces(const gi_hierarchy *h, uint32_t face_count)
{
	bool enough = true;
	fine_face *faces = allocate(face_count, sizeof *faces, &enough);
	for (uint32_t face = 0; enough && face < face_count; face++)
		faces[face].leaf = GI_NONE;
	for (uint32_t leaf = 0; enough && leaf < h->leaf_count; leaf++) {
		fine_face *face = &faces[h->leaf_face[leaf]];
		*face = (fine_face){.leaf = leaf, .known = true};
		const uint32_t count = leaf_quad(h, leaf).count;
		for (uint32_t k = 0; k < 4; k++)
			face->weight[k][k < count ? k : 2] = 1.0f;
	}
	return faces;
}

/* The faces of the finest level of `fine`, from those of the leaves' level down. NULL when memory ran out. */
static fine_face *finest_faces(const gi_hierarchy *h, const gi_refined *fine, uint32_t leaf_level)
{
	fine_face *faces = leaf_faces(h, fine->levels[leaf_level].face_count);
	for (uint32_t level = leaf_level + 1; faces && level < fine->level_count; level++) {
		bool enough = true;
		fine_face *finer = allocate(fine->levels[level].face_count, sizeof *finer, &enough);
		if (finer)
			refine_weights(&fine->levels[level - 1], &fine->levels[level], faces, finer);
		gi_free(faces);
		faces = finer;
	}
	return faces;
}

/* ---- the surface: what is drawn ---- */

static gi_vec3d fine_position(const gi_refined *fine, const uint32_t corners[4], uint32_t k)
{
	return gi_vec3d_load(fine->positions[corners[k]]);
}

static gi_vec3d fine_moment(const gi_refined *fine, const uint32_t corners[4])
{
	const gi_vec3d a = fine_position(fine, corners, 0), c = fine_position(fine, corners, 2);
	return gi_vec3d_add(gi_vec3d_triangle(a, fine_position(fine, corners, 1), c),
			    gi_vec3d_triangle(a, c, fine_position(fine, corners, 3)));
}

/* Does a finer face lie in the plane of its leaf, and say nothing else by its normals? */
static bool lies_flat(const gi_hierarchy *h, uint32_t leaf, const gi_refined *fine, const uint32_t corners[4])
{
	const gi_vec3d normal = leaf_normal(h, leaf), origin = vertex_position(h, leaf_quad(h, leaf).v[0]);
	const double tolerance = FLAT_DISTANCE * h->geometry[h->leaf_node[leaf]].sphere.w;
	for (uint32_t k = 0; k < 4; k++) {
		const gi_vec3d from = gi_vec3d_sub(fine_position(fine, corners, k), origin);
		const gi_vec3d limit = gi_vec3d_load(fine->normals[corners[k]]);
		if (fabs(gi_vec3d_dot(normal, from)) > tolerance)
			return false;
		if (gi_vec3d_dot(limit, limit) > 0.0 && gi_vec3d_length(gi_vec3d_sub(limit, normal)) > FLAT_NORMAL)
			return false;
	}
	return true;
}

/* Round its centre a leaf can be drawn when it turns the same way at every corner. */
static bool is_convex(const gi_hierarchy *h, uint32_t leaf)
{
	const quad q = leaf_quad(h, leaf);
	for (uint32_t k = 0; k < q.count; k++) {
		const gi_vec3d turn =
		    gi_vec3d_triangle(vertex_position(h, q.v[k]), vertex_position(h, q.v[(k + 1) % q.count]),
				      vertex_position(h, q.v[(k + 2) % q.count]));
		if (gi_vec3d_dot(turn, leaf_normal(h, leaf)) <= 0.0)
			return false;
	}
	return true;
}

/* Which leaves are flat to the eye, and whether all are. `area`: leaf_count zeros. */
static bool find_flat(const gi_hierarchy *h, const gi_refined *fine, const fine_face *faces, bool *flat, double *area)
{
	const gi_refine_level *level = &fine->levels[fine->level_count - 1];
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++)
		flat[leaf] = (h->topology[h->leaf_node[leaf]].range.w & GI_NODE_FLAT) && is_convex(h, leaf);
	for (uint32_t face = 0; face < level->face_count; face++) {
		const uint32_t leaf = faces[face].leaf;
		if (leaf == GI_NONE)
			continue;
		flat[leaf] = flat[leaf] && lies_flat(h, leaf, fine, level->corners[face]);
		area[leaf] += gi_vec3d_length(fine_moment(fine, level->corners[face]));
	}
	bool all = true;
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++) {
		const double own = h->geometry[h->leaf_node[leaf]].moment.w;
		flat[leaf] = flat[leaf] && fabs(area[leaf] - own) <= FLAT_DISTANCE * own;
		all = all && flat[leaf];
	}
	return all;
}

static uint32_t flat_corner(skinner *s, uint32_t leaf, uint32_t vertex, uint32_t k)
{
	float weight[4] = {0};
	weight[k] = 1.0f;
	gi_draw_vertex v = {0};
	store3(v.position, vertex_position(s->h, vertex));
	store3(v.normal, leaf_normal(s->h, leaf));
	set_light(s, leaf, weight, &v);
	return share_vertex(s, vertex, &v);
}

static void draw_flat(skinner *s, uint32_t leaf)
{
	const quad q = leaf_quad(s->h, leaf);
	uint32_t drawn[4];
	gi_vec3d centre = {0};
	for (uint32_t k = 0; k < q.count; k++) {
		drawn[k] = flat_corner(s, leaf, q.v[k], k);
		centre = gi_vec3d_add(centre, gi_vec3d_scale(vertex_position(s->h, q.v[k]), 0.25));
	}
	if (q.count == 3) {
		add_triangle(s->out, drawn[0], drawn[1], drawn[2]);
		return;
	}
	const float weight[4] = {0.25f, 0.25f, 0.25f, 0.25f};
	gi_draw_vertex v = {0};
	store3(v.position, centre);
	store3(v.normal, leaf_normal(s->h, leaf));
	set_light(s, leaf, weight, &v);
	const uint32_t middle = add_vertex(s, &v);
	for (uint32_t k = 0; k < 4; k++)
		add_triangle(s->out, drawn[k], drawn[(k + 1) % 4], middle);
}

static void draw_curved(skinner *s, const gi_refined *fine, const uint32_t corners[4], const fine_face *face)
{
	const gi_vec3d normal = unit_or(fine_moment(fine, corners), leaf_normal(s->h, face->leaf));
	uint32_t drawn[4];
	for (uint32_t k = 0; k < corner_count(corners); k++) {
		gi_draw_vertex v = {0};
		store3(v.position, fine_position(fine, corners, k));
		store3(v.normal, unit_or(gi_vec3d_load(fine->normals[corners[k]]), normal));
		set_light(s, face->leaf, face->weight[k], &v);
		drawn[k] = share_vertex(s, corners[k], &v);
	}
	add_triangle(s->out, drawn[0], drawn[1], drawn[2]);
	if (corner_count(corners) == 4)
		add_triangle(s->out, drawn[0], drawn[2], drawn[3]);
}

static bool allocate_drawing(skinner *s, const gi_refined *fine)
{
	const size_t faces = fine->levels[fine->level_count - 1].face_count, leaves = s->h->leaf_count;
	const uint32_t places = fine->vertex_count > s->h->vertex_count ? fine->vertex_count : s->h->vertex_count;
	const size_t vertices = 5 * leaves + 4 * faces;
	bool enough = true;
	s->first_drawn = allocate(places, sizeof *s->first_drawn, &enough);
	s->next_drawn = allocate(vertices, sizeof *s->next_drawn, &enough);
	s->out->vertices = allocate(vertices, sizeof *s->out->vertices, &enough);
	s->out->indices = allocate(12 * leaves + 6 * faces, sizeof *s->out->indices, &enough);
	for (uint32_t i = 0; enough && i < places; i++)
		s->first_drawn[i] = GI_NONE;
	return enough;
}

/* Where nothing was refined further, each leaf is drawn as suits it. Else flat leaves are drawn whole only when all
 * are: beside finer curved ones their long edges would leave cracks. */
static void draw_surface(skinner *s, const gi_refined *fine, bool finer, const fine_face *faces, const bool *flat,
			 bool all)
{
	const gi_refine_level *level = &fine->levels[fine->level_count - 1];
	const bool whole = all || !finer;
	for (uint32_t leaf = 0; whole && leaf < s->h->leaf_count; leaf++)
		if (flat[leaf])
			draw_flat(s, leaf);
	for (uint32_t face = 0; face < level->face_count; face++)
		if (faces[face].leaf != GI_NONE && !(whole && flat[faces[face].leaf]))
			draw_curved(s, fine, level->corners[face], &faces[face]);
}

/* Gives back what the upper bounds reserved too much; where that fails the array stays as it is. */
static void *shrink(void *memory, size_t count, size_t size)
{
	void *smaller = gi_realloc(memory, (count + 1) * size);
	return smaller ? smaller : memory;
}

static bool skin_surface(skinner *s, const gi_refined *fine, uint32_t leaf_level)
{
	bool enough = make_lights(s, EDGE_COSINE) && allocate_drawing(s, fine);
	fine_face *faces = enough ? finest_faces(s->h, fine, leaf_level) : NULL;
	bool *flat = allocate(s->h->leaf_count, sizeof *flat, &enough);
	double *area = allocate(s->h->leaf_count, sizeof *area, &enough);
	enough = enough && faces;
	if (enough) {
		const bool all = find_flat(s->h, fine, faces, flat, area);
		draw_surface(s, fine, fine->level_count > leaf_level + 1, faces, flat, all);
		s->out->vertices = shrink(s->out->vertices, s->out->vertex_count, sizeof *s->out->vertices);
		s->out->indices = shrink(s->out->indices, s->out->index_count, sizeof *s->out->indices);
	}
	gi_free(faces);
	gi_free(flat);
	gi_free(area);
	return enough;
}

/* How much finer `fine` is, its levels say themselves: a cage of n-gons is refined once whatever was asked for, so the
 * caller's `extra` can be one too many. */
bool gi_skin_from_surface(const gi_hierarchy *hierarchy, const gi_refined *coarse, const gi_refined *fine,
			  uint32_t extra, gi_skin *out)
{
	(void)extra;
	*out = (gi_skin){0};
	if (!fine)
		fine = coarse;
	const uint32_t leaf_level = coarse->level_count - 1;
	if (fine->level_count < coarse->level_count ||
	    fine->levels[leaf_level].face_count != coarse->levels[leaf_level].face_count)
		return false;
	skinner s = {.h = hierarchy, .parted = coarse->parted, .out = out};
	const bool done = skin_surface(&s, fine, leaf_level);
	free_skinner(&s);
	if (!done)
		gi_skin_free(out);
	return done;
}

/* ---- a detailed mesh ---- */

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
	gi_box *boxes = allocate(count, sizeof *boxes, &enough);
	out->nodes = allocate(2 * count, sizeof *out->nodes, &enough);
	out->order = allocate(count, sizeof *out->order, &enough);
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

static void draw_mesh(skinner *s, const locator *l, const mesh *m, const gi_vec3d *normals, const uint32_t *guide)
{
	for (uint32_t i = 0; i < m->vertex_count; i++) {
		const gi_vec3d point = mesh_position(m, i), normal = unit_or(normals[i], (gi_vec3d){0.0, 0.0, 0.0});
		const uint32_t near = i > 0 ? s->out->vertices[guide[i]].leaf : 0;
		const closest found = find_closest(l, point, normal, near);
		gi_draw_vertex v = {0};
		store3(v.position, point);
		store3(v.normal, unit_or(normal, leaf_normal(s->h, found.leaf)));
		set_light(s, found.leaf, found.weight, &v);
		add_vertex(s, &v);
	}
	for (uint32_t i = 0; i < m->index_count; i++)
		s->out->indices[s->out->index_count++] = m->indices[i];
}

static bool skin_mesh(skinner *s, const mesh *m)
{
	locator l = {.h = s->h};
	const gi_vec3d diagonal = gi_vec3d_sub(gi_vec3d_from(s->h->upper), gi_vec3d_from(s->h->lower));
	l.farther = PREFER_FARTHER * gi_vec3d_length(diagonal);
	bool enough = make_lights(s, CAGE_EDGE_COSINE) && build_locator(s->h, &l);
	gi_vec3d *normals = allocate(m->vertex_count, sizeof *normals, &enough);
	uint32_t *guide = allocate(m->vertex_count, sizeof *guide, &enough);
	s->out->vertices = allocate(m->vertex_count, sizeof *s->out->vertices, &enough);
	s->out->indices = allocate(m->index_count, sizeof *s->out->indices, &enough);
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
bool gi_skin_from_mesh(const gi_hierarchy *hierarchy, const float *positions, uint32_t vertex_count,
		       const uint32_t *indices, uint32_t index_count, gi_skin *out)
{
	*out = (gi_skin){0};
	const mesh m = {positions, vertex_count, indices, index_count};
	if (hierarchy->leaf_count == 0 || !is_valid(&m))
		return false;
	skinner s = {.h = hierarchy, .out = out};
	const bool done = skin_mesh(&s, &m);
	free_skinner(&s);
	if (!done)
		gi_skin_free(out);
	return done;
}

void gi_skin_free(gi_skin *skin)
{
	if (!skin)
		return;
	gi_free(skin->light_first);
	gi_free(skin->light_leaf);
	gi_free(skin->light_weight);
	gi_free(skin->corner_light);
	gi_free(skin->vertices);
	gi_free(skin->indices);
	*skin = (gi_skin){0};
}
