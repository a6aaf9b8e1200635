#include "caustic_splats.h"

#include "low_discrepancy.h"
#include "parallel.h"
#include "trace_smooth.h"

#include <math.h>
#include <stdlib.h>

enum { CHUNK = 4096, MOST_STEPS = 64 };

/* What a photon adds to a pixel. */
typedef struct splat {
	uint32_t pixel;
	vec3 radiance;
} splat;

/* A mirror or glass object and the sphere round it. */
typedef struct target {
	const trace_object *object;
	vec3 centre;
	float radius;
} target;

struct caustic_splats {
	const trace_scene *scene;
	const trace_embree *embree;
	const trace_lights *lights;
	const trace_camera *camera;
	uint32_t seed;
	target targets[TRACE_MOST_OBJECTS];
	uint32_t target_count;
	/* Of the pass being traced. */
	uint32_t first, photons;
	splat *splats;    /* CHUNK of each chunk, so that they are added in one order whatever the threads do */
	uint32_t *counts; /* of each chunk */
	uint32_t chunk_room;
};

static void find_sphere(target *t)
{
	vec3 lower = {INFINITY, INFINITY, INFINITY}, upper = {-INFINITY, -INFINITY, -INFINITY};
	for (int pass = 0; pass < 2; pass++)
		for (uint32_t k = 0; k < 3 * t->object->triangle_count; k++) {
			vec3 p;
			trace_object_corner(t->object, k / 3, (int)(k % 3), p);
			glm_vec3_minv(lower, p, lower);
			glm_vec3_maxv(upper, p, upper);
			if (pass)
				t->radius = fmaxf(t->radius, glm_vec3_distance(p, t->centre));
			else
				glm_vec3_center(lower, upper, t->centre);
		}
}

caustic_splats *caustic_splats_create(const trace_scene *scene, const trace_embree *embree, const trace_lights *lights,
				      const trace_camera *camera, uint32_t seed)
{
	caustic_splats *s = calloc(1, sizeof *s);
	if (!s)
		return NULL;
	*s = (caustic_splats){.scene = scene, .embree = embree, .lights = lights, .camera = camera, .seed = seed};
	caustic_splats_update(s);
	return s;
}

void caustic_splats_destroy(caustic_splats *splats)
{
	if (!splats)
		return;
	free(splats->splats);
	free(splats->counts);
	free(splats);
}

void caustic_splats_update(caustic_splats *s)
{
	s->target_count = 0;
	for (uint32_t k = 0; k < s->scene->object_count; k++)
		if (trace_object_is_smooth(&s->scene->objects[k])) {
			target *t = &s->targets[s->target_count++];
			*t = (target){.object = &s->scene->objects[k]};
			find_sphere(t);
		}
}

/* A photon on its way. */
typedef struct photon {
	uint32_t number, pairs, seed;
	vec3 origin, direction, flux;
} photon;

static void next_numbers(photon *p, float out[2])
{
	low_discrepancy_point(p->number, hash_pair(p->seed, p->pairs++), out);
}

/* A direction within the cone that holds the sphere, and the cone's solid angle; from within, any direction. */
static float aim(const target *t, const vec3 from, const float numbers[2], vec3 direction)
{
	vec3 axis, s, u;
	glm_vec3_sub((float *)t->centre, (float *)from, axis);
	const float square = glm_vec3_norm2(axis), sine2 = t->radius * t->radius / fmaxf(square, 1e-30f);
	const float least = sine2 < 1 ? sqrtf(1 - sine2) : -1;
	/* 1 - cos by the sine: where the sphere is small the difference would be rounding. */
	const float rest = least > 0 ? sine2 / (1 + least) : 1 - least;
	glm_vec3_normalize(axis);
	glm_vec3_ortho(axis, s);
	glm_vec3_normalize(s);
	glm_vec3_cross(axis, s, u);
	const float cosine = 1 - numbers[1] * rest, sine = sqrtf(fmaxf(1 - cosine * cosine, 0));
	glm_vec3_scale(axis, cosine, direction);
	glm_vec3_muladds(s, sine * cosf(2 * GLM_PIf * numbers[0]), direction);
	glm_vec3_muladds(u, sine * sinf(2 * GLM_PIf * numbers[0]), direction);
	return 2 * GLM_PIf * rest;
}

/* False where the lamp does not shine that way. */
static bool emit(const caustic_splats *s, const target *t, photon *p)
{
	float place[2], way[2];
	next_numbers(p, place);
	next_numbers(p, way);
	const trace_light_point l = trace_lights_draw(s->lights, place);
	glm_vec3_copy((float *)l.point, p->origin);
	glm_vec3_muladds((float *)l.light->normal, trace_embree_lift(s->embree), p->origin);
	const float solid_angle = aim(t, p->origin, way, p->direction);
	const float cosine = glm_vec3_dot(p->direction, (float *)l.light->normal);
	const float share = solid_angle * fmaxf(cosine, 0) / GLM_PIf * (float)s->target_count / (float)s->photons;
	glm_vec3_scale((float *)l.light->exitance, share / l.density, p->flux);
	return cosine > 0;
}

