/* The scenes that benchmarks measure in, each with one object that moves:
 *
 *   cornell   the demo's box: one lamp, the Buddha (cornell.h)
 *   rooms     two rooms and a door that swings: only light that was reflected reaches the second
 *   corridor  28 small lamps in two rows, a ball that rolls
 *   furnace   a closed room and a Buddha of one rho and E: the irradiance is known exactly
 *
 * To add one: a create, a pose and a camera, and a line in scenes.c.
 */
#ifndef SCENES_SCENES_H
#define SCENES_SCENES_H

#include "gi/gi.h"

typedef struct scene_kind {
	const char *name, *title;
	gi_sky sky;             /* for gi_context_def: rooms of several objects need no sky to close their rows */
	float exposure;         /* for pictures */
	float exact_irradiance; /* > 0: of every leaf at every time, W/m2 */
	/* Creates the objects, the mover in its place at time 0; the caller commits. */
	gi_result (*create)(gi_context *gi, gi_object *mover);
	gi_pose (*pose)(float t); /* of the mover at time t, seconds: smooth, a loop of 8 s */
	/* Column-major view_from_world and clip_from_view. */
	void (*camera)(float aspect, float view_from_world[16], float clip_from_view[16]);
} scene_kind;

enum { SCENE_KINDS = 4 };

extern const scene_kind scene_kinds[SCENE_KINDS];

/* NULL: none has that name. */
const scene_kind *scene_kind_find(const char *name);

#endif
