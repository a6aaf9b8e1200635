/* A pinhole camera for ray tracers, from the matrices that gi_view takes. */
#ifndef TESTS_BENCH_TRACE_CAMERA_H
#define TESTS_BENCH_TRACE_CAMERA_H

#include <cglm/cglm.h>

#include <stdbool.h>

typedef struct trace_camera {
	vec3 eye, forward;
	vec3 right, up; /* as long as half the picture, one unit of `forward` away */
	int width, height;
} trace_camera;

trace_camera trace_camera_make(const float view_from_world[16], const float clip_from_view[16], int width, int height);

/* The direction, not normalised, to a place in the picture: pixels from its top left corner. */
void trace_camera_direction(const trace_camera *camera, float x, float y, vec3 out);

/* The pixel that shows a point, and how much of the plane one unit before the eye that pixel has. False where the
 * picture does not show it. */
bool trace_camera_find(const trace_camera *camera, const vec3 point, int *x, int *y);
float trace_camera_pixel_area(const trace_camera *camera);

#endif
