/* Planes of a scene whose file rounds: two rooms that share a wall, written with nine digits three kilometres from the
 * origin, have two walls some 1e-5 m apart and bent by as much. A few times that is more than a renderer may take for
 * one place without asking, so the walls are made one plane here, where it is known what the file rounds.
 *
 * Faces are taken from the largest on. Each begins a plane, or lies in one: neighbours (by boxes) join it while all
 * their corners are within its rounding, and the plane is fitted anew (least squares) whenever it has twice the
 * corners. Corners in one place are one point; a point goes to where the first three of its planes meet.
 */
#include "import_level.h"

#include "import_points.h"
#include "import_tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* In units of the rounding: how far a corner may be off the plane that it belongs to (two roundings of three
 * coordinates each, and the plane's own), how far it may be moved, and how wide a face is at least to have a normal. */
static const double OFF = 4, MOVED = 16, WIDE = 20;

/* Sine of the angle between planes that meet in a line of some place. */
static const double APART = 0.1;

/* The largest faces alone; no more is looked at than some scenes of that size need. */
enum { MOST_FACES = 100000 };
static const uint64_t MOST_VISITS = (uint64_t)1 << 25;

typedef struct level_plane {
	double normal[3], height;
	uint32_t faces;
} level_plane;

typedef struct level_face {
	uint32_t first, count; /* of its corners, in level.corners */
	uint32_t plane;        /* its number and one; 0: none yet */
	double area;
	double rounding;
	import_box box;
} level_face;

/* What a plane is fitted to: sums over its corners, relative to one of them. */
typedef struct level_sums {
	double origin[3], count;
	double sum[3], products[3][3];
} level_sums;

typedef struct level {
	engine_scene *scene;
	double *rounding;  /* by object, metres in the world; < 0: it takes no part */
	uint32_t *bases;   /* by object: its first vertex among all */
	double *positions; /* 3 * vertex_count, world */
	uint32_t *points;  /* by vertex: the number of the first vertex in its place */
	uint32_t vertex_count;
	level_face *faces; /* from the largest on */
	uint32_t face_count;
	uint32_t *corners; /* vertices */
	uint32_t corner_count;
	level_plane *planes;
	uint32_t plane_count;
	uint32_t *queue; /* faces of a plane whose neighbours were not asked */
	uint64_t visits;
	double largest_rounding;
} level;

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* ---- what takes part --------------------------------------------------------------------------------------------- */

/* In the world, of what floats and digits hold of its mesh and of its node's place. */
static double world_rounding(const engine_scene *scene, const engine_scene_object *object)
{
	const double *world = scene->graph->world + 16 * (size_t)object->node;
	const float *scale = object->rest.scale;
	double place = 0;
	for (int c = 0; c < 3; c++)
		place = fmax(place, fabs(world[12 + c]));
	return object->rounding * (double)fmaxf(scale[0], fmaxf(scale[1], scale[2])) + ldexp(place, -24);
}

static void count_objects(level *l)
{
	for (uint32_t o = 0; o < l->scene->object_count; o++) {
		const engine_scene_object *object = &l->scene->objects[o];
		const bool still = !object->animated && object->scheme == ENGINE_SCHEME_BILINEAR;
		l->rounding[o] = still ? world_rounding(l->scene, object) : -1;
		l->bases[o] = l->vertex_count;
		if (!still)
			continue;
		l->largest_rounding = fmax(l->largest_rounding, l->rounding[o]);
		l->vertex_count += object->mesh.vertex_count;
		l->face_count += object->mesh.face_count;
		l->corner_count += object->mesh.index_count;
	}
}

/* By the quaternion, brought to length 1 as the renderer does; back: by its inverse. */
static void turn(const float rotation[4], bool back, const double v[3], double out[3])
{
	double q[4], length2 = 0, t[3], u[3];
	for (int k = 0; k < 4; k++) {
		q[k] = rotation[k];
		length2 += q[k] * q[k];
	}
	cross(q, v, t);
	cross(q, t, u);
	for (int k = 0; k < 3; k++)
		out[k] = v[k] + 2 * ((back ? -q[3] : q[3]) * t[k] + u[k]) / length2;
}

static void to_world(const engine_pose *pose, const float p[3], double out[3])
{
	double v[3];
	for (int k = 0; k < 3; k++)
		v[k] = (double)p[k] * (double)pose->scale[k];
	turn(pose->rotation, false, v, out);
	for (int k = 0; k < 3; k++)
		out[k] += (double)pose->translation[k];
}

