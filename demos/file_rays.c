#include "file_rays.h"

#include <cglm/cglm.h>

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Triangles that are tried in about a quarter of a second. */
enum { TESTS = 40000000, MOST_RAYS = 8192, LEAST_RAYS = 64 };

void file_world_from_object(const engine_pose *pose, mat4 out)
{
	mat4 rotation;
	versor q; /* aligned, as the file's is not */
	memcpy(q, pose->rotation, sizeof q);
	glm_translate_make(out, (float *)pose->translation);
	glm_quat_mat4(q, rotation);
	glm_mul(out, rotation, out);
	glm_scale(out, (float *)pose->scale);
}

/* A triangle of its corners; false for one without area. */
static bool make_triangle(const float (*corners)[3], file_triangle *t)
{
	memcpy(t->corner, corners[0], sizeof t->corner);
	glm_vec3_sub((float *)corners[1], (float *)corners[0], t->edge[0]);
	glm_vec3_sub((float *)corners[2], (float *)corners[0], t->edge[1]);
	glm_vec3_cross(t->edge[0], t->edge[1], t->normal);
	float length = glm_vec3_norm(t->normal);
	if (!(length > FLT_MIN))
		return false;
	t->area = 0.5f * length;
	glm_vec3_scale(t->normal, 1 / length, t->normal);
	return true;
}

/* Fans: faces of a scene are convex. */
static void add_face(file_rays *r, const engine_scene *scene, uint32_t o, uint32_t f, const uint32_t *indices,
		     mat4 world)
{
	const engine_mesh *mesh = &scene->objects[o].mesh;
	const engine_scene_material *material = &scene->materials[mesh->face_materials[f]];
	float corners[3][3];
	for (uint32_t k = 2; k < mesh->face_counts[f]; k++) {
		file_triangle *t = &r->triangles[r->count];
		const uint32_t picked[3] = {indices[0], indices[k - 1], indices[k]};
		for (int c = 0; c < 3; c++)
			glm_mat4_mulv3(world, mesh->positions + 3 * (size_t)picked[c], 1, corners[c]);
		if (!make_triangle((const float(*)[3])corners, t))
			continue;
		t->object = o;
		t->face = f;
		t->double_sided = scene->objects[o].double_sided;
		t->power =
		    t->area * GLM_PIf / 3 * (material->radiance[0] + material->radiance[1] + material->radiance[2]);
		r->count++;
	}
}

static void add_object(file_rays *r, const engine_scene *scene, uint32_t o)
{
	mat4 world;
	file_world_from_object(&scene->objects[o].rest, world);
	const engine_mesh *mesh = &scene->objects[o].mesh;
	const uint32_t *indices = mesh->indices;
	for (uint32_t f = 0; f < mesh->face_count; indices += mesh->face_counts[f++])
		add_face(r, scene, o, f, indices, world);
}

static void find_sphere(file_rays *r)
{
	vec3 lower, upper;
	glm_vec3_broadcast(FLT_MAX, lower);
	glm_vec3_broadcast(-FLT_MAX, upper);
	for (uint32_t k = 0; k < r->count; k++) {
		for (int c = 0; c < 3; c++) {
			vec3 p;
			glm_vec3_copy(r->triangles[k].corner, p);
			if (c > 0)
				glm_vec3_add(p, r->triangles[k].edge[c - 1], p);
			glm_vec3_minv(lower, p, lower);
			glm_vec3_maxv(upper, p, upper);
		}
	}
	glm_vec3_lerp(lower, upper, 0.5f, r->middle);
	r->radius = 0.5f * glm_vec3_distance(lower, upper);
}

static double mean_intensity(const engine_scene_light *l)
{
	return ((double)l->intensity[0] + l->intensity[1] + l->intensity[2]) / 3;
}

