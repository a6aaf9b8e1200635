/* The triangle that is next to a point. */
#ifndef ENGINE_NEAREST_H
#define ENGINE_NEAREST_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct engine_triangle {
	float corners[3][3];
} engine_triangle;

typedef struct engine_nearest engine_nearest;

/* A tree over triangles, which must live as long; those without an area are points or lines that are found, too. NULL:
 * out of memory, or none. */
engine_nearest *engine_nearest_make(const engine_triangle *triangles, uint32_t count);
void engine_nearest_free(engine_nearest *nearest);

/* Number of the triangle next to a point of a surface with that normal (of any length): of those that face the same
 * way, unless one that does not is a fourth as far away and by 2 % of the extent of all nearer. Of equal ones always
 * the same. */
uint32_t engine_nearest_find(const engine_nearest *nearest, const float point[3], const float normal[3]);

#ifdef __cplusplus
}
#endif

#endif
