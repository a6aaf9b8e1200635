#version 450 core
// The drawn surface under two lamps.
#define LAMPS 2
#include "draw.glsl"
