/* The limit surface of a Catmull-Clark cage as triangles of any fineness, by Embree: what the library's subdivided
 * objects are, found without the library. */
#ifndef TESTS_BENCH_LIMIT_SURFACE_H
#define TESTS_BENCH_LIMIT_SURFACE_H

#include "mesh.h"

/* 2 n^2 triangles of each face of a closed cage of quads, corners on the limit surface, and its unit normals there
 * (vertex_count * 3). The caller frees both. False with *out zeroed and *normals NULL when memory or Embree fails. */
bool limit_surface(const engine_mesh *cage, uint32_t n, engine_mesh *out, float **normals);

#endif
