/* What is seen in mirrors and through glass: a layer each of what is reflected and what is refracted by the first
 * surface, which the lamps' passes light as they light the picture. */
#ifndef GI_REFLECTIONS_H
#define GI_REFLECTIONS_H

#include "gpu_draw.h"
#include "screen_rect.h"

struct gi_context;

/* Where mirrors and glass are seen: apart from one another, for what lies between them is not to be traced and lit. */
typedef struct reflections_part {
	screen_rect rect;
	bool glass; /* there is a second layer */
} reflections_part;

enum { REFLECTIONS_PARTS = 8 };

typedef struct gi_reflections {
	uint32_t trace_program[4]; /* without and with translucent objects; likewise below a picture of the sky */
	uint32_t add_program, splat_program;
	gpu_target layer; /* of the last view's size */
	gpu_mesh square;
	reflections_part parts[REFLECTIONS_PARTS]; /* of the last view; none overlap */
	uint32_t part_count;
} gi_reflections;

typedef enum gi_layer { GI_LAYER_REFLECTED, GI_LAYER_REFRACTED, GI_LAYER_COUNT } gi_layer;

/* For a scene with mirrors or glass: programs, textures, and where they are seen. */
gi_result reflections_prepare(struct gi_context *gi, gi_reflections *r, const gi_view *view);

/* Traces the layer's rays within a part from the surfaces that are bound (shade.c). */
void reflections_trace(struct gi_context *gi, gi_reflections *r, const screen_rect *rect, gi_layer layer,
		       const gi_view *view, const gpu_mesh *screen);

/* Adds the layer that is bound to the host's picture. lit: GI_UNIT_SO_FAR has light of lamps on it. */
void reflections_add(struct gi_context *gi, gi_reflections *r, const screen_rect *rect, bool lit, const gi_view *view,
		     const int corner[2], const gpu_mesh *screen);

/* Adds caustics to the irradiance of the surfaces that are bound; the target is bound too. False: there are none. */
bool reflections_splat(struct gi_context *gi, gi_reflections *r, const float clip_from_world[16]);

void reflections_free(struct gi_context *gi, gi_reflections *r);

#endif