static void to_object(const engine_pose *pose, const double world[3], float out[3])
{
	double v[3], p[3];
	for (int k = 0; k < 3; k++)
		v[k] = world[k] - (double)pose->translation[k];
	turn(pose->rotation, true, v, p);
	for (int k = 0; k < 3; k++)
		out[k] = (float)(p[k] / (double)pose->scale[k]);
}

/* Returns the largest coordinate. */
static double find_positions(level *l)
{
	double reach = 0;
	for (uint32_t o = 0; o < l->scene->object_count; o++) {
		const engine_scene_object *object = &l->scene->objects[o];
		for (uint32_t v = 0; l->rounding[o] >= 0 && v < object->mesh.vertex_count; v++) {
			double *p = l->positions + 3 * ((size_t)l->bases[o] + v);
			to_world(&object->rest, object->mesh.positions + 3 * (size_t)v, p);
			for (int c = 0; c < 3; c++)
				reach = fmax(reach, fabs(p[c]));
		}
	}
	return reach;
}

/* ---- faces ------------------------------------------------------------------------------------------------------- */

static const double *corner_of(const level *l, const level_face *face, uint32_t k)
{
	return l->positions + 3 * (size_t)l->corners[face->first + k];
}

/* By Newell's method relative to the first corner; its length is the area. */
static void area_normal(const level *l, const level_face *face, double normal[3])
{
	const double *origin = corner_of(l, face, 0);
	memset(normal, 0, 3 * sizeof *normal);
	for (uint32_t k = 1; k + 1 < face->count; k++) {
		double a[3], b[3], n[3];
		for (int c = 0; c < 3; c++) {
			a[c] = corner_of(l, face, k)[c] - origin[c];
			b[c] = corner_of(l, face, k + 1)[c] - origin[c];
		}
		cross(a, b, n);
		for (int c = 0; c < 3; c++)
			normal[c] += .5 * n[c];
	}
}

/* False for one too thin to have a normal. */
static bool measure_face(const level *l, level_face *face)
{
	double normal[3], size2 = 0;
	area_normal(l, face, normal);
	face->area = sqrt(dot(normal, normal));
	face->box = import_box_of_nothing();
	for (uint32_t k = 0; k < face->count; k++)
		import_box_widen(&face->box, corner_of(l, face, k));
	for (int c = 0; c < 3; c++)
		size2 += pow(face->box.upper[c] - face->box.lower[c], 2);
	return 2 * face->area > WIDE * face->rounding * sqrt(size2);
}

static int from_largest(const void *a, const void *b)
{
	const level_face *x = a, *y = b;
	const int by_area = (x->area < y->area) - (x->area > y->area);
	return by_area ? by_area : (x->first > y->first) - (x->first < y->first);
}

static void find_faces(level *l)
{
	uint32_t faces = 0, corners = 0;
	for (uint32_t o = 0; o < l->scene->object_count; o++) {
		const engine_mesh *mesh = &l->scene->objects[o].mesh;
		const uint32_t *from = mesh->indices;
		for (uint32_t f = 0; l->rounding[o] >= 0 && f < mesh->face_count; from += mesh->face_counts[f++]) {
			level_face face = {.first = corners, .count = mesh->face_counts[f], .rounding = l->rounding[o]};
			for (uint32_t k = 0; k < face.count; k++)
				l->corners[corners + k] = l->bases[o] + from[k];
			corners += face.count;
			if (measure_face(l, &face))
				l->faces[faces++] = face;
		}
	}
	qsort(l->faces, faces, sizeof *l->faces, from_largest);
	l->face_count = faces < MOST_FACES ? faces : MOST_FACES;
}

/* ---- planes ------------------------------------------------------------------------------------------------------ */

static level_plane plane_of_face(const level *l, const level_face *face)
{
	level_plane plane = {.faces = 0};
	area_normal(l, face, plane.normal);
	for (int c = 0; c < 3; c++)
		plane.normal[c] /= face->area;
	for (uint32_t k = 0; k < face->count; k++)
		plane.height += dot(plane.normal, corner_of(l, face, k)) / face->count;
	return plane;
}

static void add_corners(const level *l, const level_face *face, level_sums *s)
{
	for (uint32_t k = 0; k < face->count; k++) {
		double d[3];
		for (int c = 0; c < 3; c++)
			d[c] = corner_of(l, face, k)[c] - s->origin[c];
		for (int c = 0; c < 3; c++) {
			s->sum[c] += d[c];
			for (int i = 0; i < 3; i++)
				s->products[c][i] += d[c] * d[i];
		}
		s->count++;
	}
}

