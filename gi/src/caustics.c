#include "caustics.h"

#include "binding.h"
#include "context.h"
#include "costs.h"
#include "host_memory.h"
#include "lights.h"
#include "specular.h"

#include <math.h>
#include <string.h>

/* Of all pairs together; where there are more pairs each has fewer. */
enum { MOST_PHOTONS = 1 << 22, MOST_PAIRS = 1 << 14 };

/* Positions along a path are off by less than this many lifts. */
static const float MARGIN_LIFTS = 16;

/* Uniforms: of programs for photons, of caustic_trace.comp besides, of caustic_begin.comp. */
enum { PHOTONS_A_PAIR = 0, PAIR_COUNT = 1, LIFT = 2, ALLOWED = 3 };
enum { BEGIN_PAIR_COUNT = 0, BEGIN_MARGIN = 1, BEGIN_PHOTONS_A_PAIR = 2, BEGIN_ALLOWED = 3, BEGIN_SEEN = 4 };

/* Under a budget of time photons get this share of it. */
static const float SHARE = 0.25f;

/* However little time there is: more than a quarter of these are not worth what a dispatch takes. */
enum { FEWEST = 256 };

/* What a photon is thought to take before one was measured, ms. */
static const float FIRST_PRICE_SOFTWARE = 0.01f, FIRST_PRICE_GPU = 0.00001f;

enum { PROGRAMS = 6 };

struct gi_caustics {
	bool built;    /* photons are of the committed scene */
	bool spread;   /* their radii are of where they are */
	float lift;    /* that rays of theirs begin with, metres */
	uint32_t seen; /* update of the rows up to which they know what moved */
	uint32_t pair_count, photons_a_pair;
	gi_uvec4 *traced;           /* pair_count: lights of the pair whose photons these are */
	gi_caustic_pair *pair_list; /* likewise: those of now, as they are uploaded */
	uint32_t anew;              /* pairs that are traced anew for certain */
	uint32_t missing;           /* photons that some pair may still lack */
	gi_price price;             /* of a photon */
	uint64_t asked_frame;       /* an update in which so many were traced at least */
	uint32_t asked_photons;
	uint32_t begin_program, trace_program, deposit_program, light_program, count_program, radius_program;
	CAUSTIC_BUFFERS(BUFFER_MEMBER)
};

static gi_result out_of_memory(const gi_context *gi)
{
	return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
}

static void list_programs(gi_caustics *c, gpu_program_file list[PROGRAMS])
{
	const gpu_program_file programs[PROGRAMS] = {
	    {"caustic_begin.comp", &c->begin_program},     {"caustic_trace.comp", &c->trace_program},
	    {"caustic_deposit.comp", &c->deposit_program}, {"caustic_light.comp", &c->light_program},
	    {"caustic_count.comp", &c->count_program},     {"caustic_radius.comp", &c->radius_program}};
	memcpy(list, programs, sizeof programs);
}

static gi_result make(gi_context *gi)
{
	if (gi->caustics)
		return GI_OK;
	gi->caustics = gi_calloc(1, sizeof *gi->caustics);
	if (!gi->caustics)
		return out_of_memory(gi);
	gpu_program_file list[PROGRAMS];
	list_programs(gi->caustics, list);
	const gi_result result = gpu_programs_compute(&gi->gpu, list, PROGRAMS);
	if (result)
		caustics_free(gi);
	return result;
}

void caustics_free(gi_context *gi)
{
	gi_caustics *c = gi->caustics;
	if (!c)
		return;
	gpu_program_file list[PROGRAMS];
	list_programs(c, list);
	gpu_programs_free(&gi->gpu, list, PROGRAMS);
	gi_caustics *owner = c;
	CAUSTIC_BUFFERS(BUFFER_FREE)
	gi_free(c->traced);
	gi_free(c->pair_list);
	gi_free(c);
	gi->caustics = NULL;
}

void caustics_invalidate(gi_context *gi)
{
	if (gi->caustics)
		gi->caustics->built = false;
}

/* ---- pairs ---- */

static const object_record *seen_in(const gi_scene *s, uint32_t slot)
{
	const object_record *o = scene_object_in(s, slot);
	return o && object_is_seen(o) ? o : NULL;
}

static bool changed(const object_record *o)
{
	return o->moved || o->relit || o->material_changed;
}

/* Of all objects: what is other than in the update before. */
typedef struct scene_changes {
	bool any; /* something that any pair may see */
	bool moved;
	bool smooth_values; /* of a mirror or glass */
} scene_changes;

