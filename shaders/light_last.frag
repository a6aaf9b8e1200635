#version 450 core
// The last lamp, where nothing can hide it.
#define LAST
#include "light.glsl"