/* After find_sphere(). */
static bool add_lights(file_rays *r, const engine_scene *scene)
{
	r->lights = malloc((scene->light_count + 1) * sizeof *r->lights);
	for (uint32_t k = 0; r->lights && k < scene->light_count; k++) {
		const engine_scene_light *from = &scene->lights[k];
		file_ray_light *l = &r->lights[r->light_count];
		*l = (file_ray_light){.type = from->type, .cosine = -1};
		if (!engine_scene_light_at(scene, k, 0, l->place, l->direction))
			continue;
		if (l->type == ENGINE_LIGHT_SPOT)
			l->cosine = cosf(from->outer_angle);
		l->power = mean_intensity(from) * 2 * GLM_PI * (1 - (double)l->cosine);
		if (l->type == ENGINE_LIGHT_DIRECTIONAL)
			l->power = mean_intensity(from) * GLM_PI * (double)r->radius * (double)r->radius;
		r->power += l->power;
		r->light_count++;
	}
	return r->lights;
}

bool file_rays_make(file_rays *r, const engine_scene *scene, bool sky)
{
	size_t triangles = 0;
	for (uint32_t o = 0; o < scene->object_count; o++)
		triangles += scene->objects[o].mesh.index_count - 2 * (size_t)scene->objects[o].mesh.face_count;
	*r = (file_rays){.sky = sky, .random = 2463534242u};
	r->triangles = malloc((triangles + 1) * sizeof *r->triangles);
	r->powers = malloc((triangles + 1) * sizeof *r->powers);
	if (!r->triangles || !r->powers)
		return false;
	for (uint32_t o = 0; o < scene->object_count; o++)
		add_object(r, scene, o);
	double sum = 0;
	for (uint32_t k = 0; k < r->count; k++)
		r->powers[k] = sum += (double)r->triangles[k].power;
	r->power = sum;
	if (r->count == 0)
		return true;
	find_sphere(r);
	if (!add_lights(r, scene))
		return false;
	r->rays = TESTS / r->count;
	r->rays = r->rays > MOST_RAYS ? MOST_RAYS : r->rays < LEAST_RAYS ? 0 : r->rays;
	return true;
}

void file_rays_free(file_rays *r)
{
	free(r->triangles);
	free(r->powers);
	free(r->lights);
	*r = (file_rays){0};
}

/* Möller and Trumbore 1997. */
static bool meets(const file_triangle *t, const float origin[3], const float direction[3], float *distance)
{
	vec3 p, q, s;
	glm_vec3_cross((float *)direction, (float *)t->edge[1], p);
	float determinant = glm_vec3_dot((float *)t->edge[0], p);
	if (determinant == 0)
		return false;
	glm_vec3_sub((float *)origin, (float *)t->corner, s);
	float u = glm_vec3_dot(s, p) / determinant;
	glm_vec3_cross(s, (float *)t->edge[0], q);
	float v = glm_vec3_dot((float *)direction, q) / determinant;
	*distance = glm_vec3_dot((float *)t->edge[1], q) / determinant;
	return u >= 0 && v >= 0 && u + v <= 1;
}

/* Within this share of the scene's radius two triangles lie in one place: about where they do for the library. */
static const float ONE_PLACE = 2e-6f;

/* Of two in one place that look apart, walls of two rooms, the one that looks at the ray is what it meets. */
static bool is_before(const file_hit *hit, const file_hit *other, float one_place)
{
	const float nearer = other->distance - hit->distance;
	return fabsf(nearer) <= one_place && hit->back != other->back ? other->back : nearer > 0;
}

file_hit file_rays_shoot(const file_rays *r, const float origin[3], const float direction[3], float least,
			 bool through_backs)
{
	file_hit hit = {UINT32_MAX, FLT_MAX, false};
	for (uint32_t k = 0; k < r->count; k++) {
		const file_triangle *t = &r->triangles[k];
		file_hit met = {k, 0, glm_vec3_dot((float *)t->normal, (float *)direction) > 0};
		if (through_backs && met.back && !t->double_sided)
			continue;
		if (meets(t, origin, direction, &met.distance) && met.distance > least &&
		    is_before(&met, &hit, ONE_PLACE * r->radius))
			hit = met;
	}
	return hit;
}

/* xorshift32 (Marsaglia 2003) */
float file_rays_random(file_rays *r)
{
	r->random ^= r->random << 13;
	r->random ^= r->random >> 17;
	r->random ^= r->random << 5;
	return (float)(r->random >> 8) / 16777216.0f;
}

