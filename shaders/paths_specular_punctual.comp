#version 450 core
#define SPECULAR 1
#define PUNCTUAL 1
#include "paths.glsl"