static scene_changes find_changes(const gi_scene *s)
{
	scene_changes c = {0};
	for (uint32_t slot = 0; slot < s->slot_count; slot++) {
		const object_record *o = scene_object_in(s, slot);
		c.any = c.any || (o && changed(o));
		c.moved = c.moved || (o && o->moved);
		c.smooth_values = c.smooth_values || (o && o->specular && o->material_changed);
	}
	return c;
}

/* Does what is known of the photons no longer tell which of them are right? Other values of a mirror or glass change
 * photons of all pairs that it is on the way of, and rows that are built anew ask nobody what moved (rows.c). */
static bool all_are_anew(const gi_context *gi, const scene_changes *c)
{
	return c->smooth_values || (c->moved && gi->frame.update.w & GI_UPDATE_REBUILD);
}

/* No photon carries more than this share of what the emitter gives (caustic_trace.comp): from its nearest point the
 * sphere is a cap of solid angle 2 pi (1 - cosine), and radiance is exitance / pi; within it, all round. */
static double largest_share(const gi_object_data *emitter, const gi_object_data *smooth)
{
	double square = 0;
	for (int k = 0; k < 3; k++) {
		const double d = (double)(&emitter->sphere.x)[k] - (&smooth->sphere.x)[k];
		square += d * d;
	}
	const double near = sqrt(square) - emitter->sphere.w, sine = smooth->sphere.w / fmax(near, smooth->sphere.w);
	return sine < 1 ? 2 * (1 - sqrt(1 - sine * sine)) : 4;
}

/* Fills the list, or counts them where it is NULL. */
static uint32_t list_pairs(const gi_context *gi, gi_lights *lights, gi_caustic_pair *pairs)
{
	const gi_scene *s = &gi->scene;
	uint32_t count = 0;
	double most = 0;
	for (uint32_t from = 0; from < s->slot_count; from++) {
		if (lights->first[from] == lights->first[from + 1])
			continue;
		const double power =
		    pairs ? lights_set_slices(lights, lights->first[from], lights->first[from + 1]) : 0;
		for (uint32_t to = 0; to < s->slot_count; to++) {
			const object_record *smooth = to == from ? NULL : seen_in(s, to);
			if (!smooth || !object_is_smooth(smooth) || count == MOST_PAIRS)
				continue;
			if (pairs) {
				const object_record *emitter = &s->objects[s->slots[from]];
				const gi_uvec4 before = gi->caustics->traced[count];
				const bool anew = !gi->caustics->built || before.z != from || before.w != to ||
						  changed(smooth) || changed(emitter);
				pairs[count] = (gi_caustic_pair){
				    .sphere = s->object_data[to].sphere,
				    .power = {(float)power, 0, anew ? 1 : 0, 0},
				    .lights = {lights->first[from], lights->first[from + 1], from, to}};
				most += power * largest_share(&s->object_data[from], &s->object_data[to]);
			}
			count++;
		}
	}
	/* Half the range of the sums: rounding may add to it. */
	for (uint32_t k = 0; pairs && k < count; k++)
		pairs[k].power.w = (float)(most * 0x1p-31);
	return count;
}

static uint32_t photons_for(const gi_context *gi, uint32_t pairs)
{
	const uint32_t most = MOST_PHOTONS / (pairs ? pairs : 1);
	return gi->def.caustic_photons < most ? gi->def.caustic_photons : most;
}

