#include "mesh_clean.h"

#include "mesh_duplicates.h"
#include "mesh_polygon.h"

#include <math.h>
#include <meshoptimizer.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Grows an array; size 0 still gives memory, so that NULL always means failure. */
static bool grow(void *array, size_t count, size_t element_size)
{
	void *pointer;
	memcpy(&pointer, array, sizeof pointer);
	pointer = realloc(pointer, (count ? count : 1) * element_size);
	if (pointer)
		memcpy(array, &pointer, sizeof pointer);
	return pointer != NULL;
}

/* Values of corners, `size` each; corners that had none get `without`. */
static bool grow_values(float **values, const engine_mesh *mesh, size_t corners, uint32_t size, float without)
{
	const bool fresh = !*values;
	if (!grow(values, corners, size * sizeof(float)))
		return false;
	for (size_t i = 0; fresh && i < size * (size_t)mesh->index_count; i++)
		(*values)[i] = without;
	return true;
}

static void append_values(float *to, const engine_mesh *mesh, const float *from, const engine_mesh *part, uint32_t size,
			  float without)
{
	for (size_t i = 0; to && i < size * (size_t)part->index_count; i++)
		to[size * (size_t)mesh->index_count + i] = from ? from[i] : without;
}

static bool grow_for(engine_mesh *mesh, const engine_mesh *part)
{
	size_t vertices = (size_t)mesh->vertex_count + part->vertex_count;
	size_t faces = (size_t)mesh->face_count + part->face_count;
	size_t corners = (size_t)mesh->index_count + part->index_count;
	/* Below 2^30, so that three floats a vertex still count in 32 bits wherever they go. */
	const bool textured = mesh->uvs || part->uvs, colored = mesh->colors || part->colors;
	if (vertices >= 1u << 30 || faces >= 1u << 30 || corners >= 1u << 30)
		return false;
	return grow(&mesh->positions, vertices, 3 * sizeof(float)) &&
	       grow(&mesh->face_counts, faces, sizeof(uint32_t)) &&
	       grow(&mesh->face_materials, faces, sizeof(uint32_t)) &&
	       grow(&mesh->indices, corners, sizeof(uint32_t)) &&
	       (!textured || grow_values(&mesh->uvs, mesh, corners, 2, ENGINE_NO_UV)) &&
	       (!colored || grow_values(&mesh->colors, mesh, corners, 4, ENGINE_NO_COLOR));
}

bool engine_mesh_append(engine_mesh *mesh, const engine_mesh *part, uint32_t material)
{
	if (!grow_for(mesh, part))
		return false;
	for (size_t i = 0; i < 3 * (size_t)part->vertex_count; i++)
		mesh->positions[3 * (size_t)mesh->vertex_count + i] = part->positions[i];
	for (uint32_t f = 0; f < part->face_count; f++) {
		mesh->face_counts[mesh->face_count + f] = part->face_counts[f];
		mesh->face_materials[mesh->face_count + f] = part->face_materials ? part->face_materials[f] : material;
	}
	for (uint32_t i = 0; i < part->index_count; i++)
		mesh->indices[mesh->index_count + i] = part->indices[i] + mesh->vertex_count;
	append_values(mesh->uvs, mesh, part->uvs, part, 2, ENGINE_NO_UV);
	append_values(mesh->colors, mesh, part->colors, part, 4, ENGINE_NO_COLOR);
	mesh->vertex_count += part->vertex_count;
	mesh->face_count += part->face_count;
	mesh->index_count += part->index_count;
	return true;
}

static bool check_positions(const engine_mesh *mesh, char *message, size_t message_size)
{
	for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++) {
		if (!isfinite(mesh->positions[i])) {
			snprintf(message, message_size, "the position of vertex %zu is not finite", i / 3);
			return false;
		}
		if (fabsf(mesh->positions[i]) > ENGINE_MESH_FARTHEST) {
			snprintf(message, message_size, "the position of vertex %zu is beyond 1e15 m", i / 3);
			return false;
		}
	}
	return true;
}

