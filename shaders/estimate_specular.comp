#version 450 core
// Of rows that see mirrors or glass: what comes by way of these is left out of the rows as of the samples.
#define SPECULAR
#define WITHOUT_SPECULAR_LINKS
#include "estimate.glsl"
