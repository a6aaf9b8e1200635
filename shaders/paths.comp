#version 450 core
#define SPECULAR 0
#define PUNCTUAL 0
#include "paths.glsl"
