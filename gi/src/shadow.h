/* Shadows of the lamps: a depth map per sample point on a lamp, drawn again when something moved. */
#ifndef GI_SHADOW_H
#define GI_SHADOW_H

#include "gpu_draw.h"
#include "shade_shared.h"

struct gi_context;

typedef struct gi_shadow {
	uint32_t program;
	gpu_mesh mesh;          /* the surface as the rays see it: coarsest flat nodes */
	struct shadow_caster *casters; /* by slot */
	uint32_t caster_count;
	gpu_depth_maps maps;
	gpu_buffer uniforms;
	gi_lamp_block lamps;
	uint64_t generation;    /* redraws so far */
	uint32_t drawn_lamps;   /* generation of gi_lamps that the maps show */
	bool drawn;             /* the maps show the poses below */
	float (*drawn_rows)[12]; /* by slot */
	gpu_range *ranges;      /* scratch: what one lamp's maps draw */
	uint32_t range_capacity;
} gi_shadow;

/* Builds the casters of the committed scene. */
gi_result shadow_create(struct gi_context *gi, gi_shadow *shadow);

/* Brings lamps and maps up to the poses of the last update; nothing when they are. Leaves another framebuffer bound
 * when it drew. */
gi_result shadow_update(struct gi_context *gi, gi_shadow *shadow);

/* Drops what depends on the committed scene; the program stays. */
void shadow_invalidate(struct gi_context *gi, gi_shadow *shadow);
void shadow_free(struct gi_context *gi, gi_shadow *shadow);

#endif
