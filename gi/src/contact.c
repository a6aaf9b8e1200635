/* Contacts between faces (contact.h).
 *
 *   objects --place_*--> faces and edges in the world --a tree over the faces--> pairs that are near
 *           --cross_face--> lines where a face runs through another
 *           --project_edge--> lines below sharp edges and borders that end close above a face
 */
#include "contact.h"

#include "bits.h"
#include "bvh.h"
#include "faces.h"
#include "host_memory.h"
#include "vec3d.h"

#include <stdlib.h>
#include <string.h>

/* In leaf sizes: surfaces this near lie in one plane; lines shorter than this are not worth a cut. */
#define TOUCH 1e-3
#define SHORTEST 0.05
/* An edge that rises steeper over a face has no shadow's border below it. */
#define STEEPEST 0.5
/* Strips begin a height below an edge, or at this part of a leaf, and grow by this factor up to this part of a leaf. */
#define THINNEST_STRIP (1 / 32.0)
#define STRIP_GROWTH 2
#define WIDEST_STRIP 0.7
/* Within 35 degrees. */
#define ALONG_COSINE 0.82
/* Faces whose normals are farther apart have a sharp edge between them: 40 degrees, as light vertices take it. */
#define SHARP_COSINE 0.766
/* Heights over the longest edge: flatter faces are planes. */
#define FLAT 1e-4

typedef struct face {
	uint32_t object, number; /* number: of the object's face */
	uint32_t first, count;   /* corners */
	gi_vec3d normal;
	double size; /* of its leaves; 0: it is not cut */
	bool two_sided;
} face;

/* A sharp edge or a border, and the faces that have it; the second is GI_NONE at a border. */
typedef struct edge {
	uint32_t from, to, face, other;
} edge;

typedef struct finder {
	gi_contact_object *objects;
	double reach;
	bool strips;
	gi_vec3d *corners; /* world, those of a face one after another */
	uint32_t *places;  /* of each corner: the first corner of its object in the same place */
	face *faces;
	uint32_t face_count, corner_count;
	edge *edges; /* by face */
	uint32_t edge_count;
	uint32_t *first_edge; /* face_count + 1 */
	gi_bvh_node *nodes;   /* over the faces, grown by their reach */
	uint32_t *order;
} finder;

static void *allocate(size_t count, size_t size, bool *enough)
{
	void *memory = gi_calloc(count + 1, size);
	*enough = *enough && memory;
	return memory;
}

/* ---- faces in the world ---- */

/* By a quaternion that need not have length 1, or the other way round. */
static gi_vec3d turn(const float rotation[4], double sense, gi_vec3d v)
{
	const double x = rotation[0], y = rotation[1], z = rotation[2], w = rotation[3];
	const double length = sqrt(x * x + y * y + z * z + w * w);
	const gi_vec3d q = {sense * x / length, sense * y / length, sense * z / length};
	const gi_vec3d t = gi_vec3d_scale(gi_vec3d_cross(q, v), 2);
	return gi_vec3d_add(v, gi_vec3d_add(gi_vec3d_scale(t, w / length), gi_vec3d_cross(q, t)));
}

static gi_vec3d place(const gi_object_def *def, uint32_t vertex)
{
	const float *p = def->positions + 3 * (size_t)vertex;
	const gi_vec3d v = {(double)p[0] * def->scale[0], (double)p[1] * def->scale[1], (double)p[2] * def->scale[2]};
	return gi_vec3d_add(turn(def->pose.rotation, 1, v), gi_vec3d_load(def->pose.position));
}

/* Object space, before the scale. */
static void to_object(const gi_object_def *def, gi_vec3d world, float out[3])
{
	const gi_vec3d v = turn(def->pose.rotation, -1, gi_vec3d_sub(world, gi_vec3d_load(def->pose.position)));
	out[0] = (float)(v.x / def->scale[0]);
	out[1] = (float)(v.y / def->scale[1]);
	out[2] = (float)(v.z / def->scale[2]);
}

