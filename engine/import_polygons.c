#include "import_polygons.h"

#include "image_mean.h"
#include "mesh_clean.h"
#include "import_bounds.h"
#include "import_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *import_array_add(import_array *array, size_t item_size)
{
	if (array->count == array->capacity) {
		size_t capacity = array->capacity ? 2 * array->capacity : 16;
		void *grown = array->count < IMPORT_MOST_ITEMS ? realloc(array->items, capacity * item_size) : NULL;
		if (!grown)
			return NULL;
		array->items = grown;
		array->capacity = capacity;
	}
	return (char *)array->items + array->count++ * item_size;
}

void import_polygons_free(import_polygons *polygons)
{
	free(polygons->vertices.items);
	free(polygons->corners.items);
	free(polygons->uvs.items);
	free(polygons->corner_uvs.items);
	free(polygons->faces.items);
	*polygons = (import_polygons){0};
}

/* ---- vertices and faces ------------------------------------------------------------------------------------------ */

static bool is_near(const double position[3])
{
	const double farthest = (double)ENGINE_MESH_FARTHEST; /* false for what is no number, too */
	return fabs(position[0]) <= farthest && fabs(position[1]) <= farthest && fabs(position[2]) <= farthest;
}

import_vertex *import_add_vertex(import_loader *loader, import_polygons *polygons, const double *position,
				 uint32_t place, const char *text)
{
	import_vertex *vertex = import_array_add(&polygons->vertices, sizeof *vertex);
	if (!vertex)
		return NULL;
	*vertex = (import_vertex){.broken = !position || !is_near(position)};
	if (!vertex->broken) {
		memcpy(vertex->position, position, sizeof vertex->position);
		return vertex;
	}
	char where[64];
	snprintf(where, sizeof where, "%s %u%s%s", strcmp(polygons->places, "line") ? "vertex" : "line", place,
		 text ? ": " : "", text ? text : "");
	import_note(loader, where, "vertices that are not three numbers within 1e15 m are left out");
	return vertex;
}

void import_count_digits(import_polygons *polygons, const char *before, const char *after)
{
	const uint32_t digits = import_digits(before, after);
	polygons->digits = digits > polygons->digits ? digits : polygons->digits;
}

void import_linear_color(const double srgb[3], float linear[3])
{
	for (int c = 0; c < 3; c++)
		linear[c] = (float)engine_linear_of_srgb(fmin(fmax(srgb[c], 0), 1));
}

bool import_has_color(const import_polygons *polygons, const import_polygon *face, const uint32_t *corners)
{
	const import_vertex *vertices = polygons->vertices.items;
	for (uint32_t i = 0; i < face->corners && !face->colored; i++)
		if (corners[i] >= polygons->vertices.count || !vertices[corners[i]].colored)
			return false;
	return true;
}

static bool is_whole(const import_polygons *polygons, const import_polygon *face, const uint32_t *corners)
{
	const import_vertex *vertices = polygons->vertices.items;
	for (uint32_t i = 0; i < face->corners; i++) {
		if (corners[i] >= polygons->vertices.count || vertices[corners[i]].broken)
			return false;
	}
	return true;
}

/* Drops the faces whose corners are not all there, once all vertices are known. Returns whether most stay. */
static bool drop_broken_faces(import_loader *loader, import_polygons *polygons)
{
	import_polygon *faces = polygons->faces.items;
	uint32_t *corners = polygons->corners.items, *uvs = polygons->corner_uvs.items, *next = corners, dropped = 0;
	size_t kept = 0, kept_corners = 0, all = polygons->faces.count;
	char first[64] = "";
	for (size_t f = 0; f < all; f++) {
		const import_polygon face = faces[f];
		if (is_whole(polygons, &face, next)) {
			memmove(corners + kept_corners, next, face.corners * sizeof *next);
			if (uvs)
				memmove(uvs + kept_corners, uvs + (next - corners), face.corners * sizeof *uvs);
			kept_corners += face.corners;
			faces[kept++] = face;
		} else if (dropped++ == 0) {
			snprintf(first, sizeof first, "%s %u", polygons->places, face.place);
		}
		next += face.corners;
	}
	polygons->faces.count = kept;
	polygons->corners.count = kept_corners;
	polygons->corner_uvs.count = uvs ? kept_corners : 0;
	import_note_many(loader, dropped, first, IMPORT_BROKEN_FACES);
	return dropped <= kept;
}

