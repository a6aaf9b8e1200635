/* Points of a scene that are in one place. */
#ifndef ENGINE_IMPORT_POINTS_H
#define ENGINE_IMPORT_POINTS_H

#include <stdbool.h>
#include <stdint.h>

/* Gives each of `count` points (three coordinates each) the number of the first one within a distance of it, on every
 * axis; itself where there is none before it. False: out of memory. */
bool import_points_weld(const double *points, uint32_t count, double distance, uint32_t *first);

#endif
