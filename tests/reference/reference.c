/* Path tracing as in Veach's thesis (1997, chapters 8 to 10), specialised to diffuse leaves.
 *
 * With cosine sampling, pdf_b = cos/pi, and emitter points picked by power, pdf_l = (pdf per area) r^2/cos', the
 * balance heuristic gives both strategies the same contribution to irradiance,
 *
 *     H += T E pdf_b / (pdf_b + pdf_l)  <=  T E,      T = product of rho along the path,
 *
 * so no sample is ever larger than the emitter's exitance, even in a corner next to it.
 *
 * The first vertex takes its seven numbers (point 2, direction 2, emitter 1, point on it 2) from a Sobol sequence with
 * an Owen scramble of its own for every leaf and half: stratified in all of them at once, unbiased, and the halves stay
 * independent. Later vertices use PCG32. Both are functions of (seed, leaf, half), so threads change nothing.
 */
#include "reference.h"

#include "embree.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SOBOL_DIMS 7
#define LEAVES_PER_GRAB 8
#define MAX_THREADS 64
static const float PI = 3.14159265358979f;

/* Roulette begins where the throughput is below this. Time times variance in a room with a bumpy ball, against a start
 * after 3 bounces: rho 0.3 31 : 35, 0.7 83 : 119, 0.95 581 : 1387; 0.05 and 0.2 are within 16 % of 0.1. */
static const float ROULETTE_BELOW = 0.1f;

typedef struct vec3 {
	float x, y, z;
} vec3;

