/* Light traced forward through mirrors and glass: what the library's specular transport is measured against.
 *
 * Photons of flux leave the emitters, are reflected and refracted by smooth surfaces, and end on the first surface that
 * is neither mirror nor glass, which takes all of it: one pass of light, without what that surface gives on.
 * Independent of the library on purpose: Embree for the rays, its own Fresnel equations and sampling. Only tests and
 * benchmarks link it.
 */
#ifndef TESTS_REFERENCE_LIGHT_TRACE_H
#define TESTS_REFERENCE_LIGHT_TRACE_H

#include <stdbool.h>
#include <stdint.h>

/* What the two sides of a triangle do. Where all of specular and transmittance are 0 it takes what arrives. */
typedef struct light_surface {
	float exitance[3]; /* W/m2 from the front, >= 0 */
	float specular[3]; /* of a mirror: share that is reflected, [0, 1]; the rest is absorbed. Its back is black */
	float transmittance[3]; /* of glass: share of what is refracted that goes on, at each crossing, [0, 1] */
	float index; /* of refraction behind the front, over that before it; where transmittance is above 0 */
} light_surface;

/* The caller's arrays; they are read during the call only. */
typedef struct light_scene {
	const float *positions; /* vertex_count * 3, metres */
	const float
	    *normals; /* vertex_count * 3, unit: mirrors and glass are as smooth as these; NULL: as triangles are */
	const uint32_t *corners;    /* triangle_count * 3, counter-clockwise seen from the front */
	const uint32_t *surface_of; /* triangle_count */
	const light_surface *surfaces;
	uint32_t vertex_count, triangle_count;
} light_scene;

typedef struct light_flux {
	double rgb[3]; /* W */
} light_flux;

/* Where all that was emitted went: emitted = sum of direct + sum of specular + absorbed + escaped, but for rounding. */
typedef struct light_result {
	light_flux *direct;   /* triangle_count: arrived straight from an emitter */
	light_flux *specular; /* triangle_count: arrived after at least one mirror or glass surface */
	light_flux emitted, escaped;
	light_flux absorbed; /* by mirrors, glass and backs */
} light_result;

/* `photons` in all, >= 1, the same bits for the same seed whatever the number of threads. False, with *out zeroed, when
 * nothing emits or memory or Embree fails. */
bool light_trace(const light_scene *scene, uint64_t photons, uint64_t seed, light_result *out);
void light_result_free(light_result *result);

/* Share of unpolarised light that a smooth surface between two clear media reflects (Fresnel's equations; Born and
 * Wolf, Principles of Optics, 7th ed., 1.5.2); cosine of the angle of incidence, (0, 1]; index of the medium behind
 * over that before. 1 where all is reflected. */
double light_fresnel(double cosine, double index);

#endif