static gi_result allocate(gi_context *gi, uint32_t pairs)
{
	gi_caustics *c = gi->caustics;
	const uint32_t photons = photons_for(gi, pairs);
	if (c->built && c->pair_count == pairs && c->photons_a_pair == photons)
		return GI_OK;
	c->built = false;
	c->pair_count = pairs;
	c->photons_a_pair = photons;
	gi_free(c->traced);
	gi_free(c->pair_list);
	c->traced = gi_calloc((size_t)pairs + 1, sizeof *c->traced);
	c->pair_list = gi_calloc((size_t)pairs + 1, sizeof *c->pair_list);
	if (!c->traced || !c->pair_list)
		return out_of_memory(gi);
	const struct {
		gpu_buffer *buffer;
		const char *label;
		uint64_t size;
	} wanted[] = {
	    {&c->paths, buffer_labels.CAUSTIC_PATHS, sizeof(uint32_t) * GI_CAUSTIC_PATH_WORDS * pairs},
	    {&c->photons, buffer_labels.PHOTONS, sizeof(gi_photon) * (uint64_t)pairs * photons},
	    {&c->sums, buffer_labels.CAUSTIC_SUMS, sizeof(uint32_t) * 3 * (uint64_t)gi->scene.leaf_count},
	    {&c->light, buffer_labels.CAUSTIC_LIGHT, sizeof(gi_vec4) * (uint64_t)gi->scene.leaf_count},
	    {&c->cells, buffer_labels.CAUSTIC_CELLS, sizeof(uint32_t) * GI_CAUSTIC_LEVELS * GI_CAUSTIC_CELLS}};
	gi_result result = GI_OK;
	for (size_t k = 0; !result && k < sizeof wanted / sizeof *wanted; k++)
		if (wanted[k].buffer->size != wanted[k].size)
			result = gpu_buffer_allocate(&gi->gpu, wanted[k].buffer, wanted[k].label, wanted[k].size, NULL);
	return result;
}

/* Where the emitters and the smooth objects are now. */
static gi_result upload_pairs(gi_context *gi, gi_lights *lights)
{
	gi_caustics *c = gi->caustics;
	gi_caustic_pair *pairs = c->pair_list;
	list_pairs(gi, lights, pairs);
	c->anew = 0;
	for (uint32_t k = 0; k < c->pair_count; k++)
		c->anew += pairs[k].power.z > 0;
	gi_result result =
	    gpu_buffer_replace(&gi->gpu, &c->pairs, buffer_labels.CAUSTIC_PAIRS, sizeof *pairs * c->pair_count, pairs);
	if (!result)
		result = gpu_buffer_replace(&gi->gpu, &c->lights, buffer_labels.CAUSTIC_LIGHTS,
					    sizeof(gi_uvec4) * 3 * lights->count, lights->triangles);
	for (uint32_t k = 0; k < c->pair_count; k++)
		c->traced[k] = pairs[k].lights;
	c->built = c->built && !result;
	return result;
}

/* ---- passes ---- */

static void bind(const gi_context *gi)
{
	const gi_caustics *owner = gi->caustics;
	specular_bind(gi);
	CAUSTIC_BUFFERS(BUFFER_BIND)
}

static void run_photons(gi_context *gi, uint32_t program)
{
	const gi_caustics *c = gi->caustics;
	gpu_set_uint(&gi->gpu, program, PHOTONS_A_PAIR, c->photons_a_pair);
	gpu_set_uint(&gi->gpu, program, PAIR_COUNT, c->pair_count);
	gpu_dispatch(&gi->gpu, program, (uint64_t)c->photons_a_pair * c->pair_count);
}

/* A frame late where there is a GPU. */
static void learn_price(gi_context *gi)
{
	gi_caustics *c = gi->caustics;
	if (c->asked_photons && gi->report.frame == c->asked_frame)
		gi_price_add(&c->price, gi->report.pass_ms[GI_PASS_CAUSTICS] / (float)c->asked_photons);
	c->asked_photons = 0;
}

/* Photons of a pair that this update may trace. */
static uint32_t allowed_photons(gi_context *gi, const gi_budget *budget)
{
	const gi_caustics *c = gi->caustics;
	if (!budget || !(budget->ms > 0))
		return c->photons_a_pair;
	const float first = gi->gpu.software ? FIRST_PRICE_SOFTWARE : FIRST_PRICE_GPU, known = gi_price_of(&c->price);
	const float count = SHARE * budget->ms / ((known > 0 ? known : first) * (float)c->pair_count);
	const uint32_t wanted = count < FEWEST ? FEWEST : count > MOST_PHOTONS ? MOST_PHOTONS : (uint32_t)count;
	return wanted < c->photons_a_pair ? wanted : c->photons_a_pair;
}

/* A power of two, so that it seldom changes when something flies off. */
static float lift_of(const gi_scene *s)
{
	int exponent;
	frexpf(scene_ray_lift(s), &exponent);
	return ldexpf(1, exponent);
}

