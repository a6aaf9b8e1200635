#version 450 core
// With lights without a surface.
#define PUNCTUAL
#include "emitted.glsl"
