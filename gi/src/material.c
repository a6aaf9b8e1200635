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
