#version 450 core
// In a scene with textures.
#define ALBEDO
#include "surface_last.glsl"
