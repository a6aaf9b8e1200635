#version 450 core
// The gather in double precision, where light is scattered below surfaces and goes through mirrors or glass.
#define TRANSLUCENT
#define SPECULAR
#include "double.glsl"
#include "gather.glsl"
