/* Caustics. Those that the eye sees straight: photons are traced from the lamps through mirrors and glass to
 * the first diffuse surface, and fall into the pixel that shows that place (light tracing: Arvo, "Backward ray
 * tracing", 1986; the splats of bidirectional path tracing, Veach, 1997, 10.3.4). No density estimation: unbiased.
 * Those that are seen in mirrors, through glass, or by the light they give to others: the same photons
 * (caustic_map.h), whose radius shrinks from pass to pass, so that what it blurs vanishes (Knaus and Zwicker,
 * "Progressive photon mapping: a probabilistic approach", 2011).
 *
 * Photons are aimed at the sphere round each mirror and glass object, from points drawn on the lamps. */
#ifndef TESTS_BENCH_CAUSTIC_SPLATS_H
#define TESTS_BENCH_CAUSTIC_SPLATS_H

#include "trace_camera.h"
#include "trace_embree.h"
#include "trace_light.h"

typedef struct caustic_splats caustic_splats;

/* All arguments stay where they are until the end. There is light, and an object that is smooth. NULL: out of
 * memory. */
caustic_splats *caustic_splats_create(const trace_scene *scene, const trace_embree *embree, const trace_lights *lights,
				      const trace_camera *camera, uint32_t seed);
void caustic_splats_destroy(caustic_splats *splats);

/* Takes in the poses of what moves. */
void caustic_splats_update(caustic_splats *splats);

/* Traces so many photons, pass by pass others: adds one estimate of the caustics' radiance to 3 sums a pixel, and keeps
 * them for caustic_splats_irradiance. False when out of memory. */
bool caustic_splats_add(caustic_splats *splats, uint32_t pass, uint32_t photons, uint32_t threads, double *sums);

/* What the photons of the last pass give to a place, W/m2. Any number of threads at once. */
void caustic_splats_irradiance(const caustic_splats *splats, const vec3 point, const vec3 normal, vec3 out);

#endif