static inline vec3 add(vec3 a, vec3 b)
{
	return (vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline vec3 sub(vec3 a, vec3 b)
{
	return (vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline vec3 mul(vec3 a, vec3 b)
{
	return (vec3){a.x * b.x, a.y * b.y, a.z * b.z};
}

static inline vec3 scale(vec3 a, float s)
{
	return (vec3){a.x * s, a.y * s, a.z * s};
}

static inline float dot(vec3 a, vec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline float max3(vec3 a)
{
	return fmaxf(a.x, fmaxf(a.y, a.z));
}

/* One cache line per triangle, one half per leaf.
 *
 *     |  v0  |  e1  |  e2  |  n  | leaf | light_pdf | half | free |  |  rho  | free | exitance | free |
 *     0      12     24     36    48     52          56     60     64 0       12     16         28     32
 */
typedef struct triangle {
	vec3 v0, e1, e2, n;
	uint32_t leaf;
	float light_pdf; /* per m2, of being picked as the emitter's point; 0 when dark */
	uint32_t half;   /* 0: a b c, 1: a c d */
	uint32_t unused;
} triangle;

typedef struct leaf {
	vec3 rho;
	float unused0;
	vec3 exitance;
	float unused1;
} leaf;

_Static_assert(sizeof(triangle) == 64, "one cache line per triangle");
_Static_assert(sizeof(leaf) == 32, "two leaves per cache line");

/* Everything the workers share; read-only but for next_leaf. */
typedef struct tracer {
	const reference_options *options;
	RTCDevice device;
	RTCScene scene;
	triangle *triangles;
	leaf *leaves;
	uint32_t *first_triangle; /* leaf_count + 1: leaf i has triangles [first[i], first[i+1]), none to two */
	float *first_share;       /* leaf_count: area share of the leaf's first triangle */
	uint32_t triangle_count, leaf_count;
	float offset;
	vec3 sky;
	uint32_t *light_triangles; /* light_count triangle numbers */
	uint32_t *light_ends;      /* light_count: top of each one's slice of the 32-bit line, inclusive */
	uint32_t *light_guide;     /* light_count: first light that reaches bucket k (Chen and Asau's cut points) */
	uint32_t light_count;
	uint32_t sobol[SOBOL_DIMS][32];
	reference_result *out;
	atomic_uint next_leaf;
	atomic_ullong segments;
} tracer;

/* ---- random numbers ---- */

typedef struct rng {
	uint64_t state, stream;
} rng;

/* splitmix64's finaliser */
static uint64_t mix64(uint64_t x)
{
	x += 0x9e3779b97f4a7c15u;
	x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
	x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
	return x ^ (x >> 31);
}

/* PCG32 (O'Neill 2014), XSH-RR */
static inline uint32_t rng_next(rng *r)
{
	uint64_t old = r->state;
	r->state = old * 6364136223846793005u + r->stream;
	uint32_t x = (uint32_t)(((old >> 18) ^ old) >> 27);
	uint32_t rot = (uint32_t)(old >> 59);
	return (x >> rot) | (x << ((32 - rot) & 31));
}

/* The middle of one of 2^23 cells: exact in a float, and never 0 or 1. */
static inline float unit_float(uint32_t x)
{
	return ((float)(x >> 9) + 0.5f) * 0x1p-23f;
}

static inline uint32_t reverse_bits(uint32_t x)
{
	x = __builtin_bswap32(x);
	x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
	x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
	return ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
}

/* Nested uniform (Owen) scramble of a bit-reversed number: Laine and Karras 2011, constants of Vegdahl 2021. */
static inline uint32_t owen_scramble(uint32_t reversed, uint32_t seed)
{
	uint32_t x = reversed;
	x ^= x * 0x3d20adeau;
	x += seed;
	x *= (seed >> 16) | 1;
	x ^= x * 0x05526c56u;
	x ^= x * 0x53a22864u;
	return reverse_bits(x);
}

/* Direction numbers of Joe and Kuo 2008 (new-joe-kuo-6), kept bit-reversed because the scramble wants them so. */
static void sobol_init(uint32_t directions[SOBOL_DIMS][32])
{
	static const struct {
		uint32_t degree, poly, m[4];
	} joe_kuo[SOBOL_DIMS] = {{0, 0, {0}},       {1, 0, {1}},          {2, 1, {1, 3}},       {3, 1, {1, 3, 1}},
				 {3, 2, {1, 1, 1}}, {4, 1, {1, 1, 3, 3}}, {4, 4, {1, 3, 5, 13}}};
	for (uint32_t d = 0; d < SOBOL_DIMS; d++) {
		uint32_t s = joe_kuo[d].degree, v[32];
		for (uint32_t k = 0; k < 32; k++) {
			if (s == 0) {
				v[k] = 1u << (31 - k);
			} else if (k < s) {
				v[k] = joe_kuo[d].m[k] << (31 - k);
			} else {
				v[k] = v[k - s] ^ (v[k - s] >> s);
				for (uint32_t j = 1; j < s; j++)
					v[k] ^= ((joe_kuo[d].poly >> (s - 1 - j)) & 1) * v[k - j];
			}
		}
		for (uint32_t k = 0; k < 32; k++)
			directions[d][k] = reverse_bits(v[k]);
	}
}

/* ---- geometry ---- */

static vec3 cross(vec3 a, vec3 b)
{
	return (vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* The corner's difference in double: exact for floats of like size, so areas of tiny leaves far out are right. */
static void triangle_cross(const float *a, const float *b, const float *c, double n[3])
{
	double u[3], v[3];
	for (int k = 0; k < 3; k++) {
		u[k] = (double)b[k] - a[k];
		v[k] = (double)c[k] - a[k];
	}
	n[0] = u[1] * v[2] - u[2] * v[1];
	n[1] = u[2] * v[0] - u[0] * v[2];
	n[2] = u[0] * v[1] - u[1] * v[0];
}

static double triangle_area(const float *a, const float *b, const float *c)
{
	double n[3];
	triangle_cross(a, b, c, n);
	return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

void reference_leaf_areas(const reference_scene *scene, double *areas)
{
	for (uint32_t i = 0; i < scene->leaf_count; i++) {
		const float *p = scene->corners + 12 * (size_t)i;
		areas[i] = triangle_area(p, p + 3, p + 6) + triangle_area(p, p + 6, p + 9);
	}
}

/* Bounds: the box's middle, and its largest half side. */
static float scene_extent(const reference_scene *scene, double centre[3])
{
	double extent = 0;
	for (int k = 0; k < 3; k++) {
		double lo = INFINITY, hi = -INFINITY;
		for (size_t i = 0; i < 4 * (size_t)scene->leaf_count; i++) {
			lo = fmin(lo, scene->corners[3 * i + k]);
			hi = fmax(hi, scene->corners[3 * i + k]);
		}
		centre[k] = 0.5 * (lo + hi);
		extent = fmax(extent, 0.5 * (hi - lo));
	}
	return (float)extent;
}

/* 2^-18 is 64 float steps at the far end of the (centred) scene: above the rounding of a point on a slanted triangle
 * and of the intersection, which is a few steps, and 20 micrometres in a room of 10 m. */
float reference_ray_offset(const reference_scene *scene)
{
	double centre[3];
	return 0x1p-18f * scene_extent(scene, centre);
}

/* Tangent frame of a unit normal without a branch at the poles (Duff et al. 2017). */
static inline void tangents(vec3 n, vec3 *s, vec3 *t)
{
	float sign = copysignf(1.0f, n.z);
	float a = -1.0f / (sign + n.z);
	float b = n.x * n.y * a;
	*s = (vec3){1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
	*t = (vec3){b, sign + n.y * n.y * a, -n.y};
}

/* Cosine-weighted direction about n, and its cosine (> 0: v < 1). */
static inline vec3 cosine_direction(vec3 n, float u, float v, float *cosine)
{
	vec3 s, t;
	tangents(n, &s, &t);
	float radius = sqrtf(v), phi = 2.0f * PI * u;
	*cosine = sqrtf(1.0f - v);
	vec3 d = scale(n, *cosine);
	d = add(d, scale(s, radius * cosf(phi)));
	return add(d, scale(t, radius * sinf(phi)));
}

static inline vec3 triangle_point(const triangle *tri, float u, float v)
{
	float root = sqrtf(u);
	return add(tri->v0, add(scale(tri->e1, root * (1.0f - v)), scale(tri->e2, root * v)));
}

/* ---- rays ---- */

static inline struct RTCRay make_ray(vec3 origin, vec3 direction, float near, float far)
{
	struct RTCRay ray = {0};
	ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
	ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
	ray.tnear = near;
	ray.tfar = far;
	ray.mask = 0xffffffffu;
	return ray;
}

static void keep_front_hits(const struct RTCFilterFunctionNArguments *args)
{
	const triangle *triangles = (const triangle *)args->geometryUserPtr;
	const struct RTCRay *ray = (const struct RTCRay *)args->ray;
	const struct RTCHit *hit = (const struct RTCHit *)args->hit;
	vec3 n = triangles[hit->primID].n;
	if (n.x * ray->dir_x + n.y * ray->dir_y + n.z * ray->dir_z >= 0.0f)
		args->valid[0] = 0;
}

/* A back was hit. Where a sheet has two leaves in the same place, back to back, either can be reported: look for a
 * front within the ray offset of that surface. */
static bool front_of_sheet(const tracer *t, struct RTCRayHit *rh, vec3 origin, vec3 direction)
{
	float cosine = fmaxf(dot(t->triangles[rh->hit.primID].n, direction), 1e-3f);
	float window = t->offset / cosine, distance = rh->ray.tfar;
	float near = fmaxf(distance - window, 0.0f), far = distance + window;
	struct RTCRayHit again = {.ray = make_ray(origin, direction, near, far)};
	again.hit.geomID = RTC_INVALID_GEOMETRY_ID;
	embree_closest(t->scene, &again, keep_front_hits);
	if (again.hit.geomID == RTC_INVALID_GEOMETRY_ID)
		return false;
	*rh = again;
	return true;
}

typedef struct vertex {
	const triangle *tri;
	vec3 origin; /* the point, lifted by the offset along tri->n */
} vertex;

enum hit_kind { HIT_NONE, HIT_FRONT, HIT_BACK };

/* Closest leaf; *next and *distance are set for HIT_FRONT only. */
static inline enum hit_kind closest_hit(const tracer *t, vec3 origin, vec3 direction, vertex *next, float *distance)
{
	struct RTCRayHit rh = {.ray = make_ray(origin, direction, 0.0f, INFINITY)};
	rh.hit.geomID = RTC_INVALID_GEOMETRY_ID;
	embree_closest(t->scene, &rh, NULL);
	if (rh.hit.geomID == RTC_INVALID_GEOMETRY_ID)
		return HIT_NONE;
	if (dot(t->triangles[rh.hit.primID].n, direction) >= 0.0f && !front_of_sheet(t, &rh, origin, direction))
		return HIT_BACK;
	const triangle *tri = &t->triangles[rh.hit.primID];
	vec3 p = add(tri->v0, add(scale(tri->e1, rh.hit.u), scale(tri->e2, rh.hit.v)));
	next->tri = tri;
	next->origin = add(p, scale(tri->n, t->offset));
	*distance = rh.ray.tfar;
	return HIT_FRONT;
}

static inline bool segment_free(const tracer *t, vec3 from, vec3 to)
{
	struct RTCRay ray = make_ray(from, sub(to, from), 0.0f, 1.0f);
	return !embree_occluded(t->scene, &ray);
}

/* ---- paths ---- */

static inline const triangle *pick_light(const tracer *t, uint32_t u)
{
	uint32_t k = t->light_guide[((uint64_t)u * t->light_count) >> 32];
	while (u > t->light_ends[k])
		k++;
	return &t->triangles[t->light_triangles[k]];
}

/* Irradiance at v from one emitter point, MIS-weighted. The pdfs are seen from the lifted origin to the unlifted point,
 * as those of a ray that hits the emitter are: the two weights add up to 1 right into the corners. */
static inline vec3 sample_light(const tracer *t, const vertex *v, const uint32_t u[3])
{
	const vec3 none = {0, 0, 0};
	const triangle *light = pick_light(t, u[0]);
	vec3 q = triangle_point(light, unit_float(u[1]), unit_float(u[2]));
	vec3 d = sub(q, v->origin);
	float d2 = dot(d, d), r = sqrtf(d2);
	float cos_here = dot(v->tri->n, d), cos_light = -dot(light->n, d);
	if (!(cos_here > 0.0f && cos_light > 0.0f))
		return none;
	float pdf_b = cos_here / (r * PI), pdf_l = light->light_pdf * d2 * r / cos_light;
	if (!segment_free(t, v->origin, add(q, scale(light->n, t->offset))))
		return none;
	return scale(t->leaves[light->leaf].exitance, pdf_b / (pdf_b + pdf_l));
}

/* Survival keeps the largest channel of the throughput where it was, so a path neither grows nor fades from then on. */
static inline bool roulette(rng *r, vec3 *throughput, float before)
{
	float q = max3(*throughput) / before;
	if (unit_float(rng_next(r)) >= q)
		return false;
	*throughput = scale(*throughput, 1.0f / q);
	return true;
}

/* u: the first vertex's direction (2) and emitter sample (3); later vertices draw from r. */
static uint32_t trace_path(const tracer *t, vertex v, const uint32_t first[5], rng *r, vec3 *total, vec3 *direct)
{
	uint32_t u[5], segments = 0, limit = t->options->max_bounces;
	vec3 throughput = {1, 1, 1};
	memcpy(u, first, sizeof u);
	*total = *direct = (vec3){0, 0, 0};
	for (uint32_t bounce = 0;; bounce++) {
		vec3 found = {0, 0, 0};
		if (t->light_count > 0)
			found = sample_light(t, &v, u + 2);
		float cosine, distance;
		vec3 d = cosine_direction(v.tri->n, unit_float(u[0]), unit_float(u[1]), &cosine);
		vertex next = {0};
		enum hit_kind kind = closest_hit(t, v.origin, d, &next, &distance);
		segments++;
		if (kind == HIT_NONE) {
			found = add(found, t->sky);
		} else if (kind == HIT_FRONT && next.tri->light_pdf > 0.0f) {
			float pdf_b = cosine / PI;
			float pdf_l = next.tri->light_pdf * distance * distance / -dot(next.tri->n, d);
			found = add(found, scale(t->leaves[next.tri->leaf].exitance, pdf_b / (pdf_b + pdf_l)));
		}
		*total = add(*total, mul(throughput, found));
		if (bounce == 0)
			*direct = found;
		if (kind != HIT_FRONT || (limit > 0 && bounce >= limit))
			break;
		float before = max3(throughput);
		throughput = mul(throughput, t->leaves[next.tri->leaf].rho);
		float after = max3(throughput);
		if (!(after > 0.0f) || (after < ROULETTE_BELOW && !roulette(r, &throughput, before)))
			break;
		for (int k = 0; k < 5; k++)
			u[k] = rng_next(r);
		v = next;
	}
	return segments;
}

static vertex start_vertex(const tracer *t, uint32_t i, float u, float v)
{
	uint32_t number = t->first_triangle[i];
	float share = t->first_share[i];
	if (u < share) {
		u = u / share;
	} else {
		number++;
		u = (u - share) / (1.0f - share);
	}
	const triangle *tri = &t->triangles[number];
	return (vertex){tri, add(triangle_point(tri, fminf(u, 1.0f), v), scale(tri->n, t->offset))};
}

static uint64_t trace_half(const tracer *t, uint32_t i, uint32_t half)
{
	uint64_t segments = 0, key = mix64(mix64(t->options->seed) ^ (2 * (uint64_t)i + half));
	rng r = {mix64(key ^ 1), mix64(key ^ 2) | 1};
	uint32_t seeds[SOBOL_DIMS], x[SOBOL_DIMS] = {0}, u[SOBOL_DIMS];
	double sum[3] = {0}, direct_sum[3] = {0};
	for (int d = 0; d < SOBOL_DIMS; d++)
		seeds[d] = (uint32_t)mix64(key + 16 + (uint64_t)d);
	uint32_t count = t->out->paths_per_half;
	for (uint32_t p = 0; p < count; p++) {
		for (int d = 0; d < SOBOL_DIMS; d++)
			u[d] = owen_scramble(x[d], seeds[d]);
		vec3 total, direct;
		vertex v = start_vertex(t, i, unit_float(u[0]), unit_float(u[1]));
		segments += trace_path(t, v, u + 2, &r, &total, &direct);
		sum[0] += total.x, sum[1] += total.y, sum[2] += total.z;
		direct_sum[0] += direct.x, direct_sum[1] += direct.y, direct_sum[2] += direct.z;
		int bit = __builtin_ctz(p + 1); /* Gray code order: one direction number per step */
		for (int d = 0; d < SOBOL_DIMS; d++)
			x[d] ^= t->sobol[d][bit];
	}
	for (int k = 0; k < 3; k++) {
		t->out->irradiance[half][3 * (size_t)i + k] = sum[k] / count;
		t->out->direct[half][3 * (size_t)i + k] = direct_sum[k] / count;
	}
	return segments;
}

static void *worker(void *argument)
{
	tracer *t = argument;
	uint64_t segments = 0;
	for (;;) {
		uint32_t begin = atomic_fetch_add(&t->next_leaf, LEAVES_PER_GRAB);
		if (begin >= t->leaf_count)
			break;
		for (uint32_t i = begin; i < begin + LEAVES_PER_GRAB && i < t->leaf_count; i++) {
			if (t->first_triangle[i] == t->first_triangle[i + 1])
				continue;
			segments += trace_half(t, i, 0);
			segments += trace_half(t, i, 1);
		}
	}
	atomic_fetch_add(&t->segments, segments);
	return NULL;
}

/* ---- set-up ---- */

static bool in_range(const float *values, size_t count, float lo, float below)
{
	for (size_t i = 0; i < count; i++)
		if (!(values[i] >= lo && values[i] < below))
			return false;
	return true;
}

static bool scene_valid(const reference_scene *s, const reference_options *o)
{
	size_t n = s->leaf_count;
	/* 2^30: two triangles per leaf and the grabbing counter stay below 2^32 */
	return n > 0 && n < (1u << 30) && o->paths_per_leaf > 0 && o->paths_per_leaf < UINT32_MAX &&
	       in_range(s->corners, 12 * n, -1e18f, 1e18f) && in_range(s->rho, 3 * n, 0, 1) &&
	       in_range(s->exitance, 3 * n, 0, 1e30f) && in_range(s->sky_exitance, 3, 0, 1e30f);
}

/* Tracing happens about the scene's middle, where floats are finest. */
static vec3 centred(const float *p, const double centre[3])
{
	return (vec3){(float)(p[0] - centre[0]), (float)(p[1] - centre[1]), (float)(p[2] - centre[2])};
}

/* A triangle too thin to have a direction has no area worth a sample either. */
static bool triangle_init(triangle *tri, const float *a, const float *b, const float *c, const double centre[3])
{
	double n[3];
	triangle_cross(a, b, c, n);
	double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	if (!(length > 1e-30))
		return false;
	memset(tri, 0, sizeof *tri);
	tri->v0 = centred(a, centre);
	tri->e1 = sub(centred(b, centre), tri->v0);
	tri->e2 = sub(centred(c, centre), tri->v0);
	vec3 rounded = cross(tri->e1, tri->e2); /* Embree's orientation is that of the rounded corners */
	tri->n = (vec3){(float)(n[0] / length), (float)(n[1] / length), (float)(n[2] / length)};
	return dot(rounded, tri->n) > 0.0f;
}

static bool build_triangles(tracer *t, const reference_scene *s)
{
	double centre[3];
	t->offset = 0x1p-18f * scene_extent(s, centre);
	t->leaf_count = s->leaf_count;
	t->triangles = aligned_alloc(64, 2 * sizeof *t->triangles * (size_t)s->leaf_count);
	t->leaves = calloc(s->leaf_count, sizeof *t->leaves);
	t->first_triangle = calloc((size_t)s->leaf_count + 1, sizeof *t->first_triangle);
	t->first_share = calloc(s->leaf_count, sizeof *t->first_share);
	if (!t->triangles || !t->leaves || !t->first_triangle || !t->first_share)
		return false;
	for (uint32_t i = 0; i < s->leaf_count; i++) {
		const float *p = s->corners + 12 * (size_t)i;
		const float *rho = s->rho + 3 * (size_t)i, *e = s->exitance + 3 * (size_t)i;
		t->leaves[i] = (leaf){{rho[0], rho[1], rho[2]}, 0, {e[0], e[1], e[2]}, 0};
		uint32_t before = t->triangle_count;
		for (int half = 0; half < 2; half++) {
			triangle *tri = &t->triangles[t->triangle_count];
			if (!triangle_init(tri, p, p + 3 + 3 * half, p + 6 + 3 * half, centre))
				continue;
			tri->leaf = i;
			tri->half = (uint32_t)half;
			t->triangle_count++;
		}
		double first = triangle_area(p, p + 3, p + 6), second = triangle_area(p, p + 6, p + 9);
		t->first_share[i] = t->triangle_count - before == 2 ? (float)(first / (first + second)) : 1.0f;
		t->first_triangle[i + 1] = t->triangle_count;
	}
	return true;
}

static double light_power(const tracer *t, const triangle *tri, double *luminance)
{
	vec3 e = t->leaves[tri->leaf].exitance, n = cross(tri->e1, tri->e2);
	*luminance = 0.2126 * e.x + 0.7152 * e.y + 0.0722 * e.z;
	return *luminance * 0.5 * sqrt((double)dot(n, n));
}

static void build_light_guide(tracer *t)
{
	uint32_t light = 0;
	for (uint32_t k = 0; k < t->light_count; k++) {
		/* the smallest u with floor(u * light_count / 2^32) == k */
		uint64_t smallest = (((uint64_t)k << 32) + t->light_count - 1) / t->light_count;
		while (smallest > t->light_ends[light])
			light++;
		t->light_guide[k] = light;
	}
}

static bool build_lights(tracer *t)
{
	double luminance, sum = 0, running = 0;
	t->light_triangles = malloc(sizeof(uint32_t) * ((size_t)t->triangle_count + 1));
	t->light_ends = malloc(sizeof(uint32_t) * ((size_t)t->triangle_count + 1));
	t->light_guide = malloc(sizeof(uint32_t) * ((size_t)t->triangle_count + 1));
	if (!t->light_triangles || !t->light_ends || !t->light_guide)
		return false;
	for (uint32_t i = 0; i < t->triangle_count; i++)
		sum += light_power(t, &t->triangles[i], &luminance);
	for (uint32_t i = 0; i < t->triangle_count; i++) {
		double power = light_power(t, &t->triangles[i], &luminance);
		if (!(power > 0))
			continue;
		running += power;
		t->triangles[i].light_pdf = (float)(luminance / sum);
		t->light_triangles[t->light_count] = i;
		t->light_ends[t->light_count++] = (uint32_t)fmin(running / sum * 0x1p32, UINT32_MAX);
	}
	if (t->light_count > 0) {
		t->light_ends[t->light_count - 1] = UINT32_MAX;
		build_light_guide(t);
	}
	return true;
}

static void report_embree_error(void *user, enum RTCError code, const char *text)
{
	(void)user;
	fprintf(stderr, "reference: Embree error %d: %s\n", (int)code, text);
}

/* All four corners of every leaf, as they were given but for the centring: leaves that share an edge share it to the
 * bit, which Embree needs to be watertight there. */
static void fill_corners(const reference_scene *s, vec3 *points)
{
	double centre[3];
	scene_extent(s, centre);
	for (size_t i = 0; i < 4 * (size_t)s->leaf_count; i++)
		points[i] = centred(s->corners + 3 * i, centre);
}

static RTCGeometry build_geometry(const tracer *t, const reference_scene *s)
{
	RTCGeometry geometry = rtcNewGeometry(t->device, RTC_GEOMETRY_TYPE_TRIANGLE);
	size_t count = t->triangle_count, corners = 4 * (size_t)s->leaf_count;
	vec3 *points = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, corners);
	uint32_t *indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, count);
	if (!points || !indices) {
		rtcReleaseGeometry(geometry);
		return NULL;
	}
	fill_corners(s, points);
	for (size_t i = 0; i < count; i++) {
		uint32_t first = 4 * t->triangles[i].leaf;
		indices[3 * i] = first;
		indices[3 * i + 1] = first + 1 + t->triangles[i].half;
		indices[3 * i + 2] = first + 2 + t->triangles[i].half;
	}
	rtcSetGeometryUserData(geometry, t->triangles); /* keep_front_hits' */
	rtcCommitGeometry(geometry);
	return geometry;
}

static bool build_embree(tracer *t, const reference_scene *s)
{
	t->device = rtcNewDevice(NULL);
	if (!t->device)
		return false;
	rtcSetDeviceErrorFunction(t->device, report_embree_error, NULL);
	t->scene = rtcNewScene(t->device);
	/* robust: watertight along shared edges; the filter is front_of_sheet's */
	rtcSetSceneFlags(t->scene, RTC_SCENE_FLAG_ROBUST | EMBREE_RAY_FILTERS);
	rtcSetSceneBuildQuality(t->scene, RTC_BUILD_QUALITY_HIGH);
	if (t->triangle_count > 0) {
		RTCGeometry geometry = build_geometry(t, s);
		if (!geometry)
			return false;
		rtcAttachGeometry(t->scene, geometry);
		rtcReleaseGeometry(geometry);
	}
	rtcCommitScene(t->scene);
	return rtcGetDeviceError(t->device) == RTC_ERROR_NONE;
}

static bool result_init(reference_result *out, uint32_t leaf_count, uint32_t paths)
{
	out->leaf_count = leaf_count;
	out->paths_per_half = paths / 2 + paths % 2;
	for (int half = 0; half < 2; half++) {
		out->irradiance[half] = calloc(3 * (size_t)leaf_count, sizeof(double));
		out->direct[half] = calloc(3 * (size_t)leaf_count, sizeof(double));
		if (!out->irradiance[half] || !out->direct[half])
			return false;
	}
	return true;
}

void reference_result_free(reference_result *result)
{
	for (int half = 0; half < 2; half++) {
		free(result->irradiance[half]);
		free(result->direct[half]);
	}
	memset(result, 0, sizeof *result);
}

static uint32_t choose_thread_count(uint32_t wanted)
{
	long online = sysconf(_SC_NPROCESSORS_ONLN);
	uint32_t count = wanted > 0 ? wanted : online > 0 ? (uint32_t)online : 1;
	return count < MAX_THREADS ? count : MAX_THREADS;
}

/* The calling thread works too, so that a thread that cannot be started only costs time. */
static void run_workers(tracer *t)
{
	pthread_t threads[MAX_THREADS];
	uint32_t started = 0, wanted = choose_thread_count(t->options->thread_count) - 1;
	while (started < wanted && pthread_create(&threads[started], NULL, worker, t) == 0)
		started++;
	worker(t);
	for (uint32_t i = 0; i < started; i++)
		pthread_join(threads[i], NULL);
}

static void tracer_free(tracer *t)
{
	if (t->scene)
		rtcReleaseScene(t->scene);
	if (t->device)
		rtcReleaseDevice(t->device);
	free(t->triangles);
	free(t->leaves);
	free(t->first_triangle);
	free(t->first_share);
	free(t->light_triangles);
	free(t->light_ends);
	free(t->light_guide);
}

bool reference_trace_with(const reference_scene *scene, const reference_options *options, reference_result *out)
{
	memset(out, 0, sizeof *out);
	if (!scene_valid(scene, options))
		return false;
	tracer t = {.options = options, .out = out};
	t.sky = (vec3){scene->sky_exitance[0], scene->sky_exitance[1], scene->sky_exitance[2]};
	sobol_init(t.sobol);
	bool ok = result_init(out, scene->leaf_count, options->paths_per_leaf) && build_triangles(&t, scene) &&
		  build_lights(&t) && build_embree(&t, scene);
	if (ok) {
		atomic_store(&t.next_leaf, options->first_leaf);
		run_workers(&t);
		out->segments = atomic_load(&t.segments);
	} else {
		reference_result_free(out);
	}
	tracer_free(&t);
	return ok;
}

bool reference_trace(const reference_scene *scene, uint32_t paths_per_leaf, uint64_t seed, reference_result *out)
{
	const reference_options options = {.paths_per_leaf = paths_per_leaf, .seed = seed};
	return reference_trace_with(scene, &options, out);
}
