#version 450 core
#include "estimate.glsl"
