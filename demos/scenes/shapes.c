#include "scenes/shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static bool allocate(engine_mesh *out, uint32_t vertices, uint32_t quads)
{
	*out = (engine_mesh){.vertex_count = vertices, .face_count = quads, .index_count = 4 * quads};
	out->positions = malloc(sizeof(float) * 3 * vertices);
	out->face_counts = malloc(sizeof(uint32_t) * quads);
	out->indices = malloc(sizeof(uint32_t) * 4 * quads);
	if (!out->positions || !out->face_counts || !out->indices) {
		engine_mesh_free(out);
		return false;
	}
	for (uint32_t f = 0; f < quads; f++)
		out->face_counts[f] = 4;
	return true;
}

/* Quads of an (n + 1) x (m + 1) grid of vertices. */
static void grid_indices(uint32_t *indices, uint32_t first, uint32_t n, uint32_t m)
{
	for (uint32_t j = 0; j < m; j++)
		for (uint32_t i = 0; i < n; i++) {
			const uint32_t a = first + j * (n + 1) + i;
			const uint32_t quad[4] = {a, a + 1, a + n + 2, a + n + 1};
			memcpy(indices + 4 * (j * n + i), quad, sizeof quad);
		}
}

bool shape_quad(const float corner[3], const float u[3], const float v[3], uint32_t n, uint32_t m, engine_mesh *out)
{
	if (!allocate(out, (n + 1) * (m + 1), n * m))
		return false;
	for (uint32_t j = 0; j <= m; j++)
		for (uint32_t i = 0; i <= n; i++)
			for (int c = 0; c < 3; c++)
				out->positions[3 * (j * (n + 1) + i) + (uint32_t)c] =
				    corner[c] + u[c] * ((float)i / (float)n) + v[c] * ((float)j / (float)m);
	grid_indices(out->indices, 0, n, m);
	return true;
}

/* ---- six-sided shapes: the lattice points on the surface of a cube of n cells a side ---- */

static uint32_t lattice_number(uint32_t n, const uint32_t p[3])
{
	return (p[2] * (n + 1) + p[1]) * (n + 1) + p[0];
}

