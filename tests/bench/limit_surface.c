/* Points of an edge are made once, by the last face that has it, so that faces share them.
 *
 *     numbers of vertices:  those of the cage | n - 1 of each edge | (n - 1)^2 inside each face
 */
#include "limit_surface.h"

#include "../reference/embree.h"

#include <cglm/cglm.h>

#include <stdlib.h>
#include <string.h>

typedef struct edge {
	uint32_t low, high; /* vertices of the cage */
	uint32_t side;      /* 4 * face + which of its edges */
} edge;

typedef struct tessellation {
	const engine_mesh *cage;
	uint32_t n;
	RTCDevice device;
	RTCScene scene;
	RTCGeometry geometry;
	uint32_t *edge_of; /* of each side of a face */
	uint32_t edge_count;
	engine_mesh *out;
	float *normals;
} tessellation;

static int by_vertices(const void *a, const void *b)
{
	const edge *x = a, *y = b;
	if (x->low != y->low)
		return x->low < y->low ? -1 : 1;
	if (x->high != y->high)
		return x->high < y->high ? -1 : 1;
	return x->side < y->side ? -1 : x->side > y->side;
}

static bool number_edges(tessellation *t)
{
	const uint32_t sides = 4 * t->cage->face_count;
	edge *edges = malloc(sides * sizeof *edges);
	t->edge_of = malloc(sides * sizeof *t->edge_of);
	for (uint32_t s = 0; edges && s < sides; s++) {
		const uint32_t a = t->cage->indices[s], b = t->cage->indices[s % 4 == 3 ? s - 3 : s + 1];
		edges[s] = (edge){a < b ? a : b, a < b ? b : a, s};
	}
	if (edges && t->edge_of) {
		qsort(edges, sides, sizeof *edges, by_vertices);
		for (uint32_t s = 0; s < sides; s++) {
			t->edge_count +=
			    s == 0 || edges[s].low != edges[s - 1].low || edges[s].high != edges[s - 1].high;
			t->edge_of[edges[s].side] = t->edge_count - 1;
		}
	}
	free(edges);
	return edges && t->edge_of;
}

/* Which vertex the point i, j of a face's grid is. */
static uint32_t vertex_at(const tessellation *t, uint32_t face, uint32_t i, uint32_t j)
{
	const uint32_t n = t->n, *corners = t->cage->indices + 4 * (size_t)face;
	uint32_t side, along; /* from the side's first corner */
	if ((i == 0 || i == n) && (j == 0 || j == n))
		return corners[j == 0 ? (i == 0 ? 0 : 1) : (i == 0 ? 3 : 2)];
	if (j == 0)
		side = 0, along = i;
	else if (i == n)
		side = 1, along = j;
	else if (j == n)
		side = 2, along = n - i;
	else if (i == 0)
		side = 3, along = n - j;
	else
		return t->cage->vertex_count + t->edge_count * (n - 1) + face * (n - 1) * (n - 1) + (j - 1) * (n - 1) +
		       i - 1;
	if (corners[side] > corners[(side + 1) % 4])
		along = n - along;
	return t->cage->vertex_count + t->edge_of[4 * face + side] * (n - 1) + along - 1;
}

static bool build_embree(tessellation *t)
{
	const engine_mesh *cage = t->cage;
	t->device = rtcNewDevice(NULL);
	t->scene = t->device ? rtcNewScene(t->device) : NULL;
	t->geometry = t->scene ? rtcNewGeometry(t->device, RTC_GEOMETRY_TYPE_SUBDIVISION) : NULL;
	if (!t->geometry)
		return false;
	/* Embree reads four numbers of a vertex, and wants all to be numbers. */
	float(*positions)[4] = rtcSetNewGeometryBuffer(t->geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
						       sizeof *positions, cage->vertex_count);
	uint32_t *corners = rtcSetNewGeometryBuffer(t->geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT,
						    sizeof(uint32_t), cage->index_count);
	uint32_t *faces = rtcSetNewGeometryBuffer(t->geometry, RTC_BUFFER_TYPE_FACE, 0, RTC_FORMAT_UINT,
						  sizeof(uint32_t), cage->face_count);
	if (!positions || !corners || !faces)
		return false;
	for (uint32_t v = 0; v < cage->vertex_count; v++) {
		memcpy(positions[v], cage->positions + 3 * (size_t)v, sizeof(vec3));
		positions[v][3] = 0;
	}
	memcpy(corners, cage->indices, sizeof *corners * cage->index_count);
	memcpy(faces, cage->face_counts, sizeof *faces * cage->face_count);
	rtcCommitGeometry(t->geometry);
	rtcAttachGeometry(t->scene, t->geometry);
	rtcCommitScene(t->scene);
	return rtcGetDeviceError(t->device) == RTC_ERROR_NONE;
}

