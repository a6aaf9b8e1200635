#include "punctual.h"

#include "binding.h"
#include "context.h"
#include "host_memory.h"
#include "shade_shared.h"
#include "vec3d.h"

#include <math.h>
#include <string.h>

_Static_assert(GI_MOST_PIXEL_LIGHTS == GI_PIXEL_LIGHTS, "gi.h says how many");

/* Uniforms of punctual_trace.comp; the first and the last are punctual_sum.comp's too. */
enum { LIGHT_COUNT = 0, SEEN = 1, ALL = 2, ROWS = 3 };

struct gi_punctual {
	bool built;         /* shares are of the committed scene */
	uint32_t seen;      /* update of the rows up to which they know what moved */
	uint32_t capacity;  /* lights that the buffers have room for, a power of two */
	uint32_t row_count; /* leaves and receivers */
	uint32_t trace_program, sum_program, emitted_program, specular_program;
	gi_punctual_light data[GI_MOST_LIGHTS];
	PUNCTUAL_BUFFERS(BUFFER_MEMBER)
};

static gi_result out_of_memory(const gi_context *gi)
{
	return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "out of memory");
}

/* ---- life ---- */

static gi_result want_program(gi_context *gi, const char *file, uint32_t *program)
{
	return *program ? GI_OK : gpu_programs_compute(&gi->gpu, &(gpu_program_file){file, program}, 1);
}

static gi_result make(gi_context *gi)
{
	if (!gi->punctual)
		gi->punctual = gi_calloc(1, sizeof *gi->punctual);
	gi_punctual *p = gi->punctual;
	if (!p)
		return out_of_memory(gi);
	gi_result result = want_program(gi, "punctual_trace.comp", &p->trace_program);
	if (!result)
		result = want_program(gi, "punctual_sum.comp", &p->sum_program);
	if (!result)
		result = gi->specular_rows ? want_program(gi, "emitted_specular_punctual.comp", &p->specular_program)
					   : want_program(gi, "emitted_punctual.comp", &p->emitted_program);
	return result;
}

void punctual_free(gi_context *gi)
{
	gi_punctual *owner = gi->punctual;
	if (!owner)
		return;
	uint32_t *programs[] = {&owner->trace_program, &owner->sum_program, &owner->emitted_program,
				&owner->specular_program};
	for (size_t k = 0; k < sizeof programs / sizeof *programs; k++)
		gpu_program_free(&gi->gpu, programs[k]);
	PUNCTUAL_BUFFERS(BUFFER_FREE)
	gi_free(owner);
	gi->punctual = NULL;
}

/* Not those of a commit since: maps are of the scene as it is. */
const gi_punctual_light *punctual_light_data(const gi_context *gi, uint32_t *count)
{
	*count = gi->punctual && gi->punctual->built ? gi->light_list.count : 0;
	return *count ? gi->punctual->data : NULL;
}

void punctual_invalidate(gi_context *gi)
{
	if (gi->punctual)
		gi->punctual->built = false;
}

/* ---- buffers ---- */

static gi_result allocate_rows(gi_context *gi)
{
	gi_punctual *p = gi->punctual;
	const uint64_t rows = scene_row_count(&gi->scene), leaves = gi->scene.leaf_count, vec = sizeof(gi_vec4);
	if (p->row_count == rows && p->sums.name && p->linked.size == vec * GI_LINKED_PARTS * leaves)
		return GI_OK;
	p->built = false;
	p->capacity = 0; /* shares are of others */
	p->row_count = 0;
	gi_result result =
	    gpu_buffer_allocate(&gi->gpu, &p->sums, buffer_labels.PUNCTUAL_SUMS, vec * GI_PUNCTUAL_PARTS * rows, NULL);
	if (!result)
		result = gpu_buffer_allocate(&gi->gpu, &p->linked, buffer_labels.LINKED_LIGHT,
					     vec * GI_LINKED_PARTS * leaves, NULL);
	if (!result)
		p->row_count = (uint32_t)rows;
	return result;
}

