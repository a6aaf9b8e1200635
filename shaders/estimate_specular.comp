#version 450 core
#define SPECULAR
#include "estimate.glsl"
