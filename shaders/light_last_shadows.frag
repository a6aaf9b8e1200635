#version 450 core
// The last lamp, where it may be hidden.
#define LAST
#define SHADOWS
#include "light.glsl"
