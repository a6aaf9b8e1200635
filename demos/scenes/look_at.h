#ifndef SCENES_LOOK_AT_H
#define SCENES_LOOK_AT_H

/* A camera at `eye` that looks at `target`, y up; field of view in degrees, from bottom to top. */
void look_at(const float eye[3], const float target[3], float fov, float aspect, float view_from_world[16],
	     float clip_from_view[16]);

#endif
