#include "mesh_polygon.h"

#include "mesh.h"

#include <GL/glu.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* GLU keeps the edges across its sweep in a list: a polygon of n corners takes up to 3 ns n^2, those of a mesh together
 * a few seconds. Polygons of files have some tens of corners.
 */
static const uint32_t MOST_CORNERS = 10000;
static const uint64_t MOST_SQUARES = 1000000000;

/* The mesh that is made, grown as needed, and the polygon in work. */
typedef struct cutter {
	GLUtesselator *tesselator;
	engine_mesh out;
	size_t vertex_room, face_room, index_room;
	size_t uv_room, color_room;
	uint32_t corners[3], corner_count; /* of the triangle that comes in */
	const uint32_t *polygon;           /* the corners of the one in work, */
	uint32_t polygon_count;
	const float *polygon_uvs, *polygon_colors; /* and what they carry; NULL: none */
	uint64_t squares;                          /* of the corners of all polygons cut */
	bool failed;
} cutter;

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Makes room for one more element and its like. */
static bool grow(void **array, size_t *room, size_t needed, size_t size)
{
	if (needed <= *room)
		return true;
	size_t wanted = needed + needed / 2 + 64;
	void *grown = realloc(*array, wanted * size);
	if (!grown)
		return false;
	*array = grown;
	*room = wanted;
	return true;
}

/* What the polygon's corners carry, `size` values each, NULL: nothing; a vertex that cutting made has the first
 * corner's. */
static bool add_values(cutter *c, const float *from, uint32_t size, float **to, size_t *room, const uint32_t *corners,
		       uint32_t count)
{
	const size_t first = c->out.index_count;
	if (!from)
		return true;
	if (!grow((void **)to, room, first + count, size * sizeof(float)))
		return false;
	for (uint32_t k = 0; k < count; k++) {
		uint32_t at = 0;
		while (at < c->polygon_count && c->polygon[at] != corners[k])
			at++;
		memcpy(*to + size * (first + k), from + size * (size_t)(at < c->polygon_count ? at : 0),
		       size * sizeof(float));
	}
	return true;
}

static bool add_face(cutter *c, const uint32_t *corners, uint32_t count, uint32_t material)
{
	engine_mesh *out = &c->out;
	size_t room = c->face_room;
	if (!grow((void **)&out->indices, &c->index_room, (size_t)out->index_count + count, sizeof(uint32_t)) ||
	    !grow((void **)&out->face_counts, &room, (size_t)out->face_count + 1, sizeof(uint32_t)) ||
	    !grow((void **)&out->face_materials, &c->face_room, (size_t)out->face_count + 1, sizeof(uint32_t)))
		return false;
	if (!add_values(c, c->polygon_uvs, 2, &out->uvs, &c->uv_room, corners, count) ||
	    !add_values(c, c->polygon_colors, 4, &out->colors, &c->color_room, corners, count))
		return false;
	memcpy(out->indices + out->index_count, corners, count * sizeof *corners);
	out->index_count += count;
	out->face_materials[out->face_count] = material;
	out->face_counts[out->face_count++] = count;
	return true;
}

/* ---- what GLU calls ---------------------------------------------------------------------------------------------- */

/* Vertices go through GLU as their numbers and one, so that none is NULL. */
static uint32_t number_of(const void *data)
{
	return (uint32_t)((uintptr_t)data - 1);
}

static void take_corner(void *data, void *user)
{
	cutter *c = user;
	c->corners[c->corner_count++] = number_of(data);
	if (c->corner_count < 3)
		return;
	c->corner_count = 0;
	const uint32_t *t = c->corners; /* crossings that fall together leave needles of two vertices */
	if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
		c->failed = c->failed || !add_face(c, t, 3, 0);
}

/* Where edges cross or rims touch: the vertex that is there already, or a new one. */
static void make_crossing(GLdouble coords[3], void *data[4], GLfloat weights[4], void **made, void *user)
{
	cutter *c = user;
	engine_mesh *out = &c->out;
	bool same = true;
	double position[3] = {0, 0, 0};
	(void)coords;
	for (int k = 0; k < 4 && data[k]; k++) {
		same = same && data[k] == data[0];
		for (int i = 0; i < 3; i++)
			position[i] += (double)weights[k] * out->positions[3 * (size_t)number_of(data[k]) + (size_t)i];
	}
	*made = data[0];
	if (same)
		return;
	if (out->vertex_count >= 1u << 30 ||
	    !grow((void **)&out->positions, &c->vertex_room, (size_t)out->vertex_count + 1, 3 * sizeof(float))) {
		c->failed = true;
		return;
	}
	for (int i = 0; i < 3; i++)
		out->positions[3 * (size_t)out->vertex_count + (size_t)i] = (float)position[i];
	*made = (void *)(uintptr_t)(++out->vertex_count);
}