/* a' C b, C the covariance of the corners times their number. */
static double spread(const level_sums *s, const double a[3], const double b[3])
{
	double sum = -dot(a, s->sum) * dot(b, s->sum) / s->count;
	for (int c = 0; c < 3; c++)
		sum += a[c] * dot(s->products[c], b);
	return sum;
}

/* Least squares: heights over the plane as it is, u and v in it. */
static void fit_plane(const level_sums *s, level_plane *plane)
{
	const double *n = plane->normal;
	const int least =
	    fabs(n[0]) < fabs(n[1]) ? (fabs(n[0]) < fabs(n[2]) ? 0 : 2) : (fabs(n[1]) < fabs(n[2]) ? 1 : 2);
	const double axis[3] = {least == 0, least == 1, least == 2};
	double u[3], v[3], turned[3];
	cross(n, axis, u);
	cross(n, u, v);
	const double uu = spread(s, u, u), uv = spread(s, u, v), vv = spread(s, v, v), uh = spread(s, u, n),
		     vh = spread(s, v, n), determinant = uu * vv - uv * uv;
	if (determinant > 1e-6 * (uu + vv) * (uu + vv)) {
		const double a = (uh * vv - vh * uv) / determinant, b = (vh * uu - uh * uv) / determinant;
		for (int c = 0; c < 3; c++)
			turned[c] = n[c] - a * u[c] - b * v[c];
		const double length = sqrt(dot(turned, turned));
		for (int c = 0; c < 3; c++)
			plane->normal[c] = turned[c] / length;
	}
	plane->height = dot(plane->normal, s->origin) + dot(plane->normal, s->sum) / s->count;
}

static bool lies_in(const level *l, const level_face *face, const level_plane *plane, double rounding)
{
	for (uint32_t k = 0; k < face->count; k++)
		if (fabs(dot(plane->normal, corner_of(l, face, k)) - plane->height) >
		    .5 * OFF * (face->rounding + rounding))
			return false;
	return true;
}

typedef struct level_search {
	level *l;
	level_plane *plane;
	level_sums *sums;
	double rounding, next_fit;
	uint32_t queued;
} level_search;

static void take_face(level_search *s, uint32_t f)
{
	level_face *face = &s->l->faces[f];
	face->plane = s->l->plane_count;
	s->plane->faces++;
	s->l->queue[s->queued++] = f;
	add_corners(s->l, face, s->sums);
	if (s->sums->count < s->next_fit)
		return;
	fit_plane(s->sums, s->plane);
	s->next_fit = 2 * s->sums->count;
}

static bool try_face(void *context, uint32_t f)
{
	level_search *s = context;
	const level_face *face = &s->l->faces[f];
	if (face->plane == 0 && lies_in(s->l, face, s->plane, s->rounding))
		take_face(s, f);
	return ++s->l->visits < MOST_VISITS;
}

/* All that hangs together with a face in its plane. */
static void grow_plane(level *l, const import_tree *tree, uint32_t seed)
{
	level_plane *plane = &l->planes[l->plane_count++];
	*plane = plane_of_face(l, &l->faces[seed]);
	level_sums sums = {.count = 0};
	memcpy(sums.origin, corner_of(l, &l->faces[seed], 0), sizeof sums.origin);
	level_search s = {l, plane, &sums, l->faces[seed].rounding, l->faces[seed].count, 0};
	take_face(&s, seed);
	for (uint32_t k = 0; k < s.queued && l->visits < MOST_VISITS; k++) {
		import_box box = l->faces[l->queue[k]].box;
		const double margin = OFF * l->largest_rounding;
		for (int c = 0; c < 3; c++) {
			box.lower[c] -= margin;
			box.upper[c] += margin;
		}
		import_tree_search(tree, &box, plane->normal, plane->height, margin, try_face, &s);
	}
	fit_plane(&sums, plane);
}

static bool find_planes(level *l)
{
	import_tree tree;
	import_box *boxes = malloc(((size_t)l->face_count + 1) * sizeof *boxes);
	for (uint32_t f = 0; boxes && f < l->face_count; f++)
		boxes[f] = l->faces[f].box;
	const bool built = boxes && import_tree_build(&tree, boxes, l->face_count);
	free(boxes);
	if (!built)
		return false;
	for (uint32_t f = 0; f < l->face_count && l->visits < MOST_VISITS; f++)
		if (l->faces[f].plane == 0)
			grow_plane(l, &tree, f);
	import_tree_free(&tree);
	return true;
}

/* ---- points ------------------------------------------------------------------------------------------------------ */

