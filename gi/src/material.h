/* What kind of surface a material is. */
#ifndef GI_MATERIAL_H
#define GI_MATERIAL_H

#include "gi/gi.h"

static inline bool material_is_mirror(const gi_material *m)
{
	return m->specular[0] > 0.0f || m->specular[1] > 0.0f || m->specular[2] > 0.0f;
}

static inline bool material_is_glass(const gi_material *m)
{
	return m->transmittance[0] > 0.0f || m->transmittance[1] > 0.0f || m->transmittance[2] > 0.0f;
}

/* Light goes on from it as rays. */
static inline bool material_is_smooth(const gi_material *m)
{
	return material_is_mirror(m) || material_is_glass(m);
}

#endif
