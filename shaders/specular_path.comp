#version 450 core
#define TOPS 0
#include "specular_path.glsl"
