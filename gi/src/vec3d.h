/* Three doubles: sums over thousands of leaves and measures that decide flags are taken in double, where cglm has
 * float. */
#ifndef GI_VEC3D_H
#define GI_VEC3D_H

#include "gi_shared.h"

#include <math.h>

/* Relative: distances closer than this are equal but for rounding of the positions. */
#define GI_TIE 1e-6

typedef struct gi_vec3d {
	double x, y, z;
} gi_vec3d;

static inline gi_vec3d gi_vec3d_load(const float v[3])
{
	return (gi_vec3d){v[0], v[1], v[2]};
}

static inline void gi_vec3d_store(float out[3], gi_vec3d v)
{
	out[0] = (float)v.x;
	out[1] = (float)v.y;
	out[2] = (float)v.z;
}

static inline gi_vec3d gi_vec3d_from(gi_vec4 v)
{
	return (gi_vec3d){v.x, v.y, v.z};
}

/* What is left of v when it is stored as float. The volatile is for GCC 12.2: at -O2 it drops the rounding of
 * (double)(float)x where it vectorises two of them. */
static inline gi_vec3d gi_vec3d_rounded(gi_vec3d v)
{
	volatile float x = (float)v.x, y = (float)v.y, z = (float)v.z;
	return (gi_vec3d){x, y, z};
}

static inline gi_vec3d gi_vec3d_add(gi_vec3d a, gi_vec3d b)
{
	return (gi_vec3d){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline gi_vec3d gi_vec3d_sub(gi_vec3d a, gi_vec3d b)
{
	return (gi_vec3d){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline gi_vec3d gi_vec3d_scale(gi_vec3d a, double s)
{
	return (gi_vec3d){a.x * s, a.y * s, a.z * s};
}

static inline double gi_vec3d_dot(gi_vec3d a, gi_vec3d b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline gi_vec3d gi_vec3d_cross(gi_vec3d a, gi_vec3d b)
{
	return (gi_vec3d){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline double gi_vec3d_length(gi_vec3d a)
{
	return sqrt(gi_vec3d_dot(a, a));
}

/* Of length 1; 0 stays 0. */
static inline gi_vec3d gi_vec3d_unit(gi_vec3d v)
{
	const double length = gi_vec3d_length(v);
	return length > 0 ? gi_vec3d_scale(v, 1 / length) : v;
}

/* Area times normal of the triangle a b c. */
static inline gi_vec3d gi_vec3d_triangle(gi_vec3d a, gi_vec3d b, gi_vec3d c)
{
	return gi_vec3d_scale(gi_vec3d_cross(gi_vec3d_sub(b, a), gi_vec3d_sub(c, a)), 0.5);
}

/* Weights of a triangle's corners at p, or at what of its plane is below p; returns the least. */
static inline double gi_vec3d_weights(const gi_vec3d c[3], gi_vec3d p, double out[3])
{
	const gi_vec3d n = gi_vec3d_cross(gi_vec3d_sub(c[1], c[0]), gi_vec3d_sub(c[2], c[0]));
	const double size = gi_vec3d_dot(n, n);
	double least = HUGE_VAL;
	for (int k = 0; k < 3; k++) {
		const gi_vec3d from = c[(k + 1) % 3], to = c[(k + 2) % 3];
		out[k] = gi_vec3d_dot(n, gi_vec3d_cross(gi_vec3d_sub(to, from), gi_vec3d_sub(p, from))) / size;
		least = fmin(least, out[k]);
	}
	return size > 0 ? least : -HUGE_VAL;
}

#endif
