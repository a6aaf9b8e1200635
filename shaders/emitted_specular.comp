#version 450 core
// With what comes through mirrors and glass.
#define SPECULAR
#include "emitted.glsl"
