#version 450 core
// The drawn surface under one lamp of 16 samples.
#define ONE_LAMP
#include "draw.glsl"
