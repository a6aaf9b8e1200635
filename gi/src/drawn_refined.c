/* The drawn surface of an object that is drawn as it is lit, or refined further. */
#include "drawn_build.h"

#include "host_memory.h"

#include <math.h>
#include <string.h>

/* A leaf is drawn flat when the finer surface stays this near its plane (in radii) and keeps its area, and limit
 * normals stay this near its own: less than shading could show. */
#define FLAT_DISTANCE 1e-4
#define FLAT_NORMAL 1e-3

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
	fine_face *faces = gi_drawn_allocate(face_count, sizeof *faces, &enough);
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
		fine_face *finer = gi_drawn_allocate(fine->levels[level].face_count, sizeof *finer, &enough);
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

/* Of a shape that changes: leaves without limit normals are drawn with their own, bent or not. */
static bool find_faceted(const gi_hierarchy *h, const gi_refined *fine, bool finer, bool *flat)
{
	for (uint32_t leaf = 0; leaf < h->leaf_count; leaf++)
		flat[leaf] = !finer && !fine->tangents[0].count && is_convex(h, leaf);
	return false;
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

/* ---- texture coordinates ---- */

/* Of the triangle that was added last. */
static void map_triangle(drawn_builder *s, const float a[2], const float b[2], const float c[2])
{
	const float *uvs[3] = {a, b, c};
	for (uint32_t k = 0; s->uvs && k < 3; k++)
		memcpy(s->out->uvs[s->out->index_count - 3 + k], uvs[k], 2 * sizeof **uvs);
}

/* Of the corners of a leaf that is drawn flat and, behind them, of its middle: coordinates are linear in the triangles
 * a b c and a c d, in one of which that lies. */
static void map_flat(const drawn_builder *s, uint32_t leaf, const quad *q, gi_vec3d middle, float uvs[5][2])
{
	static const uint32_t triangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
	double best = -HUGE_VAL;
	if (!s->uvs)
		return;
	memcpy(uvs, s->uvs[leaf].uvs, sizeof s->uvs[leaf].uvs);
	for (uint32_t t = 0; t < q->count - 2; t++) {
		const uint32_t *k = triangles[t];
		const gi_vec3d c[3] = {vertex_position(s->h, q->v[k[0]]), vertex_position(s->h, q->v[k[1]]),
				       vertex_position(s->h, q->v[k[2]])};
		double w[3];
		const double least = gi_vec3d_weights(c, middle, w);
		if (!(least > best))
			continue;
		best = least;
		for (int i = 0; i < 2; i++)
			uvs[4][i] = (float)(w[0] * uvs[k[0]][i] + w[1] * uvs[k[1]][i] + w[2] * uvs[k[2]][i]);
	}
}

/* Of the corners of a face that has these weights of its leaf's. */
static void map_curved(const drawn_builder *s, const fine_face *face, float uvs[4][2])
{
	for (uint32_t k = 0; s->uvs && k < 4; k++)
		for (uint32_t i = 0; i < 2; i++) {
			uvs[k][i] = 0.0f;
			for (uint32_t j = 0; j < 4; j++)
				uvs[k][i] += face->weight[k][j] * s->uvs[face->leaf].uvs[j][i];
		}
}

/* ---- the surface: triangles ---- */

/* A point on the way round a leaf that is drawn flat, and in a texture. */
typedef struct flat_point {
	uint32_t drawn;
	float uv[2];
} flat_point;

/* Of a vertex on the edge from a corner to the next, a share of the way along it. */
static flat_point flat_point_at(drawn_builder *s, uint32_t leaf, uint32_t vertex, uint32_t k, uint32_t next,
				float share, const float uvs[5][2])
{
	float weight[4] = {0};
	flat_point out;
	weight[k] = 1.0f - share;
	weight[next] += share;
	gi_draw_vertex v = {0};
	gi_vec3d_store(v.position, vertex_position(s->h, vertex));
	gi_vec3d_store(v.normal, leaf_normal(s->h, leaf));
	gi_drawn_set_light(s, leaf, weight, &v);
	s->bond = (gi_draw_bond){vertex, GI_NONE, GI_NONE};
	out.drawn = gi_drawn_share_vertex(s, vertex, &v);
	for (int i = 0; i < 2; i++)
		out.uv[i] = weight[k] * uvs[k][i] + share * uvs[next][i];
	return out;
}

/* Between the corners of quads, and where corners of other leaves lie on the edges, triangles meet in the middle. */
static uint32_t flat_middle(drawn_builder *s, uint32_t leaf, const quad *q, gi_vec3d centre)
{
	float weight[4] = {0.25f, 0.25f, q->count == 3 ? 0.5f : 0.25f, q->count == 3 ? 0.0f : 0.25f};
	gi_draw_vertex v = {0};
	gi_vec3d_store(v.position, centre);
	gi_vec3d_store(v.normal, leaf_normal(s->h, leaf));
	gi_drawn_set_light(s, leaf, weight, &v);
	s->bond = (gi_draw_bond){GI_NONE, GI_NONE, GI_NONE};
	return gi_drawn_add_vertex(s, &v);
}

/* The first point that lies on an edge of this leaf or of a later one: leaves are drawn in order. */
static uint32_t seam_of(const gi_seams *seams, uint32_t leaf, uint32_t at)
{
	while (at < seams->count && seams->points[at].corner < 4 * leaf)
		at++;
	return at;
}

/* Returns where the seam points of later leaves begin. */
static uint32_t draw_flat(drawn_builder *s, uint32_t leaf, uint32_t seam)
{
	const quad q = leaf_quad(s->h, leaf);
	const gi_seam_point *points = s->seams.points;
	flat_point corners[4];
	float uvs[5][2] = {{0}};
	gi_vec3d centre = {0};
	for (uint32_t k = 0; k < 4; k++)
		centre = gi_vec3d_add(centre, gi_vec3d_scale(vertex_position(s->h, q.v[k]), 0.25));
	map_flat(s, leaf, &q, centre, uvs);
	for (uint32_t k = 0; k < q.count; k++)
		corners[k] = flat_point_at(s, leaf, q.v[k], k, k, 0.0f, uvs);
	seam = seam_of(&s->seams, leaf, seam);
	if (q.count == 3 && (seam == s->seams.count || points[seam].corner >= 4 * leaf + 4)) {
		gi_drawn_add_triangle(s->out, corners[0].drawn, corners[1].drawn, corners[2].drawn);
		map_triangle(s, uvs[0], uvs[1], uvs[2]);
		return seam;
	}
	const uint32_t middle = flat_middle(s, leaf, &q, centre);
	for (uint32_t k = 0; k < q.count; k++) {
		flat_point last = corners[k];
		for (bool more = true; more; seam += more) {
			const uint32_t next = (k + 1) % q.count;
			more = seam < s->seams.count && points[seam].corner == 4 * leaf + k;
			const flat_point to =
			    more ? flat_point_at(s, leaf, points[seam].vertex, k, next, points[seam].share, uvs)
				 : corners[next];
			gi_drawn_add_triangle(s->out, last.drawn, to.drawn, middle);
			map_triangle(s, last.uv, to.uv, uvs[4]);
			last = to;
		}
	}
	return seam;
}

/* Of a corner of a face of the surface that is drawn. */
static gi_draw_bond bond_of(const gi_refined *fine, uint32_t vertex, uint32_t face)
{
	const gi_stencils *t = &fine->tangents[0];
	const bool smooth = t->count && t->first[vertex + 1] > t->first[vertex];
	return (gi_draw_bond){vertex, smooth ? vertex : GI_NONE, smooth ? GI_NONE : face};
}

static void draw_curved(drawn_builder *s, const gi_refined *fine, uint32_t number, const fine_face *face)
{
	const uint32_t *corners = fine->levels[fine->level_count - 1].corners[number];
	const gi_vec3d normal = unit_or(fine_moment(fine, corners), leaf_normal(s->h, face->leaf));
	uint32_t drawn[4];
	float uvs[4][2];
	map_curved(s, face, uvs);
	for (uint32_t k = 0; k < corner_count(corners); k++) {
		gi_draw_vertex v = {0};
		gi_vec3d_store(v.position, fine_position(fine, corners, k));
		gi_vec3d_store(v.normal, unit_or(gi_vec3d_load(fine->normals[corners[k]]), normal));
		gi_drawn_set_light(s, face->leaf, face->weight[k], &v);
		s->bond = bond_of(fine, corners[k], number);
		drawn[k] = gi_drawn_share_vertex(s, corners[k], &v);
	}
	gi_drawn_add_triangle(s->out, drawn[0], drawn[1], drawn[2]);
	map_triangle(s, uvs[0], uvs[1], uvs[2]);
	if (corner_count(corners) == 4) {
		gi_drawn_add_triangle(s->out, drawn[0], drawn[2], drawn[3]);
		map_triangle(s, uvs[0], uvs[2], uvs[3]);
	}
}

static bool allocate_drawing(drawn_builder *s, const gi_refined *fine)
{
	const size_t faces = fine->levels[fine->level_count - 1].face_count, leaves = s->h->leaf_count;
	const uint32_t places = fine->vertex_count > s->h->vertex_count ? fine->vertex_count : s->h->vertex_count;
	const size_t vertices = 5 * leaves + 4 * faces + s->seams.count;
	const size_t indices = 12 * leaves + 6 * faces + 3 * (size_t)s->seams.count;
	bool enough = true;
	s->first_drawn = gi_drawn_allocate(places, sizeof *s->first_drawn, &enough);
	s->next_drawn = gi_drawn_allocate(vertices, sizeof *s->next_drawn, &enough);
	s->out->vertices = gi_drawn_allocate(vertices, sizeof *s->out->vertices, &enough);
	s->out->indices = gi_drawn_allocate(indices, sizeof *s->out->indices, &enough);
	if (s->uvs)
		s->out->uvs = gi_drawn_allocate(indices, sizeof *s->out->uvs, &enough);
	for (uint32_t i = 0; enough && i < places; i++)
		s->first_drawn[i] = GI_NONE;
	if (enough && s->h->deforms) {
		s->out->bonds = gi_drawn_allocate(vertices, sizeof *s->out->bonds, &enough);
		s->out->faces = gi_drawn_allocate(faces, sizeof *s->out->faces, &enough);
		if (enough)
			memcpy(s->out->faces, fine->levels[fine->level_count - 1].corners,
			       sizeof *s->out->faces * faces);
	}
	return enough;
}

/* Where nothing was refined further, each leaf is drawn as suits it. Else flat leaves are drawn whole only when all
 * are: beside finer curved ones their long edges would leave cracks. */
static void draw_surface(drawn_builder *s, const gi_refined *fine, bool finer, const fine_face *faces, const bool *flat,
			 bool all)
{
	const gi_refine_level *level = &fine->levels[fine->level_count - 1];
	const bool whole = all || !finer;
	for (uint32_t leaf = 0, seam = 0; whole && leaf < s->h->leaf_count; leaf++)
		if (flat[leaf])
			seam = draw_flat(s, leaf, seam);
	for (uint32_t face = 0; face < level->face_count; face++)
		if (faces[face].leaf != GI_NONE && !(whole && flat[faces[face].leaf]))
			draw_curved(s, fine, face, &faces[face]);
}

/* Gives back what the upper bounds reserved too much; where that fails the array stays as it is. */
static void *shrink(void *memory, size_t count, size_t size)
{
	void *smaller = gi_realloc(memory, (count + 1) * size);
	return smaller ? smaller : memory;
}

static bool draw_from_cage(drawn_builder *s, const gi_refined *fine, uint32_t leaf_level, double least_cosine)
{
	bool enough = gi_drawn_make_lights(s, least_cosine) && allocate_drawing(s, fine);
	fine_face *faces = enough ? finest_faces(s->h, fine, leaf_level) : NULL;
	bool *flat = gi_drawn_allocate(s->h->leaf_count, sizeof *flat, &enough);
	double *area = gi_drawn_allocate(s->h->leaf_count, sizeof *area, &enough);
	enough = enough && faces;
	if (enough) {
		const bool finer = fine->level_count > leaf_level + 1;
		const bool all =
		    s->h->deforms ? find_faceted(s->h, fine, finer, flat) : find_flat(s->h, fine, faces, flat, area);
		draw_surface(s, fine, finer, faces, flat, all);
		s->out->vertices = shrink(s->out->vertices, s->out->vertex_count, sizeof *s->out->vertices);
		s->out->indices = shrink(s->out->indices, s->out->index_count, sizeof *s->out->indices);
		if (s->out->bonds)
			s->out->bonds = shrink(s->out->bonds, s->out->vertex_count, sizeof *s->out->bonds);
	}
	gi_free(faces);
	gi_free(flat);
	gi_free(area);
	return enough;
}

bool gi_drawn_from_cage(const gi_hierarchy *hierarchy, const gi_refined *coarse, const gi_refined *fine,
			const gi_leaf_uvs *uvs, double least_cosine, gi_drawn_surface *out)
{
	*out = (gi_drawn_surface){0};
	const uint32_t leaf_level = coarse->level_count - 1;
	if (fine->level_count < coarse->level_count ||
	    fine->levels[leaf_level].face_count != coarse->levels[leaf_level].face_count)
		return false;
	drawn_builder s = {.h = hierarchy, .parted = coarse->parted, .has_seams = true, .uvs = uvs, .out = out};
	const bool done = draw_from_cage(&s, fine, leaf_level, least_cosine);
	gi_drawn_free_builder(&s);
	if (!done)
		gi_drawn_free(out);
	return done;
}

bool gi_drawn_from_nothing(const gi_hierarchy *hierarchy, const gi_refined *coarse, double least_cosine,
			   gi_drawn_surface *out)
{
	*out = (gi_drawn_surface){0};
	drawn_builder s = {.h = hierarchy, .parted = coarse->parted, .out = out};
	const bool done = gi_drawn_make_lights(&s, least_cosine);
	gi_drawn_free_builder(&s);
	if (!done)
		gi_drawn_free(out);
	return done;
}
