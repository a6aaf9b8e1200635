#version 450 core
#include "assess.glsl"
