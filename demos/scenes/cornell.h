/* The Cornell box of the demo, the tests and the benchmarks: five walls, a light, and what stands in it.
 *
 * 5.5 m wide, high and deep, centred on the y axis, floor at y = 0, open towards +z; the left wall (x < 0) is red, the
 * right one green. Each wall is an object, as each would be in a scene file.
 */
#ifndef SCENES_CORNELL_H
#define SCENES_CORNELL_H

#include "gi/gi.h"
#include "mesh.h"

typedef struct cornell_def {
	uint32_t wall_faces;            /* base faces of a wall a side; default 3 */
	uint32_t wall_levels;           /* refinement of the walls; default 3: 24 x 24 leaves each */
	uint32_t light_levels;          /* refinement of the light, one face at first; default 2 */
	bool buddha;                    /* a leaf for each face of its cage; default true */
	float buddha_height;            /* metres, default 2.8 */
	const engine_mesh *figure;      /* drawn in the Buddha's place, fitted to its height; NULL: the project's own */
	const engine_mesh *figure_cage; /* what lights it (triangles); required with figure */
	float leaf_size;     /* > 0: mean leaf edge of everything, metres, instead of all levels; default 0 */
	bool balls;          /* two balls beside it, as in Song et al. (README); default true */
	uint32_t ball_faces; /* base faces of a ball: 6 n^2; default 5 */
	const gi_specular *ball_specular; /* of both, which are black else; default NULL: they are white */
} cornell_def;

typedef struct cornell {
	gi_object floor, ceiling, back, left, right, light, buddha, balls[2];
} cornell;

cornell_def cornell_def_default(void);

/* Creates the objects; the caller commits. On failure some may have been created. */
gi_result cornell_create(gi_context *gi, const cornell_def *def, cornell *out);

/* Where the demo's Buddha is at time t (seconds): a loop of 8 s over the floor, turning to face its way. Closed and
 * smooth.
 */
gi_pose cornell_buddha_pose(float t);

/* The demo's camera, looking into the box; column-major view_from_world and clip_from_view. */
void cornell_camera(float aspect, float view_from_world[16], float clip_from_view[16]);

#endif
