/* Path tracing on the trees of the rows' rays (paths.comp): ground truth at any time, without a row. Compiled and
 * allocated by the first gi_trace_paths.
 *
 * Work is cut into dispatches of about equal length; a dispatch leaves one sum a thread, which is read back and added in
 * double. How the work is cut depends on the scene and the renderer alone, so the same seed gives the same bits.
 */
#include "context.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Vertices of paths a dispatch: under half a second on two cores, under a twentieth on a GPU of 2020. */
static const double VERTICES_SOFTWARE = 1 << 19, VERTICES_GPU = 1 << 23;

/* Paths a thread at most: long runs keep a vector's threads together, short ones fill a GPU. */
enum { RUN_SOFTWARE = 32, RUN_GPU = 8, MOST_THREADS = 1 << 20, MOST_PATHS = 1 << 24 };

/* As in paths.comp. */
static const double ROULETTE_BELOW = 0.1;

/* A ray starts this far above its surface, in parts of the scene's largest coordinate: 32 float steps there or more,
 * above the rounding of a point and of its turn between frames, and 20 micrometres in a room of 5 m. */
static const float LIFT = 0x1p-18f;

struct gi_paths {
	uint32_t program;
	gpu_buffer sobol, lights, sums;
};

/* What the shader is told of the scene. */
typedef struct path_scene {
	uint32_t light_count;
	float density;
	float sky_and_lift[4];
} path_scene;

/* One dispatch: `leaves` from `first_leaf`, `paths` of each from `first_path`, `run` a thread. */
typedef struct batch {
	uint32_t first_leaf, leaves, first_path, paths, run;
} batch;

gi_path_options gi_path_options_default(void)
{
	return (gi_path_options){.paths = 256, .seed = 1};
}

/* ---- numbers ---- */

static uint32_t reverse_bits(uint32_t x)
{
	uint32_t reversed = 0;
	for (int k = 0; k < 32; k++)
		reversed |= (x >> k & 1) << (31 - k);
	return reversed;
}

/* Direction numbers of Joe and Kuo, 2008 (new-joe-kuo-6), bits reversed as the Owen scramble wants them. */
static void sobol_directions(uint32_t out[GI_SOBOL_DIMENSIONS][32])
{
	static const struct {
		uint32_t degree, polynomial, m[4];
	} dimensions[GI_SOBOL_DIMENSIONS] = {{0, 0, {0}},       {1, 0, {1}},          {2, 1, {1, 3}},      {3, 1, {1, 3, 1}},
					     {3, 2, {1, 1, 1}}, {4, 1, {1, 1, 3, 3}}, {4, 4, {1, 3, 5, 13}}};
	for (uint32_t d = 0; d < GI_SOBOL_DIMENSIONS; d++) {
		const uint32_t degree = dimensions[d].degree;
		uint32_t v[32];
		for (uint32_t k = 0; k < 32; k++) {
			if (degree == 0 || k < degree) {
				v[k] = (degree ? dimensions[d].m[k] : 1) << (31 - k);
				continue;
			}
			v[k] = v[k - degree] ^ v[k - degree] >> degree;
			for (uint32_t j = 1; j < degree; j++)
				if (dimensions[d].polynomial >> (degree - 1 - j) & 1)
					v[k] ^= v[k - j];
		}
		for (uint32_t k = 0; k < 32; k++)
			out[d][k] = reverse_bits(v[k]);
	}
}

static gi_result make_paths(gi_context *gi)
{
	if (gi->paths)
		return GI_OK;
	gi_paths *p = gi->paths = calloc(1, sizeof *p);
	if (!p)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	uint32_t directions[GI_SOBOL_DIMENSIONS][32];
	sobol_directions(directions);
	gi_result result = gpu_programs_compute(&gi->gpu, &(gpu_program_file){"paths.comp", &p->program}, 1);
	if (!result)
		result = gpu_buffer_allocate(&gi->gpu, &p->sobol, sizeof directions, directions);
	if (result)
		paths_free(gi);
	return result;
}

void paths_free(gi_context *gi)
{
	gi_paths *p = gi->paths;
	if (!p)
		return;
	gpu_program_free(&p->program);
	gpu_buffer_free(&gi->gpu, &p->sobol);
	gpu_buffer_free(&gi->gpu, &p->lights);
	gpu_buffer_free(&gi->gpu, &p->sums);
	free(p);
	gi->paths = NULL;
}

/* ---- emitters ---- */

typedef struct lights {
	gi_uvec4 *triangles; /* 3 each, as the shader has them; the tops of their slices are set last */
	double *powers;
	uint32_t count;
	double power;
} lights;

static void to_world(const gi_object_data *o, const gi_vec4 *p, float out[3])
{
	const gi_vec4 rows[3] = {o->row0, o->row1, o->row2};
	for (int k = 0; k < 3; k++)
		out[k] = (float)((double)rows[k].x * p->x + (double)rows[k].y * p->y + (double)rows[k].z * p->z + rows[k].w);
}

