#version 450 core
// Below a picture of the sky, with mirrors or glass, with lights that have no surface.
#define SPECULAR 1
#define PUNCTUAL 1
#define SKY_IMAGE 10
#include "paths.glsl"
