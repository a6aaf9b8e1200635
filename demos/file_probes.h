/* A grid of probes over a scene file. */
#ifndef DEMOS_FILE_PROBES_H
#define DEMOS_FILE_PROBES_H

#include "file_scene.h"

#include <stdbool.h>
#include <stddef.h>

/* Probes so many metres apart in the scene's bounds, as far from one side as from the other. False with one line in
 * message, which says what spacing would do where there are too many. */
bool file_probes_create(const file_scene *f, float spacing, gi_context *gi, char *message, size_t message_size);

#endif
