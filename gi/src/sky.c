/* The sky as an object at infinity: the faces of a cube, each cut four by four levels down, seen as directions. Its
 * rows' entries are what closes a row of an open scene, and the light of a sky that shines.
 */
#include "sky.h"

#include "context.h"
#include "host_memory.h"

#include <math.h>

enum { SKY_LEVELS = 3, SKY_GRID = 1 << SKY_LEVELS, SKY_POINTS = SKY_GRID + 1 };

typedef struct vec {
	double x, y, z;
} vec;

/* Corner (i, j) of the grid of a face; seen from inside, i then j run counter-clockwise. Equal angles, so that patches
 * are alike. */
static vec direction_of(int face, int i, int j)
{
	const double pi = 3.14159265358979323846;
	const double u = tan(pi / 4 * (2.0 * i / SKY_GRID - 1)), v = tan(pi / 4 * (2.0 * j / SKY_GRID - 1));
	const vec faces[6] = {{1, v, u}, {-1, u, v}, {u, 1, v}, {v, -1, u}, {v, u, 1}, {u, v, -1}};
	const vec d = faces[face];
	const double s = 1 / sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
	return (vec){d.x * s, d.y * s, d.z * s};
}

static uint32_t vertex_of(int face, int i, int j)
{
	return (uint32_t)((face * SKY_POINTS + j) * SKY_POINTS + i);
}

static double distance(vec a, vec b)
{
	return sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
}

/* Solid angle of the triangle a b c of unit vectors (van Oosterom and Strackee, 1983). */
static double solid_angle(vec a, vec b, vec c)
{
	const double triple =
	    a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
	const double ab = a.x * b.x + a.y * b.y + a.z * b.z, bc = b.x * c.x + b.y * c.y + b.z * c.z,
		     ca = c.x * a.x + c.y * a.y + c.z * a.z;
	return fabs(2 * atan2(triple, 1 + ab + bc + ca));
}

static void place_node(gi_hierarchy *h, uint32_t n, int face, int i, int j, int size)
{
	const vec c[4] = {direction_of(face, i, j), direction_of(face, i + size, j),
			  direction_of(face, i + size, j + size), direction_of(face, i, j + size)};
	vec m = {c[0].x + c[1].x + c[2].x + c[3].x, c[0].y + c[1].y + c[2].y + c[3].y,
		 c[0].z + c[1].z + c[2].z + c[3].z};
	const double s = 1 / sqrt(m.x * m.x + m.y * m.y + m.z * m.z);
	m = (vec){m.x * s, m.y * s, m.z * s};
	double radius = 0;
	for (int k = 0; k < 4; k++)
		radius = fmax(radius, distance(m, c[k]));
	const double angle = solid_angle(c[0], c[1], c[2]) + solid_angle(c[0], c[2], c[3]);
	/* A hair more than the corners, for rounding. */
	h->geometry[n].sphere = (gi_vec4){(float)m.x, (float)m.y, (float)m.z, (float)(radius * 1.0001)};
	h->geometry[n].axis = (gi_vec4){(float)-m.x, (float)-m.y, (float)-m.z, 1.0f};
	h->geometry[n].moment = (gi_vec4){0, 0, 0, (float)angle};
	h->topology[n].corners = (gi_uvec4){vertex_of(face, i, j), vertex_of(face, i + size, j),
					    vertex_of(face, i + size, j + size), vertex_of(face, i, j + size)};
}

static uint32_t build_node(gi_hierarchy *h, uint32_t n, int face, int i, int j, int size)
{
	place_node(h, n, face, i, j, size);
	uint32_t flags = GI_NODE_POLYGON | GI_NODE_SKY, next = n + 1;
	const int half = size / 2;
	if (half == 0)
		flags |= GI_NODE_LEAF;
	for (int k = 0; half && k < 4; k++)
		next = build_node(h, next, face, i + (k & 1) * half, j + (k >> 1) * half, half);
	h->topology[n].range = (gi_uvec4){next, 0, 0, flags};
	return next;
}

bool sky_build(gi_hierarchy *out)
{
	uint32_t per_face = 0;
	for (uint32_t level = 0, nodes = 1; level <= SKY_LEVELS; level++, nodes *= 4)
		per_face += nodes;
	*out = (gi_hierarchy){.node_count = 6 * per_face, .vertex_count = 6 * SKY_POINTS * SKY_POINTS};
	out->geometry = gi_calloc(out->node_count, sizeof *out->geometry);
	out->topology = gi_calloc(out->node_count, sizeof *out->topology);
	out->vertices = gi_calloc(out->vertex_count, sizeof *out->vertices);
	if (!out->geometry || !out->topology || !out->vertices) {
		gi_hierarchy_free(out);
		return false;
	}
	uint32_t next = 0;
	for (int face = 0; face < 6; face++) {
		for (int j = 0; j < SKY_POINTS; j++)
			for (int i = 0; i < SKY_POINTS; i++) {
				const vec d = direction_of(face, i, j);
				out->vertices[vertex_of(face, i, j)] = (gi_vec4){(float)d.x, (float)d.y, (float)d.z, 0};
			}
		next = build_node(out, next, face, 0, 0, SKY_GRID);
	}
	return true;
}

bool sky_is_lit(const gi_context_def *def)
{
	const float *e = def->sky_exitance;
	return e[0] + e[1] + e[2] > 0;
}

/* Writes the sky's B, which is its E: no pass computes it. */
void sky_relight(gi_context *gi)
{
	gi_scene *s = &gi->scene;
	if (!s->slot_count || s->sky_slot == GI_NONE)
		return;
	const uint32_t first = s->object_data[s->sky_slot].nodes.x, count = s->object_data[s->sky_slot].nodes.y - first;
	const float *e = gi->def.sky_exitance;
	for (uint32_t k = 0; k < count; k++)
		s->node_exitance[first + k] = (gi_vec4){e[0], e[1], e[2], 0};
	gpu_buffer_upload(&gi->gpu, &s->node_exitance_gpu, sizeof(gi_vec4) * first, sizeof(gi_vec4) * count,
			  s->node_exitance + first);
	gpu_buffer_upload(&gi->gpu, &gi->solver.radiosity, sizeof(gi_vec4) * (GI_NODE_B * s->node_count + first),
			  sizeof(gi_vec4) * count, s->node_exitance + first);
}
