#version 450 core
#define SPECULAR
// The gather in single precision.
#include "single.glsl"
#include "gather.glsl"
