/* Calls about what a scene may have besides cubes of one material: lights, receivers, probes, pictures of the sky,
 * mirrors and media, shapes that change, textures, other settings. */
#ifndef FUZZ_MORE_H
#define FUZZ_MORE_H

#include "fuzz_input.h"

enum { MORE_CALLS = 17 };
extern void (*const more_calls[MORE_CALLS])(input *in, gi_context *gi);

/* Destroys what those made that is no object, and takes the picture of the sky away. */
void forget_more(input *in, gi_context *gi);

#endif