static bool check_faces(const engine_mesh *mesh, char *message, size_t message_size)
{
	size_t corners = 0;
	for (uint32_t f = 0; f < mesh->face_count; f++) {
		corners += mesh->face_counts[f];
		if (mesh->face_counts[f] < 3 || corners > mesh->index_count) {
			snprintf(message, message_size, "face %u has %u corners", f, mesh->face_counts[f]);
			return false;
		}
	}
	for (uint32_t i = 0; i < mesh->index_count; i++) {
		if (mesh->indices[i] >= mesh->vertex_count) {
			snprintf(message, message_size, "vertex number %u is out of range, there are %u vertices",
				 mesh->indices[i], mesh->vertex_count);
			return false;
		}
	}
	return true;
}

/* Points every corner at the first of the vertices of equal position. */
static bool weld(engine_mesh *mesh, engine_clean_report *report)
{
	uint32_t count = mesh->vertex_count;
	uint32_t *unique = malloc((2 * (size_t)count + 1) * sizeof *unique);
	if (!unique)
		return false;
	for (size_t i = 0; i < 3 * (size_t)count; i++)
		mesh->positions[i] += 0.0f; /* -0 and 0 are one place but not one bit pattern */
	size_t unique_count =
	    meshopt_generateVertexRemap(unique, NULL, count, mesh->positions, count, 3 * sizeof(float));
	uint32_t *first = unique + count;
	for (uint32_t v = count; v-- > 0;)
		first[unique[v]] = v;
	for (uint32_t i = 0; i < mesh->index_count; i++)
		mesh->indices[i] = first[unique[mesh->indices[i]]];
	report->welded_vertices = count - (uint32_t)unique_count;
	free(unique);
	return true;
}

/* Removes corners that repeat the one before (around the face too); returns how many stay. */
static uint32_t drop_repeats(engine_mesh *mesh, uint32_t first, uint32_t count)
{
	const uint32_t *corners = mesh->indices + first, start = corners[0];
	uint32_t kept = 0;
	for (uint32_t i = 0; i < count; i++) {
		if (corners[i] != (i + 1 < count ? corners[i + 1] : start))
			engine_mesh_move_corners(mesh, first + kept++, first + i, 1);
	}
	return kept;
}

static double longest_edge2(const engine_mesh *mesh, const uint32_t *corners, uint32_t count)
{
	double longest = 0;
	for (uint32_t i = 0; i < count; i++) {
		const float *p = mesh->positions + 3 * (size_t)corners[i];
		const float *q = mesh->positions + 3 * (size_t)corners[(i + 1) % count];
		double length2 = 0;
		for (int k = 0; k < 3; k++)
			length2 += ((double)p[k] - q[k]) * ((double)p[k] - q[k]);
		longest = fmax(longest, length2);
	}
	return longest;
}

/* 1e-7: a float has 24 bits, a face thinner than that times its length is a line with rounding errors. */
static bool has_area(const engine_mesh *mesh, const uint32_t *corners, uint32_t count)
{
	double n[3];
	engine_mesh_face_normal(mesh, corners, count, n);
	return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) > 1e-7 * longest_edge2(mesh, corners, count);
}

static void drop_degenerate(engine_mesh *mesh, engine_clean_report *report)
{
	uint32_t read = 0, write = 0, faces = 0;
	for (uint32_t f = 0; f < mesh->face_count; f++) {
		const uint32_t first = read;
		read += mesh->face_counts[f];
		const uint32_t count = drop_repeats(mesh, first, mesh->face_counts[f]);
		if (count < 3 || !has_area(mesh, mesh->indices + first, count))
			continue;
		engine_mesh_move_corners(mesh, write, first, count);
		write += count;
		mesh->face_counts[faces] = count;
		if (mesh->face_materials)
			mesh->face_materials[faces] = mesh->face_materials[f];
		faces++;
	}
	report->degenerate_faces = mesh->face_count - faces;
	mesh->face_count = faces;
	mesh->index_count = write;
}

