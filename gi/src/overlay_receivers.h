/* Receivers and probes over the picture, discs and balls in the colour of their light. Made when first asked for. */
#ifndef GI_OVERLAY_RECEIVERS_H
#define GI_OVERLAY_RECEIVERS_H

#include "gpu_draw.h"

struct gi_context;

typedef struct gi_receiver_marks {
	uint32_t program;
	gpu_mesh triangle; /* about the unit disc */
} gi_receiver_marks;

/* Into the host's framebuffer, which is bound; those whose light an update has written. */
gi_result overlay_receivers_draw(struct gi_context *gi, gi_receiver_marks *marks, const gi_view *view,
				 const float clip_from_world[16]);
void overlay_receivers_free(struct gi_context *gi, gi_receiver_marks *marks);

#endif
