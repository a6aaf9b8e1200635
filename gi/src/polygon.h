/* Polygons that are not convex, cut into triangles of the same area. */
#ifndef GI_POLYGON_H
#define GI_POLYGON_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { GI_POLYGON_MAX_CORNERS = 1024 };

/* Whether every corner and every triangle of the fan from the first (a star turns left always) turns left about the
 * mean normal (Newell's method), or by less than 1e-6 of the area the other way: rounding on a straight side.
 */
bool gi_polygon_is_convex(const double (*points)[3], uint32_t count);

/* Cuts off ears (Meisters 1975): triangles of corner numbers below count, turned as the polygon is. Returns count - 2,
 * or 0 for a polygon that crosses or touches itself, or of more than GI_POLYGON_MAX_CORNERS corners.
 */
uint32_t gi_polygon_cut(const double (*points)[3], uint32_t count, uint32_t (*triangles)[3]);

#ifdef __cplusplus
}
#endif

#endif
