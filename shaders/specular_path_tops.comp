#version 450 core
#define TOPS 1
#include "specular_path.glsl"