import_polygon *import_add_polygon(import_polygons *polygons, uint32_t corners)
{
	import_polygon *face = import_array_add(&polygons->faces, sizeof *face);
	if (!face)
		return NULL;
	*face = (import_polygon){.corners = corners, .material = IMPORT_NO_MATERIAL};
	if (corners >= 3)
		return face;
	polygons->corners.count -= corners; /* a point or a line */
	if (polygons->corner_uvs.count > 0)
		polygons->corner_uvs.count -= corners;
	polygons->faces.count--;
	polygons->small_faces++;
	return face;
}

/* ---- what the file rounds ---------------------------------------------------------------------------------------- */

/* Fewer digits are what people write, and mean. */
enum { ROUNDED_DIGITS = 6 };

/* The place before the point of a number's first digit, from 1 on; 0.05 has -1. */
static int leading_place(double value)
{
	return value > 0 ? (int)floor(log10(value)) + 1 : 0;
}

/* Half a unit of the last of so many digits. */
static double half_unit(double value, uint32_t digits)
{
	return .5 * pow(10, leading_place(value) - (double)digits);
}

/* Metres that coordinates may be off: by the digits of the largest one, as writers have either as many digits for all
 * or as many behind the point; by those of a float, where all are floats as far as the digits tell.
 */
static double rounding_of(const import_polygons *polygons)
{
	const import_vertex *vertices = polygons->vertices.items;
	const uint32_t digits = polygons->digits;
	double largest = 0;
	bool floats = true;
	for (size_t v = 0; v < polygons->vertices.count; v++)
		for (int c = 0; c < 3; c++) {
			const double value = fabs(vertices[v].position[c]);
			const double off = digits > 0 ? half_unit(value, digits) * 1.001 : 0;
			largest = fmax(largest, value);
			floats = floats && fabs(value - (double)(float)value) <= off;
		}
	if (digits > 0 && digits < ROUNDED_DIGITS)
		return 0;
	return fmax(digits > 0 ? half_unit(largest, digits) : 0, floats ? ldexp(largest, -24) : 0);
}

/* ---- objects ----------------------------------------------------------------------------------------------------- */

/* The faces sorted by group: those of group g are sorted[first[g]] to sorted[first[g + 1] - 1], in the file's order. */
typedef struct grouping {
	uint32_t *first;  /* groups + 1 */
	uint32_t *sorted; /* faces */
	uint32_t *corner; /* faces: where the corners of each start */
	uint32_t *number; /* vertices: their number in the mesh of the group in `owner` */
	uint32_t *owner;  /* vertices: the group that used them last, plus 1 */
	double offset[3]; /* taken off all positions before they become floats */
	double rounding;  /* metres that they may be off */
} grouping;

static void free_grouping(grouping *g)
{
	free(g->first);
	free(g->sorted);
	free(g->corner);
	free(g->number);
	free(g->owner);
}

static bool make_grouping(const import_polygons *polygons, uint32_t group_count, grouping *g)
{
	size_t faces = polygons->faces.count, vertices = polygons->vertices.count;
	*g = (grouping){.first = calloc((size_t)group_count + 2, sizeof(uint32_t)),
			.sorted = calloc(faces + 1, sizeof(uint32_t)),
			.corner = calloc(faces + 1, sizeof(uint32_t)),
			.number = calloc(vertices + 1, sizeof(uint32_t)),
			.owner = calloc(vertices + 1, sizeof(uint32_t))};
	if (!g->first || !g->sorted || !g->corner || !g->number || !g->owner)
		return false;
	const import_polygon *face = polygons->faces.items;
	for (size_t f = 0; f < faces; f++)
		g->first[face[f].group + 2]++;
	for (size_t k = 2; k < (size_t)group_count + 2; k++)
		g->first[k] += g->first[k - 1];
	uint32_t corner = 0;
	for (size_t f = 0; f < faces; corner += face[f++].corners) {
		g->corner[f] = corner;
		g->sorted[g->first[face[f].group + 1]++] = (uint32_t)f; /* leaves first[] one place further down */
	}
	return true;
}

