#version 450 core
// With translucent objects: all their light comes through the leaves.
#define TRANSLUCENT
#include "draw.glsl"