static void make_vertex(tessellation *t, uint32_t face, uint32_t i, uint32_t j)
{
	float p[3], du[3], dv[3];
	const struct RTCInterpolateArguments at = {.geometry = t->geometry,
						   .primID = face,
						   .u = (float)i / (float)t->n,
						   .v = (float)j / (float)t->n,
						   .bufferType = RTC_BUFFER_TYPE_VERTEX,
						   .P = p,
						   .dPdu = du,
						   .dPdv = dv,
						   .valueCount = 3};
	rtcInterpolate(&at);
	const size_t vertex = 3 * (size_t)vertex_at(t, face, i, j);
	memcpy(t->out->positions + vertex, p, sizeof p);
	glm_vec3_crossn(du, dv, t->normals + vertex);
}

static void make_face(tessellation *t, uint32_t face)
{
	const uint32_t n = t->n;
	for (uint32_t j = 0; j <= n; j++)
		for (uint32_t i = 0; i <= n; i++)
			make_vertex(t, face, i, j);
	uint32_t *to = t->out->indices + 6 * (size_t)n * n * face;
	for (uint32_t j = 0; j < n; j++)
		for (uint32_t i = 0; i < n; i++) {
			const uint32_t a = vertex_at(t, face, i, j), b = vertex_at(t, face, i + 1, j);
			const uint32_t c = vertex_at(t, face, i + 1, j + 1), d = vertex_at(t, face, i, j + 1);
			const uint32_t triangles[6] = {a, b, c, a, c, d};
			memcpy(to, triangles, sizeof triangles);
			to += 6;
		}
}

static bool allocate(tessellation *t)
{
	const uint32_t n = t->n, faces = t->cage->face_count;
	engine_mesh *m = t->out;
	m->vertex_count = t->cage->vertex_count + t->edge_count * (n - 1) + faces * (n - 1) * (n - 1);
	m->face_count = 2 * n * n * faces;
	m->index_count = 3 * m->face_count;
	m->positions = malloc(sizeof(vec3) * m->vertex_count);
	m->indices = malloc(sizeof *m->indices * m->index_count);
	m->face_counts = malloc(sizeof *m->face_counts * m->face_count);
	t->normals = malloc(sizeof(vec3) * m->vertex_count);
	for (uint32_t f = 0; m->face_counts && f < m->face_count; f++)
		m->face_counts[f] = 3;
	return m->positions && m->indices && m->face_counts && t->normals;
}

bool limit_surface(const engine_mesh *cage, uint32_t n, engine_mesh *out, float **normals)
{
	*out = (engine_mesh){0};
	tessellation t = {.cage = cage, .n = n, .out = out};
	bool ok = number_edges(&t) && build_embree(&t) && allocate(&t);
	/* Where faces meet the last one's point counts: the same but for a rounding. */
	for (uint32_t face = 0; ok && face < cage->face_count; face++)
		make_face(&t, face);
	if (!ok) {
		engine_mesh_free(out);
		free(t.normals);
		t.normals = NULL;
	}
	*normals = t.normals;
	free(t.edge_of);
	if (t.geometry)
		rtcReleaseGeometry(t.geometry);
	if (t.scene)
		rtcReleaseScene(t.scene);
	if (t.device)
		rtcReleaseDevice(t.device);
	return ok;
}
