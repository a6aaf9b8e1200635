#version 450 core
#include "diffusion_enter.glsl"