/* Sets the normal; false where the face is no plane. */
static bool measure_face(const finder *f, face *of)
{
	const gi_vec3d *c = f->corners + of->first;
	gi_vec3d sum = {0};
	double longest = 0;
	for (uint32_t k = 0; k < of->count; k++) {
		longest = fmax(longest, gi_vec3d_length(gi_vec3d_sub(c[(k + 1) % of->count], c[k])));
		if (k >= 2)
			sum = gi_vec3d_add(sum, gi_vec3d_triangle(c[0], c[k - 1], c[k]));
	}
	of->normal = gi_vec3d_unit(sum);
	for (uint32_t k = 1; k < of->count; k++)
		if (fabs(gi_vec3d_dot(of->normal, gi_vec3d_sub(c[k], c[0]))) > FLAT * longest)
			return false;
	return gi_vec3d_length(sum) > FLAT * FLAT * longest * longest;
}

static void place_faces(finder *f, uint32_t object)
{
	const gi_contact_object *o = &f->objects[object];
	const gi_object_def *def = o->def;
	for (uint32_t k = 0, first = 0; k < def->face_count; k++) {
		const uint32_t count = gi_corner_count(def->face_counts, k);
		face *to = &f->faces[f->face_count++];
		*to = (face){.object = object,
			     .number = k,
			     .first = f->corner_count,
			     .count = count,
			     .two_sided = def->double_sided};
		for (uint32_t i = 0; i < count; i++)
			f->corners[f->corner_count++] = place(def, def->indices[first + i]);
		const bool flat = measure_face(f, to);
		to->size = flat && o->sizes ? (double)o->sizes[k] : 0;
		first += count;
	}
}

/* ---- sharp edges and borders ---- */

typedef struct corner_key {
	uint32_t object, corner;
	float at[3];
} corner_key;

static int compare_keys(const void *a, const void *b)
{
	const corner_key *x = a, *y = b;
	if (x->object != y->object)
		return x->object < y->object ? -1 : 1;
	for (int k = 0; k < 3; k++)
		if (x->at[k] != y->at[k])
			return x->at[k] < y->at[k] ? -1 : 1;
	return x->corner < y->corner ? -1 : x->corner > y->corner;
}

static bool same_place(const corner_key *a, const corner_key *b)
{
	return a->object == b->object && a->at[0] == b->at[0] && a->at[1] == b->at[1] && a->at[2] == b->at[2];
}

/* Meshes come with vertices of their own for each face as well: what lies in one place is one. */
static bool find_places(finder *f)
{
	bool enough = true;
	corner_key *keys = allocate(f->corner_count, sizeof *keys, &enough);
	if (!enough)
		return false;
	for (uint32_t k = 0; k < f->face_count; k++)
		for (uint32_t i = f->faces[k].first; i < f->faces[k].first + f->faces[k].count; i++) {
			const gi_vec3d c = f->corners[i];
			keys[i] = (corner_key){f->faces[k].object, i, {(float)c.x, (float)c.y, (float)c.z}};
		}
	qsort(keys, f->corner_count, sizeof *keys, compare_keys);
	for (uint32_t k = 0; k < f->corner_count; k++)
		f->places[keys[k].corner] =
		    k > 0 && same_place(&keys[k], &keys[k - 1]) ? f->places[keys[k - 1].corner] : keys[k].corner;
	gi_free(keys);
	return true;
}

static int compare_edges(const void *a, const void *b)
{
	const edge *x = a, *y = b;
	if (x->from != y->from)
		return x->from < y->from ? -1 : 1;
	if (x->to != y->to)
		return x->to < y->to ? -1 : 1;
	return x->face < y->face ? -1 : x->face > y->face;
}

static int compare_edge_faces(const void *a, const void *b)
{
	const edge *x = a, *y = b;
	return x->face != y->face ? (x->face < y->face ? -1 : 1) : compare_edges(a, b);
}

/* Of all edges of one place, [first, end): has it one face, or two that look apart? */
static bool is_sharp(const finder *f, const edge *edges, uint32_t first, uint32_t end, uint32_t *other)
{
	*other = GI_NONE;
	for (uint32_t k = first + 1; k < end && *other == GI_NONE; k++)
		if (gi_vec3d_dot(f->faces[edges[k].face].normal, f->faces[edges[first].face].normal) < SHARP_COSINE)
			*other = edges[k].face;
	return end - first == 1 || *other != GI_NONE;
}