/* The pixel that shows where a photon ended. Shading by the smooth normal counts each way as it does for paths from the
 * eye (Veach, 1997, 5.3.2). */
static bool find_splat(const caustic_splats *s, const photon *p, const trace_hit *hit, splat *out)
{
	int x, y;
	vec3 from, to_eye;
	const float arrives = -glm_vec3_dot((float *)p->direction, (float *)hit->flat);
	const float shaded = -glm_vec3_dot((float *)p->direction, (float *)hit->normal);
	if (!hit->front || shaded <= 0 || !trace_camera_find(s->camera, hit->point, &x, &y))
		return false;
	trace_embree_leave(s->embree, hit, p->direction, from);
	glm_vec3_sub((float *)s->camera->eye, from, to_eye);
	const float square = glm_vec3_norm2(to_eye);
	const float leaves = glm_vec3_dot(to_eye, (float *)hit->flat) / sqrtf(square);
	if (leaves <= 0 || !trace_embree_is_free(s->embree, from, s->camera->eye))
		return false;
	const float axis = -glm_vec3_dot(to_eye, (float *)s->camera->forward) / sqrtf(square);
	/* The pixel's patch of the surface has the area square * solid angle / leaves. */
	const float solid_angle = trace_camera_pixel_area(s->camera) * axis * axis * axis;
	const float factor = shaded / arrives * leaves / (GLM_PIf * square * solid_angle);
	out->pixel = (uint32_t)(y * s->camera->width + x);
	for (int c = 0; c < 3; c++)
		out->radiance[c] = p->flux[c] * hit->object->rho[c] * factor;
	return true;
}

/* False where nothing is seen of it. What meets another object first is that one's. */
static bool trace_photon(const caustic_splats *s, uint32_t number, splat *out)
{
	const target *t = &s->targets[number % s->target_count];
	photon p = {.number = number / s->target_count,
		    .seed = hash_pair(s->seed ^ 0x5bd1e995u, number % s->target_count)};
	if (!emit(s, t, &p))
		return false;
	for (int k = 0; k < MOST_STEPS; k++) {
		const trace_hit hit = trace_embree_closest(s->embree, p.origin, p.direction);
		if (!hit.object || (k == 0 && hit.object != t->object))
			return false;
		if (!trace_object_is_smooth(hit.object))
			return find_splat(s, &p, &hit, out);
		float numbers[2];
		next_numbers(&p, numbers);
		if (!trace_smooth_go_on(&hit, trace_embree_lift(s->embree), numbers[0], p.origin, p.direction, p.flux))
			return false;
	}
	return false;
}

static void trace_chunk(void *user, uint32_t chunk)
{
	caustic_splats *s = user;
	const uint32_t first = chunk * CHUNK, left = s->photons - first;
	uint32_t count = 0;
	for (uint32_t k = 0; k < CHUNK && k < left; k++)
		count += trace_photon(s, s->first + first + k, &s->splats[first + count]);
	s->counts[chunk] = count;
}

static bool make_room(caustic_splats *s, uint32_t chunks)
{
	if (chunks <= s->chunk_room)
		return true;
	splat *splats = realloc(s->splats, sizeof *splats * CHUNK * chunks);
	s->splats = splats ? splats : s->splats;
	uint32_t *counts = realloc(s->counts, sizeof *counts * chunks);
	s->counts = counts ? counts : s->counts;
	if (!splats || !counts)
		return false;
	s->chunk_room = chunks;
	return true;
}

bool caustic_splats_add(caustic_splats *s, uint32_t pass, uint32_t photons, uint32_t threads, double *sums)
{
	photons -= photons % s->target_count; /* each target's share is the same */
	const uint32_t chunks = (photons + CHUNK - 1) / CHUNK;
	if (!make_room(s, chunks))
		return false;
	s->photons = photons;
	s->first = pass * photons;
	parallel_for(threads, chunks, trace_chunk, s);
	for (uint32_t chunk = 0; chunk < chunks; chunk++)
		for (uint32_t k = 0; k < s->counts[chunk]; k++) {
			const splat *one = &s->splats[(size_t)chunk * CHUNK + k];
			for (int c = 0; c < 3; c++)
				sums[3 * (size_t)one->pixel + (size_t)c] += (double)one->radiance[c];
		}
	return true;
}
