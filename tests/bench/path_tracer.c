#include "path_tracer.h"

#include "caustic_splats.h"
#include "low_discrepancy.h"
#include "parallel.h"
#include "trace_embree.h"
#include "trace_light.h"
#include "trace_smooth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	MOST_STEPS = 256,      /* of a path, mirrors and glass included */
	ROULETTE_BOUNCES = 3,  /* diffuse ones that all paths live to see */
	CAUSTIC_SHARE_BITS = 1 /* a photon for every so many pixels, as a power of two */
};

static const float LEAST_SURVIVAL = 0.05f;

struct path_tracer {
	path_tracer_def def;
	trace_embree *embree;
	trace_lights lights;
	caustic_splats *caustics; /* NULL: none are traced */
	double *sums;             /* 3 a pixel */
	uint32_t samples;         /* so far */
	uint32_t wanted;          /* being added */
};

typedef struct path {
	uint32_t seed, sample, pairs;
	vec3 origin, direction, weight;
	vec3 light;        /* found so far */
	float density;     /* of the direction from the last diffuse vertex, 1/sr */
	uint32_t bounces;  /* diffuse */
	bool smooth_since; /* since the last diffuse vertex, or the eye */
} path;

static void next_numbers(path *p, float out[2])
{
	low_discrepancy_point(p->sample, hash_pair(p->seed, p->pairs++), out);
}

static void add_light(const path_tracer *t, path *p, bool direct, const float exitance[3], float factor)
{
	if (t->def.light != GI_MODE_GLOBAL && direct != (t->def.light == GI_MODE_DIRECT))
		return;
	for (int c = 0; c < 3; c++)
		p->light[c] += p->weight[c] * exitance[c] * (factor / GLM_PIf);
}

/* Two ways to one path: the share of the first, by the power heuristic. */
static float share(float density, float other)
{
	return density * density / (density * density + other * other);
}

/* What a lamp that was met gives. */
static void add_emission(const path_tracer *t, path *p, const trace_hit *hit)
{
	const bool direct = p->bounces == 0 || (p->bounces == 1 && !p->smooth_since);
	float part = 1;
	if (p->bounces > 0 && p->smooth_since) {
		part = t->caustics ? 0 : 1;
	} else if (p->bounces > 0) {
		const float by_area = trace_lights_density(&t->lights, hit->object->exitance);
		const float cosine = -glm_vec3_dot(p->direction, (float *)hit->flat);
		part = share(p->density, by_area * hit->distance * hit->distance / cosine);
	}
	add_light(t, p, direct, hit->object->exitance, part);
}

/* What a drawn point of light gives. The weight already has the surface's reflectance. */
static void add_drawn_light(const path_tracer *t, path *p, const trace_hit *hit, const vec3 origin)
{
	float numbers[2];
	next_numbers(p, numbers);
	if (t->lights.count == 0)
		return;
	const trace_light_point l = trace_lights_draw(&t->lights, numbers);
	vec3 to;
	glm_vec3_sub((float *)l.point, (float *)origin, to);
	const float square = glm_vec3_norm2(to), distance = sqrtf(square);
	const float cosine = glm_vec3_dot(to, (float *)hit->normal) / distance;
	const float lamp_cosine = -glm_vec3_dot(to, (float *)l.light->normal) / distance;
	if (cosine <= 0 || lamp_cosine <= 0 || glm_vec3_dot(to, (float *)hit->flat) <= 0 ||
	    !trace_embree_is_free(t->embree, origin, l.point))
		return;
	const float density = l.density * square / lamp_cosine, onward = cosine / GLM_PIf;
	add_light(t, p, p->bounces == 0, l.light->exitance, share(density, onward) * onward / density);
}

/* What caustics give, but where the eye sees them straight. The weight already has the surface's reflectance. */
static void add_caustics(const path_tracer *t, path *p, const trace_hit *hit)
{
	if (!t->caustics || (p->bounces == 0 && !p->smooth_since))
		return;
	vec3 irradiance;
	caustic_splats_irradiance(t->caustics, hit->point, hit->flat, irradiance);
	add_light(t, p, false, irradiance, 1);
}

/* Ends by chance what carries little. */
static bool survives(path *p, float number)
{
	if (p->bounces < ROULETTE_BOUNCES)
		return true;
	const float chance = glm_clamp(glm_vec3_max(p->weight), LEAST_SURVIVAL, 1);
	glm_vec3_scale(p->weight, 1 / chance, p->weight);
	return number < chance;
}

static void cosine_direction(const vec3 n, const float numbers[2], vec3 out)
{
	/* A frame without branches (Duff et al., "Building an orthonormal basis, revisited", JCGT 6 (1), 2017). */
	const float sign = copysignf(1, n[2]), a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
	vec3 s = {1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]}, t = {b, sign + n[1] * n[1] * a, -n[1]};
	const float radius = sqrtf(numbers[1]), angle = 2 * GLM_PIf * numbers[0];
	glm_vec3_scale((float *)n, sqrtf(fmaxf(1 - numbers[1], 0)), out);
	glm_vec3_muladds(s, radius * cosf(angle), out);
	glm_vec3_muladds(t, radius * sinf(angle), out);
	glm_vec3_normalize(out);
}

