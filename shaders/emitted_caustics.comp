#version 450 core
// The irradiance of each leaf by exitance (emitted.glsl), and what photons bring through mirrors and glass.
#define CAUSTICS
#include "emitted.glsl"
