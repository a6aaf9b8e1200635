/* Settings that keys turn while a scene plays: how fine, how exact, how fast, how bright. */
#include "player_internal.h"

#include <math.h>
#include <stdio.h>

/* A step is a factor of the root of two; ranges in steps from 1. */
typedef struct range {
	const char *name, *unit;
	double least, most;
} range;

static const range RANGES[PLAYER_SETTING_COUNT] = {
    [PLAYER_SETTING_ROW_TOLERANCE] = {"row tolerance", "", 0.001, 0.32},
    [PLAYER_SETTING_SOLVE_TOLERANCE] = {"solve tolerance", "", 0.001, 1},
    [PLAYER_SETTING_RATE] = {"asked for", " fps", 5, 120},
    [PLAYER_SETTING_LAMPS] = {"lamps", " times as bright", 1.0 / 64, 64},
};

static double step_factor(int steps)
{
	return exp2(0.5 * steps);
}

static double value_of(const player *p, player_setting which)
{
	gi_context_def def = gi_context_def_default();
	gi_get_context_def(p->gi, &def);
	switch (which) {
	case PLAYER_SETTING_ROW_TOLERANCE:
		return (double)def.row_tolerance;
	case PLAYER_SETTING_SOLVE_TOLERANCE:
		return (double)def.solve_tolerance;
	case PLAYER_SETTING_RATE:
		return p->rate.target_ms > 0 ? 1e3 / p->rate.target_ms : 0;
	default:
		return step_factor(p->lamp_steps);
	}
}

/* All that emits, by the same factor. */
static gi_result brighten(player *p, double factor)
{
	const export_objects objects = p->scene->objects(p->scene->user);
	for (uint32_t k = 0; k < objects.count; k++) {
		gi_material value;
		for (uint32_t m = 0; gi_material_count(p->gi, objects.handles[k]) > m; m++) {
			gi_result result = gi_get_material(p->gi, objects.handles[k], m, &value);
			for (int c = 0; c < 3; c++)
				value.exitance[c] *= (float)factor;
			if (!result)
				result = gi_set_material(p->gi, objects.handles[k], m, value);
			if (result)
				return result;
		}
	}
	return GI_OK;
}

gi_result player_setting_turn(player *p, int step)
{
	const range *r = &RANGES[p->setting];
	gi_context_def def = gi_context_def_default();
	gi_get_context_def(p->gi, &def);
	const double value = fmin(fmax(value_of(p, p->setting) * step_factor(step), r->least), r->most);
	switch (p->setting) {
	case PLAYER_SETTING_ROW_TOLERANCE:
		return gi_set_rows(p->gi, (float)value, def.emitter_refinement, def.emitter_samples, def.near_samples);
	case PLAYER_SETTING_SOLVE_TOLERANCE:
		return gi_set_solve(p->gi, (float)value, def.max_sweeps);
	case PLAYER_SETTING_RATE:
		p->rate = frame_budget_make(value);
		return GI_OK;
	default:
		if (step_factor(p->lamp_steps + step) < r->least || step_factor(p->lamp_steps + step) > r->most)
			return GI_OK;
		p->lamp_steps += step;
		return brighten(p, step_factor(step));
	}
}

const char *player_setting_text(const player *p, char *text, size_t size)
{
	const range *r = &RANGES[p->setting];
	const double value = value_of(p, p->setting);
	char bar[17] = "----------------";
	const double share = value > 0 ? log(value / r->least) / log(r->most / r->least) : 0;
	bar[(int)lround(15 * fmin(fmax(share, 0), 1))] = '#';
	snprintf(text, size, "%s %.3g%s  %s", r->name, value, r->unit, bar);
	return text;
}
