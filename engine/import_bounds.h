/* Boxes about positions, and what lies too far from the origin for floats. */
#ifndef ENGINE_IMPORT_BOUNDS_H
#define ENGINE_IMPORT_BOUNDS_H

#include "mesh.h"

#include <stdbool.h>

typedef struct import_bounds {
	double lower[3], upper[3];
} import_bounds;

/* Of nothing: inside out, so that any point widens it. */
import_bounds import_bounds_of_nothing(void);

import_bounds import_bounds_of_mesh(const engine_mesh *mesh);

void import_bounds_widen(import_bounds *bounds, const double point[3]);

/* The middle in whole metres where floats, of 24 bits, are too coarse for what lies there: farther off than 4096 times
 * the extent, or 64 times it and a kilometre, as map coordinates of seven digits are. Else false, and zero.
 */
bool import_bounds_far_middle(const import_bounds *bounds, double middle[3]);

#endif
