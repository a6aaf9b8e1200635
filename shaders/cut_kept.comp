#version 450 core
#define KEEPS 1
#include "cut.glsl"