/* Room for more lights, with the shares that are known. */
static gi_result allocate_lights(gi_context *gi)
{
	gi_punctual *p = gi->punctual;
	const uint32_t count = gi->light_list.count;
	if (count <= p->capacity)
		return GI_OK;
	uint32_t capacity = p->capacity ? p->capacity : 1;
	while (capacity < count)
		capacity *= 2;
	const uint64_t bytes = sizeof(float) * (uint64_t)p->row_count * capacity;
	if (bytes > gpu_buffer_limit(&gi->gpu, bytes))
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY,
			       "%u lights times %u leaves and receivers are too many pairs", count, p->row_count);
	gpu_buffer shares = {0};
	gi_result result = gpu_buffer_allocate(&gi->gpu, &shares, buffer_labels.PUNCTUAL_SHARES, bytes, NULL);
	if (!result)
		result = gpu_buffer_allocate(&gi->gpu, &p->lights, buffer_labels.PUNCTUAL_LIGHTS,
					     sizeof *p->data * capacity, NULL);
	if (result) {
		gpu_buffer_free(&gi->gpu, &shares);
		return result;
	}
	if (p->capacity)
		gpu_buffer_copy(&gi->gpu, &p->shares, 0, &shares, 0, sizeof(float) * p->row_count * p->capacity);
	gpu_buffer_free(&gi->gpu, &p->shares);
	p->shares = shares;
	p->capacity = capacity;
	return GI_OK;
}

/* ---- lights ---- */

static gi_vec4 unit(const float v[3], float w)
{
	const gi_vec3d d = gi_vec3d_load(v);
	double longest = fmax(fabs(d.x), fmax(fabs(d.y), fabs(d.z)));
	longest = longest > 0 ? longest : 1;
	const gi_vec3d scaled = gi_vec3d_scale(d, 1 / longest);
	const double length = gi_vec3d_length(scaled), inverse = length > 0 ? 1 / length : 0;
	return (gi_vec4){(float)(scaled.x * inverse), (float)(scaled.y * inverse), (float)(scaled.z * inverse), w};
}

/* What a spot sends at an angle is clamp(cos * x + y)^2. Nothing is between two cones that are nearly one. */
static gi_vec4 cone_of(const gi_light_def *d)
{
	if (d->type != GI_LIGHT_SPOT)
		return (gi_vec4){0, 1, 0, 0};
	const double outer = cos((double)d->outer_angle), inner = cos((double)d->inner_angle);
	const double scale = 1 / fmax(inner - outer, 1e-6);
	return (gi_vec4){(float)scale, (float)(-outer * scale), 0, 0};
}

static gi_punctual_light data_of(const light_record *light, uint32_t place)
{
	if (!light_is_there(light))
		return (gi_punctual_light){0};
	const gi_light_def *d = &light->def;
	const bool directional = d->type == GI_LIGHT_DIRECTIONAL;
	static const float none[3] = {0}; /* a point's may be anything, infinite too */
	const float *direction = d->type == GI_LIGHT_POINT ? none : d->direction;
	gi_punctual_light p = {
	    .place = {d->position[0], d->position[1], d->position[2], d->radius},
	    .axis = unit(direction, d->range > 0 && !directional ? 1 / (d->range * d->range) : 0),
	    .cone = cone_of(d),
	    .color = {d->intensity[0], d->intensity[1], d->intensity[2], 0},
	    .kind = {GI_PUNCTUAL_THERE, place, 0, 0},
	};
	if (directional)
		p.place = (gi_vec4){-p.axis.x, -p.axis.y, -p.axis.z, tanf(d->angular_radius)};
	p.kind.x |= d->enabled ? GI_PUNCTUAL_ENABLED : 0;
	p.kind.x |= directional ? GI_PUNCTUAL_DIRECTIONAL : 0;
	p.kind.x |= light->moved ? GI_PUNCTUAL_MOVED : 0;
	return p;
}

/* Pictures have so many pixel by pixel at most; the others through the leaves. */
static uint32_t how_shown(const light_record *light, uint32_t *drawn)
{
	if (!light_is_there(light) || light->def.shown == GI_LIGHT_BY_HOST)
		return 0;
	if (light->def.shown == GI_LIGHT_BY_LEAVES || *drawn == GI_PIXEL_LIGHTS)
		return GI_PUNCTUAL_BY_LEAVES;
	++*drawn;
	return GI_PUNCTUAL_BY_PIXELS;
}

