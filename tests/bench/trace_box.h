/* The Cornell box and what stands in it, as the demos show it, for ray tracers (trace_scene.h). */
#ifndef TESTS_BENCH_TRACE_BOX_H
#define TESTS_BENCH_TRACE_BOX_H

#include "trace_scene.h"

/* Fills an empty scene with walls and light. False, here and below, when out of memory: free it all the same. */
bool trace_box_walls(trace_scene *scene);

/* Everything of demos/moving_buddha: walls, the Buddha and two white balls. The Buddha is drawn with 2 * fineness^2
 * triangles of each of 992 faces, or as `figure` (triangles, metres, standing on y = 0) where that is not NULL. */
bool trace_box_buddha(trace_scene *scene, uint32_t fineness, const engine_mesh *figure);

/* Everything of demos/two_balls: walls, a mirror ball and a glass ball. */
bool trace_box_balls(trace_scene *scene);

/* Takes what moves to where it is at time t, seconds. */
void trace_box_buddha_at(trace_scene *scene, float t);
void trace_box_balls_at(trace_scene *scene, float t);

/* The Buddha as the demo places it, metres, standing on y = 0: the limit surface of its cage with 2 * fineness^2
 * triangles a face. The caller frees it. */
bool trace_box_figure(uint32_t fineness, engine_mesh *out);

#endif
