/* Forward light tracing (Arvo, "Backward ray tracing", 1986). Each step takes one way by chance, reflection or
 * refraction by Fresnel's share, so a photon stays one ray; colours are weights. */
#include "light_trace.h"

#include "embree.h"

#include <cglm/cglm.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST_THREADS = 64, CHUNKS = 64, MOST_STEPS = 256 };

/* A ray starts so far from the surface that it leaves, as a share of the scene's extent. */
static const float LIFT = 0x1p-18f;

typedef struct light_tracer {
	const light_scene *scene;
	RTCDevice device;
	RTCScene embree;
	double *power_up_to; /* triangle_count: sum of luminous power of the triangles up to and with this one */
	uint64_t photons, seed;
	float lift;
	light_result *chunks; /* CHUNKS, summed in their order, so that threads change nothing */
	atomic_uint next_chunk;
} light_tracer;

double light_fresnel(double cosine, double index)
{
	double sine2 = (1 - cosine * cosine) / (index * index);
	if (sine2 >= 1)
		return 1;
	double inside = sqrt(1 - sine2);
	double parallel = (index * cosine - inside) / (index * cosine + inside);
	double perpendicular = (cosine - index * inside) / (cosine + index * inside);
	return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

/* ---- numbers ---- */

static uint64_t mix64(uint64_t x)
{
	x += 0x9e3779b97f4a7c15u; /* splitmix64 */
	x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
	x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
	return x ^ (x >> 31);
}

/* In (0, 1). */
static double next_number(uint64_t *state)
{
	*state += 0x9e3779b97f4a7c15u;
	return ((double)(mix64(*state) >> 12) + 0.5) * 0x1p-52;
}

/* ---- geometry ---- */

static void corners_of(const light_scene *scene, uint32_t triangle, vec3 p[3])
{
	for (int k = 0; k < 3; k++)
		memcpy(p[k], scene->positions + 3 * (size_t)scene->corners[3 * (size_t)triangle + k], sizeof(vec3));
}

/* Not normalised: twice the area long. */
static void triangle_normal(const light_scene *scene, uint32_t triangle, vec3 n)
{
	vec3 p[3], u, v;
	corners_of(scene, triangle, p);
	glm_vec3_sub(p[1], p[0], u);
	glm_vec3_sub(p[2], p[0], v);
	glm_vec3_cross(u, v, n);
}

/* The normal of the smooth surface that the triangles stand for. */
static void smooth_normal(const light_scene *scene, uint32_t triangle, float u, float v, vec3 n)
{
	if (!scene->normals) {
		triangle_normal(scene, triangle, n);
		glm_vec3_normalize(n);
		return;
	}
	const float weights[3] = {1 - u - v, u, v};
	glm_vec3_zero(n);
	for (int k = 0; k < 3; k++) {
		vec3 corner;
		memcpy(corner, scene->normals + 3 * (size_t)scene->corners[3 * (size_t)triangle + k], sizeof(vec3));
		glm_vec3_muladds(corner, weights[k], n);
	}
	glm_vec3_normalize(n);
}

/* Cosine-weighted about n. */
static void emitted_direction(vec3 n, double u, double v, vec3 out)
{
	vec3 s, t;
	glm_vec3_ortho(n, s);
	glm_vec3_normalize(s);
	glm_vec3_cross(n, s, t);
	double radius = sqrt(v), phi = 2 * GLM_PI * u;
	glm_vec3_scale(n, (float)sqrt(1 - v), out);
	glm_vec3_muladds(s, (float)(radius * cos(phi)), out);
	glm_vec3_muladds(t, (float)(radius * sin(phi)), out);
}

/* ---- photons ---- */

static void add_flux(light_flux *sum, const double photon[3])
{
	for (int k = 0; k < 3; k++)
		sum->rgb[k] += photon[k];
}

static double luminous(const float rgb[3])
{
	return ((double)rgb[0] + rgb[1] + rgb[2]) / 3;
}

static uint32_t pick_emitter(const light_tracer *t, double u)
{
	uint32_t low = 0, high = t->scene->triangle_count - 1;
	double wanted = u * t->power_up_to[high];
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		if (wanted < t->power_up_to[middle])
			high = middle;
		else
			low = middle + 1;
	}
	return low;
}

typedef struct light_photon {
	vec3 origin, direction;
	double rgb[3];
} light_photon;

