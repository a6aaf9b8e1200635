#version 450 core
// A lamp that is not the last, where it may be hidden.
#define SHADOWS
#include "light.glsl"