/* False where the path ends. */
static bool bounce(const path_tracer *t, path *p, const trace_hit *hit)
{
	if (!hit->front)
		return false;
	glm_vec3_mul(p->weight, (float *)hit->object->rho, p->weight);
	trace_embree_leave(t->embree, hit, p->direction, p->origin);
	add_drawn_light(t, p, hit, p->origin);
	add_caustics(t, p, hit);
	float numbers[2], chance[2];
	next_numbers(p, numbers);
	next_numbers(p, chance);
	p->smooth_since = false;
	p->bounces++;
	if (t->def.light == GI_MODE_DIRECT && p->bounces > 1)
		return false;
	cosine_direction(hit->normal, numbers, p->direction);
	p->density = glm_vec3_dot(p->direction, (float *)hit->normal) / GLM_PIf;
	return glm_vec3_max(p->weight) > 0 && p->density > 0 && glm_vec3_dot(p->direction, (float *)hit->flat) > 0 &&
	       survives(p, chance[0]);
}

static bool step(const path_tracer *t, path *p)
{
	const trace_hit hit = trace_embree_closest(t->embree, p->origin, p->direction);
	if (!hit.object)
		return false;
	if (hit.front && trace_object_emits(hit.object))
		add_emission(t, p, &hit);
	if (!trace_object_is_smooth(hit.object))
		return bounce(t, p, &hit);
	float numbers[2];
	next_numbers(p, numbers);
	p->smooth_since = true;
	return trace_smooth_go_on(&hit, trace_embree_lift(t->embree), numbers[0], p->origin, p->direction, p->weight);
}

static void trace_path(const path_tracer *t, int x, int y, uint32_t sample, double sum[3])
{
	const uint32_t pixel = (uint32_t)(y * t->def.camera.width + x);
	path p = {.seed = hash_pair(t->def.seed, pixel), .sample = sample, .weight = {1, 1, 1}};
	float at[2];
	next_numbers(&p, at);
	if (!t->def.antialias)
		at[0] = at[1] = 0.5f;
	glm_vec3_copy((float *)t->def.camera.eye, p.origin);
	trace_camera_direction(&t->def.camera, (float)x + at[0], (float)y + at[1], p.direction);
	glm_vec3_normalize(p.direction);
	for (int k = 0; k < MOST_STEPS && step(t, &p); k++)
		;
	for (int c = 0; c < 3; c++)
		sum[c] += (double)p.light[c];
}

static void trace_row(void *user, uint32_t row)
{
	const path_tracer *t = user;
	for (int x = 0; x < t->def.camera.width; x++) {
		double *sum = t->sums + 3 * ((size_t)row * (size_t)t->def.camera.width + (size_t)x);
		for (uint32_t k = 0; k < t->wanted; k++)
			trace_path(t, x, (int)row, t->samples + k, sum);
	}
}

static bool has_smooth(const trace_scene *scene)
{
	for (uint32_t k = 0; k < scene->object_count; k++)
		if (trace_object_is_smooth(&scene->objects[k]))
			return true;
	return false;
}

path_tracer *path_tracer_create(const path_tracer_def *def)
{
	path_tracer *t = calloc(1, sizeof *t);
	if (!t)
		return NULL;
	t->def = *def;
	t->sums = calloc((size_t)def->camera.width * (size_t)def->camera.height, 3 * sizeof *t->sums);
	t->embree = trace_embree_create(def->scene);
	bool ok = t->sums && t->embree && trace_lights_find(def->scene, &t->lights);
	if (ok && !def->paths_alone && def->light != GI_MODE_DIRECT && t->lights.count && has_smooth(def->scene)) {
		t->caustics = caustic_splats_create(def->scene, t->embree, &t->lights, &t->def.camera, def->seed);
		ok = t->caustics != NULL;
	}
	if (ok)
		return t;
	path_tracer_destroy(t);
	return NULL;
}

void path_tracer_destroy(path_tracer *tracer)
{
	if (!tracer)
		return;
	caustic_splats_destroy(tracer->caustics);
	trace_lights_free(&tracer->lights);
	trace_embree_destroy(tracer->embree);
	free(tracer->sums);
	free(tracer);
}

void path_tracer_update(path_tracer *t)
{
	trace_embree_update(t->embree);
	if (t->caustics)
		caustic_splats_update(t->caustics);
	t->samples = 0;
	memset(t->sums, 0, 3 * sizeof *t->sums * (size_t)t->def.camera.width * (size_t)t->def.camera.height);
}

bool path_tracer_add(path_tracer *t, uint32_t samples)
{
	const uint32_t pixels = (uint32_t)(t->def.camera.width * t->def.camera.height);
	const uint32_t end = t->samples + samples;
	t->wanted = t->caustics ? 1 : samples; /* each with photons of its own */
	while (t->samples < end) {
		if (t->caustics &&
		    !caustic_splats_add(t->caustics, t->samples, pixels >> CAUSTIC_SHARE_BITS, t->def.threads, t->sums))
			return false;
		parallel_for(t->def.threads, (uint32_t)t->def.camera.height, trace_row, t);
		t->samples += t->wanted;
	}
	return true;
}

uint32_t path_tracer_samples(const path_tracer *tracer)
{
	return tracer->samples;
}

void path_tracer_picture(const path_tracer *tracer, linear_image *out)
{
	const size_t values = 3 * (size_t)out->width * (size_t)out->height;
	for (size_t k = 0; k < values; k++)
		out->rgb[k] = (float)(tracer->sums[k] / tracer->samples);
}