static double triangle_area(const float a[3], const float b[3], const float c[3])
{
	return gi_quad_area(a, b, c, c);
}

static void add_light(lights *l, float corners[3][3], double luminance, uint32_t material)
{
	const double power = luminance * triangle_area(corners[0], corners[1], corners[2]);
	if (!(power > 0))
		return;
	gi_uvec4 *out = l->triangles + 3 * l->count;
	for (int k = 0; k < 3; k++)
		memcpy(&out[k], corners[k], sizeof corners[k]);
	out[1].w = material;
	l->powers[l->count++] = power;
	l->power += power;
}

static void add_object_lights(const gi_scene *s, const scene_object *o, lights *l)
{
	for (uint32_t k = 0; k < o->bvh.primitive_count; k++) {
		const gi_primitive *p = &o->bvh.primitives[k];
		uint32_t leaf; /* a primitive's leaves are of one material */
		memcpy(&leaf, &p->a.w, sizeof leaf);
		const gi_vec4 e = s->node_exitance[o->node_base + o->hierarchy.leaf_node[leaf]];
		const double luminance = 0.2126 * e.x + 0.7152 * e.y + 0.0722 * e.z;
		if (!(luminance > 0))
			continue;
		const gi_vec4 *const corners[2][3] = {{&p->a, &p->b, &p->c}, {&p->a, &p->c, &p->d}};
		for (int half = 0; half < 2; half++) {
			float world[3][3];
			for (int c = 0; c < 3; c++)
				to_world(&s->object_data[o->slot], corners[half][c], world[c]);
			add_light(l, world, luminance, o->material_base + o->hierarchy.leaf_material[leaf]);
		}
	}
}

static void set_slices(lights *l)
{
	double running = 0;
	for (uint32_t k = 0; k < l->count; k++) {
		running += l->powers[k];
		const double top = running / l->power * 0x1p32;
		l->triangles[3 * k].w = k + 1 < l->count && top < UINT32_MAX ? (uint32_t)top : UINT32_MAX;
	}
}

/* As the scene was at the last gi_update: that is what the GPU has of it. */
static bool find_lights(const gi_scene *s, lights *l)
{
	uint32_t most = 0;
	for (uint32_t slot = 0; slot < s->slot_count; slot++)
		if (s->slots[slot] != GI_NONE)
			most += 2 * s->objects[s->slots[slot]].bvh.primitive_count;
	*l = (lights){.triangles = calloc(3 * (size_t)most + 1, sizeof *l->triangles),
		      .powers = calloc((size_t)most + 1, sizeof *l->powers)};
	if (!l->triangles || !l->powers)
		return false;
	for (uint32_t slot = 0; slot < s->slot_count; slot++)
		if (s->slots[slot] != GI_NONE)
			add_object_lights(s, &s->objects[s->slots[slot]], l);
	set_slices(l);
	return true;
}

static gi_result upload_lights(gi_context *gi, path_scene *out)
{
	lights l;
	gi_result result = GI_OK;
	if (find_lights(&gi->scene, &l))
		result = gpu_buffer_allocate(&gi->gpu, &gi->paths->lights, sizeof(gi_uvec4) * 3 * l.count, l.triangles);
	else
		result = gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	out->light_count = l.count;
	out->density = l.count ? (float)(1 / l.power) : 0;
	free(l.triangles);
	free(l.powers);
	return result;
}

/* ---- batches ---- */

static float ray_lift(const gi_scene *s)
{
	const float *lower = &s->tlas[0].lower.x, *upper = &s->tlas[0].upper.x;
	float largest = 0;
	for (int k = 0; k < 3; k++)
		largest = fmaxf(largest, fmaxf(fabsf(lower[k]), fabsf(upper[k])));
	return LIFT * largest;
}

/* Vertices of a path, expected, where everything reflects as much as the brightest: down to the roulette, and behind
 * it. */
static double path_length(const gi_scene *s)
{
	double rho = 0;
	for (uint32_t n = 0; n < s->node_count; n++)
		rho = fmax(rho, s->node_exitance[n].w);
	return rho > 0 ? 1 + log(ROULETTE_BELOW) / log(rho) + 1 / (1 - rho) : 1;
}

/* The largest dispatch: as many paths of all leaves as fit its length, or one path of some of them. */
static batch largest_batch(const gi_context *gi, uint32_t leaves, uint32_t paths)
{
	const double vertices = gi->gpu.software ? VERTICES_SOFTWARE : VERTICES_GPU;
	const double fit = fmax(1, vertices / path_length(&gi->scene));
	batch b = {.run = gi->gpu.software ? RUN_SOFTWARE : RUN_GPU};
	b.leaves = (uint32_t)fmin(leaves, fmin(fit, MOST_THREADS));
	b.paths = (uint32_t)fmin(paths, fmax(1, fit / b.leaves));
	const uint32_t most = MOST_THREADS / b.leaves * b.run;
	b.paths = b.paths < most ? b.paths : most;
	return b;
}

