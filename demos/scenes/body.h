/* An object of a scene made by code, from a cage of shapes.h. */
#ifndef SCENES_BODY_H
#define SCENES_BODY_H

#include "gi/gi.h"
#include "mesh.h"

#include <stdbool.h>

typedef struct scene_body {
	const char *name;
	gi_scheme scheme;
	uint32_t levels;
	float leaf_size;       /* > 0: instead of levels */
	const float *rho;      /* 3 */
	const float *exitance; /* 3; NULL: dark */
	float position[3];
	float scale;                     /* 0: 1 */
	const gi_subsurface *subsurface; /* NULL: none */
	bool moves;                      /* GI_MOBILITY_MOVABLE, else automatic */
	const engine_mesh *draw;         /* drawn in the cage's place; NULL: the cage's surface */
} scene_body;

/* The defaults, of the cage's points and faces: arrays are the mesh's, neither its materials nor its creases. */
gi_object_def scene_mesh_def(const engine_mesh *cage);

/* Creates the object and frees its cage. */
gi_result scene_add_body(gi_context *gi, const scene_body *body, engine_mesh *cage, gi_object *out);

#endif
