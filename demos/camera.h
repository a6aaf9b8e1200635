/* A camera that a mouse can carry round what it looks at. */
#ifndef DEMOS_CAMERA_H
#define DEMOS_CAMERA_H

typedef struct camera {
	float eye[3], target[3], up[3]; /* world, metres */
	float vertical_fov;             /* radians, below pi */
	float radius;                   /* of the scene, metres: sets the near and far planes */
} camera;

/* Turns the eye about the target: angles in radians, to the right and upwards; stops short of the poles. Afterwards up
 * is +y. */
void camera_orbit(camera *c, float right, float up);

/* Moves the eye towards the target, a notch is an eighth of the way. */
void camera_zoom(camera *c, float notches);

/* Two directions on the floor, unit vectors: to the right and away from the eye. */
void camera_floor_axes(const camera *c, float right[3], float away[3]);

/* The direction, not normalised, in which the eye sees a place of the picture: pixels from its top left corner. */
void camera_direction(const camera *c, float x, float y, int width, int height, float out[3]);

/* Metres that one pixel of a picture of that height covers at the target. */
float camera_metres_per_pixel(const camera *c, int height);

/* Column-major, as gi_view has them. */
void camera_matrices(const camera *c, float aspect, float view_from_world[16], float clip_from_view[16]);

/* The other way: a camera of such matrices, about the y axis at its own height. */
camera camera_about_y(const float view_from_world[16], const float clip_from_view[16], float radius);

#endif