static void swap_values(float *values, uint32_t size, size_t a, size_t b)
{
	for (uint32_t k = 0; values && k < size; k++) {
		const float kept = values[size * a + k];
		values[size * a + k] = values[size * b + k];
		values[size * b + k] = kept;
	}
}

void engine_mesh_turn_face(engine_mesh *mesh, uint32_t *corners, uint32_t count)
{
	const size_t first = (size_t)(corners - mesh->indices);
	for (uint32_t a = 0, b = count - 1; a < b; a++, b--) {
		const uint32_t kept = corners[a];
		corners[a] = corners[b];
		corners[b] = kept;
		swap_values(mesh->uvs, 2, first + a, first + b);
		swap_values(mesh->colors, 4, first + a, first + b);
	}
}

/* Polygons that leave no triangle had no area either. */
static bool cut_polygons(engine_mesh *mesh, engine_clean_report *report)
{
	engine_polygon_report cut;
	if (!engine_mesh_cut_polygons(mesh, &cut))
		return false;
	report->cut_faces = cut.cut;
	report->too_large = cut.too_large;
	report->degenerate_faces += cut.dropped;
	return true;
}

bool engine_mesh_drop_unused_vertices(engine_mesh *mesh)
{
	uint32_t *number = calloc((size_t)mesh->vertex_count + 1, sizeof *number);
	if (!number)
		return false;
	for (uint32_t i = 0; i < mesh->index_count; i++)
		number[mesh->indices[i]] = 1;
	uint32_t kept = 0;
	for (uint32_t v = 0; v < mesh->vertex_count; v++) {
		if (!number[v])
			continue;
		memmove(mesh->positions + 3 * (size_t)kept, mesh->positions + 3 * (size_t)v, 3 * sizeof(float));
		number[v] = kept++;
	}
	for (uint32_t i = 0; i < mesh->index_count; i++)
		mesh->indices[i] = number[mesh->indices[i]];
	mesh->vertex_count = kept;
	free(number);
	return true;
}

static void drop_creases(engine_mesh *mesh)
{
	free(mesh->crease_vertices);
	free(mesh->crease_sharpness);
	mesh->crease_vertices = NULL;
	mesh->crease_sharpness = NULL;
	mesh->crease_count = 0;
}

bool engine_mesh_clean(engine_mesh *mesh, engine_clean_report *report, char *message, size_t message_size)
{
	*report = (engine_clean_report){0};
	drop_creases(mesh);
	if (!check_positions(mesh, message, message_size) || !check_faces(mesh, message, message_size))
		return false;
	if (mesh->vertex_count == 0)
		return true;
	if (weld(mesh, report)) {
		drop_degenerate(mesh, report);
		if (engine_mesh_drop_duplicates(mesh, &report->duplicate_faces) && cut_polygons(mesh, report) &&
		    engine_mesh_drop_unused_vertices(mesh))
			return true;
	}
	snprintf(message, message_size, "out of memory for a mesh of %u vertices", mesh->vertex_count);
	return false;
}

static bool is_same(const float *values, uint32_t size, size_t a, size_t b)
{
	return !values || memcmp(values + size * a, values + size * b, size * sizeof *values) == 0;
}

/* Whether two corners of one place have the same of all else. */
static bool corners_agree(const engine_mesh *mesh, size_t a, size_t b)
{
	return is_same(mesh->uvs, 2, a, b) && is_same(mesh->colors, 4, a, b);
}

/* Finds the edge that the second of two triangles has the other way round, and writes which of their six corners are
 * the quad a b c d with that edge as its diagonal a-c. */
