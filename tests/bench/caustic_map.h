/* Photons where light that came through mirrors and glass fell on diffuse surfaces, to ask how bright a place is
 * (Jensen, "A practical guide to global illumination using ray tracing and photon mapping", SIGGRAPH 2004 course 5,
 * part 3). */
#ifndef TESTS_BENCH_CAUSTIC_MAP_H
#define TESTS_BENCH_CAUSTIC_MAP_H

#include <cglm/cglm.h>

#include <stdbool.h>
#include <stdint.h>

typedef struct caustic_photon {
	vec3 point, normal; /* of the surface, unit */
	vec3 flux;          /* W */
} caustic_photon;

/* Photons sorted by cells of a grid, which are found by a hash. All zero: none. */
typedef struct caustic_map {
	caustic_photon *photons;
	uint32_t *first; /* of each hash; one more at the end */
	uint32_t count, room, hashes;
	float radius; /* metres */
} caustic_map;

/* Takes in so many photons in the place of those before. False when out of memory. */
bool caustic_map_build(caustic_map *map, const caustic_photon *photons, uint32_t count, float radius);
void caustic_map_free(caustic_map *map);

/* Irradiance at a point of a surface, W/m2: of photons within the radius, the nearer the more (Epanechnikov's
 * kernel), on surfaces that face alike. */
void caustic_map_irradiance(const caustic_map *map, const vec3 point, const vec3 normal, vec3 out);

#endif