/* Faces outward; `vertex` gives each lattice point's number. */
static void cube_faces(uint32_t n, const uint32_t *vertex, uint32_t *indices)
{
	for (uint32_t side = 0; side < 6; side++) {
		const uint32_t axis = side >> 1, high = side & 1, u = (axis + 1) % 3, v = (axis + 2) % 3;
		for (uint32_t j = 0; j < n; j++)
			for (uint32_t i = 0; i < n; i++) {
				const uint32_t steps[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
				for (uint32_t k = 0; k < 4; k++) {
					uint32_t p[3];
					p[axis] = high ? n : 0;
					/* The low side is seen from the other side: its corners run the other way. */
					p[u] = i + steps[high ? k : 3 - k][0];
					p[v] = j + steps[high ? k : 3 - k][1];
					*indices++ = vertex[lattice_number(n, p)];
				}
			}
	}
}

/* Numbers the lattice points on the surface; their places in the unit cube go to positions. */
static bool cube_lattice(uint32_t n, engine_mesh *out)
{
	const uint32_t points = (n + 1) * (n + 1) * (n + 1), inner = n > 1 ? (n - 1) * (n - 1) * (n - 1) : 0;
	uint32_t *vertex = malloc(sizeof *vertex * points);
	if (!vertex || !allocate(out, points - inner, 6 * n * n)) {
		free(vertex);
		return false;
	}
	uint32_t count = 0;
	for (uint32_t z = 0; z <= n; z++)
		for (uint32_t y = 0; y <= n; y++)
			for (uint32_t x = 0; x <= n; x++) {
				const uint32_t p[3] = {x, y, z};
				bool surface = false;
				for (int c = 0; c < 3; c++)
					surface = surface || p[c] == 0 || p[c] == n;
				if (!surface)
					continue;
				for (int c = 0; c < 3; c++)
					out->positions[3 * count + (uint32_t)c] = (float)p[c] / (float)n;
				vertex[lattice_number(n, p)] = count++;
			}
	cube_faces(n, vertex, out->indices);
	free(vertex);
	return true;
}

static void turn_faces(engine_mesh *mesh)
{
	for (uint32_t f = 0; f < mesh->face_count; f++) {
		const uint32_t swap = mesh->indices[4 * f + 1];
		mesh->indices[4 * f + 1] = mesh->indices[4 * f + 3];
		mesh->indices[4 * f + 3] = swap;
	}
}

bool shape_box(const float lower[3], const float upper[3], uint32_t n, bool inward, engine_mesh *out)
{
	if (!cube_lattice(n, out))
		return false;
	for (uint32_t k = 0; k < 3 * out->vertex_count; k++)
		out->positions[k] = lower[k % 3] + (upper[k % 3] - lower[k % 3]) * out->positions[k];
	if (inward)
		turn_faces(out);
	return true;
}

bool shape_sphere(float radius, uint32_t n, engine_mesh *out)
{
	if (!cube_lattice(n, out))
		return false;
	for (uint32_t k = 0; k < out->vertex_count; k++) {
		double p[3], length = 0;
		for (int c = 0; c < 3; c++) {
			/* Equal angles make the quads alike. */
			p[c] = tan(PI / 4 * (2.0 * out->positions[3 * k + (uint32_t)c] - 1));
			length += p[c] * p[c];
		}
		for (int c = 0; c < 3; c++)
			out->positions[3 * k + (uint32_t)c] = (float)(radius * p[c] / sqrt(length));
	}
	return true;
}

/* The square [-1,1]^2 onto the disc: points on a square of half side s go to the circle of radius s. */
static void square_to_disc(double x, double y, double radius, float out[3])
{
	const double s = fmax(fabs(x), fabs(y));
	double angle = 0;
	if (s > 0)
		angle = fabs(x) >= fabs(y) ? (x > 0 ? 0 : PI) + PI / 4 * y / x
					   : (y > 0 ? PI / 2 : -PI / 2) - PI / 4 * x / y;
	out[0] = (float)(radius * s * cos(angle));
	out[1] = 0;
	out[2] = (float)(-radius * s * sin(angle));
}

bool shape_disc(float radius, uint32_t n, engine_mesh *out)
{
	if (!allocate(out, (n + 1) * (n + 1), n * n))
		return false;
	/* Radius of the 4n-gon whose area is the disc's. */
	const double sides = 4.0 * n, r = radius * sqrt(2 * PI / (sides * sin(2 * PI / sides)));
	for (uint32_t j = 0; j <= n; j++)
		for (uint32_t i = 0; i <= n; i++)
			square_to_disc(2.0 * i / n - 1, 2.0 * j / n - 1, r, &out->positions[3 * (j * (n + 1) + i)]);
	grid_indices(out->indices, 0, n, n);
	return true;
}

static bool append_array(void **to, size_t old_bytes, const void *more, size_t bytes)
{
	void *grown = realloc(*to, old_bytes + bytes + 1);
	if (!grown)
		return false;
	memcpy((char *)grown + old_bytes, more, bytes);
	*to = grown;
	return true;
}

bool shape_append(engine_mesh *to, engine_mesh *more)
{
	const size_t word = sizeof(uint32_t), vertex = 3 * sizeof(float);
	for (uint32_t k = 0; k < more->index_count; k++)
		more->indices[k] += to->vertex_count;
	const bool ok =
	    append_array((void **)&to->positions, vertex * to->vertex_count, more->positions,
			 vertex * more->vertex_count) &&
	    append_array((void **)&to->face_counts, word * to->face_count, more->face_counts,
			 word * more->face_count) &&
	    append_array((void **)&to->indices, word * to->index_count, more->indices, word * more->index_count);
	to->vertex_count += more->vertex_count;
	to->face_count += more->face_count;
	to->index_count += more->index_count;
	engine_mesh_free(more);
	if (!ok)
		engine_mesh_free(to);
	return ok;
}

bool shape_append_quad(engine_mesh *to, const float corner[3], const float u[3], const float v[3], float cell)
{
	engine_mesh quad;
	const double lengths[2] = {sqrt((double)u[0] * u[0] + (double)u[1] * u[1] + (double)u[2] * u[2]),
				   sqrt((double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2])};
	const uint32_t n = (uint32_t)fmax(1, round(lengths[0] / cell)), m = (uint32_t)fmax(1, round(lengths[1] / cell));
	if (shape_quad(corner, u, v, n, m, &quad))
		return shape_append(to, &quad);
	engine_mesh_free(to);
	return false;
}