static void trace(gi_context *gi, uint32_t allowed)
{
	gi_caustics *c = gi->caustics;
	const float lift = c->lift = lift_of(&gi->scene), margin = MARGIN_LIFTS * lift;
	gpu_set_uint(&gi->gpu, c->begin_program, BEGIN_PAIR_COUNT, c->pair_count);
	gpu_set_floats(&gi->gpu, c->begin_program, BEGIN_MARGIN, 1, 1, &margin);
	gpu_set_uint(&gi->gpu, c->begin_program, BEGIN_PHOTONS_A_PAIR, c->photons_a_pair);
	gpu_set_uint(&gi->gpu, c->begin_program, BEGIN_ALLOWED, allowed);
	gpu_set_uint(&gi->gpu, c->begin_program, BEGIN_SEEN, c->seen);
	gpu_dispatch(&gi->gpu, c->begin_program, c->pair_count);
	gpu_set_floats(&gi->gpu, c->trace_program, LIFT, 1, 1, &lift);
	gpu_set_uint(&gi->gpu, c->trace_program, ALLOWED, allowed);
	gpu_set_uint(&gi->gpu, c->trace_program, PHOTONS_A_PAIR, c->photons_a_pair);
	gpu_set_uint(&gi->gpu, c->trace_program, PAIR_COUNT, c->pair_count);
	gpu_dispatch(&gi->gpu, c->trace_program, (uint64_t)allowed * c->pair_count);
	gpu_buffer_clear(&gi->gpu, &c->sums, 0, c->sums.size, 0);
	run_photons(gi, c->deposit_program);
	gpu_dispatch(&gi->gpu, c->light_program, gi->scene.leaf_count);
	c->spread = false;
}

/* Which pairs have more photons to come the GPU alone knows: where something moved any of them may. */
static void note_missing(gi_caustics *c, bool moved, uint32_t allowed)
{
	const uint32_t missing = moved || !c->built ? c->photons_a_pair : c->missing;
	c->missing = missing > allowed ? missing - allowed : 0;
}

bool caustics_are_late(const gi_context *gi)
{
	return gi->caustics && gi->caustics->missing > 0;
}

static gi_result update(gi_context *gi, const gi_budget *budget)
{
	gi_lights lights = {0};
	if (!gi->smooth || !gi->def.caustic_photons) {
		caustics_free(gi);
		return GI_OK;
	}
	const scene_changes changes = find_changes(&gi->scene);
	if (all_are_anew(gi, &changes) || (gi->caustics && gi->caustics->lift != lift_of(&gi->scene)))
		caustics_invalidate(gi);
	if (!lights_find(&gi->scene, lights_largest, &gi->light_arena, &lights))
		return out_of_memory(gi);
	const uint32_t pairs = list_pairs(gi, &lights, NULL);
	gi_result result = GI_OK;
	if (pairs)
		result = make(gi);
	else
		caustics_free(gi);
	if (!result && pairs)
		result = allocate(gi, pairs);
	if (!result && pairs)
		result = upload_pairs(gi, &lights);
	if (result || !pairs)
		return result;
	rows_progress(gi, GI_PASS_CAUSTICS);
	gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_CAUSTICS]);
	bind_scene(gi);
	bind_rows(gi);
	bind(gi);
	learn_price(gi);
	const uint32_t allowed = allowed_photons(gi, budget);
	trace(gi, allowed);
	gpu_timer_end(&gi->gpu, &gi->timers[GI_PASS_CAUSTICS]);
	note_missing(gi->caustics, changes.any, allowed);
	gi->caustics->seen = gi->rows.update;
	gi->caustics->asked_frame = gi->frame_number;
	gi->caustics->asked_photons = allowed * gi->caustics->anew;
	gi->caustics->built = true;
	return GI_OK;
}

gi_result caustics_update(gi_context *gi, const gi_budget *budget)
{
	const gi_result result = update(gi, budget);
	if (result)
		caustics_invalidate(gi);
	return result;
}

const gpu_buffer *caustics_light(const gi_context *gi)
{
	return gi->caustics && gi->caustics->built ? &gi->caustics->light : NULL;
}

void caustics_bind_light(const gi_context *gi)
{
	gpu_bind(&gi->gpu, GI_BIND_CAUSTIC_LIGHT, &gi->caustics->light);
}

uint32_t caustics_draw(gi_context *gi, uint32_t *photons_a_pair)
{
	gi_caustics *c = gi->caustics;
	if (!c || !c->built)
		return 0;
	bind(gi);
	if (!c->spread) {
		gpu_buffer_clear(&gi->gpu, &c->cells, 0, c->cells.size, 0);
		run_photons(gi, c->count_program);
		run_photons(gi, c->radius_program);
		c->spread = true;
	}
	*photons_a_pair = c->photons_a_pair;
	return c->pair_count * c->photons_a_pair;
}
