#version 450 core
// Below a picture of the sky, with lights that have no surface.
#define SPECULAR 0
#define PUNCTUAL 1
#define SKY_IMAGE 10
#include "paths.glsl"
