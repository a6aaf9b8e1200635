#include "smooth.h"
#include "host_memory.h"

#include "vec3d.h"

#include <stdlib.h>
#include <string.h>

/* Across an edge of more than 40 degrees nothing is smooth, as light vertices have it (drawn_surface.c). */
static const double LEAST_COSINE = 0.766044443118978;

/* So many primitives meet where the tip of a cone is; more are no surface that has a normal there. */
enum { MOST_AT_A_POINT = 512 };

typedef struct corner {
	float at[3];
	uint32_t number; /* 4 * primitive + corner */
	gi_vec3d normal; /* unit, of the primitive there */
	gi_vec3d part;   /* of the mean normal */
} corner;

static const gi_vec4 *corner_at(const gi_primitive *p, uint32_t k)
{
	return &p->a + k;
}

static bool same_place(const gi_vec4 *a, const gi_vec4 *b)
{
	return a->x == b->x && a->y == b->y && a->z == b->z;
}

/* A quad may be bent: its normal at a corner is that of the two edges there. A triangle repeats its third corner.
 * What it is of the mean, a x b / (a^2 b^2) for edges a and b, makes that exact where all vertices lie on a sphere
 * (Max, "Weights for computing vertex normals from facet normals", 1999): light that is reflected shows a hundredth
 * of a degree. */
static corner make_corner(const gi_primitive *p, uint32_t primitive, uint32_t k)
{
	const uint32_t count = same_place(&p->c, &p->d) ? 3 : 4;
	const gi_vec3d at = gi_vec3d_from(*corner_at(p, k));
	const gi_vec3d next = gi_vec3d_sub(gi_vec3d_from(*corner_at(p, (k + 1) % count)), at);
	const gi_vec3d last = gi_vec3d_sub(gi_vec3d_from(*corner_at(p, (k + count - 1) % count)), at);
	const gi_vec3d cross = gi_vec3d_cross(next, last);
	/* No -0: places are compared by their bits. */
	return (corner){
	    .at = {corner_at(p, k)->x + 0.0f, corner_at(p, k)->y + 0.0f, corner_at(p, k)->z + 0.0f},
	    .number = 4 * primitive + k,
	    .normal = gi_vec3d_unit(cross),
	    .part = gi_vec3d_scale(cross, 1 / fmax(gi_vec3d_dot(next, next) * gi_vec3d_dot(last, last), 1e-300))};
}

static int by_place(const void *a, const void *b)
{
	const corner *x = a, *y = b;
	const int order = memcmp(x->at, y->at, sizeof x->at);
	return order ? order : (x->number > y->number) - (x->number < y->number);
}

static uint32_t snorm16(double x)
{
	return (uint32_t)(int32_t)lround(fmax(fmin(x, 1), -1) * 32767) & 0xFFFFu;
}

/* octahedron.glsl. */
static uint32_t pack(gi_vec3d n)
{
	const double sum = fabs(n.x) + fabs(n.y) + fabs(n.z);
	double x = sum > 0 ? n.x / sum : 0, y = sum > 0 ? n.y / sum : 0;
	if (n.z < 0) {
		const double folded = (1 - fabs(y)) * (x >= 0 ? 1 : -1);
		y = (1 - fabs(x)) * (y >= 0 ? 1 : -1);
		x = folded;
	}
	return snorm16(x) | snorm16(y) << 16;
}

static gi_vec3d mean_of(const corner *group, size_t count, const corner *own)
{
	if (count > MOST_AT_A_POINT)
		return own->normal;
	gi_vec3d sum = {0, 0, 0};
	for (size_t k = 0; k < count; k++)
		if (gi_vec3d_dot(group[k].normal, own->normal) >= LEAST_COSINE)
			sum = gi_vec3d_add(sum, group[k].part);
	return gi_vec3d_length(sum) > 0 ? gi_vec3d_unit(sum) : own->normal;
}

bool gi_smooth_normals(const gi_primitive *primitives, uint32_t count, uint32_t *out)
{
	corner *corners = gi_malloc(sizeof *corners * (4 * (size_t)count + 1));
	if (!corners)
		return false;
	size_t corner_count = 0;
	for (uint32_t p = 0; p < count; p++)
		for (uint32_t k = 0; k < (same_place(&primitives[p].c, &primitives[p].d) ? 3u : 4u); k++)
			corners[corner_count++] = make_corner(&primitives[p], p, k);
	qsort(corners, corner_count, sizeof *corners, by_place);
	for (size_t first = 0, end; first < corner_count; first = end) {
		for (end = first + 1; end < corner_count; end++)
			if (memcmp(corners[first].at, corners[end].at, sizeof corners[end].at) != 0)
				break;
		for (size_t k = first; k < end; k++)
			out[corners[k].number] = pack(mean_of(&corners[first], end - first, &corners[k]));
	}
	for (uint32_t p = 0; p < count; p++)
		if (same_place(&primitives[p].c, &primitives[p].d))
			out[4 * p + 3] = out[4 * p + 2];
	gi_free(corners);
	return true;
}
