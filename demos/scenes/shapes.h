/* Simple cages, made by code: what scenes, tests and benchmarks are built of. Each fills `out`, which the caller frees
 * with engine_mesh_free(); false when out of memory.
 */
#ifndef SCENES_SHAPES_H
#define SCENES_SHAPES_H

#include "mesh.h"

/* A parallelogram of n x m quads: corner + u * s + v * t for s, t in [0,1]; its front is the side u x v points to. */
bool shape_quad(const float corner[3], const float u[3], const float v[3], uint32_t n, uint32_t m, engine_mesh *out);

/* An axis-aligned box of n x n quads a side; normals outward, or inward for a room. */
bool shape_box(const float lower[3], const float upper[3], uint32_t n, bool inward, engine_mesh *out);

/* A sphere about the origin as the six sides of a cube, n x n quads each, corners on the sphere; normals outward. */
bool shape_sphere(float radius, uint32_t n, engine_mesh *out);

/* A disc of the given radius about the origin in the plane y = 0, facing +y: a regular polygon of 4 n sides, all quads,
 * of the disc's area. */
bool shape_disc(float radius, uint32_t n, engine_mesh *out);

/* Appends a copy of `more` to `to` (an empty mesh, all zero, will do) and frees `more`; vertices in one place stay two.
 * On failure both are freed. */
bool shape_append(engine_mesh *to, engine_mesh *more);

/* Appends a parallelogram as shape_quad makes it, of quads about `cell` wide. */
bool shape_append_quad(engine_mesh *to, const float corner[3], const float u[3], const float v[3], float cell);

#endif
