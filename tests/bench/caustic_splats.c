#include "caustic_splats.h"

#include "caustic_map.h"
#include "low_discrepancy.h"
#include "parallel.h"
#include "trace_smooth.h"

#include <math.h>
#include <stdlib.h>

enum { CHUNK = 4096, MOST_STEPS = 64, MOST_PHOTONS = 65536, UNSEEN = -1 };

/* Of the first pass, metres: as wide as the finest that is asked for. */
static const float FIRST_RADIUS = 0.05f;

/* Where a photon ended, and what it adds to the pixel that shows that place. */
typedef struct landing {
	caustic_photon photon;
	vec3 radiance;
	int32_t pixel; /* or UNSEEN */
} landing;

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
	uint32_t first, pass_photons;
	landing *landings; /* CHUNK of each chunk, so that they are added in one order whatever the threads do */
	uint32_t *counts;  /* of each chunk */
	uint32_t chunk_room;
	caustic_map map;
	caustic_photon *kept; /* MOST_PHOTONS, before they are sorted */
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
	s->kept = malloc(MOST_PHOTONS * sizeof *s->kept);
	if (!s->kept) {
		free(s);
		return NULL;
	}
	caustic_splats_update(s);
	return s;
}

void caustic_splats_destroy(caustic_splats *splats)
{
	if (!splats)
		return;
	caustic_map_free(&splats->map);
	free(splats->kept);
	free(splats->landings);
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
	const float share = solid_angle * fmaxf(cosine, 0) / GLM_PIf * (float)s->target_count / (float)s->pass_photons;
	glm_vec3_scale((float *)l.light->exitance, share / l.density, p->flux);
	return cosine > 0;
}

/* The pixel that shows where a photon ended. */
static void find_pixel(const caustic_splats *s, const photon *p, const trace_hit *hit, landing *out)
{
	int x, y;
	vec3 from, to_eye;
	out->pixel = UNSEEN;
	if (!trace_camera_find(s->camera, hit->point, &x, &y))
		return;
	trace_embree_leave(s->embree, hit, p->direction, from);
	glm_vec3_sub((float *)s->camera->eye, from, to_eye);
	const float square = glm_vec3_norm2(to_eye);
	const float leaves = glm_vec3_dot(to_eye, (float *)hit->flat) / sqrtf(square);
	if (leaves <= 0 || !trace_embree_is_free(s->embree, from, s->camera->eye))
		return;
	const float axis = -glm_vec3_dot(to_eye, (float *)s->camera->forward) / sqrtf(square);
	/* The pixel's patch of the surface has the area square * solid angle / leaves. */
	const float solid_angle = trace_camera_pixel_area(s->camera) * axis * axis * axis;
	out->pixel = y * s->camera->width + x;
	for (int c = 0; c < 3; c++)
		out->radiance[c] =
		    out->photon.flux[c] * hit->object->rho[c] * leaves / (GLM_PIf * square * solid_angle);
}

/* False at a back. Shading by the smooth normal counts each way as it does for paths from the eye (Veach, 1997,
 * 5.3.2). */
static bool land(const caustic_splats *s, const photon *p, const trace_hit *hit, landing *out)
{
	const float arrives = -glm_vec3_dot((float *)p->direction, (float *)hit->flat);
	const float shaded = -glm_vec3_dot((float *)p->direction, (float *)hit->normal);
	if (!hit->front || shaded <= 0 || arrives <= 0)
		return false;
	glm_vec3_copy((float *)hit->point, out->photon.point);
	glm_vec3_copy((float *)hit->flat, out->photon.normal);
	glm_vec3_scale((float *)p->flux, shaded / arrives, out->photon.flux);
	find_pixel(s, p, hit, out);
	return true;
}

/* False where it lands nowhere. What meets another object first is that one's. */
static bool trace_photon(const caustic_splats *s, uint32_t number, landing *out)
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
			return land(s, &p, &hit, out);
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
	const uint32_t first = chunk * CHUNK, left = s->pass_photons - first;
	uint32_t count = 0;
	for (uint32_t k = 0; k < CHUNK && k < left; k++)
		count += trace_photon(s, s->first + first + k, &s->landings[first + count]);
	s->counts[chunk] = count;
}

static bool make_room(caustic_splats *s, uint32_t chunks)
{
	if (chunks <= s->chunk_room)
		return true;
	landing *landings = realloc(s->landings, sizeof *landings * CHUNK * chunks);
	s->landings = landings ? landings : s->landings;
	uint32_t *counts = realloc(s->counts, sizeof *counts * chunks);
	s->counts = counts ? counts : s->counts;
	if (!landings || !counts)
		return false;
	s->chunk_room = chunks;
	return true;
}

static void add_splats(const caustic_splats *s, uint32_t chunk, double *sums)
{
	for (uint32_t k = 0; k < s->counts[chunk]; k++) {
		const landing *one = &s->landings[(size_t)chunk * CHUNK + k];
		for (int c = 0; c < 3 && one->pixel != UNSEEN; c++)
			sums[3 * (size_t)one->pixel + (size_t)c] += (double)one->radiance[c];
	}
}

/* Photons of the first chunks that fit; those stand for the others too. */
static bool build_map(caustic_splats *s, uint32_t pass, uint32_t chunks)
{
	uint32_t count = 0, traced = 0;
	for (uint32_t chunk = 0; chunk < chunks && count + s->counts[chunk] <= MOST_PHOTONS; chunk++) {
		for (uint32_t k = 0; k < s->counts[chunk]; k++)
			s->kept[count++] = s->landings[(size_t)chunk * CHUNK + k].photon;
		traced += s->pass_photons - traced < CHUNK ? s->pass_photons - traced : CHUNK;
	}
	for (uint32_t k = 0; k < count; k++)
		glm_vec3_scale(s->kept[k].flux, (float)s->pass_photons / (float)traced, s->kept[k].flux);
	/* So the radius goes where two thirds of a pass's photons stay within it. */
	return caustic_map_build(&s->map, s->kept, count, FIRST_RADIUS * powf((float)(pass + 1), -1 / 6.0f));
}

bool caustic_splats_add(caustic_splats *s, uint32_t pass, uint32_t photons, uint32_t threads, double *sums)
{
	photons -= photons % s->target_count; /* each target's share is the same */
	const uint32_t chunks = (photons + CHUNK - 1) / CHUNK;
	if (!make_room(s, chunks))
		return false;
	s->pass_photons = photons;
	s->first = pass * photons;
	parallel_for(threads, chunks, trace_chunk, s);
	for (uint32_t chunk = 0; chunk < chunks; chunk++)
		add_splats(s, chunk, sums);
	return build_map(s, pass, chunks);
}

void caustic_splats_irradiance(const caustic_splats *s, const vec3 point, const vec3 normal, vec3 out)
{
	caustic_map_irradiance(&s->map, point, normal, out);
}
