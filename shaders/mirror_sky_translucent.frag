#version 450 core
// Likewise, with translucent objects.
#define TRANSLUCENT
#define SKY_IMAGE 6
#include "mirror.glsl"