static size_t count_corners(const import_polygons *polygons, const grouping *g, uint32_t group)
{
	const import_polygon *faces = polygons->faces.items;
	size_t corners = 0;
	for (uint32_t k = g->first[group]; k < g->first[group + 1]; k++)
		corners += faces[g->sorted[k]].corners;
	return corners;
}

static const uint32_t *corners_of(const import_polygons *polygons, const grouping *g, uint32_t f)
{
	return (const uint32_t *)polygons->corners.items + g->corner[f];
}

static bool has_texture(const engine_scene *scene, const import_polygon *face)
{
	const engine_scene_material *m = &scene->materials[face->material];
	return m->rho_texture.number || m->radiance_texture.number || m->alpha_texture.number;
}

/* Arrays of corners that a group's mesh is to have. */
static void find_arrays(const engine_scene *scene, const import_polygons *polygons, const grouping *g, uint32_t group,
			bool *colored, bool *textured)
{
	const import_polygon *faces = polygons->faces.items;
	*colored = *textured = false;
	for (uint32_t k = g->first[group]; k < g->first[group + 1]; k++) {
		const uint32_t f = g->sorted[k];
		*colored = *colored || import_has_color(polygons, &faces[f], corners_of(polygons, g, f));
		*textured = *textured || (polygons->corner_uvs.count > 0 && has_texture(scene, &faces[f]));
	}
}

static bool allocate_mesh(engine_mesh *mesh, size_t faces, size_t corners, bool colored, bool textured)
{
	*mesh = (engine_mesh){.positions = malloc(3 * (corners + 1) * sizeof(float)),
			      .face_counts = malloc((faces + 1) * sizeof(uint32_t)),
			      .face_materials = malloc((faces + 1) * sizeof(uint32_t)),
			      .indices = malloc((corners + 1) * sizeof(uint32_t)),
			      .uvs = textured ? malloc(2 * (corners + 1) * sizeof(float)) : NULL,
			      .colors = colored ? malloc(4 * (corners + 1) * sizeof(float)) : NULL};
	return mesh->positions && mesh->face_counts && mesh->face_materials && mesh->indices &&
	       (!textured || mesh->uvs) && (!colored || mesh->colors);
}

/* The vertex's number in the group's mesh, where it is added when it comes first. */
static uint32_t take_vertex(const import_polygons *polygons, grouping *g, uint32_t group, uint32_t vertex,
			    engine_mesh *mesh)
{
	if (g->owner[vertex] != group + 1) {
		const import_vertex *from = (import_vertex *)polygons->vertices.items + vertex;
		for (int k = 0; k < 3; k++)
			mesh->positions[3 * (size_t)mesh->vertex_count + (size_t)k] =
			    (float)(from->position[k] - g->offset[k]);
		g->owner[vertex] = group + 1;
		g->number[vertex] = mesh->vertex_count++;
	}
	return g->number[vertex];
}

static void take_uv(const import_polygons *polygons, uint32_t number, float out[2])
{
	const import_uv *uvs = polygons->uvs.items;
	out[0] = number < polygons->uvs.count ? uvs[number].uv[0] : ENGINE_NO_UV;
	out[1] = number < polygons->uvs.count ? uvs[number].uv[1] : ENGINE_NO_UV;
}

static void take_color(const float color[3], float out[4])
{
	memcpy(out, color, 3 * sizeof *out);
	out[3] = 1;
}

