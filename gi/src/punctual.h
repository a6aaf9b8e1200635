/* Light of lights without a surface (light_list.h) on leaves: how much of each arrives at each leaf is remembered, and
 * traced again where something changed it. */
#ifndef GI_PUNCTUAL_H
#define GI_PUNCTUAL_H

#include "gpu.h"

typedef struct gi_punctual gi_punctual;

/* After the rows of an update, before its solve. There is nothing of it without lights. */
gi_result punctual_update(gi_context *gi);
/* For the solve: which program gathers what is emitted, where there are lights; its buffers are bound. Else 0. */
uint32_t punctual_emitted_program(const gi_context *gi);
/* For shaders that read what they bring to rows: binds all of it, and says how many lights there are; 0: none. */
uint32_t punctual_bind(const gi_context *gi);
/* Of all leaves, GI_PUNCTUAL_PARTS vec4; NULL: there are no lights. */
const gpu_buffer *punctual_sums(const gi_context *gi);
/* The lights as shaders have them, by place; for others who trace rays to them. NULL: there are none. */
const gpu_buffer *punctual_lights(const gi_context *gi, uint32_t *count);
/* The same for the CPU, as of the last update. */
const gi_punctual_light *punctual_light_data(const gi_context *gi, uint32_t *count);
void punctual_invalidate(gi_context *gi); /* after a commit */
void punctual_free(gi_context *gi);

#endif
