#include "material.h"

bool material_is_valid(const gi_log *log, const gi_material *m, const char *object, uint32_t index)
{
	for (int c = 0; c < 3; c++) {
		if (!(m->rho[c] >= 0.0f && m->rho[c] < 1.0f)) {
			gi_fail(log, GI_ERROR_INVALID_MATERIAL,
				"object '%s', material %u: rho %g is outside [0,1): a closed scene that reflects "
				"all light has no finite solution",
				object, index, (double)m->rho[c]);
			return false;
		}
		if (!(m->exitance[c] >= 0.0f && m->exitance[c] <= MATERIAL_MAX_EXITANCE)) {
			gi_fail(log, GI_ERROR_INVALID_MATERIAL,
				"object '%s', material %u: exitance %g W/m2 is outside [0, 1e12]", object, index,
				(double)m->exitance[c]);
			return false;
		}
	}
	return true;
}

bool material_emits(const gi_material *m)
{
	return m->exitance[0] + m->exitance[1] + m->exitance[2] > 0;
}

static bool is_black(const float rgb[3])
{
	return rgb[0] == 0.0f && rgb[1] == 0.0f && rgb[2] == 0.0f;
}

bool material_is_mirror(const gi_specular *s)
{
	return !is_black(s->reflectance);
}

bool material_is_glass(const gi_specular *s)
{
	return !is_black(s->transmittance);
}

bool material_is_smooth(const gi_specular *s)
{
	return material_is_mirror(s) || material_is_glass(s);
}

bool material_is_mixed(const gi_material *m, const gi_specular *s)
{
	return s && material_is_smooth(s) && (!is_black(m->rho) || material_emits(m));
}

/* What is wrong with it, or NULL. */
static const char *fault_of(const gi_specular *s, const gi_material *m)
{
	for (int c = 0; c < 3; c++) {
		if (!(s->reflectance[c] >= 0.0f && s->reflectance[c] <= 1.0f))
			return "its reflectance as a mirror is outside [0,1]";
		if (!(s->transmittance[c] >= 0.0f && s->transmittance[c] <= 1.0f))
			return "its transmittance is outside [0,1]";
		if (m->rho[c] + s->reflectance[c] > 1.0f || m->rho[c] + s->transmittance[c] > 1.0f)
			return "rho and what a mirror reflects, or glass lets through, are more than 1 together";
	}
	if (material_is_mirror(s) && material_is_glass(s))
		return "it is a mirror or glass, not both: reflectance or transmittance must be 0";
	if (material_is_glass(s) && !(s->index >= 1.0f && s->index <= 4.0f))
		return "its index of refraction is outside 1..4";
	return NULL;
}

bool material_specular_is_valid(const gi_log *log, const gi_specular *s, const gi_material *m, const char *object,
				uint32_t index)
{
	const char *fault = fault_of(s, m);
	if (fault)
		gi_fail(log, GI_ERROR_INVALID_MATERIAL, "object '%s', material %u: %s", object, index, fault);
	return !fault;
}
