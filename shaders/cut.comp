#version 450 core
#define KEEPS 0
#include "cut.glsl"