void file_rays_scatter(file_rays *r, const float normal[3], float direction[3])
{
	vec3 axis = {0, 0, 0}, right, up;
	axis[fabsf(normal[0]) < 0.6f ? 0 : 1] = 1;
	glm_vec3_crossn(axis, (float *)normal, right);
	glm_vec3_cross((float *)normal, right, up);
	float distance = sqrtf(file_rays_random(r)), angle = 2 * GLM_PIf * file_rays_random(r);
	glm_vec3_scale((float *)normal, sqrtf(1 - distance * distance), direction);
	glm_vec3_muladds(right, distance * cosf(angle), direction);
	glm_vec3_muladds(up, distance * sinf(angle), direction);
}

/* Even within the cone about a unit axis. */
static void in_cone(file_rays *r, const float axis[3], float cosine, float direction[3])
{
	vec3 away = {0, 0, 0}, right, up;
	away[fabsf(axis[0]) < 0.6f ? 0 : 1] = 1;
	glm_vec3_crossn(away, (float *)axis, right);
	glm_vec3_cross((float *)axis, right, up);
	const float along = 1 - (1 - cosine) * file_rays_random(r), angle = 2 * GLM_PIf * file_rays_random(r);
	const float aside = sqrtf(fmaxf(0, 1 - along * along));
	glm_vec3_scale((float *)axis, along, direction);
	glm_vec3_muladds(right, aside * cosf(angle), direction);
	glm_vec3_muladds(up, aside * sinf(angle), direction);
}

/* A sun's rays begin on a disc before the scene. */
static void from_sun(file_rays *r, const file_ray_light *l, float origin[3])
{
	vec3 away = {0, 0, 0}, right, up;
	away[fabsf(l->direction[0]) < 0.6f ? 0 : 1] = 1;
	glm_vec3_crossn(away, (float *)l->direction, right);
	glm_vec3_cross((float *)l->direction, right, up);
	const float distance = r->radius * sqrtf(file_rays_random(r)), angle = 2 * GLM_PIf * file_rays_random(r);
	glm_vec3_copy(r->middle, origin);
	glm_vec3_muladds((float *)l->direction, -1.5f * r->radius, origin);
	glm_vec3_muladds(right, distance * cosf(angle), origin);
	glm_vec3_muladds(up, distance * sinf(angle), origin);
}

/* `wanted`: of the sum of their powers. */
static void from_light(file_rays *r, double wanted, float origin[3], float direction[3])
{
	uint32_t k = 0;
	while (k + 1 < r->light_count && wanted >= r->lights[k].power)
		wanted -= r->lights[k++].power;
	const file_ray_light *l = &r->lights[k];
	glm_vec3_copy((float *)l->place, origin);
	glm_vec3_copy((float *)l->direction, direction);
	if (l->type == ENGINE_LIGHT_DIRECTIONAL)
		from_sun(r, l, origin);
	else
		in_cone(r, l->direction, l->cosine, direction);
}

bool file_rays_from_lamp(file_rays *r, float origin[3], float direction[3])
{
	const double lamps = r->count > 0 ? r->powers[r->count - 1] : 0;
	double wanted = r->count > 0 ? r->power * (double)file_rays_random(r) : 0;
	if (r->light_count && wanted >= lamps && r->power > lamps) {
		from_light(r, wanted - lamps, origin, direction);
		return true;
	}
	uint32_t low = 0, high = r->count;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		if (r->powers[middle] <= wanted)
			low = middle + 1;
		else
			high = middle;
	}
	if (low >= r->count)
		return false;
	const file_triangle *t = &r->triangles[low];
	float u = file_rays_random(r), v = file_rays_random(r);
	vec3 normal;
	glm_vec3_copy((float *)t->normal, normal);
	if (t->double_sided && file_rays_random(r) < 0.5f)
		glm_vec3_negate(normal);
	glm_vec3_copy((float *)t->corner, origin);
	glm_vec3_muladds((float *)t->edge[0], u + v > 1 ? 1 - u : u, origin);
	glm_vec3_muladds((float *)t->edge[1], u + v > 1 ? 1 - v : v, origin);
	file_rays_scatter(r, normal, direction);
	return true;
}
