#include "light_list.h"

#include "context.h"
#include "host_memory.h"

#include <math.h>
#include <string.h>

static const uint32_t LIGHT_COOKIE = 0x47494c31u;

static const float MOST_INTENSITY = 1e12f, FARTHEST = 1e9f, HALF_PI = 1.5707964f, WIDEST_SUN = 0.5f;

gi_light_def gi_light_def_default(void)
{
	return (gi_light_def){
	    .intensity = {1, 1, 1},
	    .direction = {0, 0, -1},
	    .outer_angle = 0.7853982f,
	    .enabled = true,
	    .internal = LIGHT_COOKIE,
	};
}

/* ---- what is taken ---- */

static gi_result refuse(const gi_context *gi, const char *what, float value, const char *range)
{
	return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT, "light: %s %g is outside %s", what, (double)value,
		       range);
}

static bool has_length(const float v[3])
{
	float longest = 0;
	bool finite = true;
	for (int c = 0; c < 3; c++) {
		finite = finite && isfinite(v[c]);
		longest = fmaxf(longest, fabsf(v[c]));
	}
	return finite && longest > 0;
}

static gi_result check_cone(const gi_context *gi, const gi_light_def *def)
{
	if (def->type != GI_LIGHT_SPOT)
		return GI_OK;
	if (!(def->outer_angle > 0 && def->outer_angle <= HALF_PI))
		return refuse(gi, "outer_angle", def->outer_angle, "(0, pi/2]");
	if (!(def->inner_angle >= 0 && def->inner_angle < def->outer_angle))
		return refuse(gi, "inner_angle", def->inner_angle, "[0, outer_angle)");
	return GI_OK;
}

static gi_result check_sizes(const gi_context *gi, const gi_light_def *def)
{
	if (!(def->range >= 0 && isfinite(def->range)))
		return refuse(gi, "range", def->range, "[0, infinity)");
	if (!(def->radius >= 0 && def->radius <= FARTHEST))
		return refuse(gi, "radius", def->radius, "[0, 1e9]");
	if (!(def->angular_radius >= 0 && def->angular_radius <= WIDEST_SUN))
		return refuse(gi, "angular_radius", def->angular_radius, "[0, 0.5]");
	return GI_OK;
}

static gi_result check(const gi_context *gi, const gi_light_def *def)
{
	const gi_log *log = &gi->gpu.log;
	if (def->internal != LIGHT_COOKIE)
		return gi_fail(log, GI_ERROR_INVALID_DEF, "start from gi_light_def_default() or gi_get_light()");
	if ((unsigned)def->type > GI_LIGHT_DIRECTIONAL || (unsigned)def->shown > GI_LIGHT_BY_HOST)
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "light: type or shown is not one of gi.h");
	for (int c = 0; c < 3; c++) {
		if (!(def->intensity[c] >= 0 && def->intensity[c] <= MOST_INTENSITY))
			return refuse(gi, "intensity", def->intensity[c], "[0, 1e12]");
		if (!(fabsf(def->position[c]) <= FARTHEST))
			return refuse(gi, "position", def->position[c], "[-1e9, 1e9]");
	}
	if (def->type != GI_LIGHT_POINT && !has_length(def->direction))
		return gi_fail(log, GI_ERROR_INVALID_ARGUMENT, "light: direction is not finite, or of no length");
	const gi_result result = check_cone(gi, def);
	return result ? result : check_sizes(gi, def);
}

/* ---- places ---- */

bool light_is_there(const light_record *light)
{
	return light->generation & 1;
}

uint32_t light_list_alive(const gi_light_list *l)
{
	uint32_t alive = 0;
	for (uint32_t k = 0; k < l->count; k++)
		alive += light_is_there(&l->list[k]);
	return alive;
}

bool light_list_shines(const gi_light_list *l)
{
	bool shines = false;
	for (uint32_t k = 0; k < l->count; k++) {
		const gi_light_def *d = &l->list[k].def;
		const float brightest = fmaxf(d->intensity[0], fmaxf(d->intensity[1], d->intensity[2]));
		shines = shines || (light_is_there(&l->list[k]) && d->enabled && brightest > 0);
	}
	return shines;
}

static void note(gi_light_list *l, light_record *light, bool moved)
{
	light->moved = light->moved || moved;
	l->changed = true;
	l->generation++;
}

void light_list_seen(gi_light_list *l)
{
	for (uint32_t k = 0; k < l->count; k++)
		l->list[k].moved = false;
	l->changed = false;
}