static void emit(const light_tracer *t, uint64_t *numbers, light_photon *out)
{
	uint32_t triangle = pick_emitter(t, next_number(numbers));
	const float *exitance = t->scene->surfaces[t->scene->surface_of[triangle]].exitance;
	double all = t->power_up_to[t->scene->triangle_count - 1] / (double)t->photons;
	for (int k = 0; k < 3; k++)
		out->rgb[k] = all * exitance[k] / luminous(exitance);
	vec3 p[3], n;
	corners_of(t->scene, triangle, p);
	triangle_normal(t->scene, triangle, n);
	glm_vec3_normalize(n);
	double root = sqrt(next_number(numbers)), v = next_number(numbers);
	glm_vec3_scale(p[0], (float)(1 - root), out->origin);
	glm_vec3_muladds(p[1], (float)(root * (1 - v)), out->origin);
	glm_vec3_muladds(p[2], (float)(root * v), out->origin);
	glm_vec3_muladds(n, t->lift, out->origin);
	double a = next_number(numbers), b = next_number(numbers);
	emitted_direction(n, a, b, out->direction);
}

static void scale_photon(light_photon *photon, const float tint[3], light_flux *absorbed)
{
	double lost[3];
	for (int k = 0; k < 3; k++) {
		lost[k] = photon->rgb[k] * (1 - (double)tint[k]);
		photon->rgb[k] -= lost[k];
	}
	add_flux(absorbed, lost);
}

/* n: unit, against the direction. */
static void reflect(vec3 direction, vec3 n)
{
	glm_vec3_muladds(n, -2 * glm_vec3_dot(direction, n), direction);
	glm_vec3_normalize(direction);
}

static void refract(vec3 direction, vec3 n, double index)
{
	double cosine = -glm_vec3_dot(direction, n);
	double inside = sqrt(fmax(1 - (1 - cosine * cosine) / (index * index), 0));
	glm_vec3_scale(direction, (float)(1 / index), direction);
	glm_vec3_muladds(n, (float)(cosine / index - inside), direction);
	glm_vec3_normalize(direction);
}

/* Takes the photon on from a mirror or glass. False where it ends there. */
static bool go_on(const light_tracer *t, const light_surface *surface, const struct RTCRayHit *hit, uint64_t *numbers,
		  light_photon *photon, light_flux *absorbed)
{
	vec3 flat, n;
	triangle_normal(t->scene, hit->hit.primID, flat);
	glm_vec3_normalize(flat);
	smooth_normal(t->scene, hit->hit.primID, hit->hit.u, hit->hit.v, n);
	bool front = glm_vec3_dot(flat, photon->direction)<0, glass = luminous(surface->transmittance)> 0;
	double index = front ? surface->index : 1 / surface->index;
	if (!front) {
		glm_vec3_negate(flat);
		glm_vec3_negate(n);
	}
	double cosine = -glm_vec3_dot(photon->direction, n);
	if ((!glass && !front) || cosine <= 0)
		return false;
	bool reflected = !glass || next_number(numbers) < light_fresnel(cosine, index);
	glm_vec3_muladds(photon->direction, hit->ray.tfar, photon->origin);
	if (reflected) {
		reflect(photon->direction, n);
		if (!glass)
			scale_photon(photon, surface->specular, absorbed);
	} else {
		refract(photon->direction, n, index);
		scale_photon(photon, surface->transmittance, absorbed);
	}
	glm_vec3_muladds(flat, reflected ? t->lift : -t->lift, photon->origin);
	/* A smooth normal may lead through triangles that it does not belong to. */
	return (glm_vec3_dot(photon->direction, flat) > 0) == reflected;
}

static void follow(const light_tracer *t, uint64_t *numbers, light_result *out)
{
	light_photon photon;
	emit(t, numbers, &photon);
	add_flux(&out->emitted, photon.rgb);
	for (int step = 0; step < MOST_STEPS; step++) {
		struct RTCRayHit hit = {.ray = {.org_x = photon.origin[0],
						.org_y = photon.origin[1],
						.org_z = photon.origin[2],
						.dir_x = photon.direction[0],
						.dir_y = photon.direction[1],
						.dir_z = photon.direction[2],
						.tfar = INFINITY,
						.mask = 0xffffffffu}};
		hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
		embree_closest(t->embree, &hit, NULL);
		if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
			add_flux(&out->escaped, photon.rgb);
			return;
		}
		uint32_t triangle = hit.hit.primID;
		const light_surface *surface = &t->scene->surfaces[t->scene->surface_of[triangle]];
		if (luminous(surface->specular) <= 0 && luminous(surface->transmittance) <= 0) {
			vec3 n;
			triangle_normal(t->scene, triangle, n);
			bool front = glm_vec3_dot(n, photon.direction) < 0;
			add_flux(!front      ? &out->absorbed
				 : step == 0 ? &out->direct[triangle]
					     : &out->specular[triangle],
				 photon.rgb);
			return;
		}
		if (!go_on(t, surface, &hit, numbers, &photon, &out->absorbed))
			break;
	}
	add_flux(&out->absorbed, photon.rgb);
}

static void *trace_chunks(void *user)
{
	light_tracer *t = user;
	for (;;) {
		uint32_t chunk = atomic_fetch_add(&t->next_chunk, 1);
		if (chunk >= CHUNKS)
			return NULL;
		uint64_t first = t->photons * chunk / CHUNKS, end = t->photons * (chunk + 1) / CHUNKS;
		for (uint64_t photon = first; photon < end; photon++) {
			uint64_t numbers = mix64(t->seed ^ mix64(photon));
			follow(t, &numbers, &t->chunks[chunk]);
		}
	}
}

