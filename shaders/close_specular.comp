#version 450 core
#define SPECULAR
#include "close.glsl"
