#version 450 core
// The gather in single precision.
#include "single.glsl"
#include "gather.glsl"
