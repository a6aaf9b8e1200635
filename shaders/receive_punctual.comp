#version 450 core
// The irradiance of receivers with normals where there are lights without a surface (receive.glsl).
#define PUNCTUAL
#include "receive.glsl"
