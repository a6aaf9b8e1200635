/* What a scene's light is, for other programs: a PLY of all leaves, a CSV of form factors.
 *
 * Files appear whole or not at all: what could not be written to its end is removed again.
 */
#ifndef DEMOS_EXPORT_H
#define DEMOS_EXPORT_H

#include "gi/gi.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The objects of a scene in the order of its file, with names that differ. */
typedef struct export_objects {
	const gi_object *handles;
	const char *const *names;
	uint32_t count;
} export_objects;

/* Binary little-endian PLY: one face a leaf with its corners in world space, unshared; rho, E and B as floats, linear
 * RGB, E and B in W/m2; `object` counts from 0 in the order of `objects`, whose names stand in the comments. Waits for
 * the GPU. False with one line in message.
 */
bool export_field(gi_context *gi, const export_objects *objects, const char *path, char *message, size_t message_size);

/* CSV `from,to,F`: the fraction of what leaves the whole of `from` that arrives directly at `to`, for all ordered
 * pairs, an object and itself too; and `from,*,rowsum`: at anything. Waits for the GPU. False with one line in message.
 */
bool export_form_factors(gi_context *gi, const export_objects *objects, const char *path, char *message,
			 size_t message_size);

#endif
