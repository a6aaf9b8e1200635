#version 450 core
// Below a picture of the sky.
#define SPECULAR 0
#define PUNCTUAL 0
#define SKY_IMAGE 10
#include "paths.glsl"
