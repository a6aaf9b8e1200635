/* Light of emitters through mirrors and glass: photons traced from each emitting object to each smooth one and on,
 * for their leaves' irradiance and the picture. Photons are traced anew where something moved on their paths; what
 * they bring is summed in whole steps, so that all of it is what a scene made at once would have, bit for bit. */
#ifndef GI_CAUSTICS_H
#define GI_CAUSTICS_H

#include "gpu.h"

typedef struct gi_caustics gi_caustics;

/* After the rows of an update, before its solve; specular_update() went before. */
/* Under a budget of time a pair of emitter and smooth object has fewer photons for a while. */
gi_result caustics_update(gi_context *gi, const gi_budget *budget);
/* Pairs may lack photons: the next update goes on. */
bool caustics_are_late(const gi_context *gi);
/* What the leaves receive, for emitted_caustics.comp; 0: there is none, and emitted.comp does. */
uint32_t caustics_emitted_program(const gi_context *gi);
/* Irradiance of the leaves, behind rows_bind(). */
void caustics_bind_light(const gi_context *gi);
const gpu_buffer *caustics_light(const gi_context *gi); /* vec4 a leaf; NULL: there is none */
void caustics_invalidate(gi_context *gi);               /* after a commit */
void caustics_free(gi_context *gi);

/* For the picture: how many photons there are, with their radii up to date, bound for splat.vert. */
uint32_t caustics_draw(gi_context *gi, uint32_t *photons_a_pair);

#endif
