/* Path tracing on the trees of the rows' rays (paths.comp): ground truth at any time, without a row. Compiled and
 * allocated by the first gi_trace_paths.
 *
 * The paths of all leaves are cut into runs, one to a slot; slots go on a few vertices a dispatch until none has a path
 * left, so that no dispatch is long. A slot leaves one sum, which is read back and added in double. How runs are cut
 * depends on the scene and the renderer alone: the same seed gives the same bits.
 */
#include "paths.h"

#include "binding.h"
#include "context.h"
#include "host_memory.h"
#include "lights.h"
#include "specular.h"

#include <string.h>

/* As many slots as keep a renderer busy, and as many as one dispatch may have: of 8 vertices each, under half a second
 * on two cores, under a tenth on a GPU of 2020. Runs are not longer than single precision adds up well. */
static const uint32_t ENOUGH_SOFTWARE = 1 << 12, ENOUGH_GPU = 1 << 17, MOST_SOFTWARE = 1 << 16, MOST_GPU = 1 << 20,
		      LONGEST_RUN = 1 << 10;

enum { MOST_PATHS = 1 << 24 };

enum { WITH_SPECULAR = 1, WITH_SKY_IMAGE = 2, WITH_LIGHTS = 4, PATH_PROGRAMS = 8 };
enum { LIGHT_COUNT = 9, SKY_ROWS = 10 }; /* uniforms */

struct gi_paths {
	/* Without mirrors and glass, and with; likewise below a picture of the sky, and with lights that have no
	 * surface: of the eight those that were wanted */
	uint32_t programs[PATH_PROGRAMS];
	PATH_BUFFERS(BUFFER_MEMBER)
};

/* What the shader is told of the scene. */
typedef struct path_scene {
	uint32_t light_count;
	float density;
	float sky_and_lift[4];
} path_scene;

/* What is traced at a time: `leaves` from `first_leaf`, `paths` of each from `first_path`, `run` a slot. */
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
	} dimensions[GI_SOBOL_DIMENSIONS] = {{0, 0, {0}},          {1, 0, {1}},       {2, 1, {1, 3}},
					     {3, 1, {1, 3, 1}},    {3, 2, {1, 1, 1}}, {4, 1, {1, 1, 3, 3}},
					     {4, 4, {1, 3, 5, 13}}};
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
	gi_paths *p = gi->paths = gi_calloc(1, sizeof *p);
	if (!p)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	uint32_t directions[GI_SOBOL_DIMENSIONS][32];
	sobol_directions(directions);
	gi_result result =
	    gpu_buffer_allocate(&gi->gpu, &p->sobol, buffer_labels.PATH_SOBOL, sizeof directions, directions);
	if (!result)
		result = gpu_buffer_allocate(&gi->gpu, &p->going, buffer_labels.PATH_GOING, sizeof(uint32_t), NULL);
	if (result)
		paths_free(gi);
	return result;
}

void paths_free(gi_context *gi)
{
	gi_paths *owner = gi->paths;
	if (!owner)
		return;
	for (int k = 0; k < PATH_PROGRAMS; k++)
		gpu_program_free(&gi->gpu, &owner->programs[k]);
	PATH_BUFFERS(BUFFER_FREE)
	gi_free(owner);
	gi->paths = NULL;
}

static int which_program(const gi_context *gi)
{
	uint32_t lights;
	return (specular_is_ready(gi) ? WITH_SPECULAR : 0) | (sky_shows_image(gi) ? WITH_SKY_IMAGE : 0) |
	       (punctual_lights(gi, &lights) ? WITH_LIGHTS : 0);
}

static uint32_t program_of(const gi_context *gi)
{
	return gi->paths->programs[which_program(gi)];
}

