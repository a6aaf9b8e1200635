#version 450 core
#include "survey.glsl"
