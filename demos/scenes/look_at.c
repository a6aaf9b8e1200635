#include "scenes/look_at.h"

#include <cglm/cglm.h>

#include <string.h>

void look_at(const float eye[3], const float target[3], float fov, float aspect, float view_from_world[16],
	     float clip_from_view[16])
{
	vec3 from, to;
	mat4 view, clip;
	memcpy(from, eye, sizeof from);
	memcpy(to, target, sizeof to);
	glm_lookat(from, to, (vec3){0, 1, 0}, view);
	glm_perspective(glm_rad(fov), aspect, .05f, 100, clip);
	memcpy(view_from_world, view, sizeof view);
	memcpy(clip_from_view, clip, sizeof clip);
}
