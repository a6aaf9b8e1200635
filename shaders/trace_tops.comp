#version 450 core
#define TOPS 1
#include "trace.glsl"
