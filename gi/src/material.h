/* Which materials are taken. */
#ifndef GI_MATERIAL_H
#define GI_MATERIAL_H

#include "log.h"
#include <stdbool.h>

/* Exitance, W/m2, is at most this: B and area times B stay in the range of floats with every rho below 1. */
#define MATERIAL_MAX_EXITANCE 1e12f

bool material_emits(const gi_material *material);
/* Fails with a line that names the object and the material's number. */
bool material_is_valid(const gi_log *log, const gi_material *material, const char *object, uint32_t index);

/* The same for `specular`, which belongs to `material`. */
bool material_specular_is_valid(const gi_log *log, const gi_specular *specular, const gi_material *material,
				const char *object, uint32_t index);
bool material_is_mirror(const gi_specular *specular);
bool material_is_smooth(const gi_specular *specular);
bool material_is_glass(const gi_specular *specular);
/* A mirror or glass that shines or is not black: what is seen in it adds to its own light. specular may be NULL. */
bool material_is_mixed(const gi_material *material, const gi_specular *specular);

#endif