void light_list_free(gi_light_list *l)
{
	gi_free(l->list);
	*l = (gi_light_list){0};
}

/* The lowest free one, so that what goes and comes again has the same samples. NULL: out of memory. */
static light_record *take_place(gi_light_list *l)
{
	for (uint32_t k = 0; k < l->count; k++)
		if (!light_is_there(&l->list[k]))
			return &l->list[k];
	if ((l->count & (l->count - 1)) == 0) {
		light_record *grown = gi_realloc(l->list, sizeof *grown * (l->count ? 2 * l->count : 1));
		if (!grown)
			return NULL;
		l->list = grown;
	}
	l->list[l->count] = (light_record){0};
	return &l->list[l->count++];
}

static light_record *find(const gi_context *gi, gi_light handle)
{
	const gi_light_list *l = &gi->light_list;
	if (handle.context != gi->number || handle.index1 == 0 || handle.index1 > l->count)
		return NULL;
	light_record *light = &l->list[handle.index1 - 1];
	return light_is_there(light) && light->generation == handle.generation ? light : NULL;
}

/* ---- public ---- */

static gi_result create(gi_context *gi, const gi_light_def *def, gi_light *out)
{
	gi_light_list *l = &gi->light_list;
	if (light_list_alive(l) == GI_MOST_LIGHTS)
		return gi_fail(&gi->gpu.log, GI_ERROR_INVALID_ARGUMENT,
			       "gi_create_light: there are %d lights: destroy one first", GI_MOST_LIGHTS);
	light_record *light = take_place(l);
	if (!light)
		return gi_fail(&gi->gpu.log, GI_ERROR_OUT_OF_MEMORY, "gi_create_light: out of memory");
	light->generation++;
	light->def = *def;
	note(l, light, true);
	*out = (gi_light){(uint32_t)(light - l->list) + 1, light->generation, gi->number};
	return GI_OK;
}

gi_result gi_create_light(gi_context *gi, const gi_light_def *def, gi_light *out)
{
	if (out)
		*out = (gi_light){0};
	if (!gi || !def || !out)
		return gi_fail_null(gi, "gi_create_light: def and out");
	gi_result result = check(gi, def);
	if (result)
		return result;
	const gi_allocator *before = gi_memory_from(&gi->def.allocator);
	result = create(gi, def, out);
	gi_memory_from(before);
	return result;
}

/* Do rays to it go other ways, or are others wanted? */
static bool moves(const gi_light_def *a, const gi_light_def *b)
{
	const bool placed = memcmp(a->position, b->position, sizeof a->position) == 0 &&
			    memcmp(a->direction, b->direction, sizeof a->direction) == 0;
	return a->type != b->type || !placed || a->inner_angle != b->inner_angle || a->outer_angle != b->outer_angle ||
	       a->range != b->range || a->radius != b->radius || a->angular_radius != b->angular_radius;
}

gi_result gi_set_light(gi_context *gi, gi_light light, const gi_light_def *def)
{
	if (!gi || !def)
		return gi_fail_null(gi, "gi_set_light: def");
	light_record *l = find(gi, light);
	if (!l)
		return gi_fail_stale(gi, "gi_set_light", "light");
	const gi_result result = check(gi, def);
	if (result)
		return result;
	const bool moved = moves(&l->def, def);
	if (moved || memcmp(l->def.intensity, def->intensity, sizeof def->intensity) != 0 ||
	    l->def.shown != def->shown || l->def.enabled != def->enabled)
		note(&gi->light_list, l, moved);
	l->def = *def;
	return GI_OK;
}

gi_result gi_get_light(const gi_context *gi, gi_light light, gi_light_def *out)
{
	if (!gi || !out)
		return gi_fail_null(gi, "gi_get_light: out");
	const light_record *l = find(gi, light);
	if (!l)
		return gi_fail_stale(gi, "gi_get_light", "light");
	*out = l->def;
	return GI_OK;
}

gi_result gi_destroy_light(gi_context *gi, gi_light light)
{
	if (!gi)
		return gi_fail_null(gi, "");
	light_record *l = find(gi, light);
	if (!l)
		return gi_fail_stale(gi, "gi_destroy_light", "light");
	l->generation++;
	note(&gi->light_list, l, true);
	return GI_OK;
}

bool gi_light_is_valid(const gi_context *gi, gi_light light)
{
	return gi && find(gi, light);
}
