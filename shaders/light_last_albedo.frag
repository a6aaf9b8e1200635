#version 450 core
// The last lamp, where nothing can hide it, in a scene with textures.
#define LAST
#define ALBEDO
#include "light.glsl"
