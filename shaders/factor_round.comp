#version 450 core
// Form factors where some receivers see all round (factor.glsl). One thread an entry.
#define ROUND
#include "factor.glsl"
