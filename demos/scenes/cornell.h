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
	uint32_t smooth_levels;         /* refinement of the Buddha and the balls where leaf_size is 0; default 0 */
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

/* One flat piece of the box, by itself: corner + s u + t v for s and t in [0, 1]; its front is the side that u x v
 * points to. */
typedef struct cornell_side {
	const char *name;
	float corner[3], u[3], v[3];
	float rho[3], exitance[3]; /* W/m2 */
} cornell_side;

/* The box for renderers of other kinds: floor, back, left, right, the light, and the ceiling round it in four
 * pieces. */
enum { CORNELL_WALLS = 4, CORNELL_SIDES = 9 };
void cornell_sides(cornell_side out[CORNELL_SIDES]);

/* What stands in it: the reflectance of the Buddha and that of balls which are neither mirror nor glass; where ball
 * k (0 or 1) stands beside the Buddha, and its radius, metres. */
extern const float cornell_stone[3], cornell_white[3];
float cornell_ball(int k, float centre[3]);

/* Where the demo's Buddha is at time t (seconds): a loop of 8 s over the floor, turning to face its way. Closed and
 * smooth.
 */
gi_pose cornell_buddha_pose(float t);

/* The two balls of figure 5 of Song et al. (README): a mirror (0) and a glass ball (1), for
 * cornell_def.ball_specular, the base faces that they take a side, and where ball k is at time t (seconds): both
 * roll round the middle in 8 s. */
extern const gi_specular cornell_mirror_and_glass[2];
enum { CORNELL_SMOOTH_BALL_FACES = 12 };
gi_pose cornell_rolling_ball_pose(int k, float t);

/* The demo's camera, looking into the box; column-major view_from_world and clip_from_view. */
void cornell_camera(float aspect, float view_from_world[16], float clip_from_view[16]);

#endif
