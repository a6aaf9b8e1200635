#version 450 core
// With translucent objects.
#define TRANSLUCENT
#include "mirror.glsl"
