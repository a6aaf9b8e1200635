#version 450 core
// Spherical harmonics where there are lights without a surface (receive.glsl).
#define PUNCTUAL
#define HARMONICS
#include "receive.glsl"
