/* The library's leaves as the reference's scene: so that both sides of a comparison are about the same patches. */
#ifndef TESTS_REFERENCE_LEAVES_H
#define TESTS_REFERENCE_LEAVES_H

#include "reference.h"

#include "gi/gi.h"

typedef struct leaf_scene {
	reference_scene scene; /* its arrays are this struct's */
	double *areas;         /* leaf_count, m2 */
	double *rho;           /* leaf_count * 3 */
} leaf_scene;

/* Copies `count` leaves; the sky is black. False, with *out zeroed, when out of memory. */
bool leaf_scene_make(const gi_leaf *leaves, uint32_t count, leaf_scene *out);

/* Frees the arrays and zeroes the struct; an already zeroed one is fine. */
void leaf_scene_free(leaf_scene *scene);

/* gi_leaf.irradiance of `count` leaves as packed doubles, count * 3. */
void leaf_irradiance(const gi_leaf *leaves, uint32_t count, double *out);

#endif
