#version 450 core
// A lamp that is not the last, where nothing can hide it.
#include "light.glsl"
