/* Which of two surfaces in one place that look the same way is the one that is seen: a carpet on the floor, a lamp in
 * the plane of the ceiling, a wall that is there twice. All of it is known at the commit, so that rows do not depend on
 * what came before, nor on rounding.
 */
#ifndef GI_RANK_H
#define GI_RANK_H

#include "scene.h"

/* Gives every primitive its rank (gi_primitive.b.w) and its leaves the same: those that emit above all others, then by
 * objects, the smaller area above the larger, the one created later above the earlier; then the smaller primitive above
 * the larger. Objects have their places in the scene, and get to know their lowest and highest. False when memory ran
 * out. */
bool rank_primitives(const gi_scene *scene, gi_primitive *primitives, gi_uvec4 *leaves);

/* Gives primitives of one object, which were made anew, the ranks that they have since the last commit. */
void rank_again(const object_record *object, gi_primitive *primitives);

#endif
