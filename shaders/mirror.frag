#version 450 core
// In a scene without translucent objects.
#include "mirror.glsl"
