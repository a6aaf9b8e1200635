#include "file_inside.h"

#include "file_rays.h"

#include <cglm/cglm.h>

#include <math.h>

/* Places that are tried, directions to look in from each, rays of a picture's side. */
enum { PLACES = 8, DIRECTIONS = 16, GRID = 6 };

/* Whether the sky is seen from a point on the side that the ray saw. */
static bool is_below_sky(file_rays *r, const float point[3], const float normal[3])
{
	for (int tries = 0; tries < 4; tries++) {
		vec3 way;
		file_rays_scatter(r, normal, way);
		if (file_rays_shoot(r, point, way, 1e-5f * r->radius, false).triangle == UINT32_MAX)
			return true;
	}
	return false;
}

/* Whether a lamp's light comes straight to it. */
static bool is_lit(file_rays *r, const float point[3], const float normal[3])
{
	vec3 lamp, unused, way;
	for (int tries = 0; tries < 4; tries++) {
		if (!file_rays_from_lamp(r, lamp, unused))
			return false;
		glm_vec3_sub(lamp, (float *)point, way);
		float distance = glm_vec3_norm(way);
		glm_vec3_normalize(way);
		if (glm_vec3_dot(way, (float *)normal) <= 0)
			continue;
		file_hit hit = file_rays_shoot(r, point, way, 1e-5f * r->radius, false);
		if (hit.distance > 0.999f * distance &&
		    (hit.triangle == UINT32_MAX || !hit.back || r->triangles[hit.triangle].double_sided))
			return true;
	}
	return false;
}

/* 1 where a ray of the picture shows what is lit, 0 for nothing and the dark. */
static int shows_light(file_rays *r, const float eye[3], const float direction[3])
{
	vec3 point, normal;
	file_hit hit = file_rays_shoot(r, eye, direction, 0, true);
	if (hit.triangle == UINT32_MAX)
		return 0;
	const file_triangle *t = &r->triangles[hit.triangle];
	if (t->power > 0)
		return 1;
	glm_vec3_scale((float *)t->normal, hit.back ? -1 : 1, normal);
	glm_vec3_copy((float *)eye, point);
	glm_vec3_muladds((float *)direction, hit.distance, point);
	return (r->sky && is_below_sky(r, point, normal)) || is_lit(r, point, normal);
}

/* 1 where a ray of the picture meets the back of a face with one side. */
static int meets_back(file_rays *r, const float eye[3], const float direction[3])
{
	const file_hit hit = file_rays_shoot(r, eye, direction, 0, false);
	return hit.triangle != UINT32_MAX && hit.back && !r->triangles[hit.triangle].double_sided;
}

/* Share of the rays of a square picture for which `is` says 1. */
static float share(file_rays *r, const camera *view, int (*is)(file_rays *, const float[3], const float[3]))
{
	vec3 ahead, right, up;
	int count = 0;
	glm_vec3_sub((float *)view->target, (float *)view->eye, ahead);
	glm_vec3_normalize(ahead);
	glm_vec3_crossn(ahead, (float *)view->up, right);
	glm_vec3_cross(right, ahead, up);
	const float slope = tanf(0.5f * view->vertical_fov);
	for (int k = 0; k < GRID * GRID; k++) {
		vec3 direction;
		glm_vec3_copy(ahead, direction);
		glm_vec3_muladds(right, slope * ((float)(2 * (k % GRID) + 1) / GRID - 1), direction);
		glm_vec3_muladds(up, slope * ((float)(2 * (k / GRID) + 1) / GRID - 1), direction);
		glm_vec3_normalize(direction);
		count += is(r, view->eye, direction);
	}
	return (float)count / (GRID * GRID);
}

/* How far a ray goes, or a radius where it meets nothing. */
static float reach(const file_rays *r, const float from[3], const float direction[3])
{
	const file_hit hit = file_rays_shoot(r, from, direction, 1e-5f * r->radius, false);
	return hit.triangle == UINT32_MAX ? r->radius : hit.distance;
}

/* On the level of a point halfway along a lamp's ray, at one end of the longest line through it, looking to the other.
 * The length of the lamp's ray in *room: a point in a gap behind the lamp is a poor place.
 */
static bool place(file_rays *r, const camera *framing, camera *out, float *room)
{
	vec3 middle, direction;
	float longest = 0;
	if (!file_rays_from_lamp(r, middle, direction))
		return false;
	*room = reach(r, middle, direction);
	glm_vec3_muladds(direction, 0.5f * *room, middle);
	*out = *framing;
	out->vertical_fov = 1.2f;
	for (int k = 0; k < DIRECTIONS; k++) {
		const float angle = 2 * GLM_PIf * (float)k / DIRECTIONS;
		vec3 back = {sinf(angle), 0, cosf(angle)}, ahead = {-sinf(angle), 0, -cosf(angle)};
		const float behind = 0.95f * reach(r, middle, back), before = reach(r, middle, ahead);
		if (behind + before <= longest)
			continue;
		longest = behind + before;
		glm_vec3_copy(middle, out->eye);
		glm_vec3_muladds(back, behind, out->eye);
		glm_vec3_copy(out->eye, out->target);
		glm_vec3_muladds(ahead, 0.5f * longest, out->target);
	}
	return longest > 0;
}

/* More of what is lit counts, and to see it from afar. */
static void try_places(file_rays *r, camera *view, bool *moved)
{
	float best = 0;
	const camera framing = *view;
	for (int k = 0; k < PLACES; k++) {
		camera tried;
		float room;
		if (!place(r, &framing, &tried, &room))
			continue;
		const float lit = share(r, &tried, shows_light);
		const float worth = lit * room * (r->radius + glm_vec3_distance(tried.eye, tried.target));
		if (lit < 0.1f || worth <= best)
			continue;
		best = worth;
		*view = tried;
		*moved = true;
	}
}

/* 2 %: less than one ray of the grid. */
static bool is_dark(file_rays *r, const camera *view)
{
	return r->rays > 0 && r->power > 0 && share(r, view, shows_light) < 0.02f;
}

bool file_inside_sees_backs(const engine_scene *scene, bool sky, const camera *view)
{
	file_rays r;
	const bool sees = file_rays_make(&r, scene, sky) && is_dark(&r, view) && share(&r, view, meets_back) > 0.5f;
	file_rays_free(&r);
	return sees;
}

bool file_inside_look(const engine_scene *scene, bool sky, camera *view)
{
	file_rays r;
	bool moved = false;
	if (file_rays_make(&r, scene, sky) && is_dark(&r, view))
		try_places(&r, view, &moved);
	file_rays_free(&r);
	return moved;
}
