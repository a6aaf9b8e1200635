/* A ray at a mirror or at glass. */
#ifndef TESTS_BENCH_TRACE_SMOOTH_H
#define TESTS_BENCH_TRACE_SMOOTH_H

#include "trace_embree.h"

/* Takes a ray that met a smooth object on: reflected or refracted by chance, as Fresnel's equations say, `chance` in
 * [0, 1). `weight` takes the surface's colour. False where light ends: at the back of a mirror. */
bool trace_smooth_go_on(const trace_hit *hit, float lift, float chance, vec3 origin, vec3 direction, vec3 weight);

#endif