/* That it is there makes GLU give triangles, no strips and fans. */
static void take_edge_flag(GLboolean flag, void *user)
{
	(void)flag;
	(void)user;
}

static void take_error(GLenum error, void *user)
{
	((cutter *)user)->failed = error == GLU_OUT_OF_MEMORY || ((cutter *)user)->failed;
}

typedef void (*glu_callback)(void);

static bool make_tesselator(cutter *c)
{
	c->tesselator = gluNewTess();
	if (!c->tesselator)
		return false;
	gluTessCallback(c->tesselator, GLU_TESS_VERTEX_DATA, (glu_callback)take_corner);
	gluTessCallback(c->tesselator, GLU_TESS_COMBINE_DATA, (glu_callback)make_crossing);
	gluTessCallback(c->tesselator, GLU_TESS_EDGE_FLAG_DATA, (glu_callback)take_edge_flag);
	gluTessCallback(c->tesselator, GLU_TESS_ERROR_DATA, (glu_callback)take_error);
	gluTessProperty(c->tesselator, GLU_TESS_WINDING_RULE, GLU_TESS_WINDING_ODD);
	gluTessNormal(c->tesselator, 0, 0, 1);
	return true;
}

/* ---- polygons ---------------------------------------------------------------------------------------------------- */

/* Twice the area of a triangle along the normal of its polygon. */
static double signed_area(const engine_mesh *mesh, uint32_t a, uint32_t b, uint32_t c, const double normal[3])
{
	double n[3];
	engine_mesh_face_normal(mesh, (const uint32_t[3]){a, b, c}, 3, n);
	return dot(n, normal);
}

static int compare_numbers(const void *a, const void *b)
{
	uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
	return (x > y) - (x < y);
}

/* scratch: as many. */
static bool passes_twice(const uint32_t *corners, uint32_t count, uint32_t *scratch)
{
	memcpy(scratch, corners, count * sizeof *corners);
	qsort(scratch, count, sizeof *scratch, compare_numbers);
	for (uint32_t i = 0; i + 1 < count; i++) {
		if (scratch[i] == scratch[i + 1])
			return true;
	}
	return false;
}

/* Every corner turns left and every triangle of the fan lies on the front: a star turns left always and is none. 1e-6
 * of the area: rounding of corners on a straight side.
 */
static bool is_convex(const engine_mesh *mesh, const uint32_t *corners, uint32_t count)
{
	double normal[3];
	engine_mesh_face_normal(mesh, corners, count, normal);
	double least = -1e-6 * dot(normal, normal);
	for (uint32_t i = 0; i < count; i++) {
		uint32_t next = corners[(i + 1) % count];
		if (signed_area(mesh, corners[i], next, corners[(i + 2) % count], normal) < least ||
		    signed_area(mesh, corners[0], corners[i], next, normal) < least)
			return false;
	}
	return true;
}

/* From the first corner to another, metres. */
static void offset_of(const engine_mesh *mesh, uint32_t first, uint32_t corner, double offset[3])
{
	for (size_t k = 0; k < 3; k++)
		offset[k] = (double)mesh->positions[3 * (size_t)corner + k] - mesh->positions[3 * (size_t)first + k];
}

/* Two unit vectors across the normal, the first to the corner that is farthest from the first: GLU sweeps along it, and
 * takes as long as edges lie across the sweep.
 */
static void make_axes(const engine_mesh *mesh, const uint32_t *corners, uint32_t count, double right[3], double up[3])
{
	double normal[3], farthest = 0;
	engine_mesh_face_normal(mesh, corners, count, normal);
	double length = sqrt(dot(normal, normal));
	for (uint32_t i = 1; i < count; i++) {
		double flat[3];
		offset_of(mesh, corners[0], corners[i], flat);
		double height = dot(flat, normal) / length;
		for (int k = 0; k < 3; k++)
			flat[k] -= height * normal[k] / length;
		if (dot(flat, flat) > farthest) {
			farthest = dot(flat, flat);
			memcpy(right, flat, sizeof flat);
		}
	}
	for (int k = 0; k < 3; k++)
		right[k] /= sqrt(farthest);
	for (int k = 0; k < 3; k++)
		up[k] = (normal[(k + 1) % 3] * right[(k + 2) % 3] - normal[(k + 2) % 3] * right[(k + 1) % 3]) / length;
}

