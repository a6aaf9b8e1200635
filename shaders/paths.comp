#version 450 core
#define SPECULAR 0
#include "paths.glsl"