/* The part of a way into a point's planes that its planes so far leave free. */
typedef struct level_point {
	double at[3], free[3][3];
	uint32_t planes, last[3];
} level_point;

static void bring_into(level_point *p, const level_plane *plane, uint32_t number)
{
	double way[3], lack = plane->height - dot(plane->normal, p->at);
	for (uint32_t k = 0; k < p->planes; k++)
		if (p->last[k] == number)
			return;
	if (p->planes == 3)
		return;
	memcpy(way, plane->normal, sizeof way);
	for (uint32_t k = 0; k < p->planes; k++) {
		const double along = dot(way, p->free[k]);
		for (int c = 0; c < 3; c++)
			way[c] -= along * p->free[k][c];
	}
	const double length = sqrt(dot(way, way));
	if (length < APART)
		return;
	for (int c = 0; c < 3; c++) {
		p->free[p->planes][c] = way[c] / length;
		p->at[c] += way[c] / length * (lack / length);
	}
	p->last[p->planes++] = number;
}

/* Planes of one triangle alone are as they were. */
static bool is_to_be_level(const level *l, const level_face *face)
{
	return face->plane > 0 && (l->planes[face->plane - 1].faces > 1 || face->count > 3);
}

static void move_points(level *l, level_point *points)
{
	for (uint32_t v = 0; v < l->vertex_count; v++)
		memcpy(points[v].at, l->positions + 3 * (size_t)v, sizeof points[v].at);
	for (uint32_t f = 0; f < l->face_count; f++) {
		const level_face *face = &l->faces[f];
		for (uint32_t k = 0; is_to_be_level(l, face) && k < face->count; k++)
			bring_into(&points[l->points[l->corners[face->first + k]]], &l->planes[face->plane - 1],
				   face->plane);
	}
}

static bool is_near(const double a[3], const double b[3], double distance)
{
	return fabs(a[0] - b[0]) <= distance && fabs(a[1] - b[1]) <= distance && fabs(a[2] - b[2]) <= distance;
}

static void write_positions(const level *l, const level_point *points)
{
	for (uint32_t o = 0; o < l->scene->object_count; o++) {
		engine_scene_object *object = &l->scene->objects[o];
		for (uint32_t v = 0; l->rounding[o] >= 0 && v < object->mesh.vertex_count; v++) {
			const uint32_t number = l->bases[o] + v;
			const level_point *p = &points[l->points[number]];
			if (p->planes > 0 &&
			    is_near(p->at, l->positions + 3 * (size_t)number, MOVED * l->largest_rounding))
				to_object(&object->rest, p->at, object->mesh.positions + 3 * (size_t)v);
		}
	}
}

/* ---- the scene --------------------------------------------------------------------------------------------------- */

static bool allocate(level *l)
{
	l->positions = malloc(((size_t)l->vertex_count + 1) * 3 * sizeof *l->positions);
	l->points = malloc(((size_t)l->vertex_count + 1) * sizeof *l->points);
	l->faces = malloc(((size_t)l->face_count + 1) * sizeof *l->faces);
	l->planes = malloc(((size_t)l->face_count + 1) * sizeof *l->planes);
	l->queue = malloc(((size_t)l->face_count + 1) * sizeof *l->queue);
	l->corners = malloc(((size_t)l->corner_count + 1) * sizeof *l->corners);
	return l->positions && l->points && l->faces && l->planes && l->queue && l->corners;
}

static void level_all(level *l)
{
	level_point *points = calloc((size_t)l->vertex_count + 1, sizeof *points);
	find_faces(l);
	if (points && import_points_weld(l->positions, l->vertex_count, 2 * l->largest_rounding, l->points) &&
	    find_planes(l)) {
		move_points(l, points);
		write_positions(l, points);
	}
	free(points);
}

void import_level_planes(import_loader *loader)
{
	const size_t objects = (size_t)loader->scene->object_count + 1;
	level l = {.scene = loader->scene,
		   .rounding = malloc(objects * sizeof *l.rounding),
		   .bases = malloc(objects * sizeof *l.bases)};
	if (l.rounding && l.bases)
		count_objects(&l);
	/* A float of the renderer's rounds by 2^-24 of it. */
	if (l.largest_rounding > 0 && allocate(&l) && l.largest_rounding > ldexp(find_positions(&l), -24))
		level_all(&l);
	free(l.rounding);
	free(l.bases);
	free(l.positions);
	free(l.points);
	free(l.faces);
	free(l.planes);
	free(l.queue);
	free(l.corners);
}
