/* One quad for many coplanar leaves: a wall of a thousand faces is a rectangle to form factors, rays and lamps. */
#ifndef GI_QUAD_COVER_H
#define GI_QUAD_COVER_H

#include "hierarchy.h"
#include "vec3d.h"

/* Four of the leaves' vertices, counter-clockwise about the normal, whose convex quad holds all corners of leaves
 * [first, first + count), within `tolerance` metres; false when none was found (a triangle, a trapezoid whose longest
 * distance is a side). Where the areas agree too, the leaves tile the quad. */
bool gi_quad_cover(const gi_hierarchy *hierarchy, uint32_t first, uint32_t count, gi_vec3d normal, double tolerance,
		   uint32_t corners[4]);

#endif
