#version 450 core
#define SPECULAR 0
#define PUNCTUAL 1
#include "paths.glsl"