/* Is there anything to trace for certain, whatever moved? */
static bool upload_lights(gi_context *gi)
{
	gi_punctual *p = gi->punctual;
	const gi_light_list *l = &gi->light_list;
	uint32_t drawn = 0;
	bool any = false;
	for (uint32_t k = 0; k < l->count; k++) {
		gi_punctual_light now = data_of(&l->list[k], k);
		now.kind.x |= how_shown(&l->list[k], &drawn);
		/* What was switched off may have missed something. */
		any = any || l->list[k].moved || (now.kind.x & ~p->data[k].kind.x & GI_PUNCTUAL_ENABLED);
		p->data[k] = now;
	}
	gpu_buffer_upload(&gi->gpu, &p->lights, 0, sizeof *p->data * l->count, p->data);
	return any;
}

/* ---- an update ---- */

static bool anything_moved(gi_context *gi)
{
	const gi_scene *s = &gi->scene;
	bool moved = receiver_sets_changed(gi);
	for (uint32_t slot = 0; slot < s->slot_count && !moved; slot++) {
		const object_record *o = scene_object_in(s, slot);
		moved = o && o->moved;
	}
	return moved;
}

static void trace(gi_context *gi, bool all)
{
	gi_punctual *p = gi->punctual;
	const uint32_t count = gi->light_list.count, program = p->trace_program;
	gpu_set_uint(&gi->gpu, program, LIGHT_COUNT, count);
	gpu_set_uint(&gi->gpu, program, SEEN, p->seen);
	gpu_set_uint(&gi->gpu, program, ALL, all);
	gpu_set_uint(&gi->gpu, program, ROWS, p->row_count);
	gpu_dispatch(&gi->gpu, program, (uint64_t)count * p->row_count);
}

static void light_leaves(gi_context *gi)
{
	gi_punctual *p = gi->punctual;
	const gi_punctual *owner = p;
	const bool moved = anything_moved(gi) || gi->rows.lost_update > p->seen;
	/* Rows that are built anew ask nobody what moved (rows.c). */
	const bool all = !p->built || (moved && gi->frame.update.w & GI_UPDATE_REBUILD);
	const bool any = upload_lights(gi);
	gpu_timer_begin(&gi->gpu, &gi->timers[GI_PASS_LIGHTS]);
	bind_scene(gi);
	bind_rows(gi);
	PUNCTUAL_BUFFERS(BUFFER_BIND)
	if (all || any || moved)
		trace(gi, all);
	gpu_set_uint(&gi->gpu, p->sum_program, LIGHT_COUNT, gi->light_list.count);
	gpu_set_uint(&gi->gpu, p->sum_program, ROWS, p->row_count);
	gpu_dispatch(&gi->gpu, p->sum_program, p->row_count);
	bind_rows(gi);
	gpu_timer_end(&gi->gpu, &gi->timers[GI_PASS_LIGHTS]);
	p->seen = gi->rows.update;
	p->built = true;
}

gi_result punctual_update(gi_context *gi)
{
	if (!light_list_alive(&gi->light_list) || !scene_row_count(&gi->scene)) {
		punctual_free(gi);
		return GI_OK;
	}
	gi_result result = make(gi);
	if (!result)
		result = allocate_rows(gi);
	if (!result)
		result = allocate_lights(gi);
	if (result)
		return result;
	light_leaves(gi);
	return GI_OK;
}

/* ---- for others ---- */

uint32_t punctual_emitted_program(const gi_context *gi)
{
	const gi_punctual *owner = gi->punctual;
	if (!owner || !owner->built)
		return 0;
	gpu_bind(&gi->gpu, GI_BIND_PUNCTUAL_SUMS, &owner->sums);
	gpu_bind(&gi->gpu, GI_BIND_LINKED_LIGHT, &owner->linked);
	return gi->specular_rows ? owner->specular_program : owner->emitted_program;
}

uint32_t punctual_bind(const gi_context *gi)
{
	const gi_punctual *owner = gi->punctual;
	if (!owner || !owner->built)
		return 0;
	PUNCTUAL_BUFFERS(BUFFER_BIND)
	return gi->light_list.count;
}

const gpu_buffer *punctual_sums(const gi_context *gi)
{
	return gi->punctual && gi->punctual->built ? &gi->punctual->sums : NULL;
}

const gpu_buffer *punctual_lights(const gi_context *gi, uint32_t *count)
{
	*count = gi->punctual && gi->punctual->built ? gi->light_list.count : 0;
	return *count ? &gi->punctual->lights : NULL;
}
