#version 450 core
// The last lamp, where it may be hidden, in a scene with textures.
#define LAST
#define SHADOWS
#define ALBEDO
#include "light.glsl"
