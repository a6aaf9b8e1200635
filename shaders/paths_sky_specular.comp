#version 450 core
// Likewise, with mirrors or glass.
#define SPECULAR 1
#define SKY_IMAGE 9
#include "paths.glsl"
