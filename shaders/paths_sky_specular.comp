#version 450 core
// Below a picture of the sky, with mirrors or glass.
#define SPECULAR 1
#define PUNCTUAL 0
#define SKY_IMAGE 10
#include "paths.glsl"
