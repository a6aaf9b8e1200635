/* Shadows of lights without a surface in pictures: depth maps of each, drawn again when it or something moved. */
#ifndef GI_PUNCTUAL_SHADOW_H
#define GI_PUNCTUAL_SHADOW_H

#include "shadow.h"

typedef struct gi_punctual_shadow {
	gpu_depth_maps maps;
	gpu_buffer uniforms; /* views */
	uint32_t count;      /* lights that pictures are lit by */
	gi_punctual_view views[GI_PIXEL_LIGHTS];
	struct punctual_box *boxes; /* scratch: of the casters; slot_count */
	uint64_t poses;             /* gi_shadow.poses that the maps show */
	bool drawn;                 /* maps are of the committed scene */
} gi_punctual_shadow;

/* Do pictures have lights of theirs, switched off ones too? */
bool punctual_shadow_is_wanted(const struct gi_context *gi);

/* After shadow_update(), where it is wanted. Leaves another framebuffer bound when it drew. */
gi_result punctual_shadow_update(struct gi_context *gi, gi_punctual_shadow *shadow, const gi_shadow *lamps);

/* Maps and numbers of one of them, for the picture's pass. */
void punctual_shadow_bind(const struct gi_context *gi, const gi_punctual_shadow *shadow, uint32_t light);

void punctual_shadow_invalidate(gi_punctual_shadow *shadow); /* after a commit */
void punctual_shadow_free(struct gi_context *gi, gi_punctual_shadow *shadow);

#endif