static gi_result make_program(gi_context *gi)
{
	static const char *const files[PATH_PROGRAMS] = {"paths.comp",
							 "paths_specular.comp",
							 "paths_sky.comp",
							 "paths_sky_specular.comp",
							 "paths_punctual.comp",
							 "paths_specular_punctual.comp",
							 "paths_sky_punctual.comp",
							 "paths_sky_specular_punctual.comp"};
	const int which = which_program(gi);
	const gpu_program_file file = {files[which], &gi->paths->programs[which]};
	return program_of(gi) ? GI_OK : gpu_programs_compute(&gi->gpu, &file, 1);
}

/* ---- emitters ---- */

static gi_result upload_lights(gi_context *gi, path_scene *out)
{
	gi_lights l;
	gi_arena arena = {0};
	if (!lights_find(&gi->scene, lights_luminance, &arena, &l))
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	lights_set_slices(&l, 0, l.count);
	const gi_result result = gpu_buffer_allocate(&gi->gpu, &gi->paths->lights, buffer_labels.PATH_LIGHTS,
						     sizeof(gi_uvec4) * 3 * l.count, l.triangles);
	out->light_count = l.count;
	out->density = l.count ? (float)(1 / l.power) : 0;
	gi_arena_free(&arena);
	return result;
}

/* ---- batches ---- */

static uint32_t minimum(uint32_t a, uint32_t b)
{
	return a < b ? a : b;
}

/* As many slots a leaf as keep the renderer busy, as many leaves as fit. */
static batch largest_batch(const gi_context *gi, uint32_t leaves, uint32_t paths)
{
	const uint32_t enough = gi->gpu.software ? ENOUGH_SOFTWARE : ENOUGH_GPU,
		       most = gi->gpu.software ? MOST_SOFTWARE : MOST_GPU;
	batch b = {.leaves = minimum(leaves, most)};
	const uint32_t slots = minimum(paths, (enough + b.leaves - 1) / b.leaves);
	b.run = minimum((paths + slots - 1) / slots, LONGEST_RUN);
	b.paths = minimum(paths, b.run * (most / b.leaves));
	return b;
}

static uint32_t slots_of(const batch *b)
{
	return b->leaves * ((b->paths + b->run - 1) / b->run);
}

static void bind_paths(const gi_context *gi, const path_scene *s, uint32_t seed)
{
	const gi_paths *owner = gi->paths;
	const uint32_t program = program_of(gi);
	bind_scene(gi);
	bind_rows(gi); /* for the frame's trees; the rest goes to others */
	PATH_BUFFERS(BUFFER_BIND)
	if (specular_is_ready(gi))
		specular_bind(gi);
	uint32_t lights;
	const gpu_buffer *punctual = punctual_lights(gi, &lights);
	if (punctual) {
		gpu_bind(&gi->gpu, GI_BIND_PUNCTUAL_LIGHTS, punctual);
		gpu_set_uint(&gi->gpu, program, LIGHT_COUNT, lights);
	}
	if (sky_shows_image(gi))
		sky_bind(gi, program, SKY_ROWS);
	gpu_set_uint(&gi->gpu, program, 5, seed);
	gpu_set_uint(&gi->gpu, program, 6, s->light_count);
	gpu_set_floats(&gi->gpu, program, 7, 4, 1, s->sky_and_lift);
	gpu_set_floats(&gi->gpu, program, 8, 1, 1, &s->density);
}

/* Dispatches until no slot has a path left; adds what they found to totals. Waits. */
static void run_batch(gi_context *gi, const batch *b, gi_path_slot *slots, double *totals)
{
	static const uint32_t minus_one[4] = {0xBF800000u, 0xBF800000u, 0xBF800000u,
					      0xBF800000u}; /* -1.0f: not begun */
	gi_paths *p = gi->paths;
	const uint32_t values[] = {b->first_leaf, b->leaves, b->first_path, b->paths, b->run}, count = slots_of(b);
	for (int k = 0; k < 5; k++)
		gpu_set_uint(&gi->gpu, program_of(gi), k, values[k]);
	gpu_buffer_fill(&gi->gpu, &p->slots, minus_one);
	for (uint32_t going = 1; going;) {
		gpu_buffer_clear(&gi->gpu, &p->going, 0, sizeof going, 0);
		gpu_dispatch(&gi->gpu, program_of(gi), count);
		gpu_buffer_read(&gi->gpu, &p->going, 0, sizeof going, &going);
	}
	gpu_buffer_read(&gi->gpu, &p->slots, 0, sizeof *slots * count, slots);
	for (uint32_t t = 0; t < count; t++) {
		double *total = totals + 3 * (size_t)(b->first_leaf + t % b->leaves);
		total[0] += slots[t].sum.x;
		total[1] += slots[t].sum.y;
		total[2] += slots[t].sum.z;
	}
}

