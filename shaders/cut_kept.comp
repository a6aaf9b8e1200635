#version 450 core
// The same for the static objects, some of which changed: entries of nodes that are what they were are kept (cut.glsl).
#define KEEPS 1
#include "cut.glsl"
