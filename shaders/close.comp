#version 450 core
#include "close.glsl"
