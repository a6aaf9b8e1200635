#version 450 core
#define SPECULAR
#include "assess.glsl"
