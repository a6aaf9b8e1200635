#version 450 core
#define SPECULAR
#include "survey.glsl"
