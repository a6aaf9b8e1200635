/* Path-traced irradiance per leaf: what the tests and benchmarks measure the library against.
 *
 * Independent of the library on purpose: its own arrays, its own sampling, Embree for the rays. Only tests and
 * benchmarks link it.
 *
 * Conventions (the radiosity glossary): B radiosity, E exitance, H irradiance, all W/m2 per RGB channel, and
 * B = E + rho H. A leaf emits radiance L = E/pi evenly over the half space its normal points to.
 */
#ifndef TESTS_REFERENCE_REFERENCE_H
#define TESTS_REFERENCE_REFERENCE_H

#include <stdbool.h>
#include <stdint.h>

/* A scene as flat arrays. The caller owns them; they are read during the call only. */
typedef struct reference_scene {
	const float *corners; /* leaf_count * 4 * 3, world space, metres: corners a b c d. The leaf is the two triangles
			       * a b c and a c d, each one-sided: the front is where (b-a) x (c-a), (c-a) x (d-a)
			       * points. A triangle has d == c. Backs are black but opaque. */
	const float *rho;     /* leaf_count * 3, reflectance, [0,1) */
	const float *exitance; /* leaf_count * 3, W/m2, >= 0 */
	uint32_t leaf_count;
	float sky_exitance[3]; /* W/m2, >= 0: a ray that misses sees radiance sky_exitance/pi; 0 is a black outside */
} reference_scene;

typedef struct reference_options {
	uint32_t paths_per_leaf; /* >= 1, rounded up to even; powers of two stratify best */
	uint64_t seed;           /* another seed gives an independent result */
	uint32_t thread_count;   /* 0: one per processor. Never changes a bit of the result */
	uint32_t max_bounces;    /* reflections followed; 0: no limit. A limit leaves the light of longer paths out */
	uint32_t first_leaf;     /* what falls on leaves before it is not asked, and left 0 */
} reference_options;

/* Two independent unbiased estimates ("halves") of the area mean of irradiance over each leaf, W/m2. Their mean is the
 * best estimate, their difference twice its noise; products across halves are free of noise bias (error.h). */
typedef struct reference_result {
	double *irradiance[2]; /* leaf_count * 3 each: all light */
	double *direct[2];     /* leaf_count * 3 each: the part straight from emitters and sky, same paths */
	uint32_t leaf_count;
	uint32_t paths_per_half; /* per leaf */
	uint64_t segments;       /* path segments traced, each one closest-hit ray and at most one shadow ray */
} reference_result;

/* Traces the scene with every processor. False, with *out zeroed, when an array is not finite or out of range, when no
 * ray engine or memory is to be had. A leaf of zero area gets irradiance 0.
 *
 * Two coincident leaves that face away from each other are the two sides of one sheet. So a leaf in contact with
 * another (a block's bottom on the floor) looks through it: lift it by reference_ray_offset() or more, or leave it out.
 */
bool reference_trace(const reference_scene *scene, uint32_t paths_per_leaf, uint64_t seed, reference_result *out);

bool reference_trace_with(const reference_scene *scene, const reference_options *options, reference_result *out);

/* Frees the arrays and zeroes the struct; an already zeroed one is fine. */
void reference_result_free(reference_result *result);

/* How far above its surface a ray starts, metres: 2^-18 of the scene's largest half extent. */
float reference_ray_offset(const reference_scene *scene);

/* areas: leaf_count values, m2, the sum of both triangles. */
void reference_leaf_areas(const reference_scene *scene, double *areas);

#endif
