#version 450 core
// In a scene without mirrors and glass.
#include "emitted.glsl"