static bool find_edges(finder *f)
{
	bool enough = true;
	f->edges = allocate(f->corner_count, sizeof *f->edges, &enough);
	f->first_edge = allocate(f->face_count, sizeof *f->first_edge, &enough);
	if (!enough)
		return false;
	for (uint32_t k = 0; k < f->face_count; k++)
		for (uint32_t i = 0; i < f->faces[k].count; i++) {
			const uint32_t a = f->places[f->faces[k].first + i],
				       b = f->places[f->faces[k].first + (i + 1) % f->faces[k].count];
			f->edges[f->faces[k].first + i] = (edge){a < b ? a : b, a < b ? b : a, k, GI_NONE};
		}
	qsort(f->edges, f->corner_count, sizeof *f->edges, compare_edges);
	for (uint32_t k = 0, end; k < f->corner_count; k = end) {
		for (end = k + 1; end < f->corner_count && f->edges[end].from == f->edges[k].from &&
				  f->edges[end].to == f->edges[k].to;)
			end++;
		uint32_t other;
		if (f->edges[k].from == f->edges[k].to || !is_sharp(f, f->edges, k, end, &other))
			continue;
		f->edges[f->edge_count] = f->edges[k];
		f->edges[f->edge_count++].other = other;
	}
	qsort(f->edges, f->edge_count, sizeof *f->edges, compare_edge_faces);
	for (uint32_t k = 0; k < f->edge_count; k++)
		f->first_edge[f->edges[k].face + 1]++;
	for (uint32_t k = 0; k < f->face_count; k++)
		f->first_edge[k + 1] += f->first_edge[k];
	return true;
}

/* ---- lines ---- */

static bool add_cut(gi_contact_object *o, uint32_t face_number, gi_vec3d from, gi_vec3d to, bool parts)
{
	/* Doubles at powers of two. */
	if ((o->cut_count & (o->cut_count - 1)) == 0) {
		gi_leaf_cut *grown = gi_realloc(o->cuts, sizeof *grown * (o->cut_count ? 2 * (size_t)o->cut_count : 1));
		if (!grown)
			return false;
		o->cuts = grown;
	}
	gi_leaf_cut *cut = &o->cuts[o->cut_count++];
	cut->face = face_number;
	cut->parts = parts;
	to_object(o->def, from, cut->from);
	to_object(o->def, to, cut->to);
	return true;
}

/* Does the contact of two faces last? */
static bool stays(const finder *f, const face *a, const face *b)
{
	return a->object == b->object || !(f->objects[a->object].moves || f->objects[b->object].moves);
}

static double height_over(const finder *f, const face *on, gi_vec3d p)
{
	return gi_vec3d_dot(on->normal, gi_vec3d_sub(p, f->corners[on->first]));
}

static gi_vec3d mix(gi_vec3d a, gi_vec3d b, double t)
{
	return gi_vec3d_add(gi_vec3d_scale(a, 1 - t), gi_vec3d_scale(b, t));
}

static gi_vec3d face_centre(const finder *f, const face *of)
{
	gi_vec3d sum = {0, 0, 0};
	for (uint32_t k = of->first; k < of->first + of->count; k++)
		sum = gi_vec3d_add(sum, f->corners[k]);
	return gi_vec3d_scale(sum, 1.0 / of->count);
}

/* Where a face runs through the plane of another: between the ends of its way across. */
static bool cross_face(finder *f, const face *on, const face *through)
{
	const double touch = TOUCH * on->size;
	double least = INFINITY, most = -INFINITY;
	for (uint32_t k = 0; k < through->count; k++) {
		const double height = height_over(f, on, f->corners[through->first + k]);
		least = fmin(least, height);
		most = fmax(most, height);
	}
	if (least >= -touch || most <= touch)
		return true;
	const gi_vec3d along = gi_vec3d_unit(gi_vec3d_cross(on->normal, through->normal));
	gi_vec3d ends[2] = {{0, 0, 0}, {0, 0, 0}};
	double reached[2] = {INFINITY, -INFINITY};
	for (uint32_t k = 0; k < through->count; k++) {
		const gi_vec3d a = f->corners[through->first + k],
			       b = f->corners[through->first + (k + 1) % through->count];
		const double from = height_over(f, on, a), to = height_over(f, on, b);
		if (from * to > 0 || from == to)
			continue;
		const gi_vec3d p = mix(a, b, from / (from - to));
		const double at = gi_vec3d_dot(along, p);
		if (at < reached[0]) {
			reached[0] = at;
			ends[0] = p;
		}
		if (at > reached[1]) {
			reached[1] = at;
			ends[1] = p;
		}
	}
	return reached[1] - reached[0] < SHORTEST * on->size ||
	       add_cut(&f->objects[on->object], on->number, ends[0], ends[1], stays(f, on, through));
}