/* ---- scene ---- */

static bool measure_power(light_tracer *t)
{
	double sum = 0;
	for (uint32_t k = 0; k < t->scene->triangle_count; k++) {
		vec3 n;
		triangle_normal(t->scene, k, n);
		sum += 0.5 * glm_vec3_norm(n) * luminous(t->scene->surfaces[t->scene->surface_of[k]].exitance);
		t->power_up_to[k] = sum;
	}
	return sum > 0;
}

static float extent_of(const light_scene *scene)
{
	float most = 0;
	for (size_t k = 0; k < 3 * (size_t)scene->vertex_count; k++)
		most = fmaxf(most, fabsf(scene->positions[k]));
	return most;
}

static bool build_embree(light_tracer *t)
{
	const light_scene *scene = t->scene;
	t->device = rtcNewDevice(NULL);
	t->embree = t->device ? rtcNewScene(t->device) : NULL;
	RTCGeometry geometry = t->embree ? rtcNewGeometry(t->device, RTC_GEOMETRY_TYPE_TRIANGLE) : NULL;
	if (!geometry)
		return false;
	float *positions = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
						   3 * sizeof(float), scene->vertex_count);
	uint32_t *corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
						    3 * sizeof(uint32_t), scene->triangle_count);
	if (positions && corners) {
		memcpy(positions, scene->positions, scene->vertex_count * 3 * sizeof(float));
		memcpy(corners, scene->corners, scene->triangle_count * 3 * sizeof(uint32_t));
		rtcCommitGeometry(geometry);
		rtcAttachGeometry(t->embree, geometry);
		rtcSetSceneFlags(t->embree, RTC_SCENE_FLAG_ROBUST);
		rtcCommitScene(t->embree);
	}
	rtcReleaseGeometry(geometry);
	return positions && corners && rtcGetDeviceError(t->device) == RTC_ERROR_NONE;
}

static bool allocate_result(uint32_t triangles, light_result *out)
{
	*out = (light_result){.direct = calloc(triangles, sizeof *out->direct),
			      .specular = calloc(triangles, sizeof *out->specular)};
	return out->direct && out->specular;
}

void light_result_free(light_result *result)
{
	free(result->direct);
	free(result->specular);
	*result = (light_result){0};
}

static void run_threads(light_tracer *t)
{
	pthread_t threads[MOST_THREADS];
	long processors = sysconf(_SC_NPROCESSORS_ONLN);
	int wanted = processors < 1 ? 1 : processors > MOST_THREADS ? MOST_THREADS : (int)processors, started = 0;
	while (started < wanted - 1 && pthread_create(&threads[started], NULL, trace_chunks, t) == 0)
		started++;
	trace_chunks(t);
	while (started > 0)
		pthread_join(threads[--started], NULL);
}

static void sum_chunks(const light_tracer *t, light_result *out)
{
	for (int c = 0; c < CHUNKS; c++) {
		const light_result *part = &t->chunks[c];
		for (uint32_t k = 0; k < t->scene->triangle_count; k++) {
			add_flux(&out->direct[k], part->direct[k].rgb);
			add_flux(&out->specular[k], part->specular[k].rgb);
		}
		add_flux(&out->emitted, part->emitted.rgb);
		add_flux(&out->escaped, part->escaped.rgb);
		add_flux(&out->absorbed, part->absorbed.rgb);
	}
}

static void free_tracer(light_tracer *t)
{
	for (int c = 0; t->chunks && c < CHUNKS; c++)
		light_result_free(&t->chunks[c]);
	free(t->chunks);
	free(t->power_up_to);
	if (t->embree)
		rtcReleaseScene(t->embree);
	if (t->device)
		rtcReleaseDevice(t->device);
}

bool light_trace(const light_scene *scene, uint64_t photons, uint64_t seed, light_result *out)
{
	light_tracer t = {.scene = scene, .photons = photons, .seed = seed, .lift = LIFT * extent_of(scene)};
	*out = (light_result){0};
	t.power_up_to = calloc(scene->triangle_count, sizeof *t.power_up_to);
	t.chunks = calloc(CHUNKS, sizeof *t.chunks);
	bool ok = scene->triangle_count > 0 && t.power_up_to && t.chunks && measure_power(&t) && build_embree(&t);
	for (int c = 0; ok && c < CHUNKS; c++)
		ok = allocate_result(scene->triangle_count, &t.chunks[c]);
	ok = ok && allocate_result(scene->triangle_count, out);
	if (ok) {
		run_threads(&t);
		sum_chunks(&t, out);
	} else {
		light_result_free(out);
	}
	free_tracer(&t);
	return ok;
}