static void take_face(const import_polygons *polygons, grouping *g, uint32_t f, engine_mesh *mesh)
{
	static const float none[3] = {ENGINE_NO_COLOR, ENGINE_NO_COLOR, ENGINE_NO_COLOR};
	const import_polygon *face = (import_polygon *)polygons->faces.items + f;
	const import_vertex *vertices = polygons->vertices.items;
	const uint32_t *corners = corners_of(polygons, g, f), *uvs = polygons->corner_uvs.items;
	const bool colored = mesh->colors && import_has_color(polygons, face, corners);
	for (uint32_t i = 0; i < face->corners; i++) {
		const size_t to = mesh->index_count++;
		mesh->indices[to] = take_vertex(polygons, g, face->group, corners[i], mesh);
		if (mesh->uvs)
			take_uv(polygons, uvs[g->corner[f] + i], mesh->uvs + 2 * to);
		if (mesh->colors)
			take_color(!colored        ? none
				   : face->colored ? face->color
						   : vertices[corners[i]].color,
				   mesh->colors + 4 * to);
	}
	mesh->face_counts[mesh->face_count] = face->corners;
	mesh->face_materials[mesh->face_count++] = face->material;
}

static bool add_group(import_loader *loader, const import_polygons *polygons, grouping *g, uint32_t group,
		      const char *name)
{
	import_object_def def = {
	    .name = name, .offset = {g->offset[0], g->offset[1], g->offset[2]}, .rounding = g->rounding};
	engine_mesh mesh;
	uint32_t faces = g->first[group + 1] - g->first[group];
	if (faces == 0)
		return true;
	bool colored, textured;
	find_arrays(loader->scene, polygons, g, group, &colored, &textured);
	if (!allocate_mesh(&mesh, faces, count_corners(polygons, g, group), colored, textured)) {
		engine_mesh_free(&mesh);
		return import_fail(loader, "out of memory for an object of %u faces", faces);
	}
	for (uint32_t k = g->first[group]; k < g->first[group + 1]; k++)
		take_face(polygons, g, g->sorted[k], &mesh);
	return import_add_object(loader, &def, &mesh);
}

/* Taken off in double precision, before the positions become floats. */
static void find_offset(const import_polygons *polygons, double offset[3])
{
	const import_vertex *vertices = polygons->vertices.items;
	const uint32_t *corners = polygons->corners.items;
	import_bounds bounds = import_bounds_of_nothing();
	for (size_t i = 0; i < polygons->corners.count; i++)
		import_bounds_widen(&bounds, vertices[corners[i]].position);
	import_bounds_far_middle(&bounds, offset);
}

static bool add_groups(import_loader *loader, const import_polygons *polygons, const char *const *names,
		       uint32_t group_count)
{
	grouping g;
	bool added = make_grouping(polygons, group_count, &g);
	if (!added)
		import_fail(loader, "out of memory for %zu faces", polygons->faces.count);
	else {
		find_offset(polygons, g.offset);
		g.rounding = rounding_of(polygons);
	}
	for (uint32_t group = 0; added && group < group_count; group++)
		added = add_group(loader, polygons, &g, group, names[group]);
	free_grouping(&g);
	return added;
}

/* Materials of faces that a file gives none. */
static bool number_materials(import_loader *loader, import_polygons *polygons)
{
	import_polygon *faces = polygons->faces.items;
	for (size_t f = 0; f < polygons->faces.count; f++)
		if (faces[f].material == IMPORT_NO_MATERIAL && !import_default_material(loader, &faces[f].material))
			return false;
	return true;
}

bool import_add_polygons(import_loader *loader, import_polygons *polygons, const char *const *names,
			 uint32_t group_count)
{
	import_note_many(loader, polygons->small_faces, NULL, "faces of fewer than three corners are left out");
	const size_t faces = polygons->faces.count;
	import_write_warning(loader);
	if (faces == 0)
		return import_fail(loader, "holds no faces%s%s", loader->scene->warning[0] ? ": " : "",
				   loader->scene->warning);
	if (!drop_broken_faces(loader, polygons)) {
		import_write_warning(loader);
		return import_fail(loader, "%zu of its %zu faces cannot be used, it may be cut off: %s",
				   faces - polygons->faces.count, faces, loader->scene->warning);
	}
	/* Both formats place their objects in world space: one node at the origin serves all. */
	return import_make_graph(loader, 1) && number_materials(loader, polygons) &&
	       add_groups(loader, polygons, names, group_count);
}