/* Light that comes in below an edge at some height falls off within a few heights, on the face and on the one above it:
 * each gets strips along the edge, or the leaves at the border would hand their mean on to what lies deep below. What
 * comes in comes from the foot outside, which sees less than the rest of its leaf: one strip there.
 */
static bool add_strips(finder *f, const face *on, const face *above, gi_vec3d from, gi_vec3d to)
{
	const double height = fabs(height_over(f, on, mix(from, to, 0.5)));
	if (height <= TOUCH * on->size)
		return true;
	gi_vec3d inward = gi_vec3d_cross(above->normal, gi_vec3d_unit(gi_vec3d_sub(to, from)));
	if (gi_vec3d_dot(inward, gi_vec3d_sub(face_centre(f, above), from)) < 0)
		inward = gi_vec3d_scale(inward, -1);
	double width = fmax(height, THINNEST_STRIP * on->size);
	const gi_vec3d out = gi_vec3d_scale(inward, -width);
	bool enough =
	    width >= WIDEST_STRIP * on->size ||
	    add_cut(&f->objects[on->object], on->number, gi_vec3d_add(from, out), gi_vec3d_add(to, out), false);
	for (; enough && width < WIDEST_STRIP * on->size; width *= STRIP_GROWTH) {
		const gi_vec3d shift = gi_vec3d_scale(inward, width), a = gi_vec3d_add(from, shift),
			       b = gi_vec3d_add(to, shift);
		enough = add_cut(&f->objects[on->object], on->number, a, b, false) &&
			 (!(above->size > 0) || add_cut(&f->objects[above->object], above->number, a, b, false));
	}
	return enough;
}

/* The face of an edge that lies along another, if one does. */
static const face *lies_along(const finder *f, const face *on, uint32_t number)
{
	const face *of = number == GI_NONE ? NULL : &f->faces[number];
	return of && fabs(gi_vec3d_dot(on->normal, of->normal)) > ALONG_COSINE ? of : NULL;
}

static bool add_lines(finder *f, const face *on, const edge *e, gi_vec3d from, gi_vec3d to)
{
	const face *above[2] = {lies_along(f, on, e->face), lies_along(f, on, e->other)};
	/* Below an edge that hovers light gets to both sides. */
	const double touch = TOUCH * on->size;
	const bool stands = fabs(height_over(f, on, from)) <= touch && fabs(height_over(f, on, to)) <= touch;
	bool enough =
	    add_cut(&f->objects[on->object], on->number, from, to, stands && stays(f, on, &f->faces[e->face]));
	for (int k = 0; k < 2 && enough && f->strips; k++)
		enough = !above[k] || add_strips(f, on, above[k], from, to);
	return enough;
}

/* Below the part of an edge that is close above the face. */
static bool project_edge(finder *f, const face *on, const edge *e)
{
	const gi_vec3d a = f->corners[e->from], b = f->corners[e->to];
	const double touch = TOUCH * on->size, highest = f->reach * on->size;
	const double from = height_over(f, on, a), to = height_over(f, on, b), rise = to - from;
	const double lowest = on->two_sided ? -highest : -touch;
	const double length = gi_vec3d_length(gi_vec3d_sub(b, a));
	if (fabs(rise) > STEEPEST * length)
		return true;
	double t[2] = {0, 1};
	if (fabs(rise) > 1e-9 * length) {
		const double low = (lowest - from) / rise, high = (highest - from) / rise;
		t[0] = fmax(t[0], fmin(low, high));
		t[1] = fmin(t[1], fmax(low, high));
	} else if (from < lowest || from > highest) {
		return true;
	}
	return (t[1] - t[0]) * length < SHORTEST * on->size || add_lines(f, on, e, mix(a, b, t[0]), mix(a, b, t[1]));
}

