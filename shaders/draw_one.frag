#version 450 core
// The drawn surface under one lamp.
#define LAMPS 1
#include "draw.glsl"
