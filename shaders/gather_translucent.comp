#version 450 core
// The gather in single precision, of a scene in which light is scattered below surfaces.
#define TRANSLUCENT
#include "single.glsl"
#include "gather.glsl"
