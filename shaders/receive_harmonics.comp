#version 450 core
// Spherical harmonics of the irradiance at receivers without normals (receive.glsl). One thread a receiver.
#define HARMONICS
#include "receive.glsl"
