#version 450 core
#define SPECULAR 1
#include "paths.glsl"
