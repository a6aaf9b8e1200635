#version 450 core
// With what comes through mirrors and glass, and lights without a surface.
#define SPECULAR
#define PUNCTUAL
#include "emitted.glsl"
