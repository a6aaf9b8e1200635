#version 450 core
// In a scene without textures.
#define READ_MATERIALS
#include "surface_last.glsl"
