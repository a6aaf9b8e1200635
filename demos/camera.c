#include "camera.h"

#include <cglm/cglm.h>

#include <math.h>
#include <string.h>

/* Nearer to a pole the view would spin about its axis. */
static const float MAX_PITCH = 1.5f;

void camera_orbit(camera *c, float right, float up)
{
	vec3 offset;
	glm_vec3_sub(c->eye, c->target, offset);
	const float distance = glm_vec3_norm(offset);
	if (!(distance > 0))
		return;
	const float yaw = atan2f(offset[0], offset[2]) + right;
	const float pitch = glm_clamp(asinf(glm_clamp(offset[1] / distance, -1, 1)) + up, -MAX_PITCH, MAX_PITCH);
	c->eye[0] = c->target[0] + distance * cosf(pitch) * sinf(yaw);
	c->eye[1] = c->target[1] + distance * sinf(pitch);
	c->eye[2] = c->target[2] + distance * cosf(pitch) * cosf(yaw);
	glm_vec3_copy((vec3){0, 1, 0}, c->up);
}

void camera_zoom(camera *c, float notches)
{
	const float factor = powf(0.875f, notches);
	for (int k = 0; k < 3; k++)
		c->eye[k] = c->target[k] + factor * (c->eye[k] - c->target[k]);
}

void camera_floor_axes(const camera *c, float right[3], float away[3])
{
	vec3 forward;
	glm_vec3_sub((float *)c->target, (float *)c->eye, forward);
	forward[1] = 0;
	if (glm_vec3_norm(forward) < 1e-6f) /* straight down: what is up in the picture is away */
		glm_vec3_copy((vec3){c->up[0], 0, c->up[2]}, forward);
	glm_vec3_normalize_to(forward, away);
	glm_vec3_cross(away, (vec3){0, 1, 0}, right);
}

void camera_direction(const camera *c, float x, float y, int width, int height, float out[3])
{
	vec3 forward, right, up;
	glm_vec3_sub((float *)c->target, (float *)c->eye, forward);
	glm_vec3_normalize(forward);
	glm_vec3_crossn(forward, (float *)c->up, right);
	glm_vec3_cross(right, forward, up);
	const float half = tanf(0.5f * c->vertical_fov), pixel = 2 * half / (float)height;
	glm_vec3_copy(forward, out);
	glm_vec3_muladds(right, pixel * (x - 0.5f * (float)width), out);
	glm_vec3_muladds(up, pixel * (0.5f * (float)height - y), out);
}

float camera_metres_per_pixel(const camera *c, int height)
{
	const float distance = glm_vec3_distance((float *)c->eye, (float *)c->target);
	return 2 * distance * tanf(0.5f * c->vertical_fov) / (float)height;
}

void camera_matrices(const camera *c, float aspect, float view_from_world[16], float clip_from_view[16])
{
	mat4 view, clip;
	const float distance = glm_vec3_distance((float *)c->eye, (float *)c->target);
	glm_lookat((float *)c->eye, (float *)c->target, (float *)c->up, view);
	/* The planes 1 : 1000 and a little more apart: a 32-bit depth buffer tells a millimetre at ten metres. */
	glm_perspective(c->vertical_fov, aspect, 0.01f * c->radius, 10 * c->radius + distance, clip);
	memcpy(view_from_world, view, sizeof view);
	memcpy(clip_from_view, clip, sizeof clip);
}

camera camera_about_y(const float view_from_world[16], const float clip_from_view[16], float radius)
{
	mat4 view, world_from_view;
	memcpy(view, view_from_world, sizeof view);
	glm_mat4_inv(view, world_from_view);
	camera out = {.target = {0, world_from_view[3][1], 0}, .up = {0, 1, 0}, .radius = radius};
	memcpy(out.eye, world_from_view[3], sizeof out.eye);
	out.vertical_fov = 2 * atanf(1 / clip_from_view[5]);
	return out;
}
