#version 450 core
// The irradiance of each leaf by exitance (emitted.glsl), in a scene without mirrors and glass.
#include "emitted.glsl"
