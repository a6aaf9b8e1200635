#version 450 core
// Of an object with textures of the host.
#define TEXTURED
#include "shade_shared.h"
#include "draw.glsl"
