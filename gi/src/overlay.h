/* Pictures of what the library does: edges of leaves, heat maps over leaves. Built when first asked for. */
#ifndef GI_OVERLAY_H
#define GI_OVERLAY_H

#include "gpu_draw.h"

struct gi_context;

typedef struct gi_overlays {
	uint32_t program;      /* of what is known of each leaf by itself */
	uint32_t row_program;  /* of what the row of one leaf has of it */
	gpu_mesh faces, edges; /* two triangles a leaf, and the lines around it */
} gi_overlays;

/* Draws the view's overlay: lines over the picture, or a heat map in place of it. The host's framebuffer is bound. */
gi_result overlay_draw(struct gi_context *gi, gi_overlays *overlays, const gi_view *view,
		       const float clip_from_world[16]);

void overlay_invalidate(struct gi_context *gi, gi_overlays *overlays);
void overlay_free(struct gi_context *gi, gi_overlays *overlays);

#endif
