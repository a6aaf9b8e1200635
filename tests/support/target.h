/* A square framebuffer of floats that tests draw pictures into. */
#ifndef TESTS_TARGET_H
#define TESTS_TARGET_H

#include "harness.h"

typedef struct target {
	uint32_t size; /* pixels a side */
	uint32_t framebuffer, colour, depth;
	float *pixels; /* 4 * size * size, bottom row first: what was drawn last */
} target;

target target_make(uint32_t size);
void target_free(target *t);

/* Binds it, cleared to black and far away, and draws; the view's sides are the target's. */
gi_result target_try(target *t, gi_context *gi, gi_view view);
/* The same; fails the test on error, or where another framebuffer is bound in the end. */
void target_draw(target *t, gi_context *gi, gi_view view);

/* Of a picture of `size` pixels a side. Looks straight down, parallel, at [-1, 1] x [-1, 1]: pixel (i, j) sees x to the
 * right and -z up. */
gi_view target_look_down(uint32_t size);

#endif
