#version 450 core
// In a scene without translucent objects.
#include "draw.glsl"
