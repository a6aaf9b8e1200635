/* Random small scenes and their moves, the same for the same seed: what solves and updates are tried on by the
 * thousand.
 *
 * A scene is a closed room or open ground under the sky, with one to four boxes, balls
 * and quads of one or two refinement levels in it; some of them emit, over five decades; reflectances are ordinary,
 * near 1 (up to 0.999) or, one scene in ten, up to 0.9999. Objects may cut each other: rows take that.
 */
#ifndef TESTS_RANDOM_SCENE_H
#define TESTS_RANDOM_SCENE_H

#include "harness.h"

enum { RANDOM_SCENE_OBJECTS = 6 };

typedef struct random_scene {
	uint64_t state; /* of the generator */
	gi_object objects[RANDOM_SCENE_OBJECTS];
	uint32_t count, fixed; /* the first `fixed` objects do not move */
	float brightest_rho;   /* the most any object of the scene may have */
} random_scene;

/* Creates the scene of that seed in a context and commits it. */
random_scene random_scene_make(gi_context *gi, uint64_t seed);

/* The same with reflectances of up to 1 - 1e-6: one brightest in each scene, between 0.9 and that. */
random_scene random_scene_make_stiff(gi_context *gi, uint64_t seed);

/* The next move: new poses for some objects, near their old ones or anywhere, sometimes a new material or only that;
 * the caller updates. */
void random_scene_move(gi_context *gi, random_scene *scene);

/* Destroys its objects and commits; the context takes the next scene. */
void random_scene_clear(gi_context *gi, random_scene *scene);

/* In [0, 1), for what a test draws on top of a scene: from the scene's own generator. */
double random_scene_draw(random_scene *scene);

#endif
