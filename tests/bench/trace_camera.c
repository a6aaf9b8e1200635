#include "trace_camera.h"

#include <math.h>
#include <string.h>

trace_camera trace_camera_make(const float view_from_world[16], const float clip_from_view[16], int width, int height)
{
	mat4 view, world;
	memcpy(view, view_from_world, sizeof view);
	glm_mat4_inv(view, world);
	trace_camera c = {.width = width, .height = height};
	glm_vec3_copy(world[3], c.eye);
	glm_vec3_negate_to(world[2], c.forward);
	glm_vec3_scale(world[0], 1 / clip_from_view[0], c.right);
	glm_vec3_scale(world[1], 1 / clip_from_view[5], c.up);
	return c;
}

void trace_camera_direction(const trace_camera *camera, float x, float y, vec3 out)
{
	glm_vec3_copy((float *)camera->forward, out);
	glm_vec3_muladds((float *)camera->right, 2 * x / (float)camera->width - 1, out);
	glm_vec3_muladds((float *)camera->up, 1 - 2 * y / (float)camera->height, out);
}

bool trace_camera_find(const trace_camera *camera, const vec3 point, int *x, int *y)
{
	vec3 to;
	glm_vec3_sub((float *)point, (float *)camera->eye, to);
	const float depth = glm_vec3_dot(to, (float *)camera->forward);
	if (!(depth > 0))
		return false;
	const float across =
	    glm_vec3_dot(to, (float *)camera->right) / (glm_vec3_norm2((float *)camera->right) * depth);
	const float up = glm_vec3_dot(to, (float *)camera->up) / (glm_vec3_norm2((float *)camera->up) * depth);
	if (!(fabsf(across) < 1 && fabsf(up) < 1))
		return false;
	*x = (int)(0.5f * (1 + across) * (float)camera->width);
	*y = (int)(0.5f * (1 - up) * (float)camera->height);
	return *x < camera->width && *y < camera->height;
}

float trace_camera_pixel_area(const trace_camera *camera)
{
	return 4 * glm_vec3_norm((float *)camera->right) * glm_vec3_norm((float *)camera->up) /
	       (float)(camera->width * camera->height);
}
