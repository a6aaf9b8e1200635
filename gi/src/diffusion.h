/* Translucent objects in the solve: the links of subsurface.h on the GPU, and what a sweep does with them. Nothing of
 * it is there in a scene without any. */
#ifndef GI_DIFFUSION_H
#define GI_DIFFUSION_H

#include "gi/gi.h"

typedef struct gi_diffusion gi_diffusion;

/* Makes what is not there for the committed scene; frees all where nothing wants it. */
gi_result diffusion_update(gi_context *gi);
void diffusion_invalidate(gi_context *gi); /* after a commit */
/* The gathers of the committed scene, which leave translucent objects out; false: there are none. */
bool diffusion_gathers(const gi_context *gi, uint32_t *single_precision, uint32_t *double_precision);
/* In places of others (gi_shared.h), behind bind_all(). */
void diffusion_bind(const gi_context *gi);
/* What was emitted and entered, after emitted.comp. */
void diffusion_emitted(gi_context *gi);
/* After a gather, as often as what hands over. */
void diffusion_sweep(gi_context *gi);
void diffusion_free(gi_context *gi);

#endif
