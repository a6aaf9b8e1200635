#version 450 core
// The irradiance of receivers with normals (receive.glsl). One thread a receiver.
#include "receive.glsl"