/* Nothing arrives at what is hidden. */
static void darken_unseen(const gi_scene *s, uint32_t leaves, float *irradiance)
{
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		const gi_uvec4 range = s->object_data[slot].nodes;
		if (s->slots[slot] == GI_NONE || scene_slot_is_seen(s, slot))
			continue;
		for (uint32_t leaf = range.z; leaf < minimum(range.w, leaves); leaf++)
			memset(irradiance + 3 * (size_t)leaf, 0, 3 * sizeof *irradiance);
	}
}

static gi_result trace_all(gi_context *gi, uint32_t leaves, const gi_path_options *o, float *irradiance)
{
	const batch largest = largest_batch(gi, leaves, o->paths);
	const uint64_t bytes = sizeof(gi_path_slot) * slots_of(&largest);
	path_scene scene = {0};
	gi_result result = upload_lights(gi, &scene);
	if (!result && gi->paths->slots.size < bytes)
		result = gpu_buffer_allocate(&gi->gpu, &gi->paths->slots, buffer_labels.PATH_SLOTS, bytes, NULL);
	if (result)
		return result;
	gi_path_slot *slots = gi_malloc(bytes);
	double *totals = gi_calloc(3 * (size_t)leaves, sizeof *totals);
	if (slots && totals) {
		scene_sky_exitance(&gi->scene, scene.sky_and_lift);
		scene.sky_and_lift[3] = scene_ray_lift(&gi->scene);
		bind_paths(gi, &scene, o->seed);
		batch b = largest;
		for (b.first_path = 0; b.first_path < o->paths; b.first_path += largest.paths)
			for (b.first_leaf = 0; b.first_leaf < leaves; b.first_leaf += largest.leaves) {
				b.paths = minimum(largest.paths, o->paths - b.first_path);
				b.leaves = minimum(largest.leaves, leaves - b.first_leaf);
				run_batch(gi, &b, slots, totals);
			}
		for (size_t k = 0; k < 3 * (size_t)leaves; k++)
			irradiance[k] = (float)(totals[k] / o->paths);
		darken_unseen(&gi->scene, leaves, irradiance);
	} else {
		result = gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
	}
	gi_free(slots);
	gi_free(totals);
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
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT, "paths %u is outside 1..%d", o.paths,
			       MOST_PATHS);
	if (!gi->rows.fitted || gi->issued_frame <= gi->commit_frame)
		return gi_fail(
		    &gi->gpu.log, GI_ERROR_NOT_COMMITTED,
		    "call gi_commit() and gi_update() before gi_trace_paths(): it traces the scene of the last update");
	if (gi->scene.translucent_leaves)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT,
			       "gi_trace_paths knows no subsurface scattering, and the scene has objects with it");
	if (gpu_check_current(&gi->gpu, "gi_trace_paths"))
		return GI_ERROR_WRONG_CONTEXT;
	const uint32_t leaves = gi->scene.leaf_count;
	*count = leaves;
	if (!leaves || !capacity)
		return GI_OK;
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	gi_result result = make_paths(gi);
	if (!result)
		result = make_program(gi);
	if (!result && sky_shows_image(gi))
		result = sky_upload_texels(gi);
	if (!result)
		result = trace_all(gi, capacity < leaves ? capacity : leaves, &o, irradiance);
	gi_memory_from(before);
	return result;
}