static bool join_at_shared_edge(const engine_mesh *mesh, const uint32_t *first, uint32_t *quad)
{
	const uint32_t *second = first + 3;
	const size_t at = (size_t)(first - mesh->indices);
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++) {
			uint32_t from = first[i], to = first[(i + 1) % 3];
			if (second[j] != to || second[(j + 1) % 3] != from)
				continue;
			/* The first is (from, to, x): as (to, x, from) its last edge is the diagonal. */
			quad[0] = (uint32_t)(i + 1) % 3;
			quad[1] = (uint32_t)(i + 2) % 3;
			quad[2] = (uint32_t)i;
			quad[3] = 3 + (uint32_t)(j + 2) % 3;
			return first[quad[1]] != first[quad[3]] &&
			       corners_agree(mesh, at + quad[0], at + 3 + (size_t)j) &&
			       corners_agree(mesh, at + quad[2], at + 3 + (size_t)(j + 1) % 3);
		}
	}
	return false;
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* cos 45 degrees: flatter than that, two triangles are the halves of a bent quad rather than two sides of an edge. */
static bool nearly_coplanar(const engine_mesh *mesh, const uint32_t *first, const uint32_t *second)
{
	double n[3], m[3];
	engine_mesh_face_normal(mesh, first, 3, n);
	engine_mesh_face_normal(mesh, second, 3, m);
	return dot(n, m) > 0.7071 * sqrt(dot(n, n) * dot(m, m));
}

/* Every corner turns left about the quad's own normal, by more than rounding. */
static bool is_convex(const engine_mesh *mesh, const uint32_t *quad)
{
	double normal[3];
	engine_mesh_face_normal(mesh, quad, 4, normal);
	for (int i = 0; i < 4; i++) {
		const uint32_t corner[3] = {quad[(i + 3) % 4], quad[i], quad[(i + 1) % 4]};
		double turn[3];
		engine_mesh_face_normal(mesh, corner, 3, turn);
		if (dot(turn, normal) <= 1e-6 * dot(normal, normal))
			return false;
	}
	return true;
}

/* which: of the six corners of both, those of the quad. */
static bool pair_at(const engine_mesh *mesh, uint32_t face, const uint32_t *corners, uint32_t *which)
{
	uint32_t quad[4];
	if (face + 1 >= mesh->face_count || mesh->face_counts[face] != 3 || mesh->face_counts[face + 1] != 3)
		return false;
	if (mesh->face_materials && mesh->face_materials[face] != mesh->face_materials[face + 1])
		return false;
	if (!join_at_shared_edge(mesh, corners, which) || !nearly_coplanar(mesh, corners, corners + 3))
		return false;
	for (int k = 0; k < 4; k++)
		quad[k] = corners[which[k]];
	return is_convex(mesh, quad);
}

/* The four of six corners from `read` on, at `write`. */
static void put_quad(engine_mesh *mesh, uint32_t write, uint32_t read, const uint32_t which[4])
{
	uint32_t corners[4];
	float uvs[4][2], colors[4][4];
	for (int k = 0; k < 4; k++) {
		const size_t from = (size_t)read + which[k];
		corners[k] = mesh->indices[from];
		if (mesh->uvs)
			memcpy(uvs[k], mesh->uvs + 2 * from, sizeof uvs[k]);
		if (mesh->colors)
			memcpy(colors[k], mesh->colors + 4 * from, sizeof colors[k]);
	}
	memcpy(mesh->indices + write, corners, sizeof corners);
	if (mesh->uvs)
		memcpy(mesh->uvs + 2 * (size_t)write, uvs, sizeof uvs);
	if (mesh->colors)
		memcpy(mesh->colors + 4 * (size_t)write, colors, sizeof colors);
}

/* In place: what is written never passes what is still to be read. */
void engine_mesh_pair_triangles(engine_mesh *mesh)
{
	uint32_t read = 0, write = 0, faces = 0;
	for (uint32_t f = 0; f < mesh->face_count;) {
		uint32_t which[4];
		const bool paired = pair_at(mesh, f, mesh->indices + read, which);
		uint32_t count = paired ? 4 : mesh->face_counts[f];
		uint32_t consumed = paired ? 6 : count;
		if (paired)
			put_quad(mesh, write, read, which);
		else
			engine_mesh_move_corners(mesh, write, read, count);
		if (mesh->face_materials)
			mesh->face_materials[faces] = mesh->face_materials[f];
		mesh->face_counts[faces++] = count;
		read += consumed;
		write += count;
		f += paired ? 2 : 1;
	}
	mesh->face_count = faces;
	mesh->index_count = write;
}
