/* Scenes with three movers and their random motion: what the tests of updates and of budgets play. */
#ifndef TESTS_MOVING_SCENE_H
#define TESTS_MOVING_SCENE_H

#include "harness.h"

enum { MOVERS = 3, BALL = 0, BLOCK = 1, SHEET = 2 };

typedef struct scene {
	gi_context *gi;
	gi_object mover[MOVERS], light;
} scene;

/* The Cornell box without its own figures, and a closed room of the same size (no sky). */
void open_box(scene *s, const gi_context_def *def);
void open_room(scene *s, const gi_context_def *def);

extern const gi_pose HOME[MOVERS];

typedef struct motion {
	gi_pose pose[MOVERS], seen[MOVERS][4]; /* poses they were in before */
	bool stay_inside;
} motion;

/* Sets where the motion begins: the same seed gives the same motion. */
void seed_motion(uint32_t seed);
motion start_motion(bool stay_inside);
gi_pose random_pose(int mover, bool stay_inside);

/* Which of the movers get a new pose in this frame. */
void next_poses(motion *m, bool moved[MOVERS]);

#endif
