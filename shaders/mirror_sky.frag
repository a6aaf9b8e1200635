#version 450 core
// Below a picture of the sky.
#define SKY_IMAGE 6
#include "mirror.glsl"