/* In the plane of the polygon, from its first corner: GLU then works near zero, where doubles have all their digits. */
static void feed(cutter *c, const engine_mesh *mesh, const uint32_t *corners, uint32_t count, double (*flat)[3])
{
	double right[3], up[3], offset[3];
	make_axes(mesh, corners, count, right, up);
	gluTessBeginPolygon(c->tesselator, c);
	gluTessBeginContour(c->tesselator);
	for (uint32_t i = 0; i < count; i++) {
		offset_of(mesh, corners[0], corners[i], offset);
		flat[i][0] = dot(offset, right);
		flat[i][1] = dot(offset, up);
		flat[i][2] = 0;
		gluTessVertex(c->tesselator, flat[i], (void *)((uintptr_t)corners[i] + 1));
	}
	gluTessEndContour(c->tesselator);
	gluTessEndPolygon(c->tesselator);
}

/* Appends the polygon as triangles; materials are set afterwards. */
static bool cut(cutter *c, const engine_mesh *mesh, const uint32_t *corners, uint32_t count, uint32_t material)
{
	double(*flat)[3] = malloc(count * sizeof *flat);
	uint32_t first = c->out.face_count;
	if (!flat || (!c->tesselator && !make_tesselator(c))) {
		free(flat);
		return false;
	}
	c->corner_count = 0;
	feed(c, mesh, corners, count, flat);
	free(flat);
	for (uint32_t f = first; f < c->out.face_count; f++)
		c->out.face_materials[f] = material;
	return !c->failed;
}

static bool cut_all(cutter *c, const engine_mesh *mesh, uint32_t *scratch, engine_polygon_report *report)
{
	const uint32_t *corners = mesh->indices;
	for (uint32_t f = 0; f < mesh->face_count; corners += mesh->face_counts[f++]) {
		uint32_t count = mesh->face_counts[f], material = mesh->face_materials ? mesh->face_materials[f] : 0;
		uint32_t before = c->out.face_count;
		c->polygon = corners;
		c->polygon_count = count;
		c->polygon_uvs = mesh->uvs ? mesh->uvs + 2 * (corners - mesh->indices) : NULL;
		c->polygon_colors = mesh->colors ? mesh->colors + 4 * (corners - mesh->indices) : NULL;
		if (count == 3 || (is_convex(mesh, corners, count) && !passes_twice(corners, count, scratch))) {
			if (!add_face(c, corners, count, material))
				return false;
			continue;
		}
		c->squares += (uint64_t)count * count;
		if (count > MOST_CORNERS || c->squares > MOST_SQUARES) {
			report->too_large++;
			continue;
		}
		if (!cut(c, mesh, corners, count, material))
			return false;
		report->cut++;
		report->dropped += c->out.face_count == before;
	}
	return true;
}

/* Whether there is anything to do: nearly all meshes are convex, and stay where they are. */
static bool all_convex(const engine_mesh *mesh, uint32_t *scratch)
{
	const uint32_t *corners = mesh->indices;
	for (uint32_t f = 0; f < mesh->face_count; corners += mesh->face_counts[f++]) {
		uint32_t count = mesh->face_counts[f];
		if (count > 3 && (!is_convex(mesh, corners, count) || passes_twice(corners, count, scratch)))
			return false;
	}
	return true;
}

static void take_arrays(engine_mesh *mesh, engine_mesh *out)
{
	float *crease_sharpness = mesh->crease_sharpness;
	uint32_t *crease_vertices = mesh->crease_vertices, crease_count = mesh->crease_count;
	mesh->crease_sharpness = NULL;
	mesh->crease_vertices = NULL;
	engine_mesh_free(mesh);
	*mesh = *out;
	mesh->crease_sharpness = crease_sharpness;
	mesh->crease_vertices = crease_vertices;
	mesh->crease_count = crease_count;
	*out = (engine_mesh){0};
}

bool engine_mesh_cut_polygons(engine_mesh *mesh, engine_polygon_report *report)
{
	cutter c = {0};
	uint32_t *scratch = malloc(((size_t)mesh->index_count + 1) * sizeof *scratch);
	*report = (engine_polygon_report){0};
	if (!scratch)
		return false;
	if (all_convex(mesh, scratch)) {
		free(scratch);
		return true;
	}
	c.vertex_room = mesh->vertex_count;
	c.out.vertex_count = mesh->vertex_count;
	c.out.positions = malloc(((size_t)mesh->vertex_count + 1) * 3 * sizeof(float));
	bool done = c.out.positions != NULL;
	if (done) {
		memcpy(c.out.positions, mesh->positions, (size_t)mesh->vertex_count * 3 * sizeof(float));
		done = cut_all(&c, mesh, scratch, report);
	}
	if (done)
		take_arrays(mesh, &c.out);
	if (c.tesselator)
		gluDeleteTess(c.tesselator);
	engine_mesh_free(&c.out);
	free(scratch);
	return done;
}
