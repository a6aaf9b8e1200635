#version 450 core
#define SPECULAR 1
#define PUNCTUAL 0
#include "paths.glsl"