/* ---- pairs ---- */

static gi_box bounds(const finder *f, const face *of, double grown)
{
	gi_vec3d l = {INFINITY, INFINITY, INFINITY}, u = {-INFINITY, -INFINITY, -INFINITY};
	for (uint32_t k = of->first; k < of->first + of->count; k++) {
		const gi_vec3d c = f->corners[k];
		l = (gi_vec3d){fmin(l.x, c.x), fmin(l.y, c.y), fmin(l.z, c.z)};
		u = (gi_vec3d){fmax(u.x, c.x), fmax(u.y, c.y), fmax(u.z, c.z)};
	}
	return (gi_box){{(float)(l.x - grown), (float)(l.y - grown), (float)(l.z - grown)},
			{(float)(u.x + grown), (float)(u.y + grown), (float)(u.z + grown)}};
}

static bool boxes_meet(const gi_bvh_node *n, const gi_box *box)
{
	return box->lower[0] <= n->upper.x && box->upper[0] >= n->lower.x && box->lower[1] <= n->upper.y &&
	       box->upper[1] >= n->lower.y && box->lower[2] <= n->upper.z && box->upper[2] >= n->lower.z;
}

static bool meet(finder *f, const face *on, uint32_t other)
{
	const face *through = &f->faces[other];
	bool enough = cross_face(f, on, through);
	for (uint32_t k = f->first_edge[other]; enough && k < f->first_edge[other + 1]; k++)
		enough = project_edge(f, on, &f->edges[k]);
	return enough;
}

static bool find_pairs(finder *f)
{
	bool enough = true;
	const uint32_t nodes = f->face_count ? 2 * f->face_count - 1 : 0;
	for (uint32_t other = 0; other < f->face_count && enough; other++) {
		const gi_box box = bounds(f, &f->faces[other], 0);
		for (uint32_t n = 0; n < nodes && enough;) {
			if (!boxes_meet(&f->nodes[n], &box)) {
				n = gi_bits_from_float(f->nodes[n].lower.w);
				continue;
			}
			const uint32_t leaf = gi_bits_from_float(f->nodes[n++].upper.w);
			if (leaf == GI_NONE || f->order[leaf] == other || !(f->faces[f->order[leaf]].size > 0))
				continue;
			enough = meet(f, &f->faces[f->order[leaf]], other);
		}
	}
	return enough;
}

static bool build_tree(finder *f)
{
	bool enough = true;
	gi_box *boxes = allocate(f->face_count, sizeof *boxes, &enough);
	f->nodes = allocate(2 * (size_t)f->face_count, sizeof *f->nodes, &enough);
	f->order = allocate(f->face_count, sizeof *f->order, &enough);
	for (uint32_t k = 0; enough && k < f->face_count; k++)
		boxes[k] = bounds(f, &f->faces[k], fmax(f->reach, TOUCH) * f->faces[k].size);
	if (enough)
		gi_bvh_build_boxes(boxes, f->face_count, f->nodes, f->order);
	gi_free(boxes);
	return enough;
}

static bool place_all(finder *f, uint32_t count)
{
	bool enough = true;
	size_t faces = 0, corners = 0;
	for (uint32_t k = 0; k < count; k++) {
		faces += f->objects[k].def->face_count;
		corners += f->objects[k].def->index_count;
	}
	f->corners = allocate(corners, sizeof *f->corners, &enough);
	f->places = allocate(corners, sizeof *f->places, &enough);
	f->faces = allocate(faces, sizeof *f->faces, &enough);
	for (uint32_t k = 0; enough && k < count; k++)
		place_faces(f, k);
	return enough;
}

bool gi_find_contacts(gi_contact_object *objects, uint32_t count, double reach, bool strips)
{
	finder f = {.objects = objects, .reach = reach, .strips = strips};
	const bool done = place_all(&f, count) && find_places(&f) && find_edges(&f) && build_tree(&f) && find_pairs(&f);
	gi_free(f.corners);
	gi_free(f.places);
	gi_free(f.faces);
	gi_free(f.edges);
	gi_free(f.first_edge);
	gi_free(f.nodes);
	gi_free(f.order);
	return done;
}
