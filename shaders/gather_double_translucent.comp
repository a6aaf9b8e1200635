#version 450 core
// The gather in double precision, of a scene in which light is scattered below surfaces.
#define TRANSLUCENT
#include "double.glsl"
#include "gather.glsl"
