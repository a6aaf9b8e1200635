#version 450 core
// The drawn surface under any number of lamps.
#include "draw.glsl"