static uint32_t threads_of(const batch *b)
{
	return b->leaves * ((b->paths + b->run - 1) / b->run);
}

static void bind_paths(const gi_context *gi, const path_scene *s, uint32_t seed)
{
	const gi_paths *p = gi->paths;
	scene_bind(gi);
	rows_bind(gi); /* for the frame's trees; the rest goes to others */
	gpu_bind_storage(GI_BIND_PATH_SUMS, &p->sums);
	gpu_bind_storage(GI_BIND_PATH_LIGHTS, &p->lights);
	gpu_bind_storage(GI_BIND_PATH_SOBOL, &p->sobol);
	gpu_set_uint(p->program, 5, seed);
	gpu_set_uint(p->program, 6, s->light_count);
	gpu_set_floats(p->program, 7, 4, 1, s->sky_and_lift);
	gpu_set_floats(p->program, 8, 1, 1, &s->density);
}

/* One dispatch; adds what its paths found to totals, and waits. */
static void run_batch(gi_context *gi, const batch *b, gi_vec4 *sums, double *totals)
{
	gi_paths *p = gi->paths;
	const uint32_t values[] = {b->first_leaf, b->leaves, b->first_path, b->paths, b->run}, threads = threads_of(b);
	for (int k = 0; k < 5; k++)
		gpu_set_uint(p->program, k, values[k]);
	gpu_dispatch(&gi->gpu, p->program, threads);
	gpu_buffer_read(&p->sums, 0, sizeof *sums * threads, sums);
	for (uint32_t t = 0; t < threads; t++) {
		double *total = totals + 3 * (size_t)(b->first_leaf + t % b->leaves);
		total[0] += sums[t].x;
		total[1] += sums[t].y;
		total[2] += sums[t].z;
	}
}

static gi_result trace_all(gi_context *gi, uint32_t leaves, const gi_path_options *o, float *irradiance)
{
	const batch largest = largest_batch(gi, leaves, o->paths);
	const uint64_t bytes = sizeof(gi_vec4) * threads_of(&largest);
	path_scene scene = {0};
	gi_result result = upload_lights(gi, &scene);
	if (!result && gi->paths->sums.size < bytes)
		result = gpu_buffer_allocate(&gi->gpu, &gi->paths->sums, bytes, NULL);
	if (result)
		return result;
	gi_vec4 *sums = malloc(bytes);
	double *totals = calloc(3 * (size_t)leaves, sizeof *totals);
	if (sums && totals) {
		if (gi->scene.sky_slot != GI_NONE)
			memcpy(scene.sky_and_lift, gi->def.sky_exitance, sizeof gi->def.sky_exitance);
		scene.sky_and_lift[3] = ray_lift(&gi->scene);
		bind_paths(gi, &scene, o->seed);
		batch b = largest;
		for (b.first_path = 0; b.first_path < o->paths; b.first_path += largest.paths)
			for (b.first_leaf = 0; b.first_leaf < leaves; b.first_leaf += largest.leaves) {
				b.paths = (uint32_t)fmin(largest.paths, o->paths - b.first_path);
				b.leaves = (uint32_t)fmin(largest.leaves, leaves - b.first_leaf);
				run_batch(gi, &b, sums, totals);
			}
		for (size_t k = 0; k < 3 * (size_t)leaves; k++)
			irradiance[k] = (float)(totals[k] / o->paths);
	} else {
		result = gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	}
	free(sums);
	free(totals);
	return result;
}

gi_result gi_trace_paths(gi_context *gi, const gi_path_options *options, float *irradiance, uint32_t capacity,
			 uint32_t *count)
{
	if (!gi || !irradiance || !count)
		return gi_fail_null(gi, "gi_trace_paths: irradiance and count");
	const gi_path_options o = options ? *options : gi_path_options_default();
	*count = 0;
	if (o.paths < 1 || o.paths > MOST_PATHS)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT, "paths %u is outside 1..%d", o.paths, MOST_PATHS);
	if (gi->scene.uncommitted || !gi->rows.fitted)
		return gi_fail(&gi->gpu.log, GI_ERROR_NOT_COMMITTED,
			       "call gi_commit() and gi_update() before gi_trace_paths(): it traces the scene of the last update");
	const uint32_t leaves = gi->scene.leaf_count;
	*count = leaves;
	if (!leaves || !capacity)
		return GI_OK;
	const gi_result result = make_paths(gi);
	return result ? result : trace_all(gi, capacity < leaves ? capacity : leaves, &o, irradiance);
}
